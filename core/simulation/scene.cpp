#include "core/simulation/scene.h"

#include <cmath>

namespace sluice {

template <int Dim>
GridGeometry<Dim> grid_of(const GridCase& grid) {
  GridGeometry<Dim> g;
  for (std::size_t a = 0; a < Dim; ++a) {
    g.min[a] = grid.min[a];
    g.max[a] = grid.max[a];
    g.cells[a] = static_cast<int>(std::lround((grid.max[a] - grid.min[a]) / grid.cell[a]));
    g.cell[a] = (grid.max[a] - grid.min[a]) / g.cells[a];
    g.periodic[a] = grid.periodic[a];
  }
  return g;
}

template GridGeometry<2> grid_of<2>(const GridCase&);
template GridGeometry<3> grid_of<3>(const GridCase&);

namespace {

template <int Dim>
std::array<std::vector<double>, Dim> node_places(const Scene<Dim>& scene) {
  std::array<std::vector<double>, Dim> places;
  for (int a = 0; a < Dim; ++a)
    for (int i = 0; i < scene.grid.cells[a] + (scene.grid.periodic[a] ? 0 : scene.shape->reach()); ++i)
      places[a].push_back(scene.node_position(a, i));
  return places;
}

/// The length of each periodic axis [m]; 0 for the others.
template <int Dim>
Vector<Dim> periods(const GridGeometry<Dim>& grid) {
  Vector<Dim> length{};
  for (int a = 0; a < Dim; ++a)
    if (grid.periodic[a]) length[a] = grid.max[a] - grid.min[a];
  return length;
}

/// Where the case says `transfer`, or else `shape`.
Place place_of_scheme(const Case& definition) {
  const Node* const section = definition.source.find("scheme");
  if (section == nullptr) return definition.source.place;
  const Node *const transfer = section->find("transfer"), *const shape = section->find("shape");
  return transfer != nullptr ? transfer->place : shape != nullptr ? shape->place : section->place;
}

}  // namespace

template <int Dim>
Scene<Dim>::Scene(const Case& definition)
    : grid(grid_of<Dim>(definition.grid)),
      unrolled(grid.unrolled()),
      shape(shape_registry<Dim>().find(definition.scheme.shape, definition.source.place)()),
      transfer(transfer_registry().find(definition.scheme.transfer, definition.source.place)),
      scheme(definition.scheme),
      faces(definition.faces, grid, shape->reach(), shape->outside()),
      dashpots(faces, grid, shape->reach(), definition.contact ? definition.contact->bodies() : 1),
      obstacles(definition.obstacles, node_places<Dim>(*this), 0.5 * (shape->reach() + 1), grid.min, periods(grid)),
      particles(Dim) {
  for (std::size_t a = 0; a < Dim; ++a) gravity[a] = definition.gravity.empty() ? 0 : definition.gravity[a];
  obstacles.note_faces(faces);
  std::vector<std::string> materials;
  for (const auto& [name, section] : definition.materials) materials.push_back(name);
  if (definition.contact) contact = std::make_unique<BodyContact<Dim>>(*definition.contact, materials);
  if (grid.any_periodic()) particles.declare_periodic(periods(grid));
  if (transfer.affine)
    affine = particles.columns.declare({"affine_velocity", "1/s", Dim * Dim, Role::state,
                                        "Affine velocity field, row by row: component, direction.", false});
  if (wants_area() || contact != nullptr)
    unit_pressure = particles.columns.declare(
        {"unit_pressure", "1", 2, Role::derived, "Ones and zeros: a stress of one, and none.", false});
  if (transfer.affine && !transfer.gradient && !shape->takes_moments())
    throw CaseError(place_of_scheme(definition), "scheme: transfer '" + scheme.transfer +
                                                     "' needs moments of the shape functions, which shape '" +
                                                     scheme.shape + "' does not have; take tpic, xpic or flip");
  if (const ColumnSpec spec = shape->domain(); spec.components > 0) domain = particles.columns.declare(spec);
}

/// Bodies are filled with lattices that divide cells evenly, so that volumes tell the spacing.
template <int Dim>
void Scene<Dim>::initialise_domains() {
  const int components = domain_components();
  if (components == 0) return;
  std::array<double, domain_capacity<Dim>> numbers{};
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double volume = particles.columns.data(particles.volume)[p] / grid.cell_volume();
    shape->fill_domain(grid, 1 / std::round(std::pow(volume, -1.0 / Dim)), numbers);
    for (int c = 0; c < components; ++c) particles.columns.data(domain, c)[p] = numbers[static_cast<std::size_t>(c)];
  }
}

