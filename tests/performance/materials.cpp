#include "materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <string>
#include <vector>

#include "core/case/case_tree.h"
#include "physics/materials/material.h"

namespace {

using namespace sluice;

/// As many points as stay in the second cache, each with a stress at about 50 kPa and strain increments that change
/// sign from update to update, so that the share of points that yield stays what it is. Half of them yield.
template <int Dim>
class Points {
 public:
  Points(const Material& material, std::size_t size) : size_(size) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (auto* columns : {&strain_, &reversed_, &stress_})
      for (auto& column : *columns) column.assign(size, 0.0);
    for (std::size_t i = 0; i < size; ++i)
      for (int k = 0; k < symmetric_components<Dim>; ++k) {
        const double large = i / 16 % 4 == 0 ? 2e-2 : 1e-5;  // whole chunks, as a shear band has it
        strain_[k][i] = Dim == 2 && k == 2 ? 0 : large * normal(random);
        reversed_[k][i] = -strain_[k][i];
        stress_[k][i] = (k < 3 ? -50e3 : 0) + 1e3 * normal(random);
      }
    for (const ColumnSpec& spec : material.columns())
      for (int c = 0; c < spec.components; ++c) state_.emplace_back(size, 0.0);
    for (auto& column : state_) pointers_.push_back(column.data());
    batch_.size = size;
    batch_.dt = 1e-3;
    batch_.state = pointers_;
  }

  void update(const Material& material) {
    auto& strain = forward_ ? strain_ : reversed_;
    forward_ = !forward_;
    for (int k = 0; k < symmetric_components<Dim>; ++k) {
      batch_.strain_increment[k] = strain[k].data();
      batch_.stress[k] = stress_[k].data();
    }
    material.update(batch_);
  }

 private:
  std::size_t size_;
  std::array<std::vector<double>, symmetric_components<Dim>> strain_, reversed_, stress_;
  std::vector<std::vector<double>> state_;
  std::vector<double*> pointers_;
  MaterialBatch<Dim> batch_;
  bool forward_ = true;
};

/// Nanoseconds per point, the least of several bursts taken in turn with the others.
template <int Dim>
void measure(const std::vector<std::pair<std::string, std::string>>& models, bool smoke) {
  using Clock = std::chrono::steady_clock;
  constexpr std::size_t size = 1600;
  std::vector<std::unique_ptr<Material>> materials;
  std::vector<Points<Dim>> points;
  std::vector<double> best(models.size(), 1e300);
  for (const auto& [name, keys] : models) {
    materials.push_back(make_material(read_yaml_text("{" + keys + "}", "benchmark")));
    materials.back()->set_cell_size(1);
    points.emplace_back(*materials.back(), size);
  }
  const int turns = smoke ? 2 : 40, updates = smoke ? 2 : 50;
  for (int turn = 0; turn < turns; ++turn)
    for (std::size_t m = 0; m < models.size(); ++m) {
      points[m].update(*materials[m]);
      const auto start = Clock::now();
      for (int n = 0; n < updates; ++n) points[m].update(*materials[m]);
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      best[m] = std::min(best[m], 1e9 * seconds / (updates * static_cast<double>(size)));
    }
  fmt::print("{}-D\n  {:<34}{:>16}{:>22}\n", Dim, "model", "ns per update", "times mohr_coulomb");
  for (std::size_t m = 0; m < models.size(); ++m)
    fmt::print("  {:<34}{:>16.2f}{:>22.2f}\n", models[m].first, best[m], best[m] / best[0]);
}

}  // namespace

void measure_materials(bool smoke) {
  const std::string soil = "density: 1800 kg/m3, youngs_modulus: 20 MPa, ";
  const std::string mohr = "model: mohr_coulomb, " + soil + "friction_angle: 30 deg, cohesion: 5 kPa";
  const std::vector<std::pair<std::string, std::string>> models = {
      {"mohr_coulomb", mohr},
      {"mohr_coulomb, cut-off", mohr + ", tension_cutoff: 1 kPa"},
      {"mohr_coulomb, softening", mohr + ", softening: {cohesion: 1 kPa, friction_angle: 20 deg, strain: 2}"},
      {"von_mises", "model: von_mises, " + soil + "strength: 20 kPa"},
      {"von_mises, softening",
       "model: von_mises, " + soil +
           "strength_ratio: 0.4, minimum_strength: 1 kPa, softening: {sensitivity: 4, strain: 2}"},
      {"tresca", "model: tresca, " + soil + "strength: 20 kPa"},
      {"drucker_prager", "model: drucker_prager, " + soil + "friction_angle: 30 deg, cohesion: 5 kPa"},
      {"newtonian", "model: newtonian, density: 1000 kg/m3, bulk_modulus: 2 MPa, viscosity: 1 Pa s"},
      {"bingham",
       "model: bingham, density: 1500 kg/m3, bulk_modulus: 2 MPa, shear_modulus: 1 MPa, yield_stress: 1 kPa, "
       "viscosity: 10 Pa s"},
      {"modified_cam_clay",
       "model: modified_cam_clay, density: 1500 kg/m3, critical_stress_ratio: 1, lambda: 0.2, kappa: 0.04, "
       "initial_void_ratio: 1, overconsolidation_ratio: 1.5"},
      {"linear_elastic", "model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 20 MPa"},
  };
  measure<2>(models, smoke);
  measure<3>(models, smoke);
}
