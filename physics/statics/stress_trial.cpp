#include "physics/statics/stress_trial.h"

#include <Eigen/Dense>
#include <algorithm>

#include "physics/materials/f_bar.h"

namespace sluice {

namespace {

/// Row and column of the off-diagonal symmetric components, xy (yz xz).
constexpr std::array<std::array<int, 2>, 3> off_diagonal = {{{0, 1}, {1, 2}, {0, 2}}};

template <int Dim>
using Tensor = Eigen::Matrix<double, Dim, Dim>;

/// The gradient of the displacement from its symmetric part and its spin, as StrainIncrements has them.
template <int Dim>
Tensor<Dim> gradient_of(const StrainIncrements<Dim>& s, std::size_t p) {
  Tensor<Dim> l;
  for (int a = 0; a < Dim; ++a) l(a, a) = s.strain[static_cast<std::size_t>(a)][p];
  for (std::size_t k = 0; k < spin_components<Dim>; ++k) {
    const auto [a, b] = off_diagonal[k];
    const double sum = s.strain[3 + k][p], spin = Dim == 2 ? -s.rotation[k][p] : s.rotation[k][p];
    l(a, b) = sum + spin;
    l(b, a) = sum - spin;
  }
  return l;
}

template <int Dim>
void set_gradient(const Tensor<Dim>& l, const StrainIncrements<Dim>& s, std::size_t p) {
  for (int a = 0; a < Dim; ++a) s.strain[static_cast<std::size_t>(a)][p] = l(a, a);
  for (std::size_t k = 0; k < spin_components<Dim>; ++k) {
    const auto [a, b] = off_diagonal[k];
    s.strain[3 + k][p] = 0.5 * (l(a, b) + l(b, a));
    s.rotation[k][p] = (Dim == 2 ? -0.5 : 0.5) * (l(a, b) - l(b, a));
  }
}

}  // namespace

template <int Dim>
StressTrial<Dim>::StressTrial(Scene<Dim>& scene, const StressUpdate<Dim>& stress, const Unknowns<Dim>& unknowns,
                              Kinematics kinematics)
    : scene_(scene), stress_(stress), kinematics_(kinematics) {
  for (const NodeBlock<Dim>& block : scene.blocks.node_blocks())
    for (int n = 0; n < block_nodes<Dim>; ++n) {
      const Index<Dim> node = block.node(n);
      unknown_.push_back(unknowns.find(node));
    }
  const std::size_t count = scene.particles.size();
  for (auto& column : increments_) column.resize(count + column_alignment / sizeof(double));  // vector loops
  if (kinematics == Kinematics::large) {
    for (auto& column : gradient_) column.resize(count);
    for (auto& column : piola_) column.resize(count + column_alignment / sizeof(double));
  }
  if (stress.f_bar()) cells_.resize(scene.blocks, scene.shape->node_shift());
  sound_.resize(scene.blocks.particle_blocks().size());
}

template <int Dim>
void StressTrial<Dim>::keep() {
  kept_.clear();
  Columns& columns = scene_.particles.columns;
  for (const ColumnId id : stress_.materials().updated(scene_.particles))
    for (int c = 0; c < columns.spec(id).components; ++c) {
      const auto values = columns.values(id, c);
      kept_.push_back({columns.data(id, c), {values.begin(), values.end()}});
    }
}

template <int Dim>
void StressTrial<Dim>::restore() {
  for (const Kept& kept : kept_) std::ranges::copy(kept.values, kept.column);
}

template <int Dim>
StrainIncrements<Dim> StressTrial<Dim>::increments(std::size_t first) {
  StrainIncrements<Dim> all;
  for (std::size_t c = 0; c < symmetric_components<Dim>; ++c) all.strain[c] = increments_[c].data() + first;
  for (std::size_t c = 0; c < spin_components<Dim>; ++c)
    all.rotation[c] = increments_[symmetric_components<Dim> + c].data() + first;
  return all;
}

template <int Dim>
bool StressTrial<Dim>::apply(std::span<const double> u, double dt, std::span<double> f) {
  set_motion(u, 1 / dt);
  strain(dt);
  if (stress_.f_bar()) average_dilation();
  const bool sound = update(dt);
  if (sound) {
    if (kinematics_ == Kinematics::small)
      collect(0, Dim, f);
    else
      for (int a = 0; a < Dim; ++a) {
        // The scatter takes symmetric stresses: each component of the force has the row of its own.
        parallel_for(scene_.blocks.particle_blocks().size(), [&](std::size_t b) {
          ScatterInput<Dim> in = scene_.scatter_input(scene_.blocks.particle_blocks()[b]);
          for (int c = 0; c < Dim; ++c)
            in.stress[static_cast<std::size_t>(c)] = piola_[static_cast<std::size_t>(c * Dim + c)].data();
          for (std::size_t k = 0; k < spin_components<Dim>; ++k) {
            const auto [r, s] = off_diagonal[k];
            const int other = r == a ? s : r;
            in.stress[3 + k] =
                piola_[static_cast<std::size_t>(r == a || s == a ? a * Dim + other : r * Dim + s)].data();
          }
          scene_.shape->scatter(ScatterWhat::force, in, 0, nullptr, scene_.nodes.force_tile(b));
        });
        collect(a, a + 1, f);
      }
  }
  return sound;
}

template <int Dim>
void StressTrial<Dim>::set_motion(std::span<const double> values, double share, std::span<const double> change) {
  parallel_for(scene_.blocks.node_blocks().size(), [&](std::size_t b) {
    Lane* const motion = scene_.nodes.motion(b);
    for (int n = 0; n < block_nodes<Dim>; ++n) {
      const auto& own = unknown_[b * block_nodes<Dim> + static_cast<std::size_t>(n)];
      Lane velocity{}, second{};
      for (int a = 0; a < Dim; ++a) {
        if (own[static_cast<std::size_t>(a)] < 0) continue;
        const auto i = static_cast<std::size_t>(own[static_cast<std::size_t>(a)]);
        velocity[a] = share * values[i];
        if (change.empty()) continue;
        if constexpr (Dim == 2)
          velocity[2 + a] = change[i];
        else
          second[a] = change[i];
      }
      motion[n * motion_lanes<Dim>] = velocity;
      if constexpr (Dim == 3) motion[n * motion_lanes<Dim> + 1] = second;
    }
  });
}

template <int Dim>
void StressTrial<Dim>::get_velocity(std::span<double> values) {
  for (std::size_t b = 0; b < scene_.blocks.node_blocks().size(); ++b)
    for (int n = 0; n < block_nodes<Dim>; ++n)
      for (int a = 0; a < Dim; ++a)
        if (const int i = unknown_[b * block_nodes<Dim> + static_cast<std::size_t>(n)][static_cast<std::size_t>(a)];
            i >= 0)
          values[static_cast<std::size_t>(i)] = scene_.nodes.motion(b)[n * motion_lanes<Dim>][a];
}

template <int Dim>
void StressTrial<Dim>::strain(double dt) {
  for_each_block(scene_, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    const StrainIncrements<Dim> own = increments(block.begin);
    scene_.nodes.load_motion(scene_.blocks, b, work.motion_tile.data());
    scene_.shape->gather_strain(scene_.view(block), work.motion_tile.data(), dt, own);
    sound_[b] = 1;
    if (kinematics_ == Kinematics::small) {
      for (double* column : own.rotation) std::fill_n(column, block.end - block.begin, 0.0);
    } else {
      sound_[b] = deform(block, own) ? 1 : 0;
    }
    if (!stress_.f_bar()) return;
    cells_.locate(scene_.view(block));
    volumetric_strain(own, block.end - block.begin, work.numbers.data());
    cells_.clear(b);
    cells_.add(b, scene_.view(block), scene_.particles.columns.data(scene_.particles.volume), work.numbers.data());
  });
}

