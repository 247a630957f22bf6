/// Transfer kernels against sums written out over the stencil of each particle: every shape function, every kind of
/// scatter, with and without APIC. Particles stand anywhere that a tile reaches, walls and cell edges included.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/transfer/cell_averages.h"
#include "core/transfer/shape_kernels.h"

namespace sluice {
namespace {

constexpr std::size_t particles = 333;  // five chunks and a remainder

template <int Dim>
struct Fixture {
  GridGeometry<Dim> grid;
  Index<Dim> first_cell{};
  std::array<std::vector<double>, Dim> x, v, x_new;
  std::array<std::vector<double>, Dim * Dim> c;
  std::array<std::vector<double>, symmetric_components<Dim>> stress, strain;
  std::array<std::vector<double>, spin_components<Dim>> spin;
  std::array<std::vector<double>, domain_capacity<Dim>> domain;
  std::vector<double> mass, volume;
  const ShapeKernels<Dim>& shape;

  /// The block is the first, the last, or one in the middle of each axis.
  Fixture(const ShapeKernels<Dim>& kernels, int place) : shape(kernels) {
    constexpr int width = block_width<Dim>;
    for (int a = 0; a < Dim; ++a) {
      grid.cells[a] = 3 * width - 1;
      grid.min[a] = 0.3 - a;
      grid.cell[a] = 0.2 * (a + 1);
      grid.max[a] = grid.min[a] + grid.cell[a] * grid.cells[a];
      first_cell[a] = place * width;
    }
    std::mt19937 generator(11);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto fill = [&](std::vector<double>& column, const auto& value) {
      column.resize(particles + 64);
      for (double& entry : column) entry = value();
    };
    for (int a = 0; a < Dim; ++a) {
      const int low = std::max(0, first_cell[a] - tile_margin);
      const int high = std::min(grid.cells[a], first_cell[a] + width + tile_margin);
      fill(x[a], [&] {
        const double cells = low + uniform(generator) * (high - low);
        const double share = uniform(generator);
        return grid.min[a] + grid.cell[a] * (share < 0.1 ? std::floor(cells) : share < 0.2 ? low : cells);
      });
      fill(v[a], [&] { return normal(generator); });
      x_new[a] = x[a];
    }
    for (auto& column : c) fill(column, [&] { return normal(generator); });
    for (auto& column : stress) fill(column, [&] { return 100 * normal(generator); });
    for (auto& column : strain) fill(column, [&] { return 0; });
    for (auto& column : spin) fill(column, [&] { return 0; });
    fill(mass, [&] { return 1 + uniform(generator); });
    fill(volume, [&] { return 0.1 + uniform(generator); });
    fill_domains();
  }

  /// Of gradients, over that of products over the axes: see shape_functions.cpp.
  double round_off() const { return shape.takes_moments() ? 1 : 1e3; }
  /// Domains that deform are distorted, by up to a tenth of half of the least cell; sizes stay.
  double distortion() {
    static std::mt19937 generator(23);
    static std::uniform_real_distribution<double> uniform(-0.01, 0.01);
    return shape.takes_moments() ? 0 : uniform(generator);
  }
  /// One to three particles in the width of a cell.
  void fill_domains() {
    std::array<double, domain_capacity<Dim>> numbers{};
    for (auto& column : domain) column.resize(particles + 64);
    for (std::size_t p = 0; p < particles + 64; ++p) {
      shape.fill_domain(grid, 1.0 / static_cast<double>(1 + p % 3), numbers);
      for (std::size_t k = 0; k < numbers.size(); ++k) domain[k][p] = numbers[k] + distortion();
    }
  }
  Stencil<Dim> stencil(std::size_t p) const {
    std::array<double, domain_capacity<Dim>> numbers{};
    for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = domain[k][p];
    return shape.stencil(grid, at(p), numbers);
  }

