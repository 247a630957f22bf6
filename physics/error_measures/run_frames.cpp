#include "physics/error_measures/run_frames.h"

#include <fmt/format.h>

#include <cmath>

#include "physics/loads/external_pressure.h"
#include "physics/two_phase/water.h"

namespace sluice {

namespace {

/// A measure without keys of its own.
struct NoKeys {
  std::string measure;
};

const Schema<NoKeys>& no_keys() {
  static const auto schema = Schema<NoKeys>("error").text("measure", &NoKeys::measure, "The name of the measure.");
  return schema;
}

class WithoutKeys final : public chart::ErrorMeasure {
 public:
  explicit WithoutKeys(double (*function)(const chart::FinishedRun&)) : evaluate_(function) {}
  double evaluate(const chart::FinishedRun& run) const override { return evaluate_(run); }

 private:
  double (*evaluate_)(const chart::FinishedRun&);
};

}  // namespace

RunFrames::RunFrames(const std::filesystem::path& folder, std::string field)
    : reader_(folder / "results.h5"), field_(std::move(field)) {}

RunFrame RunFrames::at(std::size_t i) const {
  RunFrame frame{reader_.times().at(i), {}, {}, {}};
  const std::vector<double> points = reader_.points(i), moved = reader_.field("displacement", i);
  const std::size_t n = reader_.particles(i);
  frame.start.resize(n);
  frame.displacement.resize(n);
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t a = 0; a < 3; ++a) {
      frame.displacement[p][a] = moved[3 * p + a];
      frame.start[p][a] = points[3 * p + a] - moved[3 * p + a];
    }
  if (!field_.empty()) frame.field = reader_.field(field_, i);
  return frame;
}

std::unique_ptr<Material> only_material(const Case& definition) {
  if (definition.materials.size() != 1)
    throw CaseError(fmt::format("{}: the error measure knows cases with one material only; found {}", definition.file,
                                definition.materials.size()));
  return make_material(without_pores(definition).materials.front().second);
}

double extent(const Case& definition, int axis) {
  const auto bounds = definition.bodies.front().region.bounds(definition.dimension());
  const auto a = static_cast<std::size_t>(axis);
  const double length = bounds[1][a] - bounds[0][a];
  if (definition.bodies.size() != 1 || !std::isfinite(length))
    throw CaseError(definition.bodies.front().place,
                    "the error measure knows cases with one body of a given size only");
  return length;
}

exact::SaturatedSoil saturated_soil_of(const Case& definition) {
  const auto material = only_material(definition);
  const WaterCase water = read_water(definition);
  const PoreSpace pores = read_pore_spaces(definition, water, {false}).front();
  exact::SaturatedSoil soil;
  soil.porosity = pores.porosity;
  soil.solid_density = material->density() / (1 - pores.porosity);
  soil.water_density = water.density;
  soil.modulus = material->elasticity().constrained_modulus();
  soil.conductivity = pores.permeability.back();
  if (water.compressibility() > 0) soil.water_bulk_modulus = 1 / water.compressibility();
  return soil;
}

double load_of(const Case& definition) {
  const auto loads = read_surface_loads(definition);
  if (loads.size() != 1 || !loads.front().pressure)
    throw CaseError(
        fmt::format("{}: the error measure knows cases with one pressure as surface load only", definition.file));
  return loads.front().pressure->at(0);
}

bool add_error_measure(const std::string& name, const std::string& summary,
                       double (*evaluate)(const chart::FinishedRun& run)) {
  return chart::error_measure_registry().add(name, {summary, [] { return no_keys().docs(); }},
                                             [evaluate](const Node& section, const chart::Study&) {
                                               no_keys().read(section);
                                               return std::make_unique<WithoutKeys>(evaluate);
                                             });
}

}  // namespace sluice
