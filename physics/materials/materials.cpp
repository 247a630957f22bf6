#include "physics/materials/materials.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/parallel/multitarget.h"
#include "core/parallel/parallel.h"
#include "physics/materials/hencky.h"

namespace sluice {

template <int Dim>
Materials<Dim>::Materials(const Case& definition) {
  double cell = 1;  // of equal volume, where the edges differ
  for (const double edge : definition.grid.cell) cell *= edge;
  cell = std::pow(cell, 1.0 / Dim);
  smallest_cell_ = *std::ranges::min_element(definition.grid.cell);
  hencky_ = definition.scheme.strain == "hencky";
  for (const auto& [name, section] : definition.materials) {
    names_.push_back(name);
    sections_.push_back(section);
    materials_.push_back(make_material(section));
    materials_.back()->set_cell_size(cell);
    if (hencky_ && !materials_.back()->linear_elasticity())
      throw CaseError(section.find("model")->place,
                      fmt::format("material '{}': `scheme.strain: hencky` needs a model with linear elasticity, and {} "
                                  "is none; take `strain: jaumann`",
                                  name, section.find("model")->scalar));
  }
}

template <int Dim>
void Materials<Dim>::declare(Columns& particles) {
  if (hencky_)
    initial_volume_ = particles.declare({"initial_volume", "m3", 1, Role::state,
                                         "Volume before the first step, per metre of thickness in 2-D.", false});
  for (const auto& material : materials_) {
    auto& ids = state_.emplace_back();
    auto& components = components_.emplace_back();
    for (const ColumnSpec& spec : material->columns()) {
      ids.push_back(particles.declare(spec));
      components.push_back(spec.components);
    }
  }
}

template <int Dim>
std::vector<ColumnId> Materials<Dim>::updated(const Particles& particles) const {
  std::vector<ColumnId> all{particles.stress, particles.volume};
  if (hencky_) all.push_back(initial_volume_);
  for (const auto& ids : state_)
    for (const ColumnId id : ids)
      if (std::ranges::none_of(all, [&](ColumnId other) { return other.index == id.index; })) all.push_back(id);
  return all;
}

// Multi-target functions need external linkage: the linker chooses among their clones.
namespace stress_update {

/// Turns the stress of n particles by the rotation whose tangent is W: Q = (I - W/2)^-1 (I + W/2).
SLUICE_MULTITARGET void rotate(std::size_t n, const std::array<double*, 4>& stress,
                               const std::array<const double*, 1>& rotation) {
  double* __restrict xx = stress[0];
  double* __restrict yy = stress[1];
  double* __restrict xy = stress[3];
  const double* __restrict w = rotation[0];
#pragma omp simd
  for (std::size_t p = 0; p < n; ++p) {
    const double a = 0.5 * w[p], scale = 1 / (1 + a * a);
    const double cosine = (1 - a * a) * scale, sine = 2 * a * scale;
    const double cosine2 = cosine * cosine - sine * sine, sine2 = 2 * sine * cosine;
    const double centre = 0.5 * (xx[p] + yy[p]), difference = 0.5 * (xx[p] - yy[p]), shear = xy[p];
    const double turned = difference * cosine2 - shear * sine2;
    xx[p] = centre + turned;
    yy[p] = centre - turned;
    xy[p] = difference * sine2 + shear * cosine2;
  }
}

SLUICE_MULTITARGET void rotate(std::size_t n, const std::array<double*, 6>& stress,
                               const std::array<const double*, 3>& rotation) {
#pragma omp simd
  for (std::size_t p = 0; p < n; ++p) {
    const double wxy = 0.5 * rotation[0][p], wyz = 0.5 * rotation[1][p], wxz = 0.5 * rotation[2][p];
    const double k = 2 / (1 + wxy * wxy + wyz * wyz + wxz * wxz);
    // Q = I + k (A + A A), A = W / 2
    const double q00 = 1 - k * (wxy * wxy + wxz * wxz), q01 = k * (wxy - wxz * wyz), q02 = k * (wxz + wxy * wyz);
    const double q10 = k * (-wxy - wyz * wxz), q11 = 1 - k * (wxy * wxy + wyz * wyz), q12 = k * (wyz - wxy * wxz);
    const double q20 = k * (-wxz + wyz * wxy), q21 = k * (-wyz - wxz * wxy), q22 = 1 - k * (wxz * wxz + wyz * wyz);
    const double xx = stress[0][p], yy = stress[1][p], zz = stress[2][p];
    const double xy = stress[3][p], yz = stress[4][p], xz = stress[5][p];
    const double b00 = q00 * xx + q01 * xy + q02 * xz, b01 = q00 * xy + q01 * yy + q02 * yz,
                 b02 = q00 * xz + q01 * yz + q02 * zz;
    const double b10 = q10 * xx + q11 * xy + q12 * xz, b11 = q10 * xy + q11 * yy + q12 * yz,
                 b12 = q10 * xz + q11 * yz + q12 * zz;
    const double b20 = q20 * xx + q21 * xy + q22 * xz, b21 = q20 * xy + q21 * yy + q22 * yz,
                 b22 = q20 * xz + q21 * yz + q22 * zz;
    stress[0][p] = b00 * q00 + b01 * q01 + b02 * q02;
    stress[1][p] = b10 * q10 + b11 * q11 + b12 * q12;
    stress[2][p] = b20 * q20 + b21 * q21 + b22 * q22;
    stress[3][p] = b00 * q10 + b01 * q11 + b02 * q12;
    stress[4][p] = b10 * q20 + b11 * q21 + b12 * q22;
    stress[5][p] = b00 * q20 + b01 * q21 + b02 * q22;
  }
}

/// Largest specific volume [m3/kg], and whether something went wrong.
struct VolumeReport {
  double largest_specific_volume = 0;
  bool sound = true;
};

/// V_new = V exp(tr de), to second order and reversible. A particle that would invert (or more than double) in
/// one step is left with a negative volume, by which it is found.
SLUICE_MULTITARGET VolumeReport update_volume(std::size_t n, const double* __restrict xx, const double* __restrict yy,
                                              const double* __restrict zz, const double* __restrict mass,
                                              double* __restrict volume) {
  double largest = 0;
  int inverted = 0;
#pragma omp simd reduction(max : largest) reduction(+ : inverted)
  for (std::size_t p = 0; p < n; ++p) {
    const double trace = xx[p] + yy[p] + zz[p];
    const bool good = std::abs(trace) < 1;  // false for NaN, too
    const double grown = volume[p] * (1 + 0.5 * trace) / (1 - 0.5 * trace);
    inverted += good ? 0 : 1;
    volume[p] = good ? grown : -std::abs(volume[p]);
    largest = std::max(largest, volume[p] / mass[p]);
  }
  return {largest, inverted == 0};
}

template <std::size_t Components>
SLUICE_MULTITARGET bool all_finite(std::size_t n, const std::array<double*, Components>& stress) {
  int bad = 0;
#pragma omp simd reduction(+ : bad)
  for (std::size_t p = 0; p < n; ++p) {
    double sum = 0;
    for (std::size_t c = 0; c < Components; ++c) sum += std::abs(stress[c][p]);
    bad += sum < 1e300 ? 0 : 1;
  }
  return bad == 0;
}

}  // namespace stress_update

template <int Dim>
StressReport Materials<Dim>::update_stress(Particles& particles, ColumnId inertia, const Blocks<Dim>& blocks,
                                           const ParticleBlock<Dim>& block, const StrainIncrements<Dim>& strain,
                                           double dt, double time) const {
  Columns& columns = particles.columns;
  StressReport report;
  for (std::uint32_t b = block.first_batch; b < block.last_batch; ++b) {
    const Batch& batch = blocks.batches()[b];
    const std::size_t n = batch.end - batch.begin, offset = batch.begin - block.begin;
    const auto m = static_cast<std::size_t>(batch.material);
    MaterialBatch<Dim> material_batch{n, dt, time, {}, {}, {}};
    std::array<const double*, spin_components<Dim>> rotation;
    for (std::size_t c = 0; c < rotation.size(); ++c) rotation[c] = strain.rotation[c] + offset;
    for (int c = 0; c < symmetric_components<Dim>; ++c) {
      material_batch.strain_increment[c] = strain.strain[c] + offset;
      material_batch.stress[c] = columns.data(particles.stress, c) + batch.begin;
    }
    std::array<double*, 32> state;
    std::size_t components = 0;
    for (std::size_t s = 0; s < state_[m].size(); ++s)
      for (int c = 0; c < components_[m][s]; ++c) state[components++] = columns.data(state_[m][s], c) + batch.begin;
    material_batch.state = {state.data(), components};

    double* const volumes = columns.data(particles.volume) + batch.begin;
    double* const initial_volumes = hencky_ ? columns.data(initial_volume_) + batch.begin : nullptr;
    if (hencky_) {
      auto increments = strain.strain;
      for (double*& component : increments) component += offset;
      hencky::begin(n, material_batch.stress, increments, rotation, volumes, initial_volumes,
                    materials_[m]->elasticity());
    } else {
      stress_update::rotate(n, material_batch.stress, rotation);
    }
    materials_[m]->update(material_batch);
    const auto& e = material_batch.strain_increment;
    const auto volume = stress_update::update_volume(n, e[0], e[1], e[2], columns.data(inertia) + batch.begin, volumes);
    if (hencky_) hencky::end(n, material_batch.stress, volumes, initial_volumes);
    std::array<const double*, symmetric_components<Dim>> stress;
    std::ranges::copy(material_batch.stress, stress.begin());
    report.fastest_wave =
        std::max(report.fastest_wave,
                 wave(*materials_[m], materials_[m]->constrained_modulus(stress, n), volume.largest_specific_volume));
    report.sound = report.sound && volume.sound && stress_update::all_finite(n, material_batch.stress);
  }
  return report;
}

template <int Dim>
double Materials<Dim>::stored_energy(const Particles& particles) const {
  const Columns& columns = particles.columns;
  const double* volume = columns.data(particles.volume);
  const double* initial = hencky_ ? columns.data(initial_volume_) : nullptr;
  const auto sigma = columns.pointers<symmetric_components<Dim>>(particles.stress);
  return parallel_sum(particles.size(), [&](std::size_t p) {
    std::array<double, symmetric_components<Dim>> stress;
    for (std::size_t c = 0; c < stress.size(); ++c) stress[c] = sigma[c][p];
    double counted = volume[p];
    if (initial != nullptr && initial[p] > 0) {  // tau, per initial volume
      for (double& component : stress) component *= volume[p] / initial[p];
      counted = initial[p];
    }
    return counted * materials_[static_cast<std::size_t>(particles.material[p])]->stored_energy(stress);
  });
}

template <int Dim>
double Materials<Dim>::fastest_wave(const Particles& particles, ColumnId inertia) const {
  const double* volume = particles.columns.data(particles.volume);
  const double* mass = particles.columns.data(inertia);
  double fastest = 0;
  std::array<const double*, symmetric_components<Dim>> stress;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Material& material = *materials_[static_cast<std::size_t>(particles.material[p])];
    for (std::size_t c = 0; c < stress.size(); ++c)
      stress[c] = particles.columns.data(particles.stress, static_cast<int>(c)) + p;
    fastest = std::max(fastest, wave(material, material.constrained_modulus(stress, 1), volume[p] / mass[p]));
  }
  return fastest;
}

template <int Dim>
double Materials<Dim>::wave(const Material& material, double modulus, double specific_volume) const {
  return std::sqrt(modulus * specific_volume) + 8.0 / 3 * Dim * material.viscosity() * specific_volume / smallest_cell_;
}

template <int Dim>
Node Materials<Dim>::resolved() const {
  Node all;
  all.kind = Node::Kind::map;
  for (std::size_t m = 0; m < names_.size(); ++m) {
    all.keys.emplace_back(names_[m], Place{});
    all.items.push_back(sections_[m]);
  }
  return all;
}

template class Materials<2>;
template class Materials<3>;

}  // namespace sluice