  BlockParticles<Dim> view() const {
    BlockParticles<Dim> view{&grid, first_cell, 0, particles, {}};
    for (int a = 0; a < Dim; ++a) view.position[a] = x[a].data();
    for (std::size_t k = 0; k < domain.size(); ++k) view.domain[k] = domain[k].data();
    return view;
  }
  ScatterInput<Dim> input(bool affine) const {
    ScatterInput<Dim> in{};
    in.particles = view();
    in.mass = mass.data();
    in.volume = volume.data();
    for (int a = 0; a < Dim; ++a) in.velocity[a] = v[a].data();
    for (std::size_t k = 0; k < stress.size(); ++k) in.stress[k] = stress[k].data();
    if (affine)
      for (std::size_t k = 0; k < c.size(); ++k) in.affine[k] = c[k].data();
    return in;
  }
  Vector<Dim> at(std::size_t p) const {
    Vector<Dim> place;
    for (int a = 0; a < Dim; ++a) place[a] = x[a][p];
    return place;
  }
  int tile_size() const { return power(tile_width<Dim>(shape.reach()), Dim); }
  int place_in_tile(const Index<Dim>& node) const {
    int place = 0;
    for (int a = Dim - 1; a >= 0; --a)
      place = place * tile_width<Dim>(shape.reach()) + node[a] - first_cell[a] + tile_margin;
    return place;
  }
  double sigma(std::size_t p, int a, int b) const {
    if (a == b) return stress[static_cast<std::size_t>(a)][p];
    if (Dim == 2 || a + b == 1) return stress[3][p];
    return stress[a + b == 3 ? 4 : 5][p];
  }
};

/// {mass, momentum} and {0, force} of each place of the tile, summed as the textbook has it.
template <int Dim>
struct Dense {
  std::vector<std::array<double, 4>> momentum, force;

  Dense(const Fixture<Dim>& f, bool affine)
      : momentum(static_cast<std::size_t>(f.tile_size())), force(momentum.size()) {
    for (std::size_t p = 0; p < particles; ++p) {
      const Vector<Dim> x = f.at(p);
      const Stencil<Dim> s = f.stencil(p);
      for (int n = 0; n < s.count; ++n) {
        const auto i = static_cast<std::size_t>(n);
        const auto place = static_cast<std::size_t>(f.place_in_tile(s.node[i]));
        momentum[place][0] += f.mass[p] * s.value[i];
        for (int a = 0; a < Dim; ++a) {
          double velocity = f.v[a][p];
          for (int b = 0; b < Dim; ++b) {
            if (affine)
              velocity += f.c[static_cast<std::size_t>(a * Dim + b)][p] *
                          (f.shape.node_position(f.grid, b, s.node[i][b]) - x[b]);
            force[place][static_cast<std::size_t>(a + 1)] -= f.volume[p] * f.sigma(p, a, b) * s.gradient[i][b];
          }
          momentum[place][static_cast<std::size_t>(a + 1)] += f.mass[p] * s.value[i] * velocity;
        }
      }
    }
  }
};

struct LaneBuffer {
  explicit LaneBuffer(std::size_t count) { lanes.resize(count); }
  LaneArray lanes;
  void fill(std::size_t count, double value) {
    for (std::size_t i = 0; i < count; ++i) lanes.data()[i] = Lane{value, value, value, value};
  }
};

// Round-off of sums of some dozen terms of the order of 1 (momentum) and 1e3 (force).
template <int Dim>
void expect_scatter(const Fixture<Dim>& f, bool affine) {
  using enum ScatterWhat;
  const Dense<Dim> dense(f, affine);
  const auto size = static_cast<std::size_t>(f.tile_size());
  LaneBuffer tile(size), force_tile(size);
  for (const ScatterWhat what : {momentum, force, momentum_and_force, momentum_and_impulse}) {
    const double dt = 0.01;
    tile.fill(size, 7);  // what was there is overwritten
    force_tile.fill(size, 7);
    f.shape.scatter(what, f.input(affine), dt, tile.lanes.data(), force_tile.lanes.data());
    for (std::size_t i = 0; i < size; ++i)
      for (int k = 0; k < Dim + 1; ++k) {
        const auto component = static_cast<std::size_t>(k);
        const double impulse = what == momentum_and_impulse ? dt * dense.force[i][component] : 0;
        if (what != force) {
          ASSERT_NEAR(tile.lanes.data()[i][k], dense.momentum[i][component] + impulse,
                      (what == momentum_and_impulse ? f.round_off() : 1) * 1e-11)
              << "node " << i << ", " << k;
        }
        if (what == force || what == momentum_and_force) {
          ASSERT_NEAR(force_tile.lanes.data()[i][k], dense.force[i][component], f.round_off() * 1e-9)
              << "node " << i << ", " << k;
        }
      }
  }
}

/// The affine field that particles get.
enum class Affine { none, apic, tpic };

template <int Dim>
void expect_gather(Fixture<Dim>& f, Affine kind, bool with_strain) {
  const bool affine = kind != Affine::none;
  const auto size = static_cast<std::size_t>(f.tile_size());
  LaneBuffer motion(size * motion_lanes<Dim>);
  std::mt19937 generator(13);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < size * motion_lanes<Dim>; ++i)
    for (int k = 0; k < 4; ++k) motion.lanes.data()[i][k] = normal(generator);
  const auto velocity = [&](const Index<Dim>& node, int a) {
    return motion.lanes.data()[static_cast<std::size_t>(f.place_in_tile(node) * motion_lanes<Dim>)][a];
  };
  const auto change = [&](const Index<Dim>& node, int a) {
    const auto first = static_cast<std::size_t>(f.place_in_tile(node) * motion_lanes<Dim>);
    return Dim == 2 ? motion.lanes.data()[first][2 + a] : motion.lanes.data()[first + motion_lanes<Dim> - 1][a];
  };

