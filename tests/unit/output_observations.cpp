#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/output/main_body.h"
#include "core/output/observation.h"
#include "tests/unit/output_fixture.h"

namespace sluice {
namespace {

using test::row_of_particles;

ObservationCase observe(const std::string& measure, std::vector<double> direction = {}) {
  ObservationCase result;
  result.name = "followed";
  result.measure = measure;
  result.direction = std::move(direction);
  result.place = {"dam.yaml", 12, 3};
  return result;
}

double value(const ObservationCase& observation, const Particles& particles) {
  const std::vector<double> cell(static_cast<std::size_t>(particles.dimension), 1.0);
  return make_observation(observation, particles, cell)->evaluate(particles);
}

std::string error(const ObservationCase& observation, const Particles& particles) {
  try {
    value(observation, particles);
  } catch (const CaseError& caught) {
    return caught.what();
  }
  return "";
}

/// Ten particles in a row; moved 2 m to the left; the one farthest left is thrown off by 5 m more.
Particles thrown_off() {
  Particles particles = row_of_particles(10);
  double* x = particles.columns.data(particles.position, 0);
  for (std::size_t i = 0; i < particles.size(); ++i) x[i] -= 2;
  x[0] -= 5;
  particles.columns.data(particles.position, 1)[0] += 9;
  return particles;
}

TEST(Observation, FrontDoesNotCountThrownOffParticles) {
  EXPECT_DOUBLE_EQ(value(observe("front", {-1, 0}), row_of_particles(10)), 0);
  // The front was particle 0 at 0.25 m; now it is particle 1, from 0.75 m to -1.25 m.
  EXPECT_DOUBLE_EQ(value(observe("front", {-1, 0}), thrown_off()), 1.5);
  EXPECT_DOUBLE_EQ(value(observe("front", {1, 0}), thrown_off()), -2);
}

TEST(Observation, FrontIsTheSameAfterSorting) {
  Particles particles = thrown_off();
  std::vector<std::uint32_t> order(particles.size());
  std::iota(order.rbegin(), order.rend(), 0u);
  particles.permute(order);
  EXPECT_DOUBLE_EQ(value(observe("front", {-1, 0}), particles), 1.5);
}

TEST(Observation, HighestPointAndItsDrop) {
  Particles particles = thrown_off();
  for (double& y : particles.columns.values(particles.position, 1)) y -= 0.1;
  EXPECT_DOUBLE_EQ(value(observe("highest_point"), particles), 0.15);
  EXPECT_DOUBLE_EQ(value(observe("drop_of_highest_point"), particles), 0.1);
}

TEST(Observation, MainBodyIsTheHeaviestAndCornersHangTogether) {
  Particles particles(2);
  particles.resize(5);
  const double x[5] = {0.5, 1.5, 2.5, 10.5, 12.5}, y[5] = {0.5, 1.5, 0.5, 0.5, 0.5};
  for (std::size_t i = 0; i < 5; ++i) {
    particles.columns.data(particles.position, 0)[i] = x[i];
    particles.columns.data(particles.position, 1)[i] = y[i];
    particles.columns.data(particles.mass)[i] = 1;
    particles.id[i] = static_cast<std::int32_t>(i);
  }
  const std::vector<double> cell{1, 1};
  EXPECT_EQ(main_body(particles, particles.position, cell), (std::vector<std::uint8_t>{1, 1, 1, 0, 0}));
  particles.columns.data(particles.mass)[4] = 3.5;  // heavier than three
  EXPECT_EQ(main_body(particles, particles.position, cell), (std::vector<std::uint8_t>{0, 0, 0, 0, 1}));
}

TEST(Observation, MainBodyOfManyCellsInThreeDimensions) {
  Particles particles(3);
  const int n = 30;
  particles.resize(n * n * n + 1);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const int j = static_cast<int>(i);
    const double x[3] = {j % n - 0.5 * n, (j / n) % n - 0.5 * n, j / (n * n) - 0.5 * n};  // across the origin
    for (int k = 0; k < 3; ++k) particles.columns.data(particles.position, k)[i] = x[k];
    particles.columns.data(particles.mass)[i] = 1;
    particles.id[i] = j;
  }
  particles.columns.data(particles.position, 2)[n * n * n] = 1e7;  // far away costs nothing
  const auto inside = main_body(particles, particles.position, std::vector<double>{1, 1, 1});
  EXPECT_EQ(std::count(inside.begin(), inside.end(), 1), n * n * n);
  EXPECT_EQ(inside.back(), 0);
}

TEST(Observation, MeanDisplacementOfARegionFollowsTheMaterial) {
  Particles particles = row_of_particles(4);
  particles.columns.data(particles.mass)[1] = 3;
  ObservationCase crest = observe("mean_displacement", {0, -1});
  crest.region = Region{{Box{{0, 0}, {1, 1}}}};  // particles 0 and 1
  const auto made = make_observation(crest, particles, std::vector<double>{1, 1});
  double* y = particles.columns.data(particles.position, 1);
  y[0] -= 1, y[1] -= 2, y[2] -= 100;
  EXPECT_DOUBLE_EQ(made->evaluate(particles), 0.25 * 1 + 0.75 * 2);
  const std::vector<std::uint32_t> order{3, 1, 0};  // sorted, and one has left
  particles.permute(order);
  EXPECT_DOUBLE_EQ(made->evaluate(particles), 0.25 * 1 + 0.75 * 2);
  // Made anew from the moved particles, as after a resume, it is the same.
  EXPECT_DOUBLE_EQ(value(crest, particles), 0.25 * 1 + 0.75 * 2);
}

TEST(Observation, MotionOfAllMaterial) {
  Particles particles = row_of_particles(2);
  particles.columns.data(particles.velocity, 0)[0] = 3;
  particles.columns.data(particles.velocity, 1)[0] = 4;
  particles.columns.data(particles.velocity, 1)[1] = 1;
  EXPECT_DOUBLE_EQ(value(observe("kinetic_energy"), particles), 13);
  EXPECT_DOUBLE_EQ(value(observe("max_speed"), particles), 5);
  EXPECT_DOUBLE_EQ(value(observe("center_of_mass", {1, 0}), particles), 0.5);
}

TEST(Observation, MeanAndLargestOfAField) {
  Particles particles = row_of_particles(4);  // of equal volume
  double* vy = particles.columns.data(particles.velocity, 1);
  for (int i = 0; i < 4; ++i) vy[i] = 10 * i;
  std::ranges::fill(particles.columns.values(particles.volume), 1.0);
  particles.columns.data(particles.volume)[1] = 3;
  ObservationCase rise = observe("mean", {0, 1});
  rise.field = "velocity";
  rise.region = Region{{Box{{0, 0}, {1, 1}}}};  // particles 0 and 1
  EXPECT_DOUBLE_EQ(value(rise, particles), 7.5);
  rise.measure = "largest";
  EXPECT_DOUBLE_EQ(value(rise, particles), 10);
  rise.region.reset();
  EXPECT_DOUBLE_EQ(value(rise, particles), 30);
  rise.direction = {0, -1};
  EXPECT_DOUBLE_EQ(value(rise, particles), 0);
  ObservationCase mass = observe("largest");
  mass.field = "mass";
  particles.columns.data(particles.mass)[2] = 7;
  EXPECT_DOUBLE_EQ(value(mass, particles), 7);
  EXPECT_EQ(make_observation(mass, particles, std::vector<double>{1, 1})->unit(), "kg/m");  // per metre of thickness
}

TEST(Observation, FieldsThatAreMissingAreNamed) {
  const Particles particles = row_of_particles(2);
  ObservationCase mean = observe("mean");
  EXPECT_NE(error(mean, particles).find("needs a field"), std::string::npos);
  mean.field = "pore_presure";
  EXPECT_NE(error(mean, particles).find("finds no field 'pore_presure'; there are"), std::string::npos);
  mean.field = "velocity";
  EXPECT_NE(error(mean, particles).find("needs a direction"), std::string::npos);
  mean.field = "stress";
  EXPECT_NE(error(mean, particles).find("is a tensor"), std::string::npos);
  mean.measure = "kinetic_energy";
  EXPECT_NE(error(mean, particles).find("takes no field"), std::string::npos);
}

TEST(Observation, WhatIsMissingOrTooMuchIsNamed) {
  const Particles particles = row_of_particles(3);
  EXPECT_EQ(error(observe("front"), particles),
            "dam.yaml:12:3: observation 'followed': measure 'front' needs a direction, for example direction: [-1, 0]");
  EXPECT_NE(error(observe("front", {1, 0, 0}), particles).find("2 numbers"), std::string::npos);
  EXPECT_NE(error(observe("mean_displacement", {1, 0}), particles).find("needs a region"), std::string::npos);
  EXPECT_NE(error(observe("max_speed", {1, 0}), particles).find("takes no direction"), std::string::npos);
  ObservationCase nowhere = observe("mean_displacement", {1, 0});
  nowhere.region = Region{{Box{{50, 50}, {51, 51}}}};
  EXPECT_NE(error(nowhere, particles).find("no material"), std::string::npos);
  EXPECT_NE(error(observe("frnt", {1, 0}), particles).find("front"), std::string::npos);
}

}  // namespace
}  // namespace sluice
