#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include "core/output/results_reader.h"
#include "physics/initial_stress/initial_stress.h"
#include "physics/statics/grid_unknowns.h"

namespace sluice {

namespace {

/// One component of a column, and the same of the earlier run.
struct Component {
  ColumnId column;
  int component;
  bool state;  // not the stress
  std::vector<double> values;
};

/// The state of the earlier run at one time.
struct Earlier {
  std::vector<double> points;  // three a particle
  std::vector<double> displacement;
  std::vector<std::int32_t> id, material;
  std::vector<std::string> names;  // of the materials
  std::vector<double> volume;
  std::vector<Component> components;
  std::size_t size() const { return id.size(); }
};

[[noreturn]] void refuse(const InitialStress& initial, const std::string& what) {
  throw CaseError(initial.place, fmt::format("initial_stress: '{}' {}", initial.file, what));
}

std::size_t time_index(const InitialStress& initial, const ResultsReader& results) {
  const auto& times = results.times();
  if (!initial.time) return times.size() - 1;
  const auto nearest = std::ranges::min_element(times, {}, [&](double t) { return std::abs(t - *initial.time); });
  // An output time is met to round-off, and written as text in the case.
  if (std::abs(*nearest - *initial.time) > 1e-9 * std::max(1.0, std::abs(*initial.time)))
    refuse(initial, fmt::format("has no output time {:g} s; the nearest is {:g} s, the last {:g} s", *initial.time,
                                *nearest, times.back()));
  return static_cast<std::size_t>(nearest - times.begin());
}

/// The columns to be taken: the stress, and what the materials in use keep. The message about a missing one names a
/// material.
template <int Dim>
std::vector<std::pair<ColumnSpec, std::string>> wanted(const InitialStress& initial, const Scene<Dim>& scene,
                                                       const Materials<Dim>& materials) {
  const auto& specs = scene.particles.columns.specs();
  std::vector<std::pair<ColumnSpec, std::string>> all{
      {specs[static_cast<std::size_t>(scene.particles.stress.index)], ""}};
  if (!initial.state) return all;
  const std::set<std::int32_t> used(scene.particles.material.begin(), scene.particles.material.end());
  for (const std::int32_t m : used)
    for (const ColumnSpec& spec : materials[static_cast<std::size_t>(m)].columns())
      if (std::ranges::none_of(all, [&](const auto& other) { return other.first.name == spec.name; }))
        all.emplace_back(spec, scene.particles.material_names[static_cast<std::size_t>(m)]);
  return all;
}

template <int Dim>
Earlier read(const InitialStress& initial, const Scene<Dim>& scene, const Materials<Dim>& materials) {
  const ResultsReader results(initial.file);
  if (results.dimension() != Dim)
    refuse(initial, fmt::format("is of a run in {}-D; this case is in {}-D", results.dimension(), Dim));
  const std::size_t time = time_index(initial, results);
  const std::vector<std::string> fields = results.fields();
  Earlier earlier{results.points(time),
                  results.field("displacement", time),
                  results.numbers("id", time),
                  results.numbers("material", time),
                  results.material_names(),
                  results.field("volume", time),
                  {}};
  for (const auto& [spec, material] : wanted(initial, scene, materials)) {
    if (std::ranges::find(fields, spec.name) == fields.end())
      refuse(initial, fmt::format("has no field '{}', which the material '{}' keeps; it has {}. Take another run, or "
                                  "write `state: false` for the stress alone",
                                  spec.name, material, fmt::join(fields, ", ")));
    const std::vector<double> rows = results.field(spec.name, time);
    const std::size_t stride = results.components(spec.name);
    for (int c = 0; c < spec.components; ++c) {
      Component component{scene.particles.columns.find(spec.name), c, !material.empty(), {}};
      for (std::size_t k = static_cast<std::size_t>(c); k < rows.size(); k += stride)
        component.values.push_back(rows[k]);
      earlier.components.push_back(std::move(component));
    }
  }
  return earlier;
}

// ---- by particles ----

/// Why the particles are not the same; empty if they are: as many, and each identity of the same material and born at
/// the same place. `row` becomes the row of each particle of this run.
template <int Dim>
std::string difference(const Scene<Dim>& scene, const Earlier& earlier, std::vector<std::size_t>& row) {
  const Particles& ps = scene.particles;
  if (ps.size() != earlier.size()) return fmt::format("{} particles there, {} here", earlier.size(), ps.size());
  std::unordered_map<std::int32_t, std::size_t> row_of;
  for (std::size_t k = 0; k < earlier.size(); ++k) row_of[earlier.id[k]] = k;
  row.resize(ps.size());
  // Positions less displacements are places of birth to round-off.
  const double tolerance = 1e-6 * scene.grid.smallest_cell();
  for (std::size_t p = 0; p < ps.size(); ++p) {
    const auto found = row_of.find(ps.id[p]);
    if (found == row_of.end()) return fmt::format("no particle {} there", ps.id[p]);
    const std::size_t k = row[p] = found->second;
    const std::string &there = earlier.names.at(static_cast<std::size_t>(earlier.material[k])),
                      &here = ps.material_names[static_cast<std::size_t>(ps.material[p])];
    if (there != here) return fmt::format("particle {} is of '{}' there, of '{}' here", ps.id[p], there, here);
    for (int a = 0; a < Dim; ++a) {
      const std::size_t at = 3 * k + static_cast<std::size_t>(a);
      // Displacements count every turn.
      const double off = scene.grid.shortest(
          a, earlier.points[at] - earlier.displacement[at] - ps.columns.data(ps.initial_position, a)[p]);
      if (!(std::abs(off) < tolerance)) return fmt::format("particle {} began elsewhere", ps.id[p]);
    }
  }
  return "";
}

// ---- by cells ----

/// Linear fits to the earlier particles of one material in a cell and those around it, weighted with their volumes.
template <int Dim>
class Fits {
 public:
  Fits(const InitialStress& initial, const Scene<Dim>& scene, const Earlier& earlier)
      : initial_(initial), scene_(scene), earlier_(earlier) {
    const auto& names = scene.particles.material_names;
    for (std::size_t k = 0; k < earlier.size(); ++k) {
      const auto found = std::ranges::find(names, earlier.names.at(static_cast<std::size_t>(earlier.material[k])));
      if (found != names.end()) rows_[key(scene.grid.cell_of(point(k)), found - names.begin())].push_back(k);
    }
  }

