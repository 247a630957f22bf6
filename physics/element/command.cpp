/// The command `sluice element`: a material alone on a path of strain and stress. docs/element.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

#include "core/case/case_tree.h"
#include "core/command.h"
#include "core/output/csv_table.h"
#include "core/output/file_aside.h"
#include "core/output/pictures.h"
#include "core/simulation/physics_module.h"
#include "core/simulation/run.h"
#include "physics/element/comparison.h"
#include "physics/element/path.h"
#include "physics/element/reference.h"

namespace sluice::element {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string file, output;
  std::vector<std::string> sets;
  bool force = false, quiet = false, no_reference = false, no_picture = false;
};

/// One of the two tables.
class Table {
 public:
  Table(const fs::path& path, const ElementCase& definition, const Material& material)
      : definition_(definition), table_(path, columns(definition, material)) {}

  void append(const Row& row) {
    const PointState& p = row.point;
    const double volume = p.strain[0] + p.strain[1] + p.strain[2];
    std::vector<CsvTable::Cell> cells = {p.time, definition_.stages[row.stage].name};
    cells.insert(cells.end(), p.strain.begin(), p.strain.end());
    cells.insert(cells.end(), p.stress.begin(), p.stress.end());
    for (const double value : {pressure(p.stress), mises_stress(p.stress), p.pore_pressure, volume})
      cells.emplace_back(value);
    if (definition_.initial_void_ratio)
      cells.emplace_back((1 + *definition_.initial_void_ratio) * std::exp(volume) - 1);
    cells.insert(cells.end(), p.state.begin(), p.state.end());
    table_.append(cells);
  }

 private:
  static std::vector<std::string> columns(const ElementCase& definition, const Material& material) {
    std::vector<std::string> names = {"time_s", "stage"};
    for (const std::string& component : component_names()) names.push_back("strain_" + component);
    for (const std::string& component : component_names()) names.push_back("stress_" + component + "_Pa");
    for (const char* name : {"pressure_Pa", "mises_stress_Pa", "pore_pressure_Pa", "volumetric_strain"})
      names.emplace_back(name);
    if (definition.initial_void_ratio) names.emplace_back("void_ratio");
    for (const ColumnSpec& spec : material.columns())
      for (int c = 0; c < spec.components; ++c)
        names.push_back(spec.name + (spec.components > 1 ? fmt::format("_{}", c) : "") +
                        (spec.unit == "1" ? "" : "_" + spec.unit));
    return names;
  }

  const ElementCase& definition_;
  CsvTable table_;
};

void prepare_folder(const fs::path& folder, bool force) {
  if (fs::is_directory(folder) && !fs::is_empty(folder) && !force)
    throw CaseError(fmt::format(
        "the output folder {} is not empty; take another --output, or overwrite it with --force", folder.string()));
  make_output_folder(folder);
  for (const char* name : {"element.csv", "reference.csv", "pictures/element.png"}) fs::remove(folder / name);
}

void report(const std::vector<Row>& rows) {
  const PointState& end = rows.back().point;
  double peak = 0;
  for (const Row& row : rows) peak = std::max(peak, mises_stress(row.point.stress));
  fmt::print("end:   p = {:.6g} Pa, q = {:.6g} Pa, volumetric strain {:.4g}\n", pressure(end.stress),
             mises_stress(end.stress), end.strain[0] + end.strain[1] + end.strain[2]);
  fmt::print("peak:  q = {:.6g} Pa\n", peak);
}

/// Runs the reference beside `rows`; what stops it is a warning, for the path itself was run.
void compare(const ElementCase& definition, const Material& material, const std::vector<Row>& rows,
             const Arguments& arguments, const fs::path& folder) {
  Table table(folder / "reference.csv", definition, material);
  std::vector<Row> expected;
  try {
    integrate_reference(definition, material, [&](const Row& row) {
      table.append(row);
      expected.push_back(row);
    });
  } catch (const PhysicsError& error) {
    fmt::print(stderr, "warning: {}\n", error.what());
    return;
  }
  if (arguments.quiet) return;
  const Difference d = difference(rows, expected);
  fmt::print(
      "reference with tolerance {:g}: stress differs by up to {:.2g} of {:.4g} Pa, strain {:.2g}, state {:.2g}\n",
      definition.reference.tolerance, d.stress, d.largest_stress, d.strain, d.state);
}

int execute(const Arguments& arguments) {
  const ElementCase definition = load_element(arguments.file, overrides_of(arguments.sets));
  const auto material = material_of(definition);
  initial_point(definition, *material);  // says what is wrong with it before anything is written
  const fs::path folder =
      arguments.output.empty() ? fs::path("results") / fs::path(arguments.file).stem() : fs::path(arguments.output);
  prepare_folder(folder, arguments.force);
  replace_text_file(folder / "element.resolved.yaml", definition.resolved);

  std::vector<Row> rows;
  Table table(folder / "element.csv", definition, *material);
  drive(definition, *material, [&](const Row& row) {
    table.append(row);
    rows.push_back(row);
  });
  if (!arguments.quiet) report(rows);
  if (definition.reference.compute && !arguments.no_reference) compare(definition, *material, rows, arguments, folder);
  const bool drawn = arguments.no_picture || run_script("element_pictures.py", {folder.string()}, arguments.quiet);
  if (!arguments.quiet) fmt::print("results in {}\n", folder.string());
  return drawn ? exit_code::done : exit_code::run_failed;
}

std::function<int()> declare(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("file", arguments->file, "The element file (YAML), see docs/element.md")->required();
  app.add_option("--set", arguments->sets, "Override a value: KEY=VALUE, for example path.strain=\"5 %\"")
      ->allow_extra_args(false);
  app.add_option("-o,--output", arguments->output, "Folder for the results (default: results/FILE)");
  app.add_flag("--force", arguments->force, "Overwrite earlier results");
  app.add_flag("--no-reference", arguments->no_reference, "Leave out the reference with controlled error");
  app.add_flag("--no-picture", arguments->no_picture, "Draw nothing");
  app.add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  std::string types = "Tests by name, for `path: {type: NAME, …}`:";
  for (const PathType& type : path_types()) types += fmt::format("\n  {:<24}{}", type.name, type.summary);
  app.footer(types);
  return [arguments] { return execute(*arguments); };
}

const bool registered =
    command_registry().add("element", {"Put a material alone on a path of strain and stress", {}}, declare);

}  // namespace
}  // namespace sluice::element
