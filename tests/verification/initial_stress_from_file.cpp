/// `initial_stress: {method: from_file}`. A run that starts with the stress of an earlier one: the same particles have
/// the same bits, others the same field.
#include <filesystem>
#include <fstream>

#include "core/output/results.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

/// A folder with the results of a run.
class FromFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              fmt::format("sluice_from_file_{}", ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Two output times: now, and after `steps`.
  void record(Simulation& simulation, int steps) const {
    Provenance provenance;
    for (int a = 0; a < simulation.particles().dimension; ++a) {
      provenance.grid.min.push_back(0);
      provenance.grid.max.push_back(1);
      provenance.grid.cell.push_back(1);
    }
    ResultsWriter writer(folder_, provenance, simulation.particles());
    writer.add_frame(simulation.particles(), simulation.time(), simulation.steps());
    if (steps > 0) {
      take_steps(simulation, steps);
      writer.add_frame(simulation.particles(), simulation.time(), simulation.steps());
    }
    writer.finish();
  }
  std::string from_file(const std::string& more = "") const {
    return "{method: from_file, file: '" + (folder_ / "results.h5").string() + "'" + more + "}";
  }

  std::filesystem::path folder_;
};

/// A column of soil between smooth walls, 4 m high, two cells wide; 3-D with the last axis up.
std::string column(int dimension, double h, const std::string& initial_stress, const std::string& name = "soil",
                   double cohesion = 2) {
  const bool flat = dimension == 2;
  const std::string zero = flat ? "[0, 0, m]" : "[0, 0, 0, m]", high = flat ? "[1, 5, m]" : "[1, 1, 5, m]";
  return fmt::format(
      "schema: 1\nphysics: total_stress\nend_time: 10 s\ngrid: {{min: {}, max: {}, cell: {} m}}\ngravity: {}\n"
      "materials: {{{}: {{model: mohr_coulomb, density: 2000 kg/m3, youngs_modulus: 5 MPa, friction_angle: 20 deg, "
      "cohesion: {} kPa}}}}\n"
      "bodies: [{{material: {}, layer: {{top: 4 m}}}}]\n"
      "boundaries: {{bottom: roller, left: roller, right: roller{}}}\ninitial_stress: {}\n",
      zero, high, h, flat ? "[0, -10 m/s2]" : "[0, 0, -10 m/s2]", name, cohesion, name,
      flat ? "" : ", front: roller, back: roller", initial_stress);
}

std::unique_ptr<Simulation> simulation(const std::string& text) {
  return Simulation::create(parse_case(text, "from_file.yaml"));
}

std::string by_of(const Simulation& simulation) {
  for (const auto& [name, section] : simulation.resolved_sections())
    if (name == "initial_stress") return section.find("by")->scalar;
  return "";
}

/// Components of the stress, and the plastic strain, in order of identity.
std::vector<std::vector<double>> state(const Particles& particles) {
  std::vector<std::vector<double>> all{by_id(particles, "equivalent_plastic_strain")};
  for (int c = 0; c < (particles.dimension == 2 ? 4 : 6); ++c) all.push_back(by_id(particles, "stress", c));
  return all;
}

// In equilibrium the particles have not moved, so a run that starts from the last state is in equilibrium as well. The
// earlier run's largest speed is round-off (K0.LevelGroundIsAtRest); so is this one's after 50 steps: 1e-10 m/s is what
// 1e-11 g would make of its 0.3 s. Tolerance of the stress: none.
TEST_F(FromFile, AStoppedRunGoesOnAtRestBitForBit) {
  for (const int dimension : {2, 3}) {
    const auto first = simulation(column(dimension, 0.5, "{method: k0}"));
    record(*first, 50);
    const auto second = simulation(column(dimension, 0.5, from_file()));
    EXPECT_EQ(by_of(*second), "particles");
    EXPECT_EQ(state(second->particles()), state(first->particles()));
    take_steps(*second, 50);
    EXPECT_LT(second->largest_speed(), 1e-10) << dimension << "-D";
  }
}

// A column that falls into its weight has moved, yielded and been sorted: still the same bits, at either time.
TEST_F(FromFile, TakesPlasticStrainAndTheGivenTime) {
  const auto first = simulation(column(2, 0.25, "{method: none}", "soil", 0.5));
  take_steps(*first, 20);
  const auto early = state(first->particles());
  const double time = first->time();
  record(*first, 100);
  const auto late = state(first->particles());
  EXPECT_GT(largest_magnitude(late[0]), 1e-5);
  const auto text = [&](const std::string& more) { return column(2, 0.25, from_file(more), "soil", 0.5); };
  EXPECT_EQ(state(simulation(text(""))->particles()), late);
  EXPECT_EQ(state(simulation(text(fmt::format(", time: {} s", time)))->particles()), early);
  const auto stress_alone = state(simulation(text(", state: false"))->particles());
  EXPECT_EQ(stress_alone[1], late[1]);
  EXPECT_EQ(largest_magnitude(stress_alone[0]), 0);
}