  const double dt = 0.02;
  const VelocityShares shares = {0.7, 0.6, 0.3};
  const auto before = f.v;
  StrainIncrements<Dim> strain;
  for (std::size_t k = 0; k < f.strain.size(); ++k) strain.strain[k] = f.strain[k].data();
  for (std::size_t k = 0; k < f.spin.size(); ++k) strain.rotation[k] = f.spin[k].data();
  MotionUpdate<Dim> update{};
  update.dt = dt;
  update.shares = shares;
  update.affine_is_gradient = kind == Affine::tpic;
  for (int a = 0; a < Dim; ++a) {
    update.velocity[a] = f.v[a].data();
    update.position[a] = f.x_new[a].data();
  }
  if (affine)
    for (std::size_t k = 0; k < f.c.size(); ++k) update.affine[k] = f.c[k].data();
  if (with_strain) update.strain = &strain;
  const MotionReport report = f.shape.gather_motion(f.view(), motion.lanes.data(), update);
  if (!with_strain) f.shape.gather_strain(f.view(), motion.lanes.data(), dt, strain);

  double fastest = 0;
  for (std::size_t p = 0; p < particles; ++p) {
    const Vector<Dim> x = f.at(p);
    const Stencil<Dim> s = f.stencil(p);
    Vector<Dim> v{}, dv{}, square{};
    std::array<Vector<Dim>, Dim> gradient{}, moment{};
    for (int n = 0; n < s.count; ++n) {
      const auto i = static_cast<std::size_t>(n);
      for (int a = 0; a < Dim; ++a) {
        v[a] += s.value[i] * velocity(s.node[i], a);
        dv[a] += s.value[i] * change(s.node[i], a);
        const double distance = f.shape.node_position(f.grid, a, s.node[i][a]) - x[a];
        square[a] += s.value[i] * distance * distance;
        for (int b = 0; b < Dim; ++b) {
          gradient[a][b] += s.gradient[i][b] * velocity(s.node[i], a);
          moment[a][b] += s.value[i] * velocity(s.node[i], a) * (f.shape.node_position(f.grid, b, s.node[i][b]) - x[b]);
        }
      }
    }
    double squared = 0;
    for (int a = 0; a < Dim; ++a) {
      const double expected = affine ? v[a] : shares.old * before[a][p] + shares.change * dv[a] + shares.nodes * v[a];
      ASSERT_NEAR(f.v[a][p], expected, 1e-13) << "particle " << p;
      ASSERT_NEAR(f.x_new[a][p], x[a] + dt * v[a], 1e-13) << "particle " << p;
      squared += expected * expected;
      for (int b = 0; b < Dim && affine; ++b) {
        const double c = f.c[static_cast<std::size_t>(a * Dim + b)][p];
        if (kind == Affine::tpic) {
          ASSERT_NEAR(c, gradient[a][b], f.round_off() * 1e-12 / f.grid.cell[b]) << "particle " << p;
        } else if (square[b] > 1e-6 * f.grid.cell[b] * f.grid.cell[b]) {  // C = B D^-1, where D can be inverted
          ASSERT_NEAR(c, moment[a][b] / square[b], 1e-9 / f.grid.cell[b]) << "particle " << p;
        }
        ASSERT_LT(std::abs(c), 100 / f.grid.cell[b]) << "particle " << p;
      }
    }
    fastest = std::max(fastest, squared);
    for (int a = 0; a < Dim; ++a) {
      ASSERT_NEAR(f.strain[static_cast<std::size_t>(a)][p], dt * gradient[a][a],
                  f.round_off() * 1e-13 / f.grid.cell[a]);
    }
    if (Dim == 2) {
      ASSERT_EQ(f.strain[2][p], 0);
    }
    const int pairs[3][2] = {{0, 1}, {1, 2}, {0, 2}};
    for (std::size_t k = 0; k < (Dim == 2 ? 1u : 3u); ++k) {
      const auto a = static_cast<std::size_t>(pairs[k][0]), b = static_cast<std::size_t>(pairs[k][1]);
      ASSERT_NEAR(f.strain[3 + k][p], dt / 2 * (gradient[a][b] + gradient[b][a]), f.round_off() * 1e-12);
      const double spin = dt / 2 * (gradient[a][b] - gradient[b][a]);  // w_ab; 2-D stores w_yx
      ASSERT_NEAR(f.spin[k][p], Dim == 2 ? -spin : spin, f.round_off() * 1e-12);
    }
  }
  EXPECT_NEAR(report.largest_speed_squared, fastest, 1e-12 * fastest);
  EXPECT_TRUE(report.finite);
}

// Forces of stress and of a force on each particle, which its nodes share as they share its mass.
template <int Dim>
void expect_body_force(const Fixture<Dim>& f) {
  const auto size = static_cast<std::size_t>(f.tile_size());
  Dense<Dim> dense(f, false);
  ScatterInput<Dim> in = f.input(false);
  for (int a = 0; a < Dim; ++a) in.body_force[a] = f.c[static_cast<std::size_t>(a)].data();
  for (std::size_t p = 0; p < particles; ++p) {
    const Stencil<Dim> s = f.stencil(p);
    for (int n = 0; n < s.count; ++n) {
      const auto i = static_cast<std::size_t>(n);
      auto& force = dense.force[static_cast<std::size_t>(f.place_in_tile(s.node[i]))];
      for (std::size_t a = 0; a < Dim; ++a) force[a + 1] += s.value[i] * f.c[a][p];
    }
  }
  LaneBuffer tile(size);
  tile.fill(size, 7);
  f.shape.scatter(ScatterWhat::force, in, 0, nullptr, tile.lanes.data());
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t k = 0; k < Dim + 1; ++k)
      ASSERT_NEAR(tile.lanes.data()[i][k], dense.force[i][k], f.round_off() * 1e-9);
}

