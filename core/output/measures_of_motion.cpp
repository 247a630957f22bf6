/// Measures of motion: mean_displacement, center_of_mass, kinetic_energy, max_speed.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/output/followed_material.h"
#include "core/output/observation.h"

namespace sluice {

namespace {

/// The place of a particle along a direction [m], as if periodic axes had no ends.
double along(const Particles& particles, std::size_t particle, std::span<const double> direction) {
  double sum = 0;
  for (std::size_t k = 0; k < direction.size(); ++k)
    sum += particles.unrolled_position(particle, static_cast<int>(k)) * direction[k];
  return sum;
}

double start_along(const Particles& particles, std::size_t particle, std::span<const double> direction) {
  double sum = 0;
  for (std::size_t k = 0; k < direction.size(); ++k)
    sum += particles.columns.data(particles.initial_position, static_cast<int>(k))[particle] * direction[k];
  return sum;
}

double speed_squared(const Particles& particles, std::size_t particle) {
  double sum = 0;
  for (int k = 0; k < particles.dimension; ++k) {
    const double v = particles.columns.data(particles.velocity, k)[particle];
    sum += v * v;
  }
  return sum;
}

class MeanDisplacement : public Observation {
 public:
  MeanDisplacement(const ObservationCase& observation, const Particles& particles)
      : direction_(observation.direction), material_(observation, particles) {}

  double evaluate(const Particles& particles) const override {
    const double* mass = particles.columns.data(particles.mass);
    double moment = 0, total = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (!material_.contains(particles, i)) continue;
      moment += mass[i] * (along(particles, i, direction_) - start_along(particles, i, direction_));
      total += mass[i];
    }
    return moment / total;  // not a number once all of it has left
  }
  std::string unit() const override { return "m"; }

 private:
  std::vector<double> direction_;
  FollowedMaterial material_;
};

class CenterOfMass : public Observation {
 public:
  explicit CenterOfMass(std::vector<double> direction) : direction_(std::move(direction)) {}
  double evaluate(const Particles& particles) const override {
    const double* mass = particles.columns.data(particles.mass);
    double moment = 0, total = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      moment += mass[i] * along(particles, i, direction_);
      total += mass[i];
    }
    return moment / total;
  }
  std::string unit() const override { return "m"; }

 private:
  std::vector<double> direction_;
};

class KineticEnergy : public Observation {
 public:
  explicit KineticEnergy(int dimension) : unit_(dimension == 2 ? "J/m" : "J") {}
  double evaluate(const Particles& particles) const override {
    const double* mass = particles.columns.data(particles.mass);
    double energy = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) energy += 0.5 * mass[i] * speed_squared(particles, i);
    return energy;
  }
  std::string unit() const override { return unit_; }

 private:
  std::string unit_;
};

class MaxSpeed : public Observation {
 public:
  double evaluate(const Particles& particles) const override {
    double largest = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) largest = std::max(largest, speed_squared(particles, i));
    return std::sqrt(largest);
  }
  std::string unit() const override { return "m/s"; }
};

std::unique_ptr<Observation> make_mean_displacement(const ObservationCase& observation, const Particles& particles,
                                                    std::span<const double>) {
  require_direction(observation, particles.dimension);
  require_region(observation);
  refuse_field(observation);
  return std::make_unique<MeanDisplacement>(observation, particles);
}

std::unique_ptr<Observation> make_center_of_mass(const ObservationCase& observation, const Particles& particles,
                                                 std::span<const double>) {
  require_direction(observation, particles.dimension);
  refuse_region(observation);
  refuse_field(observation);
  return std::make_unique<CenterOfMass>(observation.direction);
}

std::unique_ptr<Observation> make_kinetic_energy(const ObservationCase& observation, const Particles& particles,
                                                 std::span<const double>) {
  refuse_direction(observation);
  refuse_region(observation);
  refuse_field(observation);
  return std::make_unique<KineticEnergy>(particles.dimension);
}

std::unique_ptr<Observation> make_max_speed(const ObservationCase& observation, const Particles&,
                                            std::span<const double>) {
  refuse_direction(observation);
  refuse_region(observation);
  refuse_field(observation);
  return std::make_unique<MaxSpeed>();
}

[[maybe_unused]] const bool mean_displacement_registered = measure_registry().add(
    "mean_displacement",
    {"Mass-weighted mean displacement [m] along `direction` of the material that was in `region` at the start.", {}},
    make_mean_displacement);
[[maybe_unused]] const bool center_of_mass_registered = measure_registry().add(
    "center_of_mass", {"Place [m] of the center of mass along `direction`.", {}}, make_center_of_mass);
[[maybe_unused]] const bool kinetic_energy_registered = measure_registry().add(
    "kinetic_energy", {"Kinetic energy [J] of all particles (2-D: per metre of thickness).", {}}, make_kinetic_energy);
[[maybe_unused]] const bool max_speed_registered =
    measure_registry().add("max_speed", {"Largest speed [m/s] of any particle.", {}}, make_max_speed);

}  // namespace
}  // namespace sluice