  void set(Particles& ps, std::size_t p) {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = ps.columns.data(ps.position, a)[p];
    const Index<Dim> cell = scene_.grid.cell_of(x);
    const std::int64_t number = key(cell, ps.material[p]);
    auto known = fits_.find(number);
    if (known == fits_.end()) known = fits_.emplace(number, fit(cell, ps.material[p], x)).first;
    const Fit& f = known->second;
    const Eigen::VectorXd values = f.mean + f.slopes.transpose() * (in_cells(x) - f.centre);
    for (std::size_t c = 0; c < earlier_.components.size(); ++c) {
      const auto i = static_cast<Eigen::Index>(c);
      const Component& component = earlier_.components[c];
      // A state variable stays within what there was: a strain must not become negative. The stress may go on linearly,
      // to the surface.
      ps.columns.data(component.column, component.component)[p] =
          component.state ? std::clamp(values[i], f.least[i], f.most[i]) : values[i];
    }
  }

 private:
  using Place = Eigen::Matrix<double, Dim, 1>;
  struct Fit {
    Place centre;            // of the earlier particles, in cells
    Eigen::VectorXd mean;    // by component
    Eigen::MatrixXd slopes;  // axes by components
    Eigen::VectorXd least, most;
  };

  std::int64_t key(const Index<Dim>& cell, std::int64_t material) const {
    std::int64_t number = material;
    for (int a = Dim - 1; a >= 0; --a) number = number * (std::int64_t{1} << 18) + cell[a];
    return number;
  }
  Vector<Dim> point(std::size_t k) const {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = earlier_.points[3 * k + static_cast<std::size_t>(a)];
    return x;
  }
  Place in_cells(const Vector<Dim>& x) const {
    Place place;
    for (int a = 0; a < Dim; ++a) place[a] = (x[a] - scene_.grid.min[a]) / scene_.grid.cell[a];
    return place;
  }

  std::vector<std::size_t> rows_around(const Index<Dim>& cell, std::int64_t material) const {
    std::vector<std::size_t> rows;
    for (int n = 0; n < neighbourhood<Dim>; ++n) {
      Index<Dim> other = cell;
      bool inside = true;
      for (int a = 0, rest = n; a < Dim; ++a, rest /= 3) {
        other[a] += rest % 3 - 1;
        inside = inside && other[a] >= 0 && other[a] < scene_.grid.cells[a];
      }
      if (!inside) continue;
      if (const auto found = rows_.find(key(other, material)); found != rows_.end())
        rows.insert(rows.end(), found->second.begin(), found->second.end());
    }
    return rows;
  }

