/// Scene: everything that a physics module works on, shared by all modules.
#pragma once

#include <cstdint>
#include <memory>

#include "core/case/case.h"
#include "core/grid/blocks.h"
#include "core/grid/dashpots.h"
#include "core/grid/faces.h"
#include "core/grid/geometry.h"
#include "core/grid/nodes.h"
#include "core/grid/obstacles.h"
#include "core/particles/particles.h"
#include "core/simulation/body_contact.h"
#include "core/simulation/stage_clock.h"
#include "core/transfer/shape_kernels.h"
#include "core/transfer/transfer_scheme.h"

namespace sluice {

template <int Dim>
struct Scene {
  explicit Scene(const Case& definition);

  GridGeometry<Dim> grid;
  GridGeometry<Dim> unrolled;  ///< as the kernels see it
  Vector<Dim> gravity{};       ///< [m/s2]
  std::unique_ptr<ShapeKernels<Dim>> shape;
  TransferScheme transfer;
  SchemeCase scheme;
  Faces<Dim> faces;
  Dashpots<Dim> dashpots;  ///< of the faces that absorb
  Obstacles<Dim> obstacles;
  Particles particles;
  ColumnId affine;         ///< C of APIC [1/s], declared when the transfer is affine
  ColumnId domain;         ///< what part of space a particle stands for; declared when the shape functions ask for it
  ColumnId unit_pressure;  ///< declared where the area is wanted
  Blocks<Dim> blocks;
  NodeFields<Dim> nodes;
  std::unique_ptr<BodyContact<Dim>> contact;  ///< of bodies that do not stick together, or null
  NodeFields<Dim> surface;  ///< area of the surface of the material by node, its forces; only where wanted, and not
                            ///< with `contact`, which has one for each body

  double time = 0;         ///< [s]
  std::int64_t step = 0;   ///< steps completed
  double previous_dt = 0;  ///< length of the last step [s]; 0 before the first
  MotionReport motion;     ///< of the last step, over all blocks
  double travelled = 0;    ///< most cells that a particle may have crossed since the last sort
  StageClock clock;

  int domain_components() const { return domain.index < 0 ? 0 : particles.columns.spec(domain).components; }

  /// Time over which velocities change in a step of length dt: they live at the middle of steps (leap-frog).
  double kick(double dt) const { return 0.5 * (previous_dt + dt); }

  /// Bodies that have nodes of their own; one without `contact`.
  int bodies() const { return contact == nullptr ? 1 : contact->bodies(); }
  /// The nodes of a body, and the area of its surface.
  NodeFields<Dim>& nodes_of(int body) { return contact == nullptr ? nodes : contact->nodes(body); }
  NodeFields<Dim>& surface_of(int body) { return contact == nullptr ? surface : contact->surface(body); }

  /// Makes room for fields beside those of `nodes_of`.
  void resize(FieldsByBody<Dim>& fields) const {
    fields.resize(static_cast<std::size_t>(bodies()));
    for (NodeFields<Dim>& of_body : fields) of_body.resize(blocks, shape->reach());
  }

  /// Called once, when all bodies are filled: the domains of the particles.
  void initialise_domains();
  /// Makes room for the fields of the nodes of the active blocks.
  void resize_nodes();
  /// Faces and obstacles take their places and velocities for a step of length dt.
  void move_boundaries(double dt);
  bool any_friction() const {
    return faces.any_friction() || obstacles.any_friction() || (contact != nullptr && contact->has_friction());
  }
  /// Whether anything asks for the area of the surface of the material.
  bool wants_area() const { return faces.any_adhesion() || obstacles.any_adhesion() || dashpots.any(); }
  /// The particles of a block under unit pressure: their forces are the area of the surface of the material.
  ScatterInput<Dim> surface_input(const ParticleBlock<Dim>& block) const;

  /// Shape functions at a point, and where a node stands along an axis, by the numbers that nodes have in the grid.
  Stencil<Dim> stencil(const Vector<Dim>& x, std::span<const double> domain_numbers) const;
  double node_position(int axis, int node) const {
    return shape->node_position(unrolled, axis, node + grid.first_inside()[static_cast<std::size_t>(axis)]);
  }

  BlockParticles<Dim> view(const ParticleBlock<Dim>& block) const;
  /// The affine columns are null when the transfer is not affine.
  ScatterInput<Dim> scatter_input(const ParticleBlock<Dim>& block) const;
};

/// Makes the geometry of the grid of a case.
template <int Dim>
GridGeometry<Dim> grid_of(const GridCase& grid);

extern template struct Scene<2>;
extern template struct Scene<3>;

}  // namespace sluice