// Forces of a pressure: of its first normal stress, taken as a pressure, as the textbook sums V p grad N.
template <int Dim>
void expect_pressure(const Fixture<Dim>& f) {
  const auto size = static_cast<std::size_t>(f.tile_size());
  std::vector<std::array<double, 4>> force(size);
  for (std::size_t p = 0; p < particles; ++p) {
    const Stencil<Dim> s = f.stencil(p);
    for (int n = 0; n < s.count; ++n) {
      const auto i = static_cast<std::size_t>(n);
      for (std::size_t a = 0; a < Dim; ++a)
        force[static_cast<std::size_t>(f.place_in_tile(s.node[i]))][a + 1] +=
            f.volume[p] * f.stress[0][p] * s.gradient[i][a];
    }
  }
  LaneBuffer tile(size);
  tile.fill(size, 7);
  f.shape.scatter_pressure(f.view(), f.volume.data(), f.stress[0].data(), tile.lanes.data());
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(tile.lanes.data()[i][k], force[i][k], f.round_off() * 1e-9);
}

/// A tile of motion lanes full of numbers, and what its nodes hold: component `a` of lane `lane`.
template <int Dim>
struct RandomMotion {
  const Fixture<Dim>& fixture;
  LaneBuffer tile;

  explicit RandomMotion(const Fixture<Dim>& f)
      : fixture(f), tile(static_cast<std::size_t>(f.tile_size() * motion_lanes<Dim>)) {
    std::mt19937 generator(19);
    std::normal_distribution<double> normal;
    for (int i = 0; i < f.tile_size() * motion_lanes<Dim>; ++i)
      for (int k = 0; k < 4; ++k) tile.lanes.data()[i][k] = normal(generator);
  }
  double at(const Index<Dim>& node, int lane, int a) const {
    return tile.lanes.data()[fixture.place_in_tile(node) * motion_lanes<Dim> + lane][a];
  }
};

