/// What the tests of the output share: a folder of one's own and small sets of particles.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/output/provenance.h"
#include "core/particles/particles.h"

namespace sluice::test {

/// A folder that exists as long as the object.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "sluice_test_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// `count` particles in a row, 0.5 m apart, of mass 1 kg, with a strain column; particle i has id i.
inline Particles row_of_particles(std::size_t count, int dimension = 2) {
  Particles particles(dimension);
  particles.columns.declare({"equivalent_plastic_strain", "1", 1, Role::state, "Accumulated plastic strain."});
  particles.columns.declare({"hidden", "1", 2, Role::state, "Not written to results.", false});
  particles.columns.declare({"scratch", "1", 1, Role::derived, "Recomputed within a step."});
  particles.material_names = {"clay", "sand"};
  particles.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 0.25 + 0.5 * static_cast<double>(i);
    for (const auto column : {particles.position, particles.initial_position}) {
      particles.columns.data(column, 0)[i] = x;
      particles.columns.data(column, 1)[i] = 0.25;
    }
    particles.columns.data(particles.mass)[i] = 1;
    particles.id[i] = static_cast<std::int32_t>(i);
    particles.material[i] = static_cast<std::int32_t>(i % 2);
  }
  return particles;
}

/// The state of a row of particles at a time: each has moved by `time` along x, and its strain is its id + time.
inline void set_state(Particles& particles, double time) {
  const auto strain = particles.columns.find("equivalent_plastic_strain");
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.columns.data(particles.position, 0)[i] = particles.columns.data(particles.initial_position, 0)[i] + time;
    particles.columns.data(strain)[i] = particles.id[i] + time;
    particles.columns.data(particles.velocity, 0)[i] = 1;
    particles.columns.data(particles.stress, 3)[i] = -1000 * time;
  }
}

inline Provenance provenance() {
  Provenance result = Provenance::of_this_process();
  result.case_text = "schema: 1\ntitle: a row of particles\n";
  result.resolved_case = "schema: 1\n";
  result.title = "a row of particles";
  result.version = "test";
  result.grid = {{0, 0}, {10, 1}, {1, 1}};
  return result;
}

}  // namespace sluice::test
