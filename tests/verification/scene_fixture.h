/// Scenes of the verification tests: a case from a few lines of text, the scheme as a test parameter, and particle
/// columns read by identity, so that sorting does not matter.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/simulation/simulation.h"

namespace sluice {

/// The discretisation that a parameterised test runs with.
struct Scheme {
  std::string shape = "quadratic_bspline";
  std::string transfer = "apic";
  std::string stress_update = "usl";
  double flip_fraction = 1;
  std::string more;  ///< further keys of the section, for example "time_step: 1 ms"

  bool linear() const { return shape == "linear"; }
  bool by_corners() const { return shape.starts_with("cpdi"); }
  bool sized() const { return by_corners() || shape == "ugimp"; }
  bool affine() const { return transfer == "apic" || transfer == "tpic"; }
  std::string text() const {
    return fmt::format("{{shape: {}, transfer: {}, stress_update: {}, flip_fraction: {}{}{}}}", shape, transfer,
                       stress_update, flip_fraction, more.empty() ? "" : ", ", more);
  }
  std::string name() const { return shape + "_" + transfer + "_" + stress_update; }
  Scheme with(const std::string& keys) const {
    Scheme s = *this;
    s.more = keys;
    return s;
  }
};

inline void PrintTo(const Scheme& scheme, std::ostream* out) { *out << scheme.name(); }

/// Every shape function with every transfer and every stress timing. Shapes by corners take no moments, as APIC does.
inline std::vector<Scheme> all_schemes() {
  std::vector<Scheme> schemes;
  for (const char* shape : {"linear", "ugimp", "quadratic_bspline", "cubic_bspline", "cpdi", "cpdi2"})
    for (const char* transfer : {"flip", "apic", "tpic", "xpic"})
      for (const char* stress_update : {"usf", "usl", "musl"})
        schemes.push_back({shape, transfer, stress_update, 1, {}});
  std::erase_if(schemes, [](const Scheme& s) { return s.by_corners() && s.transfer == "apic"; });
  return schemes;
}

inline std::string scheme_name(const ::testing::TestParamInfo<Scheme>& info) { return info.param.name(); }

/// Every transfer with every stress timing, for tests that choose the shape functions themselves.
inline std::vector<Scheme> transfers_and_timings() {
  auto schemes = all_schemes();
  std::erase_if(schemes, [](const Scheme& s) { return s.shape != "quadratic_bspline"; });
  return schemes;
}

inline std::string transfer_and_timing(const ::testing::TestParamInfo<Scheme>& info) {
  return info.param.transfer + "_" + info.param.stress_update;
}

/// Sections of a case file, as YAML.
struct SceneText {
  std::string grid;
  std::string material = "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0}";
  std::string bodies;  ///< list items, each beginning with "- {material: soil, …"
  std::string gravity = "";
  std::string boundaries = "";
  std::string initial_stress = "";
  Scheme scheme = {};
  std::string outflow = "error";
  double end_time = 1e6;
  std::string physics = "total_stress";
  std::string more = "";  ///< further top-level sections, each ending its line

  std::string text() const {
    std::string all = fmt::format("schema: 1\ntitle: verification\nphysics: {}\n{}", physics, more);
    all += fmt::format("grid: {}\nmaterials:\n  soil: {}\nbodies:\n{}\n", grid, material, bodies);
    if (!gravity.empty()) all += fmt::format("gravity: {}\n", gravity);
    if (!boundaries.empty()) all += fmt::format("boundaries: {}\n", boundaries);
    if (!initial_stress.empty()) all += fmt::format("initial_stress: {}\n", initial_stress);
    return all + fmt::format("scheme: {}\noutflow: {}\nend_time: {} s\n", scheme.text(), outflow, end_time);
  }
};

inline std::unique_ptr<Simulation> simulate(const SceneText& scene) {
  return Simulation::create(parse_case(scene.text(), "scene.yaml"));
}

/// What the program says of a case that it refuses; `accepted` if it does not.
inline std::string refusal_of(const SceneText& scene, const std::string& accepted = "") {
  try {
    simulate(scene);
  } catch (const CaseError& error) {
    return error.what();
  }
  return accepted;
}

inline void take_steps(Simulation& simulation, int steps, double until = 1e6) {
  for (int i = 0; i < steps; ++i) simulation.advance(until);
}

/// One component of a column in order of identity; particles that were removed leave zeros.
inline std::vector<double> by_id(const Particles& particles, const std::string& column, int component = 0) {
  const double* from = particles.columns.data(particles.columns.find(column), component);
  std::size_t count = 0;
  for (const auto id : particles.id) count = std::max(count, static_cast<std::size_t>(id) + 1);
  std::vector<double> values(count, 0.0);
  for (std::size_t p = 0; p < particles.size(); ++p) values[static_cast<std::size_t>(particles.id[p])] = from[p];
  return values;
}

/// Sets one component of a column at every particle to value(position of the particle).
template <class Value>
void set_column(Particles& particles, const std::string& column, int component, const Value& value) {
  double* to = particles.columns.data(particles.columns.find(column), component);
  for (std::size_t p = 0; p < particles.size(); ++p) {
    std::array<double, 3> x{};
    for (int a = 0; a < particles.dimension; ++a)
      x[static_cast<std::size_t>(a)] = particles.columns.data(particles.position, a)[p];
    to[p] = value(x);
  }
}

inline double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

inline double largest_magnitude(const std::vector<double>& values) {
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

inline double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

inline double energy(const Simulation& simulation, const std::string& name) {
  for (const auto& [key, value] : simulation.energies())
    if (key == name) return value;
  ADD_FAILURE() << "no energy is called " << name;
  return NAN;
}

inline double kinetic_and_elastic_energy(const Simulation& simulation) {
  return energy(simulation, "kinetic") + energy(simulation, "elastic");
}

inline double total_momentum(const Particles& particles, int component) {
  return dot(by_id(particles, "mass"), by_id(particles, "velocity", component));
}

}  // namespace sluice
