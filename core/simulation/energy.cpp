#include "core/simulation/energy.h"

#include "core/parallel/parallel.h"

namespace sluice {

template <int Dim>
double kinetic_energy(const Scene<Dim>& scene) {
  const Columns& columns = scene.particles.columns;
  const double* mass = columns.data(scene.particles.mass);
  const auto v = columns.pointers<Dim>(scene.particles.velocity);
  return parallel_sum(scene.particles.size(), [&](std::size_t p) {
    double squares = 0;
    for (std::size_t a = 0; a < Dim; ++a) squares += v[a][p] * v[a][p];
    return 0.5 * mass[p] * squares;
  });
}

template <int Dim>
double potential_energy(const Scene<Dim>& scene) {
  const Columns& columns = scene.particles.columns;
  const double* mass = columns.data(scene.particles.mass);
  const auto x = columns.pointers<Dim>(scene.particles.position);
  return parallel_sum(scene.particles.size(), [&](std::size_t p) {
    double height = 0;
    for (std::size_t a = 0; a < Dim; ++a) height -= scene.gravity[a] * x[a][p];
    return mass[p] * height;
  });
}

template double kinetic_energy<2>(const Scene<2>&);
template double kinetic_energy<3>(const Scene<3>&);
template double potential_energy<2>(const Scene<2>&);
template double potential_energy<3>(const Scene<3>&);

}  // namespace sluice
