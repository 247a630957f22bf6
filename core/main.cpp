/// The `sluice` command.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <iostream>
#include <new>
#include <thread>

#include "core/case/advice.h"
#include "core/case/case.h"
#include "core/case/case_tree.h"
#include "core/case/reference.h"
#include "core/case/registry.h"
#include "core/chart/study.h"
#include "core/command.h"
#include "core/output/pictures.h"
#include "core/parallel/parallel.h"
#include "core/simulation/guard.h"
#include "core/simulation/physics_module.h"
#include "core/simulation/prediction.h"
#include "core/simulation/run.h"
#include "core/version.h"

namespace {

namespace fs = std::filesystem;
using namespace sluice;

/// The options that several subcommands share.
struct Arguments {
  std::string case_file, output, list_kind, results;
  std::vector<std::string> sets, fields;
  std::vector<double> times;
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  bool resume = false, force = false, quiet = false, animation = false, json = false;
};

void use_threads(int asked) {
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  if (asked > cores)
    fmt::print(stderr, "warning: {} threads on {} core{} are slower than --threads {}\n", asked, cores,
               cores == 1 ? "" : "s", cores);
  set_thread_count(asked);
}

/// Fields and times that are not asked for are those of the case.
int plot(const Arguments& arguments) {
  const fs::path folder = arguments.results;
  if (!fs::exists(folder / "results.h5"))
    throw CaseError(
        fmt::format("{} holds no results.h5; give the folder that `sluice run` wrote to", arguments.results));
  PictureRequest request{folder, arguments.fields, arguments.times, arguments.animation, false};
  if (const fs::path resolved = folder / "case.resolved.yaml"; fs::exists(resolved)) {
    const OutputCase output = load_case(resolved.string()).output;
    if (request.fields.empty()) request.fields = output.pictures;
    if (request.times.empty()) request.times = output.picture_times;
  }
  return draw_pictures(request) ? exit_code::done : exit_code::run_failed;
}

int run(const Arguments& arguments) {
  use_threads(arguments.threads);
  const Case definition = load_case(arguments.case_file, overrides_of(arguments.sets));
  RunOptions options;
  options.folder = arguments.output.empty() ? fs::path("results") / fs::path(arguments.case_file).stem()
                                            : fs::path(arguments.output);
  options.resume = arguments.resume;
  options.force = arguments.force;
  options.quiet = arguments.quiet;
  for (const auto& [name, entry] : advisor_registry().entries())
    for (const std::string& line : advisor_registry().find(name, {}).warn(definition))
      if (!options.quiet) fmt::print(stderr, "warning: {}\n", line);
  return run_case(definition, options);
}

int check(const Arguments& arguments) {
  use_threads(arguments.threads);
  print_prediction(load_case(arguments.case_file, overrides_of(arguments.sets)));
  return exit_code::done;
}

int list(const Arguments& arguments) {
  const auto& catalogues = Catalogue::all();
  if (arguments.list_kind.empty()) {
    for (const auto& [plural, catalogue] : catalogues) fmt::print("{}\n", plural);
    return exit_code::done;
  }
  const auto found = catalogues.find(arguments.list_kind);
  if (found == catalogues.end()) {
    std::vector<std::string> kinds;
    for (const auto& entry : catalogues) kinds.push_back(entry.first);
    const std::string near = nearest_word(arguments.list_kind, kinds);
    throw CaseError(fmt::format("there is no list of '{}'; allowed: {}{}", arguments.list_kind, fmt::join(kinds, ", "),
                                near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
  }
  for (const auto& [name, entry] : found->second->entries()) fmt::print("{:<24}{}\n", name, entry.summary);
  return exit_code::done;
}

int schema(const Arguments& arguments) {
  const std::string study = "What `sluice chart` reads: [charts](charts/README.md). Errors are listed under *errors*.";
  std::cout << (arguments.json
                    ? case_json_schema()
                    : case_reference_markdown() + file_reference_markdown("The study", study, chart::study_docs()));
  return exit_code::done;
}

constexpr int most_threads = 1024;

/// What is wrong with the word after --threads; "" if nothing is.
std::string trouble_with_threads(const std::string& word) {
  int number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc() && end == word.data() + word.size() && number >= 1 && number <= most_threads) return "";
  return fmt::format("found '{}'; expected a whole number from 1 to {}; without the option all cores are used", word,
                     most_threads);
}

void add_case_options(CLI::App& app, Arguments& arguments) {
  app.add_option("case", arguments.case_file, "The case file (YAML)")->required();
  app.add_option("--set", arguments.sets, "Override a value: KEY=VALUE, for example materials.core.cohesion=\"25 kPa\"")
      ->allow_extra_args(false);
  app.add_option("--threads", arguments.threads, "Number of threads (default: all cores)")->check(trouble_with_threads);
}

/// What CLI11 found wrong with the command line, with the commands where that is the trouble.
[[noreturn]] void refuse_command_line(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  std::vector<std::string> commands;
  for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(command->get_name());
  const std::string word = argc > 1 ? argv[1] : "";
  if (word.empty()) throw CaseError(fmt::format("a command is missing; {}", allowed_words(word, commands)));
  if (word[0] != '-' && std::find(commands.begin(), commands.end(), word) == commands.end())
    throw CaseError(fmt::format("there is no command '{}'; {}", word, allowed_words(word, commands)));
  throw CaseError(fmt::format("{}\nsluice --help and sluice COMMAND --help say what is allowed", error.what()));
}

int dispatch(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Sluice: the material point method for soil, water and both together", "sluice");
  app.set_version_flag("--version", "sluice " + version_text());
  app.require_subcommand(1);
  auto* run_command = app.add_subcommand("run", "Run a case");
  add_case_options(*run_command, arguments);
  run_command->add_option("-o,--output", arguments.output, "Folder for the results (default: results/CASE)");
  auto* resume =
      run_command->add_flag("--resume", arguments.resume, "Continue an interrupted run from its latest checkpoint");
  run_command->add_flag("--force", arguments.force, "Overwrite the results of an earlier run")->excludes(resume);
  run_command->add_flag("-q,--quiet", arguments.quiet, "Print errors only");
  auto* check_command = app.add_subcommand("check", "Validate a case and predict what it will cost");
  add_case_options(*check_command, arguments);
  auto* plot_command = app.add_subcommand("plot", "Draw pictures of results");
  plot_command->add_option("results", arguments.results, "Folder that `sluice run` wrote")->required();
  plot_command->add_option("--fields", arguments.fields, "Fields to draw");
  plot_command->add_option("--times", arguments.times, "Times to draw [s]");
  plot_command->add_flag("--animation", arguments.animation, "Draw an animation, too");
  auto* list_command = app.add_subcommand("list", "List materials, physics, shapes, transfers, measures");
  list_command->add_option("kind", arguments.list_kind, "What to list; without it, what can be listed");
  auto* schema_command = app.add_subcommand("schema", "Print the reference of the case file (Markdown)");
  schema_command->add_flag("--json", arguments.json, "Print a JSON Schema for editors instead");
  std::vector<std::pair<CLI::App*, std::function<int()>>> others;
  for (const auto& [name, entry] : command_registry().entries()) {
    auto* const command = app.add_subcommand(name, entry.summary);
    others.emplace_back(command, command_registry().find(name, {})(*command));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) refuse_command_line(app, error, argc, argv);
    return app.exit(error);  // the help, or the version
  }
  if (*run_command) return run(arguments);
  if (*check_command) return check(arguments);
  if (*plot_command) return plot(arguments);
  if (*list_command) return list(arguments);
  for (const auto& [command, execute] : others)
    if (*command) return execute();
  return schema(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return dispatch(argc, argv);
  } catch (const sluice::CaseError& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return sluice::exit_code::bad_input;
  } catch (const sluice::PhysicsError& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return sluice::exit_code::bad_physics;
  } catch (const fs::filesystem_error& error) {
    fmt::print(stderr, "error: {}: {}\n", error.path1().string(), error.code().message());
    return sluice::exit_code::run_failed;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: not enough memory\n");
    return sluice::exit_code::run_failed;
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return sluice::exit_code::run_failed;
  }
}