/// Keeps the inverse of the deformation, and makes the increments those of the middle of the step (29c). False where a
/// particle would be turned inside out: in logarithmic strain nothing else tells.
template <int Dim>
bool StressTrial<Dim>::deform(const ParticleBlock<Dim>& block, const StrainIncrements<Dim>& own) {
  const Tensor<Dim> one = Tensor<Dim>::Identity();
  bool upright = true;
  for (std::uint32_t p = block.begin; p < block.end; ++p) {
    const Tensor<Dim> l = gradient_of<Dim>(own, p - block.begin);
    upright = upright && (one + l).determinant() > 0;
    const Tensor<Dim> inverse = (one + l).inverse();
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) gradient_[static_cast<std::size_t>(a * Dim + b)][p] = inverse(a, b);
    set_gradient<Dim>(2 * l * (2 * one + l).inverse(), own, p - block.begin);
  }
  return upright;
}

template <int Dim>
void StressTrial<Dim>::average_dilation() {
  for_each_block(scene_, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    cells_.mean(scene_.blocks, b, scene_.view(block), work.numbers.data());
    set_volumetric_strain(work.numbers.data(), block.end - block.begin, increments(block.begin));
  });
}

template <int Dim>
bool StressTrial<Dim>::update(double dt) {
  double* const volume = scene_.particles.columns.data(scene_.particles.volume);
  for_each_block(scene_, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>&) {
    for (const Kept& kept : kept_)
      std::copy(kept.values.begin() + block.begin, kept.values.begin() + block.end, kept.column + block.begin);
    const StressReport report = stress_.materials().update_stress(scene_.particles, stress_.inertia(), scene_.blocks,
                                                                  block, increments(block.begin), dt, scene_.time);
    if (!report.sound) sound_[b] = 0;
    if (kinematics_ == Kinematics::large) {
      set_piola(block);
      return;
    }
    for (const Kept& kept : kept_)
      if (kept.column == volume)
        std::copy(kept.values.begin() + block.begin, kept.values.begin() + block.end, volume + block.begin);
    scene_.shape->scatter(ScatterWhat::force, scene_.scatter_input(block), 0, nullptr, scene_.nodes.force_tile(b));
  });
  return std::ranges::all_of(sound_, [](char sound) { return sound != 0; });
}

