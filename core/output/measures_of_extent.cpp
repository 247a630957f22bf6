/// Measures of how far the main body reaches: front, highest_point, drop_of_highest_point.
#include <utility>
#include <vector>

#include "core/output/main_body.h"
#include "core/output/observation.h"

namespace sluice {

namespace {

/// Reach of the main body along a direction [m], times `sign`, from `origin`.
class Extent : public Observation {
 public:
  Extent(std::vector<double> direction, std::span<const double> cell, double origin, double sign)
      : direction_(std::move(direction)), cell_(cell.begin(), cell.end()), origin_(origin), sign_(sign) {}

  double evaluate(const Particles& particles) const override {
    return sign_ * (front_of_main_body(particles, particles.position, direction_, cell_) - origin_);
  }
  std::string unit() const override { return "m"; }

 private:
  std::vector<double> direction_, cell_;
  double origin_, sign_;
};

std::vector<double> up(const Particles& particles) {
  std::vector<double> direction(static_cast<std::size_t>(particles.dimension), 0.0);
  direction.back() = 1;
  return direction;
}

std::unique_ptr<Observation> make_front(const ObservationCase& observation, const Particles& particles,
                                        std::span<const double> cell) {
  require_direction(observation, particles.dimension);
  refuse_region(observation);
  refuse_field(observation);
  const double start = front_of_main_body(particles, particles.initial_position, observation.direction, cell);
  return std::make_unique<Extent>(observation.direction, cell, start, 1.0);
}

std::unique_ptr<Observation> make_highest_point(const ObservationCase& observation, const Particles& particles,
                                                std::span<const double> cell) {
  refuse_direction(observation);
  refuse_region(observation);
  refuse_field(observation);
  return std::make_unique<Extent>(up(particles), cell, 0.0, 1.0);
}

std::unique_ptr<Observation> make_drop(const ObservationCase& observation, const Particles& particles,
                                       std::span<const double> cell) {
  refuse_direction(observation);
  refuse_region(observation);
  refuse_field(observation);
  const double start = front_of_main_body(particles, particles.initial_position, up(particles), cell);
  return std::make_unique<Extent>(up(particles), cell, start, -1.0);
}

[[maybe_unused]] const bool front_registered = measure_registry().add(
    "front",
    {"Advance [m] along `direction` of the outermost particle of the main body since the start; thrown-off particles "
     "do not count.",
     {}},
    make_front);
[[maybe_unused]] const bool highest_point_registered = measure_registry().add(
    "highest_point", {"Elevation [m] of the highest particle of the main body.", {}}, make_highest_point);
[[maybe_unused]] const bool drop_registered = measure_registry().add(
    "drop_of_highest_point", {"Loss of elevation [m] of the highest point of the main body since the start.", {}},
    make_drop);

}  // namespace
}  // namespace sluice
