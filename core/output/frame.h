/// Frame: the state at one time in the layout of results.h5, one file a frame, while a run is under way.
///
/// A frame file holds the datasets of one time step in the VTKHDF layout (unstructured grid of vertex cells):
/// Points (N, 3), Connectivity (N), Offsets (N + 1), Types (N) and PointData/NAME, (N) or (N, components).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/particles/particles.h"

namespace sluice {

/// A field of the results: one value, or several components, per particle.
struct FieldSpec {
  std::string name;
  std::string unit;
  std::string sentence;
  int components = 1;    ///< as stored: vectors have three also in 2-D, the last one zero
  bool integer = false;  ///< stored as std::int32_t instead of double
  bool operator==(const FieldSpec&) const = default;
};

/// What must be known of a frame to present it in results.h5.
struct FrameHeader {
  double time = 0;  ///< [s]
  std::int64_t step = 0;
  std::size_t points = 0;
};

/// The fields that are written for these particles: all state columns with `output` (but the position, which is
/// Points), displacement, material and id. Sorted by name.
std::vector<FieldSpec> result_fields(const Particles& particles);

/// Writes the file aside and moves it into place. Throws std::runtime_error.
FrameHeader write_frame(const std::filesystem::path& path, const Particles& particles, double time, std::int64_t step);
FrameHeader read_frame_header(const std::filesystem::path& path);
std::vector<FieldSpec> read_frame_fields(const std::filesystem::path& path);

}  // namespace sluice
