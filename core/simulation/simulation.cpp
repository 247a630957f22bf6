#include "core/simulation/simulation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/particles/fill.h"
#include "core/simulation/guard.h"
#include "core/simulation/physics_module.h"
#include "core/simulation/time_step.h"

namespace sluice {

namespace {

/// Throws CaseError where a body lies in an obstacle.
template <int Dim>
void require_room(const Scene<Dim>& scene) {
  const Particles& ps = scene.particles;
  for (std::size_t p = 0; scene.obstacles.any() && p < ps.size(); ++p) {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = ps.columns.data(ps.position, a)[p];
    SignedDistance where;
    if (const ObstacleCase* const obstacle = scene.obstacles.at(x, &where))
      throw CaseError(
          obstacle->place,
          fmt::format("obstacles.{}: it holds a part of a body of '{}': the material point at ({:g}) m lies "
                      "{:.3g} m inside",
                      obstacle->name, ps.material_names[static_cast<std::size_t>(ps.material[p])], fmt::join(x, ", "),
                      -where.distance));
  }
}

template <int Dim>
class SimulationOf final : public Simulation {
 public:
  explicit SimulationOf(const Case& definition)
      : definition_(definition),
        scene_(definition),
        module_(physics_registry<Dim>().find(definition.physics, definition.source.place)(definition)) {
    module_->declare(scene_.particles);
    fill_bodies<Dim>(
        definition, scene_.grid, [&](int m) { return module_->density(m); }, scene_.particles);
    scene_.initialise_domains();
    require_room(scene_);
    module_->initialise(scene_);
    scene_.motion.largest_speed_squared = largest_speed_squared();
  }

  double time() const override { return scene_.time; }
  std::int64_t steps() const override { return scene_.step; }
  const Particles& particles() const override { return scene_.particles; }
  Particles& particles() override { return scene_.particles; }

  StepInfo advance(double until) override {
    const double stop = change_materials(until);
    TimeStepLimit dt = choose_time_step(*module_, scene_, stop);
    longest_dt_ = std::max(longest_dt_, dt.seconds);
    if (dt.name != "output" && dt.seconds < collapse * longest_dt_) throw_time_step_collapsed(scene_, dt);
    take_step(dt);
    if (!scene_.motion.inside) removed_ += apply_outflow(scene_, definition_.outflow);
    const bool arrives = stop - scene_.time <= dt.seconds * (1 + 1e-6);
    scene_.time = arrives ? stop : scene_.time + dt.seconds;
    ++scene_.step;
    scene_.previous_dt = dt.seconds;
    return {dt.seconds, dt.name, largest_speed()};
  }

  void require_time_step() const override { choose_time_step(*module_, scene_, definition_.end_time); }

  std::vector<std::pair<std::string, double>> time_step_limits() const override {
    std::vector<std::pair<std::string, double>> limits;
    for (const auto& limit : module_->time_step_limits(scene_)) limits.emplace_back(limit.name, limit.seconds);
    return limits;
  }
  std::vector<std::pair<std::string, double>> energies() const override { return module_->energies(scene_); }
  std::vector<std::pair<std::string, double>> step_numbers() const override {
    auto numbers = module_->step_numbers();
    for (auto& force : scene_.obstacles.forces()) numbers.push_back(std::move(force));
    return numbers;
  }
  std::vector<std::pair<std::string, double>> totals() const override { return module_->totals(); }
  double largest_speed() const override { return std::sqrt(scene_.motion.largest_speed_squared); }
  std::map<std::string, double> stage_seconds() const override { return scene_.clock.seconds(); }
  std::size_t removed_particles() const override { return removed_; }
  std::size_t memory() const override { return scene_.particles.columns.memory(); }
  std::vector<std::pair<std::string, Node>> resolved_sections() const override { return module_->resolved_sections(); }

  void store(Archive& archive) const override {
    store_particles(scene_.particles, archive);
    archive.integers["blocks"] = scene_.blocks.record();
    archive.integers["step"] = {scene_.step, static_cast<std::int64_t>(removed_), static_cast<std::int64_t>(changed_)};
    archive.reals["loop"] = {scene_.time,
                             scene_.previous_dt,
                             scene_.travelled,
                             scene_.motion.largest_speed_squared,
                             scene_.motion.largest_strain_rate,
                             longest_dt_,
                             solved_dt_};
    if (scene_.dashpots.any()) archive.reals["dashpots"] = scene_.dashpots.record();
    module_->store(archive);
  }