// Other particles: linear fits reproduce the linear stress of self-weight exactly, up to the surface. Tolerance:
// round-off of sums over some 100 particles. The earlier stress is set to the exact one.
TEST_F(FromFile, OtherParticlesTakeALinearField) {
  for (const int dimension : {2, 3}) {
    const int up = dimension - 1;
    const auto first = simulation(column(dimension, 0.5, "{method: none}"));
    for (int c = 0; c < 3; ++c)
      set_column(first->particles(), "stress", c, [&](const auto& x) {
        return -2e4 * (c == up ? 1 : 0.5) * (4 - x[static_cast<std::size_t>(up)]) + 1e3 * x[0];
      });
    record(*first, 0);
    const auto second = simulation(column(dimension, 0.25, from_file()));
    EXPECT_EQ(by_of(*second), "cells");
    const auto x = by_id(second->particles(), "position", 0), z = by_id(second->particles(), "position", up);
    for (int c = 0; c < 3; ++c) {
      const auto s = by_id(second->particles(), "stress", c);
      for (std::size_t p = 0; p < z.size(); ++p)
        EXPECT_NEAR(s[p], -2e4 * (c == up ? 1 : 0.5) * (4 - z[p]) + 1e3 * x[p], 1e-8) << dimension << "-D";
    }
  }
}

// The same particles by cells: linear fits take away part of what k0 added to balance the weight on the grid (theory,
// after (32c)). Without all of it a particle would start with 0.0597 g (K0.LevelGroundIsAtRest), which is the bound.
TEST_F(FromFile, ByCellsWhereAskedFor) {
  const auto first = simulation(column(2, 0.25, "{method: k0}"));
  record(*first, 0);
  const auto second = simulation(column(2, 0.25, from_file(", by: cells")));
  EXPECT_EQ(by_of(*second), "cells");
  const auto info = second->advance(1e6);
  EXPECT_LT(second->largest_speed() / (0.5 * info.dt), 0.0597 * 10);
}

TEST_F(FromFile, Messages) {
  const auto first = simulation(column(2, 0.5, "{method: k0}"));
  record(*first, 0);
  const auto error = [&](const std::string& text) -> std::string {
    try {
      simulation(text);
    } catch (const CaseError& e) {
      std::string message = e.what();
      for (auto at = message.find(folder_.string()); at != std::string::npos; at = message.find(folder_.string()))
        message.erase(at, folder_.string().size() + 1);
      return message;
    }
    return "accepted";
  };
  const std::string begin = "from_file.yaml:9:17: initial_stress: 'results.h5' ";
  EXPECT_EQ(error(column(3, 0.5, from_file())), begin + "is of a run in 2-D; this case is in 3-D");
  EXPECT_EQ(error(column(2, 0.5, from_file(", time: 3 s"))),
            begin + "has no output time 3 s; the nearest is 0 s, the last 0 s");
  EXPECT_EQ(error(column(2, 0.25, from_file(", by: particles"))),
            begin + "does not hold the same particles: 64 particles there, 256 here; `by: cells` does without");
  EXPECT_EQ(error(column(2, 0.5, from_file(), "rock")),
            begin +
                "has no particle of 'rock' in or around the cell of (0.125, 0.125) m, where this case has one: its "
                "bodies were others");
  std::string other = column(2, 0.5, from_file());
  other.replace(other.find("top: 4 m"), 8, "top: 5 m");
  EXPECT_NE(error(other).find("has no particle of 'soil' in or around the cell of (0.125, 4.625) m"), std::string::npos)
      << error(other);
  std::string clay = column(2, 0.5, from_file());
  const auto model = clay.find("{model");
  clay.replace(model, clay.find("kPa}", model) + 4 - model,
               "{model: modified_cam_clay, density: 2000 kg/m3, critical_stress_ratio: 1, lambda: 0.1, kappa: 0.02, "
               "initial_void_ratio: 1, overconsolidation_ratio: 2}");
  EXPECT_EQ(error(clay),
            begin +
                "has no field 'preconsolidation_pressure', which the material 'soil' keeps; it has displacement, "
                "equivalent_plastic_strain, id, mass, material, stress, velocity, volume. Take another run, or "
                "write `state: false` for the stress alone");
  EXPECT_EQ(error(column(2, 0.5, "{method: from_file}")),
            "from_file.yaml:9:17: initial_stress: `method: from_file` needs `file: RESULTS/results.h5`");
  EXPECT_EQ(error(column(2, 0.5, "{method: from_file, file: nowhere.h5}")),
            "from_file.yaml:9:43: file: there is no file 'nowhere.h5'");
  std::filesystem::remove(folder_ / "results.h5");
  std::ofstream(folder_ / "results.h5") << "no HDF5";
  EXPECT_NE(error(column(2, 0.5, from_file())).find("from_file.yaml:9:17: initial_stress: results.h5"),
            std::string::npos)
      << error(column(2, 0.5, from_file()));
}

}  // namespace
}  // namespace sluice
