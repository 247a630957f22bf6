/// Raster: heights of a surface on a regular grid of points, from an ESRI ASCII file.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/case/node.h"

namespace sluice {

/// Heights in the middles of square cells; between the middles bilinear, in the outer halves of the cells at the edge
/// as at the nearest middle. Where one of the heights that it takes is missing, and outside, there is none.
class Raster {
 public:
  Raster(std::string file, int columns, int rows, std::array<double, 2> corner, double cell,
         std::vector<double> heights);

  const std::string& file() const { return file_; }
  std::optional<double> height(double x, double y) const;       ///< [m]
  std::array<double, 2> slope(double x, double y) const;        ///< where there is a height
  std::array<double, 2> extremes() const { return extremes_; }  ///< lowest and highest [m]
  /// The lower and the upper corner [m].
  std::array<std::array<double, 2>, 2> extent() const;

 private:
  /// The four heights around a point, and where it lies between them, from 0 to 1.
  struct Cell {
    std::array<double, 4> height;  // lower left, lower right, upper left, upper right
    double u, v;
  };
  std::optional<Cell> around(double x, double y) const;

  std::string file_;
  int columns_, rows_;
  std::array<double, 2> corner_;  // lower left, of the cells
  double cell_;
  std::vector<double> heights_;  // from the lower left, row by row; not a number where there is none
  std::array<double, 2> extremes_;
};

/// Reads ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize and NODATA_value (may be absent:
/// -9999), and then the heights, row by row from the north. Lengths in m. Throws CaseError with the place in the file.
Raster read_raster(const std::string& file);

}  // namespace sluice