template <int Dim>
void expect_divergence(const Fixture<Dim>& f) {
  const RandomMotion<Dim> motion(f);
  std::vector<double> divergence(particles, 7.0);
  std::array<std::vector<double>, Dim> change;
  std::array<double*, Dim> out;
  for (int a = 0; a < Dim; ++a) {
    change[a].assign(particles, 7.0);
    out[a] = change[a].data();
  }
  f.shape.gather_divergence(f.view(), motion.tile.lanes.data(), divergence.data(), out);
  for (std::size_t p = 0; p < particles; ++p) {
    const Stencil<Dim> s = f.stencil(p);
    double sum = 0;
    Vector<Dim> dv{};
    for (int n = 0; n < s.count; ++n) {
      const auto i = static_cast<std::size_t>(n);
      for (int a = 0; a < Dim; ++a) {
        sum += s.gradient[i][a] * motion.at(s.node[i], 0, a);
        dv[a] += s.value[i] * motion.at(s.node[i], motion_lanes<Dim> - 1, Dim == 2 ? 2 + a : a);
      }
    }
    ASSERT_NEAR(divergence[p], sum, f.round_off() * 1e-12 / f.grid.cell[0]) << "particle " << p;
    for (int a = 0; a < Dim; ++a) ASSERT_NEAR(change[a][p], dv[a], 1e-13) << "particle " << p;
  }
}

// The nodes' velocity at the particles, and from there back to the nodes: sums of some dozen terms of the order of 1.
template <int Dim>
void expect_map_again(const Fixture<Dim>& f) {
  const RandomMotion<Dim> motion(f);
  const auto size = static_cast<std::size_t>(f.tile_size());
  std::vector<std::array<double, 4>> dense(size);
  for (std::size_t p = 0; p < particles; ++p) {
    const Stencil<Dim> s = f.stencil(p);
    Vector<Dim> v{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(s.count); ++i)
      for (int a = 0; a < Dim; ++a) v[a] += s.value[i] * motion.at(s.node[i], 0, a);
    for (std::size_t i = 0; i < static_cast<std::size_t>(s.count); ++i) {
      auto& node = dense[static_cast<std::size_t>(f.place_in_tile(s.node[i]))];
      node[0] += f.mass[p] * s.value[i];
      for (std::size_t a = 0; a < Dim; ++a) node[a + 1] += f.mass[p] * s.value[i] * v[a];
    }
  }
  LaneBuffer tile(size);
  tile.fill(size, 7);
  f.shape.map_again(f.view(), f.mass.data(), motion.tile.lanes.data(), tile.lanes.data());
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t k = 0; k < Dim + 1; ++k) ASSERT_NEAR(tile.lanes.data()[i][k], dense[i][k], 1e-11) << "node " << i;
}

class Transfer : public ::testing::TestWithParam<std::string> {
 protected:
  template <int Dim, class Check>
  void for_each_place(const Check& check) {
    const auto shape = shape_registry<Dim>().find(GetParam(), {})();
    for (const int place : {0, 1, 2}) {
      SCOPED_TRACE(std::to_string(Dim) + "-D, block " + std::to_string(place));
      for (const bool affine : {false, true}) {
        Fixture<Dim> fixture(*shape, place);
        check(fixture, affine);
      }
    }
  }
  template <int Dim, class Check>
  void for_each_affine(const Check& check) {
    const auto shape = shape_registry<Dim>().find(GetParam(), {})();
    for (const int place : {0, 1, 2}) {
      SCOPED_TRACE(std::to_string(Dim) + "-D, block " + std::to_string(place));
      for (const Affine affine : {Affine::none, Affine::apic, Affine::tpic}) {
        if (affine == Affine::apic && !shape->takes_moments()) continue;
        Fixture<Dim> fixture(*shape, place);
        check(fixture, affine);
      }
    }
  }
};

TEST_P(Transfer, ScatterEqualsTheSumsOverTheStencil) {
  for_each_place<2>([](auto& f, bool affine) { expect_scatter<2>(f, affine); });
  for_each_place<3>([](auto& f, bool affine) { expect_scatter<3>(f, affine); });
}

TEST_P(Transfer, GatherEqualsTheSumsOverTheStencil) {
  for_each_affine<2>([](auto& f, Affine affine) { expect_gather<2>(f, affine, true); });
  for_each_affine<3>([](auto& f, Affine affine) { expect_gather<3>(f, affine, true); });
}

TEST_P(Transfer, GatherWithoutStrainGivesTheSame) {
  for_each_affine<2>([](auto& f, Affine affine) { expect_gather<2>(f, affine, false); });
  for_each_affine<3>([](auto& f, Affine affine) { expect_gather<3>(f, affine, false); });
}

TEST_P(Transfer, BodyForceIsSharedLikeTheMass) {
  for_each_place<2>([](auto& f, bool) { expect_body_force<2>(f); });
  for_each_place<3>([](auto& f, bool) { expect_body_force<3>(f); });
}

