/// The case: everything that a case file declares, checked, in SI units, with all defaults filled in.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/case/geometry.h"
#include "core/case/node.h"
#include "core/case/table.h"

namespace sluice {

/// The background grid: a box of uniform cells. `min.size()` is the dimension, 2 (plane strain) or 3.
struct GridCase {
  std::vector<double> min;         ///< lower corner [m]
  std::vector<double> max;         ///< upper corner [m]; max - min is a whole number of cells on each axis
  std::vector<double> cell;        ///< cell size per axis [m]; a single value in the file means the same on all axes
  std::array<bool, 3> periodic{};  ///< by axis: both of its faces are periodic
};

/// A region filled with material points of one material.
struct BodyCase {
  std::string material;
  Region region;
  int particles_per_cell = 4;         ///< a perfect square in 2-D, a perfect cube in 3-D
  std::vector<double> velocity;       ///< initial velocity [m/s]; Dim components
  std::vector<std::string> replaces;  ///< materials of earlier bodies that this body may take points from
  Place place;                        ///< where the body stands in the case file
};

/// What lies beyond a face that lets waves out.
struct AbsorbingCase {
  double density = 0;             ///< [kg/m3]
  double p_wave = 0, s_wave = 0;  ///< speeds [m/s]
};

/// What a face of the grid, or the surface of an obstacle, does to the material that reaches it.
struct FaceCase {
  enum class Normal {
    free,     ///< nothing
    fixed,    ///< the material has the normal velocity of the face
    contact,  ///< the same, but it may move away
  };
  enum class Tangential { free, fixed, friction };
  Normal normal = Normal::free;
  Tangential tangential = Tangential::free;
  double friction = 0;                          ///< Coulomb coefficient, used where tangential is `friction`
  double adhesion = 0;                          ///< shear traction that needs no pressure [Pa], likewise
  std::vector<Table> velocity = {};             ///< of the face [m/s], Dim components; empty: at rest
  std::optional<AbsorbingCase> absorbing = {};  ///< then it is free otherwise; faces only
  bool periodic = false;                        ///< the same; what leaves comes in at the face opposite
};

/// A rigid region inside the grid that keeps material out.
struct ObstacleCase {
  std::string name;
  Region region;     ///< where it is at time 0
  FaceCase surface;  ///< never free; it moves with the velocity
  Place place;
};

/// A material that gives way to another during the run, for example sand to liquefied sand.
struct ChangeCase {
  double at = 0;  ///< [s]
  std::string material, becomes;
  Place place;
};

/// Bodies that do not stick to each other.
struct ContactCase {
  std::vector<std::string> materials;  ///< each a body of its own; all other materials are one more
  double friction = 0;                 ///< Coulomb coefficient
  double adhesion = 0;                 ///< shear traction that needs no pressure [Pa]
  std::vector<double> normal;          ///< of the surfaces, either way round; empty: found from the particles
  Place place;
  int bodies() const { return static_cast<int>(materials.size()) + 1; }
};

/// How the equations are discretised. See docs/theory.md.
struct SchemeCase {
  std::string preset = "balanced";
  std::string shape = "quadratic_bspline";
  std::string transfer = "apic";
  double flip_fraction = 1;  ///< share of FLIP in the FLIP/PIC blend; 1 is pure FLIP, 0 is pure PIC
  int xpic_order = 2;        ///< of XPIC: mappings to the nodes in a step; 1 is PIC
  std::string stress_update = "usl";
  std::string integration = "explicit";  ///< explicit, implicit_static or implicit_newmark
  double tolerance = 1e-6;               ///< implicit steps: of forces out of balance, over the largest force on a node
  double gravity_ramp = 0;               ///< implicit_static: time over which gravity grows [s]
  double ghost_penalty = 1e-3;           ///< implicit steps: of nodes hardly reached, in units of 2 G
  std::string strain = "jaumann";        ///< how stress follows large strain: jaumann or hencky
  bool f_bar = false;                    ///< volumetric strain increments averaged over cells
  std::optional<double> fixed_time_step;  ///< [s]; absent: computed every step
  Place time_step_place;                  ///< where `time_step` stands in the case file
  double courant = 0.5;                   ///< wave limit: courant * h / (c + |v|)
  double advection = 0.2;                 ///< advection limit: share of a cell that a particle crosses in one step
  double strain_per_step = 0.05;          ///< strain limit: largest strain increment in one step
};

enum class OutflowPolicy { error, remove, clamp };

/// A number that is followed during a run and written to observations.csv.
struct ObservationCase {
  std::string name;
  std::string measure;               ///< name of a registered measure, for example `front`
  std::vector<double> direction;     ///< unit vector; empty if the measure needs none
  std::optional<Region> region;      ///< initial region of the material that is followed; absent: everything
  std::optional<std::string> field;  ///< name of a column
  Place place;
};

struct OutputCase {
  double every = 0;  ///< [s]; 0: only the first and the last state
  /// [s] between rows of history.csv and observations.csv; 0: every step; absent: a thousandth of the end time.
  std::optional<double> history_every;
  std::vector<std::string> pictures;
  std::vector<double> picture_times;  ///< [s]; empty: four evenly spaced
  double checkpoint_every = 30;       ///< wall-clock seconds between checkpoints
};

struct Case {
  std::string file;  ///< as named by the user
  std::string title;
  std::string physics;
  GridCase grid;
  std::vector<double> gravity;                          ///< [m/s2], Dim components
  std::vector<std::pair<std::string, Node>> materials;  ///< in file order; read by the physics module
  std::vector<BodyCase> bodies;
  std::map<std::string, FaceCase> faces;  ///< left right bottom top (front back in 3-D)
  std::vector<ObstacleCase> obstacles;
  Node initial_stress;  ///< read by the physics module
  Node surface_loads;   ///< the same
  Node water;           ///< the same
  Node advice;          ///< read by advisors; they add what they decided as `verdict`
  std::vector<ChangeCase> changes;
  std::optional<ContactCase> contact;
  SchemeCase scheme;
  OutflowPolicy outflow = OutflowPolicy::error;
  double end_time = 0;  ///< [s]
  std::vector<ObservationCase> observe;
  OutputCase output;
  Node source;  ///< the whole tree as read, overrides applied

  int dimension() const { return static_cast<int>(grid.min.size()); }
};

/// A `--set key=value` of the command line, for example {"materials.core.cohesion", "25 kPa"}.
struct Override {
  std::string key;
  std::string value;
};

/// Reads and checks a case file. Throws CaseError naming file, line and column of everything that is wrong.
Case load_case(const std::string& file, const std::vector<Override>& overrides = {});

/// The same from text; `name` stands for the file in messages. Relative files are looked up beside `name`.
Case parse_case(const std::string& text, const std::string& name, const std::vector<Override>& overrides = {});

}  // namespace sluice
