/// Regions as obstacles: signed distances and normals, tables integrated, messages of the case file, faces that move.
#include <gtest/gtest.h>

#include <cmath>

#include "core/case/case.h"
#include "core/case/problems.h"
#include "core/grid/faces.h"
#include "core/simulation/simulation.h"

namespace sluice {
namespace {

void expect_surface(const Region& region, const std::vector<double>& x, double distance, std::array<double, 3> normal) {
  const SignedDistance found = region.signed_distance(x);
  EXPECT_NEAR(found.distance, distance, 1e-14);
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_NEAR(found.normal[a], normal[a], 1e-14) << "component " << a;
}

// By hand.
TEST(SignedDistance, OfEveryShapeInsideOnAndOutside) {
  const Region box{{Box{{0, 0}, {4, 2}}}};
  expect_surface(box, {2, 0.5}, -0.5, {0, -1});
  expect_surface(box, {3.75, 1}, -0.25, {1, 0});
  expect_surface(box, {1, 1}, -1, {0, 1});  // of equal distances the later axis
  expect_surface(box, {7, 6}, 5, {0.6, 0.8});
  const Region plane{{HalfSpace{{0, 1}, {3, 4}}}};
  expect_surface(plane, {3, 5}, 5, {0.6, 0.8});
  expect_surface(plane, {-3, -3}, -5, {0.6, 0.8});
  const Region ball{{Sphere{{1, 1, 1}, 2}}};
  expect_surface(ball, {1, 2, 1}, -1, {0, 1, 0});
  expect_surface(ball, {1, 1, 1}, -2, {0, 0, 1});
  for (const bool turned : {false, true}) {
    Polygon wedge{{{0, 0}, {4, 0}, {4, 3}}};
    if (turned) std::swap(wedge.vertices[0], wedge.vertices[1]);
    const Region region{{wedge}};
    expect_surface(region, {2, 0.5}, -0.5, {0, -1});
    expect_surface(region, {3.5, 0.6}, -0.5, {1, 0});
    expect_surface(region, {2, 1.5}, 0, {-0.6, 0.8});  // on the edge
    expect_surface(region, {2 - 0.6, 1.5 + 0.8}, 1, {-0.6, 0.8});
  }
  const Region layer{{Layer{0, 4}}};
  expect_surface(layer, {2, 3}, -1, {0, 1});
  expect_surface(layer, {2, -3}, 3, {0, -1});
  const Region floor{{Box{{0, 0}, {4, 1}}}}, post{{Box{{3, 0}, {4, 3}}}};
  expect_surface(Region{{Union{{floor, post}}}}, {3.75, 1.5}, -0.25, {1, 0});
  expect_surface(Region{{Union{{floor, post}}}}, {1, 1.5}, 0.5, {0, 1});
  expect_surface(Region{{Intersection{{floor, post}}}}, {1, 0.5}, 2, {-1, 0});
  expect_surface(Region{{Difference{{floor, post}}}}, {2.75, 0.5}, -0.25, {1, 0});
  const Region slab{{Box{{0, 0}, {4, 4}}, HalfSpace{{0, 1}, {0, 1}}}};
  expect_surface(slab, {2, 0.75}, -0.25, {0, 1});
}

TEST(Table, IsIntegratedFromTimeZero) {
  const Table ramp{{1, 3}, {2, 6}};  // 2, then up to 6, then 6
  EXPECT_DOUBLE_EQ(ramp.integral(0.5), 1);
  EXPECT_DOUBLE_EQ(ramp.integral(2), 2 + 3);
  EXPECT_DOUBLE_EQ(ramp.integral(5), 2 + 8 + 12);
  EXPECT_DOUBLE_EQ(ramp.integral(-2), -4);
  EXPECT_DOUBLE_EQ(Table::constant(3).integral(4), 12);
}

std::string message(const std::string& more) {
  const std::string text =
      "schema: 1\nphysics: total_stress\nend_time: 1 s\ngravity: [0, -9.81 m/s2]\n"
      "grid: {min: [0 m, 0 m], max: [4 m, 4 m], cell: 0.5 m}\n"
      "materials: {soil: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa}}\n"
      "bodies: [{material: soil, box: {min: [1 m, 1 m], max: [2 m, 2 m]}}]\n";
  try {
    Simulation::create(parse_case(text + more, "c.yaml"));
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

TEST(CaseObstacles, SayWhatIsWrong) {
  EXPECT_EQ(message("obstacles: {ramp: {box: {min: [0 m, 0 m], max: [4 m, 1 m]}, friction: 0.3}}\n"), "");
  EXPECT_EQ(message("obstacles: [{box: {min: [0 m, 0 m], max: [4 m, 1 m]}}]\n"),
            "c.yaml:8:12: obstacles: found a list of 1; expected sections by name, NAME: {…}");
  EXPECT_EQ(message("obstacles: {ramp: {friction: 0.3}}\n"),
            "c.yaml:8:19: obstacle 'ramp': it has no shape; give one or more of box, polygon, "
            "half_space, circle, sphere, layer, below_raster, above_raster, union, intersection, difference");
  EXPECT_EQ(message("obstacles: {ramp: {sphere: {centre: [1 m, 1 m, 1 m], radius: 1 m}}}\n"),
            "c.yaml:8:28: sphere: found 3 components; the grid has 2 dimensions");
  EXPECT_EQ(message("obstacles: {ramp: {box: {min: [0 m, 0 m], max: [4 m, 1 m]}, normal: fixd}}\n"),
            "c.yaml:8:69: normal: found 'fixd'; allowed: fixed, contact; did you mean 'fixed'?");
  EXPECT_EQ(message("obstacles: {ramp: {box: {min: [0 m, 0 m], max: [4 m, 1 m]}, velocity: [1 m/s]}}\n"),
            "c.yaml:8:71: velocity: found 1 components; expected 2 or 3");
  EXPECT_EQ(message("obstacles: {ramp: {box: {min: [0 m, 0 m], max: [4 m, 1 m]}, velocity: [1 m/s, 0, 0]}}\n"),
            "c.yaml:8:71: velocity: found 3 components; the grid has 2 dimensions");
  EXPECT_EQ(message("obstacles: {ramp: {box: {min: [0 m, 0 m], max: [4 m, 1 m]}, friction: 0.1, tangential: free}}\n"),
            "c.yaml:8:71: obstacles.ramp: friction contradicts `tangential: free`; leave out one of them");
  EXPECT_EQ(
      message("obstacles: {ramp: {box: {min: [0 m, 0 m], max: [4 m, 1.5 m]}}}\n"),
      "c.yaml:8:19: obstacles.ramp: it holds a part of a body of 'soil': the material point at (1.125, 1.125) m lies "
      "0.375 m inside");
}

/// The message of a case of soil with water and an obstacle below it; empty if it is accepted.
std::string message_with_water(const std::string& water, const std::string& more = "") {
  const std::string text =
      "schema: 1\nphysics: two_phase\nend_time: 1 s\ngravity: [0, -9.81 m/s2]\n"
      "grid: {min: [0 m, 0 m], max: [4 m, 4 m], cell: 0.5 m}\n"
      "materials: {soil: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa, water: {porosity: 0.4, "
      "permeability: 1e-5 m/s}}}\n"
      "bodies: [{material: soil, box: {min: [1 m, 1 m], max: [2 m, 2 m]}}]\n"
      "obstacles: {ramp: {layer: {top: 1 m}}}\nwater: " +
      water + "\n" + more;
  try {
    Simulation::create(parse_case(text, "c.yaml"));
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

TEST(CaseObstacles, GoWithSoilAndWater) {
  EXPECT_EQ(message_with_water("{formulation: u-p}"), "");
  EXPECT_EQ(
      message_with_water("{formulation: v-w-p}",
                         "boundaries: {left: {absorbing: {density: 2000 kg/m3, p_wave: 1600 m/s, s_wave: 50 m/s}}}\n"),
      "");
  EXPECT_EQ(message_with_water("{formulation: explicit, bulk_modulus: 2.2 GPa}"),
            "c.yaml:8:19: obstacles: `formulation: explicit` does not know them, for its particles have no gradient of "
            "the pressure that could stand at their surfaces; take `formulation: u-p` or `v-w-p`");
}

TEST(CaseFaces, SayWhatIsWrong) {
  EXPECT_EQ(message("boundaries: {left: {normal: contact, velocity: [[[0 s, 0 m/s], [1 s, 2 m/s]], 0]}}\n"), "");
  EXPECT_EQ(message("boundaries: {left: {velocity: [1 m/s, 0]}}\n"),
            "c.yaml:8:31: boundaries.left: velocity needs `normal: fixed` or `normal: contact`");
  EXPECT_EQ(message("boundaries: {left: {normal: fixed, velocity: [[[0 s, 1 m/s]]]}}\n"),
            "c.yaml:8:46: velocity: found 1 components; the grid has 2 dimensions");
  EXPECT_EQ(message("boundaries: {left: {adhesion: 1 kPa}}\n"),
            "c.yaml:8:31: boundaries.left: adhesion needs `normal: fixed`: what adheres does not let go");
  EXPECT_EQ(message("boundaries: {left: {normal: contact, adhesion: 1 kPa}}\n"),
            "c.yaml:8:48: boundaries.left: adhesion needs `normal: fixed`: what adheres does not let go");
  EXPECT_EQ(message("boundaries: {left: {normal: fixed, adhesion: 1 kPa, tangential: fixed}}\n"),
            "c.yaml:8:46: boundaries.left: adhesion contradicts `tangential: fixed`; leave out one of them");
}

TEST(CaseFaces, SayWhatIsWrongWithDashpots) {
  const std::string good = "density: 2000 kg/m3, p_wave: 300 m/s, s_wave: 150 m/s";
  EXPECT_EQ(message("boundaries: {left: {absorbing: {" + good + "}}}\n"), "");
  EXPECT_EQ(message("boundaries: {left: {absorbing: {" + good + "}, friction: 0.3}}\n"),
            "c.yaml:8:32: boundaries.left: absorbing goes with no other key");
  EXPECT_EQ(message("boundaries: {left: {absorbing: {density: 2000 kg/m3, p_wave: 300 m/s, s_wave: 400 m/s}}}\n"),
            "c.yaml:8:32: boundaries.left: absorbing: s_wave must be below p_wave");
  EXPECT_EQ(message("boundaries: {left: {absorbing: {density: 2000 kg/m3, p_wave: 300 m/s}}}\n"),
            "c.yaml:8:32: absorbing: the key 's_wave' is missing (number in m/s, at least 0): Speed of shear waves.");
}

/// The motion of one node on the bottom of a grid after the face has acted.
Vector<2> moved(const FaceCase& bottom, const Vector<2>& velocity, Moment moment) {
  GridGeometry<2> g;
  g.cell.fill(1), g.cells.fill(2), g.max.fill(2);
  Faces<2> faces({{"bottom", bottom}}, g, 2);
  faces.begin_step(1, 2);
  NodeBlock<2> block{};
  block.high.fill(block_width<2>);
  std::vector<Lane> motion(block_nodes<2>);
  motion[1] = Lane{velocity[0], velocity[1], 0, 0};
  if (moment == Moment::kicked)
    faces.fix_with_friction(block, motion.data());
  else
    faces.fix(block, motion.data(), moment);
  return {motion[1][0], motion[1][1]};
}

// The face moves with (10 t, t): (10, 1) m/s at the first moment, (20, 2) at the second.
TEST(Faces, MoveWithTheirVelocity) {
  FaceCase face{FaceCase::Normal::fixed, FaceCase::Tangential::fixed};
  face.velocity = {Table{{0, 10}, {0, 100}}, Table{{0, 10}, {0, 10}}};
  EXPECT_EQ(moved(face, {3, 4}, Moment::before), (Vector<2>{10, 1}));
  EXPECT_EQ(moved(face, {3, 4}, Moment::now), (Vector<2>{20, 2}));
  face.tangential = FaceCase::Tangential::friction;
  face.friction = 0.5;  // 2 m/s into the face take 1 m/s of the slip of 5 m/s
  EXPECT_EQ(moved(face, {25, 0}, Moment::kicked), (Vector<2>{24, 2}));
  face.normal = FaceCase::Normal::contact;
  EXPECT_EQ(moved(face, {25, 0}, Moment::kicked), (Vector<2>{24, 2}));
  EXPECT_EQ(moved(face, {25, 3}, Moment::kicked), (Vector<2>{25, 3}));  // it moves away
}

}  // namespace
}  // namespace sluice
