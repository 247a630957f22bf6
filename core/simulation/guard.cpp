#include "core/simulation/guard.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include "core/simulation/physics_module.h"

namespace sluice {

namespace {

template <int Dim>
Vector<Dim> vector_at(const Columns& columns, ColumnId id, std::size_t p) {
  Vector<Dim> v;
  for (int a = 0; a < Dim; ++a) v[a] = columns.data(id, a)[p];
  return v;
}

template <int Dim>
double length(const Vector<Dim>& v) {
  double squared = 0;
  for (const double c : v) squared += c * c;
  return std::sqrt(squared);
}

/// "particle 17 (clay_core) at (1.5, 330.25) m, born at (…) m, moving at 3 m/s, in step 1200 at time 12 s"
template <int Dim>
std::string describe(const Scene<Dim>& scene, std::size_t p) {
  const Particles& ps = scene.particles;
  return fmt::format("particle {} ({}) at ({:g}) m, born at ({:g}) m, moving at {:g} m/s, in step {} at time {:g} s",
                     ps.id[p], ps.material_names[static_cast<std::size_t>(ps.material[p])],
                     fmt::join(vector_at<Dim>(ps.columns, ps.position, p), ", "),
                     fmt::join(vector_at<Dim>(ps.columns, ps.initial_position, p), ", "),
                     length<Dim>(vector_at<Dim>(ps.columns, ps.velocity, p)), scene.step + 1, scene.time);
}

}  // namespace

template <int Dim>
void throw_first_bad_particle(const Scene<Dim>& scene) {
  const Particles& ps = scene.particles;
  for (std::size_t p = 0; p < ps.size(); ++p) {
    double stress = 0;
    for (int c = 0; c < symmetric_components<Dim>; ++c) stress += std::abs(ps.columns.data(ps.stress, c)[p]);
    const double volume = ps.columns.data(ps.volume)[p];
    const char* what = nullptr;
    if (!(length<Dim>(vector_at<Dim>(ps.columns, ps.velocity, p)) < 1e150))
      what = "a velocity is not finite";
    else if (!(volume > 0))
      what = "a particle inverts, or more than doubles its volume, in one step";
    else if (!(stress < 1e300))
      what = "a stress is not finite";
    if (what != nullptr)
      throw PhysicsError(
          fmt::format("the physics went bad: {}: {}. The last good state is in the latest checkpoint; a smaller "
                      "time step (scheme.courant, scheme.strain_per_step) is the usual remedy.",
                      what, describe(scene, p)));
  }
  throw PhysicsError(fmt::format("the physics went bad in step {} at time {:g} s", scene.step + 1, scene.time));
}

template <int Dim>
void throw_time_step_collapsed(const Scene<Dim>& scene, const TimeStepLimit& limit) {
  const Particles& ps = scene.particles;
  std::size_t fastest = 0;
  double highest = -1;
  for (std::size_t p = 0; p < ps.size(); ++p)
    if (const double v = length<Dim>(vector_at<Dim>(ps.columns, ps.velocity, p)); v > highest) fastest = p, highest = v;
  throw PhysicsError(
      fmt::format("the physics went bad: the {} limit has cut the time step to {:.3g} s; the fastest is {}", limit.name,
                  limit.seconds, describe(scene, fastest)));
}

template <int Dim>
std::size_t apply_outflow(Scene<Dim>& scene, OutflowPolicy policy) {
  Particles& ps = scene.particles;
  std::vector<std::uint32_t> kept;
  for (std::size_t p = 0; p < ps.size(); ++p) {
    bool inside = true;
    for (int a = 0; a < Dim; ++a) {
      if (scene.grid.periodic[a]) continue;
      double& x = ps.columns.data(ps.position, a)[p];
      double& v = ps.columns.data(ps.velocity, a)[p];
      const double low = scene.grid.min[a], high = scene.grid.max[a], tolerance = 1e-9 * scene.grid.cell[a];
      if (x >= low && x < high) continue;
      const bool by_round_off = x > low - tolerance && x < high + tolerance;
      if (policy == OutflowPolicy::error && !by_round_off)
        throw OutflowError(
            fmt::format("a particle left the grid: {}; make the grid larger, close the face, or set "
                        "`outflow: remove` or `outflow: clamp`",
                        describe(scene, p)));
      if (policy == OutflowPolicy::remove && !by_round_off) {
        inside = false;
        continue;
      }
      const bool below = x < low;
      x = below ? low : std::nextafter(high, low);
      if ((v < 0) == below) v = 0;
    }
    if (inside) kept.push_back(static_cast<std::uint32_t>(p));
  }
  const std::size_t removed = ps.size() - kept.size();
  if (removed > 0) {
    ps.permute(kept);
    scene.blocks.clear();
  }
  return removed;
}

#define SLUICE_INSTANTIATE(Dim)                                                          \
  template void throw_first_bad_particle<Dim>(const Scene<Dim>&);                        \
  template void throw_time_step_collapsed<Dim>(const Scene<Dim>&, const TimeStepLimit&); \
  template std::size_t apply_outflow<Dim>(Scene<Dim>&, OutflowPolicy);
SLUICE_INSTANTIATE(2)
SLUICE_INSTANTIATE(3)
#undef SLUICE_INSTANTIATE

}  // namespace sluice
