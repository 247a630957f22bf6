/// A thick cylinder under inner pressure, a quarter of it in plane strain, for all tests that bring it to equilibrium.
#pragma once

#include "physics/exact/thick_cylinder.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {

/// Radii [m], and the strength of its Tresca clay [Pa].
inline const exact::ThickCylinder cylinder{1, 2, 100e3};

/// `youngs_modulus` and `pressure` as in a case file. The pressure field reaches to 1.1 m, beyond the staircase of
/// particles at the inner face.
inline SceneText quarter_cylinder(double cell, const std::string& youngs_modulus, const std::string& pressure) {
  SceneText scene{.grid = fmt::format("{{min: [0 m, 0 m], max: [2.2 m, 2.2 m], cell: {} m}}", cell),
                  .material = fmt::format("{{model: tresca, density: 2000 kg/m3, youngs_modulus: {}, poisson_ratio: "
                                          "0.3, strength: 100 kPa}}",
                                          youngs_modulus),
                  .bodies =
                      "  - {material: soil, box: {min: [0 m, 0 m], max: [2 m, 2 m]}, difference: [{circle: "
                      "{centre: [0 m, 0 m], radius: 2 m}}, {circle: {centre: [0 m, 0 m], radius: 1 m}}]}",
                  .boundaries = "{left: roller, bottom: roller}"};
  scene.more = fmt::format(
      "surface_loads: [{{pressure: {}, region: {{circle: {{centre: [0 m, 0 m], radius: 1.1 m}}}}, fade: 0.6 m}}]\n",
      pressure);
  return scene;
}

}  // namespace sluice