template <int Dim>
void Scene<Dim>::resize_nodes() {
  nodes.resize(blocks, shape->reach());
  if (wants_area() && contact == nullptr) surface.resize(blocks, shape->reach());
  if (contact != nullptr) contact->resize(blocks, shape->reach());
  if (unit_pressure.index >= 0) {
    std::fill_n(particles.columns.data(unit_pressure, 0), particles.size(), 1.0);
    std::fill_n(particles.columns.data(unit_pressure, 1), particles.size(), 0.0);
  }
  obstacles.resize(blocks.node_blocks().size());
}

template <int Dim>
void Scene<Dim>::move_boundaries(double dt) {
  const double before = time - 0.5 * previous_dt, now = time + 0.5 * dt;
  faces.begin_step(before, now);
  obstacles.begin_step(time, before, now);
}

template <int Dim>
Stencil<Dim> Scene<Dim>::stencil(const Vector<Dim>& x, std::span<const double> domain_numbers) const {
  Stencil<Dim> s = shape->stencil(unrolled, x, domain_numbers);
  if (!grid.any_periodic()) return s;
  for (int n = 0; n < s.count; ++n) {
    Index<Dim>& node = s.node[static_cast<std::size_t>(n)];
    for (int a = 0; a < Dim; ++a) node[a] -= grid.first_inside()[a];
    node = grid.wrapped(node);
  }
  return s;
}

template <int Dim>
BlockParticles<Dim> Scene<Dim>::view(const ParticleBlock<Dim>& block) const {
  BlockParticles<Dim> view{&unrolled, block.first_cell, block.begin, block.end, {}};
  for (int a = 0; a < Dim; ++a) view.first_cell[a] += grid.first_inside()[a];
  for (int a = 0; a < Dim; ++a) view.position[a] = particles.columns.data(particles.position, a);
  const int components = domain_components();
  for (int c = 0; c < components; ++c) view.domain[static_cast<std::size_t>(c)] = particles.columns.data(domain, c);
  return view;
}

template <int Dim>
ScatterInput<Dim> Scene<Dim>::scatter_input(const ParticleBlock<Dim>& block) const {
  const Columns& columns = particles.columns;
  ScatterInput<Dim> in{};
  in.particles = view(block);
  in.mass = columns.data(particles.mass);
  in.volume = columns.data(particles.volume);
  for (int a = 0; a < Dim; ++a) in.velocity[a] = columns.data(particles.velocity, a);
  for (int c = 0; c < symmetric_components<Dim>; ++c) in.stress[c] = columns.data(particles.stress, c);
  if (transfer.affine)
    for (int c = 0; c < Dim * Dim; ++c) in.affine[c] = columns.data(affine, c);
  return in;
}

template <int Dim>
ScatterInput<Dim> Scene<Dim>::surface_input(const ParticleBlock<Dim>& block) const {
  ScatterInput<Dim> in = scatter_input(block);
  for (int c = 0; c < symmetric_components<Dim>; ++c)
    in.stress[c] = particles.columns.data(unit_pressure, c < Dim ? 0 : 1);
  return in;
}

template struct Scene<2>;
template struct Scene<3>;

}  // namespace sluice