TEST_P(Transfer, ForcesOfPressureEqualTheSumsOverTheStencil) {
  for_each_place<2>([](auto& f, bool) { expect_pressure<2>(f); });
  for_each_place<3>([](auto& f, bool) { expect_pressure<3>(f); });
}

TEST_P(Transfer, MappingAgainEqualsTheSumsOverTheStencil) {
  for_each_place<2>([](auto& f, bool) { expect_map_again<2>(f); });
  for_each_place<3>([](auto& f, bool) { expect_map_again<3>(f); });
}

TEST_P(Transfer, DivergenceEqualsTheSumsOverTheStencil) {
  for_each_place<2>([](auto& f, bool) { expect_divergence<2>(f); });
  for_each_place<3>([](auto& f, bool) { expect_divergence<3>(f); });
}

INSTANTIATE_TEST_SUITE_P(Registered, Transfer, ::testing::ValuesIn(shape_registry<2>().names()),
                         [](const auto& value) { return value.param; });

/// Cell averages across blocks, for particles that wandered beyond their block: against a map from cells to sums.
template <int Dim>
void expect_cell_averages(double shift) {
  GridGeometry<Dim> g;
  g.min.fill(0);
  g.cell.fill(0.5);
  g.cells.fill(3 * block_width<Dim>);
  for (int a = 0; a < Dim; ++a) g.max[a] = g.cell[a] * g.cells[a];
  Particles points(Dim);
  points.material_names = {"soil"};
  points.resize(4000);
  std::mt19937 generator(17);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int a = 0; a < Dim; ++a)
    for (double& x : points.columns.values(points.position, a)) x = uniform(generator) * g.max[a];
  Blocks<Dim> blocks;
  blocks.sort(points, g, 1);
  for (int a = 0; a < Dim; ++a)
    for (double& x : points.columns.values(points.position, a))
      x = std::clamp(x + (uniform(generator) - 0.5) * 0.99, 0.0, g.max[a]);
  std::vector<double> quantity(points.size()), weight(points.size()), mean(points.size());
  for (std::size_t p = 0; p < points.size(); ++p)
    quantity[p] = uniform(generator), weight[p] = 0.5 + uniform(generator);

  const auto cell_of = [&](std::size_t p) {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = points.columns.data(points.position, a)[p];
    // Cells moved back by a share: those that they make at the upper walls are their own.
    for (int a = 0; a < Dim; ++a) x[a] = (x[a] - g.min[a]) / g.cell[a] + shift;
    Index<Dim> cell;
    for (int a = 0; a < Dim; ++a)
      cell[a] = std::clamp(static_cast<int>(std::floor(x[a])), 0, g.cells[a] - (shift > 0 ? 0 : 1));
    return cell;
  };
  std::map<Index<Dim>, std::pair<double, double>> sums;
  for (std::size_t p = 0; p < points.size(); ++p) {
    auto& [weights, products] = sums[cell_of(p)];
    weights += weight[p];
    products += weight[p] * quantity[p];
  }
  CellAverages<Dim> averages;
  averages.resize(blocks, shift);
  const auto for_each_block = [&](const auto& work) {
    for (std::size_t b = 0; b < blocks.particle_blocks().size(); ++b) {
      const auto& block = blocks.particle_blocks()[b];
      BlockParticles<Dim> view{&g, block.first_cell, block.begin, block.end, {}};
      for (int a = 0; a < Dim; ++a) view.position[a] = points.columns.data(points.position, a);
      work(b, view, block.begin);
    }
  };
  for_each_block([&](std::size_t, const auto& view, std::size_t) { averages.locate(view); });
  for_each_block([&](std::size_t b, const auto& view, std::size_t begin) {
    averages.clear(b);
    averages.add(b, view, weight.data(), quantity.data() + begin);
  });
  for_each_block(
      [&](std::size_t b, const auto& view, std::size_t begin) { averages.mean(blocks, b, view, mean.data() + begin); });
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto& [weights, products] = sums[cell_of(p)];
    ASSERT_NEAR(mean[p], products / weights, 1e-14) << "particle " << p;
  }
}

TEST(CellAverages, EqualTheMeansOverCells) {
  for (const double shift : {0.0, 0.5}) {
    expect_cell_averages<2>(shift);
    expect_cell_averages<3>(shift);
  }
}

}  // namespace
}  // namespace sluice
