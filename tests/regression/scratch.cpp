#include "tests/regression/scratch.h"

#include <stdlib.h>

#include <fstream>
#include <stdexcept>

namespace sluice::test {

Scratch::Scratch() {
  std::string name = (std::filesystem::temp_directory_path() / "sluice regression XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
  path_ = name;
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void Scratch::write(const std::string& name, const std::string& text) const { std::ofstream(path_ / name) << text; }

const std::string column = R"(schema: 1
title: Collapse of a column of sand
physics: total_stress
grid: {min: [0 m, 0 m], max: [6 m, 3 m], cell: 0.25 m}
gravity: [0, -9.81 m/s2]
materials:
  sand:
    model: mohr_coulomb
    density: 1600 kg/m3
    youngs_modulus: 2 MPa
    friction_angle: 30 deg
    cohesion: 100 Pa
bodies:
  - material: sand
    box: {min: [0 m, 0 m], max: [2 m, 2 m]}
boundaries:
  left: roller
  right: roller
  bottom: {normal: fixed, friction: 0.5}
end_time: 1 s
observe:
  runout: {measure: front, direction: [1, 0]}
output: {every: 0.1 s}
)";

const std::string block = R"(schema: 1
title: A block of two materials that falls
physics: total_stress
grid: {min: [0 m, 0 m, 0 m], max: [4 m, 2 m, 4 m], cell: 0.5 m}
gravity: [0, 0, -9.81 m/s2]
materials:
  stiff: {model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 5 MPa}
  soft: {model: linear_elastic, density: 1500 kg/m3, youngs_modulus: 1 MPa}
bodies:
  - {material: soft, box: {min: [1 m, 0.5 m, 1 m], max: [2.5 m, 1.5 m, 2 m]}}
  - {material: stiff, box: {min: [1 m, 0.5 m, 2 m], max: [2.5 m, 1.5 m, 3 m]}}
boundaries: {bottom: fixed}
end_time: 0.2 s
observe:
  height: {measure: center_of_mass, direction: [0, 0, 1]}
output: {every: 0.05 s}
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::invalid_argument("'" + from + "' does not stand in the text");
  return text.replace(at, from.size(), to);
}

}  // namespace sluice::test
