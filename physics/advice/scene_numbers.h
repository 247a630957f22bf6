/// SceneNumbers: what a case says of its soils, its water, its loads and its geometry, as the advisor needs it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "physics/advice/advice_case.h"
#include "physics/advice/column.h"
#include "physics/advice/scene_lattice.h"
#include "physics/materials/material.h"
#include "physics/two_phase/water.h"

namespace sluice::advice {

struct SoilNumbers {
  std::string name;
  bool liquid = false;
  bool wet = false;            ///< holds water, and its permeability is known
  bool unknown_water = false;  ///< of `total_stress`: may hold water, and nothing is known of it
  Strength strength = Strength::unlimited;
  IsotropicElasticity elasticity;  ///< as in the case
  double density = 0;              ///< with its water [kg/m3]
  double dry_density = 0;          ///< without [kg/m3]

  // Of wet soil.
  exact::SaturatedSoil soil;      ///< conductivity: the largest of those of the axes
  double least_conductivity = 0;  ///< the smallest [m/s]
  double drainage_length = 0;     ///< [m]; infinite: water cannot leave
  bool has_undrained = false;     ///< the case says what it is in total stresses
  double undrained_modulus = 0;   ///< M + Q, or that of what the case says [Pa]
};

struct Stage {
  std::string name;  ///< for people: "whole run, 0.75 s"
  Loading loading;
};

struct Layer {
  std::string material;
  double thickness = 0;  ///< [m]; infinite: from face to face of the grid
};

struct SceneNumbers {
  AdviceCase asked;
  WaterCase water;
  std::vector<SoilNumbers> soils;  ///< those of the bodies, and what they become
  std::vector<Stage> stages;
  bool guessed_stages = true;
  std::vector<Layer> layers;            ///< by body
  std::vector<std::string> same_along;  ///< axes along which nothing varies: x, y, z
  std::vector<double> cells_along;      ///< how many cells the scene has along each of them
  double height = 0;                    ///< along the last axis [m]
  double expected_strain = 0;  ///< of elastic soil, under its weight and the loads; infinite where soil may flow

  bool any_wet() const;
  bool any_liquid() const;
  bool any_unknown() const;
};

/// Throws CaseError. Undrained sections of materials are read where `physics: auto` allows them.
SceneNumbers numbers_of(const Case& definition);

/// The key of a material under `physics: auto` that says what it is in undrained total stresses.
inline constexpr const char* undrained_key = "undrained";

}  // namespace sluice::advice
