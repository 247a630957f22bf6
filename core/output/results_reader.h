/// ResultsReader: results.h5 of an earlier run, time by time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/output/hdf5_file.h"

namespace sluice {

class ResultsReader {
 public:
  /// Throws std::runtime_error if it cannot be opened or is no results.h5.
  explicit ResultsReader(const std::filesystem::path& file);

  int dimension() const { return dimension_; }
  const std::vector<double>& times() const { return times_; }  ///< [s]
  const std::vector<std::string>& material_names() const { return materials_; }
  std::vector<std::string> fields() const;

  std::size_t particles(std::size_t time) const { return count_.at(time); }
  /// Three coordinates a particle [m].
  std::vector<double> points(std::size_t time) const;
  /// Components as they are stored: those of a particle side by side.
  std::vector<double> field(const std::string& name, std::size_t time) const;
  std::size_t components(const std::string& name) const;
  /// `id` or `material`.
  std::vector<std::int32_t> numbers(const std::string& name, std::size_t time) const;

 private:
  Hdf5File file_;
  int dimension_ = 0;
  std::vector<double> times_;
  std::vector<std::string> materials_;
  std::vector<std::size_t> first_, count_;
};

}  // namespace sluice
