/// What a case says of water: the section `water`, and the key `water` of each material that is saturated with it.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/case/schema.h"
#include "physics/loads/external_pressure.h"
#include "physics/materials/materials.h"
#include "solvers/lagged_cholesky.h"

namespace sluice {

/// Which equations are solved. docs/theory.md, section 9.
enum class Formulation {
  u_p,       ///< the water follows the acceleration of the solid; its pressure is solved for
  v_w_p,     ///< the water keeps an inertia of its own; its pressure is solved for
  explicit_  ///< both inertias, pressure from the compressibility of the water, explicitly: for comparison
};

/// Permeability [m/s] up to which u-p is meant to hold: at 5 Hz its error is beyond ten per cent from 1.6e-2 m/s on,
/// and in soil ten times coarser than this limit its explicit acceleration makes long steps unstable.
inline constexpr double coarsest_u_p = 0.1;

/// What a face of the grid is to the water.
struct WaterFace {
  std::optional<Table> pressure;  ///< [Pa]
  std::optional<Table> head;      ///< [m]: the level of water beyond the face; impermeable above it
  std::optional<Table> flux;      ///< [m/s], out of the grid
};

/// The pore pressure before the first step.
struct InitialPressure {
  enum class Method { none, uniform, hydrostatic, steady_seepage };
  Method method = Method::none;
  double pressure = 0;            ///< [Pa], for `uniform`
  std::optional<double> level;    ///< [m], for `hydrostatic` without a water table
  std::optional<double> suction;  ///< [Pa], for `hydrostatic`: the pressure does not go below minus this
};

struct WaterCase {
  Formulation formulation = Formulation::u_p;
  double density = 1000;               ///< [kg/m3]
  std::optional<double> bulk_modulus;  ///< [Pa]; absent: incompressible
  double saturation = 1;
  double increment = 1;  ///< beta: share of the old pressure that the predictor uses
  bool stabilisation = true;
  bool join_films = true;                    ///< eq. (49e); else they burst, for comparison
  bool surface_within_cells = true;          ///< eq. (48); else the pressure is zero at whole vertices, for comparison
  std::vector<std::array<double, 2>> table;  ///< [m]: points above it hold no water; absent: all are saturated
  InitialPressure initial;
  std::map<std::string, WaterFace> faces;
  std::vector<Pond> ponds;
  LaggedCholeskyOptions solver;

  /// 1/K of water with a little air: S/K_w + (1 - S)/p_atmospheric [1/Pa]; 0 if incompressible.
  double compressibility() const;
  /// Whether the point with these first and last coordinates lies below the water table.
  bool below_table(double x, double z) const { return table.empty() || z <= table_level(x); }
  double table_level(double x) const;  ///< [m]; of a table that is given
};

/// How much water a material holds, and how it lets it pass.
struct PoreSpace {
  double porosity = 0;               ///< before the first step
  std::vector<double> permeability;  ///< hydraulic conductivity [m/s], one for all axes or one for each
  bool kozeny_carman = true;         ///< the permeability follows the porosity

  double per_initial_kozeny_carman = 1;  ///< 1 / (n^3 / (1 - n)^2) at the start
  bool saturated = false;                ///< holds water
  bool liquid = false;                   ///< is water
};

/// Throws CaseError.
WaterCase read_water(const Case& definition);
Node resolved(const WaterCase& water);
/// The keys that the module reads, for the reference.
std::vector<FieldDoc> water_docs();

/// Pore spaces by index of the material; `liquid` says which of them are liquids. Throws CaseError.
std::vector<PoreSpace> read_pore_spaces(const Case& definition, const WaterCase& water,
                                        const std::vector<bool>& liquid);
Node resolved(const PoreSpace& pores);

/// The case without the keys `water` of the materials, as the constitutive models want it.
Case without_pores(Case definition);

}  // namespace sluice
