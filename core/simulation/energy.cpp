#include "core/simulation/energy.h"

namespace sluice {

template <int Dim>
double kinetic_energy(const Scene<Dim>& scene) {
  const Columns& columns = scene.particles.columns;
  const double* mass = columns.data(scene.particles.mass);
  double sum = 0;
  for (int a = 0; a < Dim; ++a) {
    const double* v = columns.data(scene.particles.velocity, a);
    for (std::size_t p = 0; p < scene.particles.size(); ++p) sum += 0.5 * mass[p] * v[p] * v[p];
  }
  return sum;
}

template <int Dim>
double potential_energy(const Scene<Dim>& scene) {
  const Columns& columns = scene.particles.columns;
  const double* mass = columns.data(scene.particles.mass);
  double sum = 0;
  for (int a = 0; a < Dim; ++a) {
    const double* x = columns.data(scene.particles.position, a);
    for (std::size_t p = 0; p < scene.particles.size(); ++p) sum -= mass[p] * scene.gravity[a] * x[p];
  }
  return sum;
}

template double kinetic_energy<2>(const Scene<2>&);
template double kinetic_energy<3>(const Scene<3>&);
template double potential_energy<2>(const Scene<2>&);
template double potential_energy<3>(const Scene<3>&);

}  // namespace sluice