template <int Dim>
void StressTrial<Dim>::set_piola(const ParticleBlock<Dim>& block) {
  const Columns& columns = scene_.particles.columns;
  for (std::uint32_t p = block.begin; p < block.end; ++p) {
    Tensor<Dim> sigma, inverse;
    for (int a = 0; a < Dim; ++a) sigma(a, a) = columns.data(scene_.particles.stress, a)[p];
    for (int k = 0; k < spin_components<Dim>; ++k) {
      const auto [a, b] = off_diagonal[static_cast<std::size_t>(k)];
      sigma(a, b) = sigma(b, a) = columns.data(scene_.particles.stress, 3 + k)[p];
    }
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) inverse(a, b) = gradient_[static_cast<std::size_t>(a * Dim + b)][p];
    const Tensor<Dim> piola = sigma * inverse.transpose();
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) piola_[static_cast<std::size_t>(a * Dim + b)][p] = piola(a, b);
  }
}

/// Forces of the nodes to the unknowns, components [first, last).
template <int Dim>
void StressTrial<Dim>::collect(int first, int last, std::span<double> f) {
  parallel_for(scene_.blocks.node_blocks().size(), [&](std::size_t b) {
    scene_.nodes.collect_force(scene_.blocks, b);
    const Lane* const force = scene_.nodes.force(b);
    for (int n = 0; n < block_nodes<Dim>; ++n) {
      const auto& own = unknown_[b * block_nodes<Dim> + static_cast<std::size_t>(n)];
      for (int a = first; a < last; ++a) {
        const int i = own[static_cast<std::size_t>(a)];
        if (i >= 0) f[static_cast<std::size_t>(i)] = -force[n][1 + a];
      }
    }
  });
}

template class StressTrial<2>;
template class StressTrial<3>;

}  // namespace sluice
