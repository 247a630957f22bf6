/// The `sluice` command.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>
#include <thread>

#include "core/case/case.h"
#include "core/case/reference.h"
#include "core/case/registry.h"
#include "core/simulation/guard.h"
#include "core/simulation/parallel.h"
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
  int threads = 0;
  bool resume = false, force = false, quiet = false, animation = false, json = false;
};

std::vector<Override> overrides_of(const Arguments& arguments) {
  std::vector<Override> overrides;
  for (const auto& text : arguments.sets) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw CaseError(fmt::format("--set {}: expected KEY=VALUE, for example --set end_time=\"10 s\"", text));
    overrides.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return overrides;
}

void use_threads(int asked) {
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  if (asked < 0) throw CaseError("--threads: expected a positive number");
  set_thread_count(asked == 0 ? cores : asked);
}

/// The script that draws pictures stands beside the program, or in the share folder of the installation.
fs::path pictures_script() {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& candidate : {program / "pictures.py", program / "../share/sluice/pictures.py"})
    if (fs::exists(candidate)) return fs::canonical(candidate);
  throw std::runtime_error(fmt::format("pictures.py was not found beside the program in {}", program.string()));
}

/// A python3 that knows matplotlib: $SLUICE_PYTHON, else Debian's.
std::string python() {
  if (const char* chosen = std::getenv("SLUICE_PYTHON")) return chosen;
  return fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
}

int draw_pictures(const Arguments& arguments) {
  if (!fs::exists(fs::path(arguments.results) / "results.h5"))
    throw CaseError(fmt::format("{} holds no results.h5; give the folder that `sluice run` wrote to", arguments.results));
  std::vector<std::string> words = {python(), pictures_script().string(), arguments.results};
  if (!arguments.fields.empty()) {
    words.emplace_back("--fields");
    words.insert(words.end(), arguments.fields.begin(), arguments.fields.end());
  }
  if (!arguments.times.empty()) {
    words.emplace_back("--times");
    for (const double t : arguments.times) words.push_back(fmt::format("{}", t));
  }
  if (arguments.animation) words.emplace_back("--animation");
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    execvp(argv[0], argv.data());
    fmt::print(stderr, "sluice plot: {} could not be started\n", words[0]);
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? exit_code::done : exit_code::run_failed;
}

int run(const Arguments& arguments) {
  use_threads(arguments.threads);
  const Case definition = load_case(arguments.case_file, overrides_of(arguments));
  RunOptions options;
  options.folder = arguments.output.empty() ? fs::path("results") / fs::path(arguments.case_file).stem()
                                            : fs::path(arguments.output);
  options.resume = arguments.resume;
  options.force = arguments.force;
  options.quiet = arguments.quiet;
  return run_case(definition, options);
}

int check(const Arguments& arguments) {
  use_threads(arguments.threads);
  print_prediction(load_case(arguments.case_file, overrides_of(arguments)));
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
  std::cout << (arguments.json ? case_json_schema() : case_reference_markdown());
  return exit_code::done;
}

void add_case_options(CLI::App& app, Arguments& arguments) {
  app.add_option("case", arguments.case_file, "The case file (YAML)")->required();
  app.add_option("--set", arguments.sets, "Override a value: KEY=VALUE, for example materials.core.cohesion=\"25 kPa\"")
      ->allow_extra_args(false);
  app.add_option("--threads", arguments.threads, "Number of threads (default: all cores)");
}

int dispatch(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Sluice: the material point method for soil, water and both together", "sluice");
  app.set_version_flag("--version", "sluice " + version_text());
  app.require_subcommand(1);
  auto* run_command = app.add_subcommand("run", "Run a case");
  add_case_options(*run_command, arguments);
  run_command->add_option("-o,--output", arguments.output, "Folder for the results (default: results/CASE)");
  run_command->add_flag("--resume", arguments.resume, "Continue an interrupted run from its latest checkpoint");
  run_command->add_flag("--force", arguments.force, "Overwrite the results of an earlier run");
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
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_code::done : exit_code::bad_input;
  }
  if (*run_command) return run(arguments);
  if (*check_command) return check(arguments);
  if (*plot_command) return draw_pictures(arguments);
  if (*list_command) return list(arguments);
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
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: not enough memory\n");
    return sluice::exit_code::run_failed;
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return sluice::exit_code::run_failed;
  }
}