  /// Sums in the order of the rows of the file.
  Fit fit(const Index<Dim>& cell, std::int32_t material, const Vector<Dim>& x) const {
    const std::vector<std::size_t> rows = rows_around(cell, material);
    if (rows.empty())
      refuse(initial_,
             fmt::format("has no particle of '{}' in or around the cell of ({:g}) m, where this case has "
                         "one: its bodies were others",
                         scene_.particles.material_names[static_cast<std::size_t>(material)], fmt::join(x, ", ")));
    const auto count = static_cast<Eigen::Index>(earlier_.components.size());
    Fit f{Place::Zero(), Eigen::VectorXd::Zero(count), Eigen::MatrixXd::Zero(Dim, count),
          Eigen::VectorXd::Constant(count, INFINITY), Eigen::VectorXd::Constant(count, -INFINITY)};
    const auto values = [&](std::size_t k) {
      Eigen::VectorXd all(count);
      for (Eigen::Index c = 0; c < count; ++c) all[c] = earlier_.components[static_cast<std::size_t>(c)].values[k];
      return all;
    };
    double weight = 0;
    for (const std::size_t k : rows) {
      const double volume = earlier_.volume[k];
      const Eigen::VectorXd value = values(k);
      weight += volume;
      f.centre += volume * in_cells(point(k));
      f.mean += volume * value;
      f.least = f.least.cwiseMin(value);
      f.most = f.most.cwiseMax(value);
    }
    f.centre /= weight;
    f.mean /= weight;
    Eigen::Matrix<double, Dim, Dim> spread = Eigen::Matrix<double, Dim, Dim>::Zero();
    for (const std::size_t k : rows) {
      const Place away = in_cells(point(k)) - f.centre;
      spread += earlier_.volume[k] / weight * away * away.transpose();
      f.slopes += earlier_.volume[k] / weight * away * (values(k) - f.mean).transpose();
    }
    // Particles in one row do not say how the stress changes across it: no slope in that direction.
    constexpr double narrow = 1e-3;  // square of a distance in cells
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, Dim, Dim>> axes(spread);
    Place inverse;
    for (int a = 0; a < Dim; ++a) inverse[a] = axes.eigenvalues()[a] > narrow ? 1 / axes.eigenvalues()[a] : 0;
    f.slopes = axes.eigenvectors() * inverse.asDiagonal() * axes.eigenvectors().transpose() * f.slopes.eval();
    return f;
  }

  const InitialStress& initial_;
  const Scene<Dim>& scene_;
  const Earlier& earlier_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> rows_;  // of the earlier run, by cell and material
  std::unordered_map<std::int64_t, Fit> fits_;
};

}  // namespace

template <int Dim>
void stress_from_file(InitialStress& initial, Scene<Dim>& scene, const Materials<Dim>& materials) {
  Earlier earlier;
  try {
    earlier = read(initial, scene, materials);
  } catch (const CaseError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw CaseError(initial.place, fmt::format("initial_stress: {}", error.what()));
  }
  Particles& ps = scene.particles;
  std::vector<std::size_t> row;
  const std::string differs =
      initial.by == InitialStress::By::cells ? "not asked for" : difference(scene, earlier, row);
  if (initial.by == InitialStress::By::particles && !differs.empty())
    refuse(initial, fmt::format("does not hold the same particles: {}; `by: cells` does without", differs));
  if (differs.empty()) {
    initial.by = InitialStress::By::particles;
    for (const Component& component : earlier.components)
      for (std::size_t p = 0; p < ps.size(); ++p)
        ps.columns.data(component.column, component.component)[p] = component.values[row[p]];
    return;
  }
  initial.by = InitialStress::By::cells;
  Fits<Dim> fits(initial, scene, earlier);
  for (std::size_t p = 0; p < ps.size(); ++p)
    if (!materials[static_cast<std::size_t>(ps.material[p])].liquid()) fits.set(ps, p);
}

template void stress_from_file<2>(InitialStress&, Scene<2>&, const Materials<2>&);
template void stress_from_file<3>(InitialStress&, Scene<3>&, const Materials<3>&);

}  // namespace sluice
