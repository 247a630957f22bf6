/// Shape functions, every registered one: partition of unity, linear reproduction up to the wall, gradients, Greville
/// points.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/transfer/shape_kernels.h"

namespace sluice {
namespace {

/// A grid with few cells along the last axis, so that first and last cell meet.
template <int Dim>
GridGeometry<Dim> grid(int cells_of_last_axis) {
  GridGeometry<Dim> g;
  for (int a = 0; a < Dim; ++a) {
    g.min[a] = -1.5 + a;
    g.cells[a] = a == Dim - 1 ? cells_of_last_axis : 6 + a;
    g.cell[a] = 0.25 * (a + 1);
    g.max[a] = g.min[a] + g.cells[a] * g.cell[a];
  }
  return g;
}

/// Random points, and points on the edges of cells and of the grid.
template <int Dim>
std::vector<Vector<Dim>> points(const GridGeometry<Dim>& g) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::uniform_int_distribution<int> choice(0, 3);
  std::vector<Vector<Dim>> all;
  for (int i = 0; i < 2000; ++i) {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) {
      const double cells = uniform(generator) * g.cells[a];
      const int kind = choice(generator);
      x[a] = g.min[a] + g.cell[a] * (kind == 0 ? std::floor(cells) : kind == 1 && cells < 1 ? 0 : cells);
    }
    all.push_back(x);
  }
  all.push_back(g.min);
  all.push_back(g.max);
  return all;
}

/// The stencil of a point, or of a particle that fills half of the width of a cell.
template <int Dim>
Stencil<Dim> stencil(const ShapeKernels<Dim>& shape, const GridGeometry<Dim>& g, const Vector<Dim>& x) {
  std::array<double, domain_capacity<Dim>> domain{};
  shape.fill_domain(g, 0.5, domain);
  return shape.stencil(g, x, domain);
}

/// Round-off of gradients, over that of products over the axes: domains with corners are drawn in at a wall, to 1e-4 of
/// a cell at the wall itself, and their gradients are differences over that.
template <int Dim>
double round_off(const ShapeKernels<Dim>& shape) {
  return shape.takes_moments() ? 1 : 1e3;
}

template <int Dim>
void expect_linear_reproduction(const ShapeKernels<Dim>& shape, const GridGeometry<Dim>& g) {
  for (const auto& x : points(g)) {
    const Stencil<Dim> s = stencil<Dim>(shape, g, x);
    double unity = 0;
    Vector<Dim> gradient_of_one{}, place{};
    std::array<Vector<Dim>, Dim> gradient_of_place{};
    for (int n = 0; n < s.count; ++n) {
      const auto i = static_cast<std::size_t>(n);
      EXPECT_GE(s.value[i], -1e-15);
      unity += s.value[i];
      for (int a = 0; a < Dim; ++a) {
        ASSERT_GE(s.node[i][a], 0);
        ASSERT_LT(s.node[i][a], g.cells[a] + shape.reach());
        const double at = shape.node_position(g, a, s.node[i][a]);
        place[a] += s.value[i] * at;
        gradient_of_one[a] += s.gradient[i][a];
        for (int b = 0; b < Dim; ++b) gradient_of_place[a][b] += s.gradient[i][b] * at;
      }
    }
    EXPECT_NEAR(unity, 1, 1e-14);
    for (int a = 0; a < Dim; ++a) {
      EXPECT_NEAR(gradient_of_one[a], 0, 1e-13 * round_off<Dim>(shape));
      EXPECT_NEAR(place[a], x[a], 1e-14);
      for (int b = 0; b < Dim; ++b) EXPECT_NEAR(gradient_of_place[a][b], a == b ? 1 : 0, 1e-12 * round_off<Dim>(shape));
    }
  }
}

/// Values of the stencil, by node.
template <int Dim>
std::map<Index<Dim>, double> values(const ShapeKernels<Dim>& shape, const GridGeometry<Dim>& g, const Vector<Dim>& x) {
  const Stencil<Dim> s = stencil<Dim>(shape, g, x);
  std::map<Index<Dim>, double> v;
  for (int n = 0; n < s.count; ++n) v[s.node[static_cast<std::size_t>(n)]] = s.value[static_cast<std::size_t>(n)];
  return v;
}

// Central differences of width 1e-6 cells: errors of 1e-9 of the slope from round-off, 1e-12 from the third derivative.
// Particles with a size shrink towards a wall, and their slope is the mean over the particle, not the derivative: they
// are looked at away from walls. With CPDI the slope is the mean gradient of a function that is linear between the
// corners of the particle, and not the derivative of the value: left out.
template <int Dim>
void expect_gradients(const ShapeKernels<Dim>& shape, const GridGeometry<Dim>& g) {
  if (!shape.takes_moments()) return;
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> uniform(0.01, 0.99);
  for (int i = 0; i < 300; ++i) {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a)
      x[a] = g.min[a] + g.cell[a] * (std::floor(uniform(generator) * g.cells[a]) + uniform(generator));
    const Stencil<Dim> s = stencil<Dim>(shape, g, x);
    for (int a = 0; a < Dim; ++a) {
      const double cells = (x[a] - g.min[a]) / g.cell[a];
      if (shape.outside() > 0 && std::min(cells, g.cells[a] - cells) < 0.26) continue;
      const double step = 1e-6 * g.cell[a];
      Vector<Dim> up = x, down = x;
      up[a] += step;
      down[a] -= step;
      auto above = values<Dim>(shape, g, up), below = values<Dim>(shape, g, down);
      for (int n = 0; n < s.count; ++n) {
        const auto k = static_cast<std::size_t>(n);
        EXPECT_NEAR(s.gradient[k][a], (above[s.node[k]] - below[s.node[k]]) / (2 * step), 1e-8 / g.cell[a]);
      }
    }
  }
}