  void restore(const Archive& archive) override {
    restore_particles(archive, scene_.particles);
    scene_.blocks.restore(archive.integers.at("blocks"), scene_.particles, scene_.grid, scene_.shape->reach());
    scene_.resize_nodes();
    const auto& step = archive.integers.at("step");
    scene_.step = step[0];
    removed_ = static_cast<std::size_t>(step[1]);
    changed_ = static_cast<std::uint64_t>(step.at(2));
    const auto& loop = archive.reals.at("loop");
    scene_.time = loop[0];
    scene_.previous_dt = loop[1];
    scene_.travelled = loop[2];
    scene_.motion.largest_speed_squared = loop[3];
    scene_.motion.largest_strain_rate = loop[4];
    longest_dt_ = loop.at(5);
    if (loop.size() > 6) solved_dt_ = loop[6];  // older checkpoints have none
    if (scene_.dashpots.any()) scene_.dashpots.restore(archive.reals.at("dashpots"));
    module_->restore(archive);
  }

 private:
  /// A step of that length, or, where the module finds no solution, of a half, a quarter … of it. After that the length
  /// may double from step to step.
  void take_step(TimeStepLimit& dt) {
    const double shortest = smallest_share * dt.seconds;
    if (dt.seconds > solved_dt_) dt = {std::max(solved_dt_, shortest), "solution"};
    for (;;) {
      scene_.move_boundaries(dt.seconds);
      try {
        module_->step(scene_, dt.seconds);
        break;
      } catch (const StepNotSolved&) {
        if (0.5 * dt.seconds < shortest) throw;
        dt = {0.5 * dt.seconds, "solution"};
        solved_dt_ = dt.seconds;
      }
    }
    solved_dt_ *= 2;
  }

  /// Makes the changes of material that are due; returns the time of the next one, at most `until`.
  double change_materials(double until) {
    bool any = false;
    for (std::size_t c = 0; c < definition_.changes.size(); ++c) {
      const ChangeCase& change = definition_.changes[c];
      if (change.at > scene_.time) {
        until = std::min(until, change.at);
        continue;
      }
      if (changed_ & (std::uint64_t{1} << c)) continue;
      changed_ |= std::uint64_t{1} << c;
      const auto number = [&](const std::string& name) {
        return static_cast<std::int32_t>(std::ranges::find(scene_.particles.material_names, name) -
                                         scene_.particles.material_names.begin());
      };
      std::ranges::replace(scene_.particles.material, number(change.material), number(change.becomes));
      scene_.blocks.clear();  // particles are sorted by material
      any = true;
    }
    if (any) module_->materials_changed(scene_);
    return until;
  }

  double largest_speed_squared() const {
    double largest = 0;
    for (std::size_t p = 0; p < scene_.particles.size(); ++p) {
      double squared = 0;
      for (int a = 0; a < Dim; ++a) {
        const double v = scene_.particles.columns.data(scene_.particles.velocity, a)[p];
        squared += v * v;
      }
      largest = std::max(largest, squared);
    }
    return largest;
  }

  Case definition_;
  Scene<Dim> scene_;
  std::unique_ptr<PhysicsModule<Dim>> module_;
  std::size_t removed_ = 0;
  double longest_dt_ = 0;                                       // [s]
  double solved_dt_ = std::numeric_limits<double>::infinity();  // the longest step worth a try [s]
  std::uint64_t changed_ = 0;                                   // a bit for each change of material that has been made

  /// A step shorter than this share of the longest one means that the run goes nowhere.
  static constexpr double collapse = 1e-4;
  /// The shortest step that is tried where there is no solution, as a share of the one that was to be taken.
  static constexpr double smallest_share = 1.0 / 32;
};

}  // namespace

std::unique_ptr<Simulation> Simulation::create(const Case& definition) {
  if (definition.dimension() == 2) return std::make_unique<SimulationOf<2>>(definition);
  return std::make_unique<SimulationOf<3>>(definition);
}

}  // namespace sluice
