/// Measures of a field over material: mean, largest.
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/output/followed_material.h"
#include "core/output/observation.h"

namespace sluice {

namespace {

/// A field at the particles: a scalar, or the component of a vector along a direction.
class Field {
 public:
  Field(const ObservationCase& observation, const Particles& particles)
      : column_(require_field(observation, particles.columns)),
        unit_(particles.columns.specs()[static_cast<std::size_t>(column_.index)].unit) {
    const int components = particles.columns.specs()[static_cast<std::size_t>(column_.index)].components;
    if (components == 1) {
      refuse_direction(observation);
      direction_ = {1};
    } else if (components == particles.dimension) {
      require_direction(observation, particles.dimension);
      direction_ = observation.direction;
    } else {
      throw CaseError(observation.place, "observation '" + observation.name + "': the field '" + *observation.field +
                                             "' is a tensor; fields that can be followed are scalars and vectors");
    }
  }
  double at(const Particles& particles, std::size_t particle) const {
    double sum = 0;
    for (std::size_t k = 0; k < direction_.size(); ++k)
      sum += direction_[k] * particles.columns.data(column_, static_cast<int>(k))[particle];
    return sum;
  }
  const std::string& unit() const { return unit_; }

 private:
  ColumnId column_;
  std::string unit_;
  std::vector<double> direction_;
};

class MeanOfField : public Observation {
 public:
  MeanOfField(const ObservationCase& observation, const Particles& particles)
      : field_(observation, particles), material_(observation, particles) {}
  double evaluate(const Particles& particles) const override {
    const double* volume = particles.columns.data(particles.volume);
    double sum = 0, total = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (!material_.contains(particles, i)) continue;
      sum += volume[i] * field_.at(particles, i);
      total += volume[i];
    }
    return sum / total;  // not a number once all of it has left
  }
  std::string unit() const override { return field_.unit(); }

 private:
  Field field_;
  FollowedMaterial material_;
};

class LargestOfField : public Observation {
 public:
  LargestOfField(const ObservationCase& observation, const Particles& particles)
      : field_(observation, particles), material_(observation, particles) {}
  double evaluate(const Particles& particles) const override {
    double largest = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (!material_.contains(particles, i)) continue;
      const double value = field_.at(particles, i);
      if (!(largest >= value)) largest = value;
    }
    return largest;
  }
  std::string unit() const override { return field_.unit(); }

 private:
  Field field_;
  FollowedMaterial material_;
};

template <class Measure>
std::unique_ptr<Observation> make(const ObservationCase& observation, const Particles& particles,
                                  std::span<const double>) {
  return std::make_unique<Measure>(observation, particles);
}

[[maybe_unused]] const bool mean_registered = measure_registry().add(
    "mean",
    {"Volume-weighted mean of `field` over the material that was in `region` at the start, or over all; of a vector "
     "its component along `direction`.",
     {}},
    make<MeanOfField>);
[[maybe_unused]] const bool largest_registered =
    measure_registry().add("largest",
                           {"Largest value of `field` in the material that was in `region` at the start, or in all; of "
                            "a vector its component along `direction`.",
                            {}},
                           make<LargestOfField>);

}  // namespace
}  // namespace sluice