// Domains that deform, sheared and stretched beyond their cell: constants and linear fields and their gradients, up to
// the wall. No value is negative; 1e-8 for a particle on the wall itself.
template <int Dim>
void expect_reproduction_by_sheared_domains(const std::string& name) {
  const auto shape = shape_registry<Dim>().find(name, {})();
  const auto g = grid<Dim>(5);
  std::array<double, domain_capacity<Dim>> domain{};
  shape->fill_domain(g, 0.5, domain);
  const int components = shape->domain().components;
  for (int n = 0; n < components; n += Dim) {
    const double x = domain[static_cast<std::size_t>(n)];
    for (int a = 1; a < Dim; ++a) domain[static_cast<std::size_t>(n + a)] += 0.7 * a * x;  // shear
    domain[static_cast<std::size_t>(n)] *= 2.5;
  }
  const auto on_wall = [&](const Vector<Dim>& x) {
    bool on = false;
    for (int a = 0; a < Dim; ++a) on = on || std::min(x[a] - g.min[a], g.max[a] - x[a]) < 1e-4 * g.cell[a];
    return on;
  };
  for (const auto& x : points(g)) {
    const Stencil<Dim> s = shape->stencil(g, x, domain);
    double unity = 0;
    Vector<Dim> place{};
    std::array<Vector<Dim>, Dim> gradient{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(s.count); ++i) {
      EXPECT_GE(s.value[i], on_wall(x) ? -1e-8 : -1e-15);
      unity += s.value[i];
      for (int a = 0; a < Dim; ++a) {
        ASSERT_GE(s.node[i][a], 0);
        ASSERT_LT(s.node[i][a], g.cells[a] + shape->reach());
        const double at = shape->node_position(g, a, s.node[i][a]);
        place[a] += s.value[i] * at;
        for (int b = 0; b < Dim; ++b) gradient[a][b] += s.gradient[i][b] * at;
      }
    }
    EXPECT_NEAR(unity, 1, 1e-14);
    for (int a = 0; a < Dim; ++a) {
      EXPECT_NEAR(place[a], x[a], 1e-14);
      for (int b = 0; b < Dim; ++b) EXPECT_NEAR(gradient[a][b], a == b ? 1 : 0, 1e-12 * round_off<Dim>(*shape));
    }
  }
}

TEST(ShearedDomains, ReproduceLinearFields) {
  for (const char* name : {"cpdi", "cpdi2"}) {
    expect_reproduction_by_sheared_domains<2>(name);
    expect_reproduction_by_sheared_domains<3>(name);
  }
}

class ShapeFunctions : public ::testing::TestWithParam<std::string> {
 protected:
  template <int Dim, class Check>
  void for_each_grid(const Check& check) {
    const auto shape = shape_registry<Dim>().find(GetParam(), {})();
    for (const int cells : {1, 2, 3, 7}) {
      SCOPED_TRACE(std::to_string(Dim) + "-D, " + std::to_string(cells) + " cells along the last axis");
      check(*shape, grid<Dim>(cells));
    }
  }
};

TEST_P(ShapeFunctions, ReproduceConstantsAndLinearFieldsUpToTheWall) {
  for_each_grid<2>([](const auto& shape, const auto& g) { expect_linear_reproduction<2>(shape, g); });
  for_each_grid<3>([](const auto& shape, const auto& g) { expect_linear_reproduction<3>(shape, g); });
}

TEST_P(ShapeFunctions, GradientsAreDerivativesOfTheValues) {
  for_each_grid<2>([](const auto& shape, const auto& g) { expect_gradients<2>(shape, g); });
  for_each_grid<3>([](const auto& shape, const auto& g) { expect_gradients<3>(shape, g); });
}

// At the wall the outermost node alone carries the value: conditions on it are conditions at the wall.
TEST_P(ShapeFunctions, OutermostNodeCarriesTheValueAtTheWall) {
  const auto shape = shape_registry<2>().find(GetParam(), {})();
  const auto g = grid<2>(5);
  const auto low = values<2>(*shape, g, g.min), high = values<2>(*shape, g, g.max);
  const int first = shape->outside(), last = shape->reach() - 1 - shape->outside();
  EXPECT_NEAR(low.at({first, first}), 1, 1e-13);
  EXPECT_NEAR(high.at({g.cells[0] + last, g.cells[1] + last}), 1, 1e-13);
  for (int a = 0; a < 2; ++a) {
    EXPECT_DOUBLE_EQ(shape->node_position(g, a, first), g.min[a]);
    EXPECT_DOUBLE_EQ(shape->node_position(g, a, g.cells[a] + last), g.max[a]);
  }
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const auto& name : shape_registry<2>().names()) all.push_back(name);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Registered, ShapeFunctions, ::testing::ValuesIn(names()),
                         [](const auto& value) { return value.param; });

}  // namespace
}  // namespace sluice
