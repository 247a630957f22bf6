/// The command `sluice chart`: error against cost. docs/charts/README.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/chart/error_measure.h"
#include "core/chart/ledger.h"
#include "core/chart/measured_run.h"
#include "core/chart/results_table.h"
#include "core/chart/study.h"
#include "core/command.h"
#include "core/output/file_aside.h"
#include "core/output/pictures.h"
#include "core/simulation/interrupt.h"
#include "core/simulation/run.h"
#include "core/version.h"

namespace sluice::chart {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string file, output;
  int threads = 1;
  bool force = false, quiet = false, no_picture = false;
};

/// The same for the same text in every program (FNV-1a, 64 bits).
std::string fingerprint(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return fmt::format("{:016x}", hash);
}

class StudyRun {
 public:
  StudyRun(const Study& study, const Arguments& arguments)
      : study_(study), arguments_(arguments), measure_(make_error_measure(study)) {
    load_case(study.case_file, study.settings);  // what is wrong with the case itself is not the fault of a variant
    for (const Variant& variant : variants_of(study)) rows_.push_back({variant, {}, "", 0, 0, 0});
    if (rows_.empty()) throw CaseError(study.file + ": every combination is left out");
    for (Row& row : rows_) cases_.push_back(case_of(row));
    refuse_useless_choices();
    folder_ = arguments.output.empty() ? fs::path("results") / "charts" / fs::path(study.file).stem()
                                       : fs::path(arguments.output);
    prepare_folder();
  }

  int execute() {
    watch_for_interruption();
    if (study_.reference && !run_reference()) return stop();
    for (int repetition = 1; repetition <= study_.repetitions; ++repetition)
      for (std::size_t i = 0; i < rows_.size(); ++i)
        if (!run_variant(i, repetition)) return stop();
    complete(rows_, study_);
    write_chart(folder_, study_, rows_);
    const bool drawn = arguments_.no_picture || run_script("chart_figures.py", {folder_.string()}, arguments_.quiet);
    return report() && drawn ? exit_code::done : exit_code::run_failed;
  }

 private:
  /// The case of a variant; nothing where the case reader refuses it, which is a result.
  std::optional<Case> case_of(Row& row) const {
    try {
      return load_case(study_.case_file, row.variant.settings);
    } catch (const CaseError& error) {
      row.failure = "refused";
      row.runs = {{.variant = row.variant.name(), .version = version_text(), .error = NAN, .report = {}}};
      row.runs.front().report.failure = "refused";
      row.runs.front().report.message = error.what();
      return std::nullopt;
    }
  }

  /// A choice that is refused in every combination is a mistake, such as a key that does not exist.
  void refuse_useless_choices() const {
    if (std::ranges::none_of(cases_, [](const auto& definition) { return definition.has_value(); }))
      throw CaseError(fmt::format("{}: the case refuses every combination; the first, {}:\n{}", study_.file,
                                  rows_.front().variant.name(), rows_.front().runs.front().report.message));
    for (std::size_t a = 0; a < study_.axes.size(); ++a)
      for (const Choice& choice : study_.axes[a].choices) {
        bool useful = false, met = false;
        std::string message;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
          if (rows_[i].variant.labels[a] != choice.label) continue;
          met = true;
          useful = useful || cases_[i];
          if (message.empty() && !cases_[i]) message = rows_[i].runs.front().report.message;
        }
        if (met && !useful)
          throw CaseError(study_.axes[a].place,
                          fmt::format("axis '{}', choice '{}': the case refuses it in every combination:\n{}",
                                      study_.axes[a].name, choice.label, message));
      }
  }

  void prepare_folder() {
    const fs::path table = folder_ / "runs.csv";
    if (fs::is_directory(folder_) && !fs::is_empty(folder_) && !fs::exists(table) && !arguments_.force)
      throw CaseError(
          fmt::format("the output folder {} is not empty and holds no study; take another --output, or "
                      "overwrite it with --force",
                      folder_.string()));
    make_output_folder(folder_);
    ledger_.emplace(table, arguments_.force);
  }

  std::string identity_of(const Case& definition) const {
    std::string text = yaml_text(definition.source) + yaml_text(study_.error);
    if (study_.reference)
      for (const Override& o : *study_.reference) text += o.key + "=" + o.value + "\n";
    return fingerprint(text);
  }

  RunRequest request(const std::vector<Override>& settings, const fs::path& folder) const {
    return {study_.case_file, settings, folder, arguments_.threads, study_.limits.cpu};
  }

  /// False if the user interrupted. The reference has no limit of CPU time.
  bool run_reference() {
    std::vector<Override> settings = study_.settings;
    settings.insert(settings.end(), study_.reference->begin(), study_.reference->end());
    const std::string identity = identity_of(load_case(study_.case_file, settings));
    reference_ = folder_ / "reference";
    if (ledger_->find(identity, 0) != nullptr && fs::exists(reference_ / "summary.json")) return true;
    RunRequest wanted = request(settings, reference_);
    wanted.cpu_limit = 1e6;
    say("reference run");
    Entry entry{identity, "reference", 0, version_text(), 0, measured_run(wanted)};
    if (entry.report.interrupted) return false;
    if (!entry.report.failure.empty())
      throw std::runtime_error(fmt::format("the reference run of {} failed, {}: {}\nits results are in {}", study_.file,
                                           entry.report.failure, entry.report.message, reference_.string()));
    ledger_->append(entry);
    return true;
  }

  bool wanted(const Row& row, int repetition) const {
    if (repetition == 1) return true;
    const RunReport& first = row.runs.front().report;
    return first.failure.empty() && first.cpu_seconds <= study_.repeat_up_to;
  }

  /// A run that the limit of CPU time stopped is done again when the limit has grown.
  bool stands(const Entry* entry) const {
    return entry != nullptr &&
           !(entry->report.failure == "CPU limit" && entry->report.process_cpu < 0.9 * study_.limits.cpu);
  }

  /// False if the user interrupted.
  bool run_variant(std::size_t i, int repetition) {
    Row& row = rows_[i];
    if (!cases_[i] || !wanted(row, repetition)) return true;
    const std::string identity = identity_of(*cases_[i]);
    if (const Entry* const done = ledger_->find(identity, repetition); stands(done)) {
      row.runs.push_back(*done);
      return true;
    }
    const fs::path folder = folder_ / "run";
    Entry entry{identity,   row.variant.name(),
                repetition, version_text(),
                NAN,        measured_run(request(row.variant.settings, folder))};
    if (entry.report.interrupted) return false;
    if (entry.report.failure.empty())
      entry.error = repetition == 1 ? error_of(*cases_[i], folder, entry.report) : row.runs.front().error;
    ledger_->append(entry);
    row.runs.push_back(entry);
    say(fmt::format("{:>4}/{}  {:<48} {}  {:.3g} s", i + 1, rows_.size(), row.variant.name(),
                    entry.report.failure.empty() ? fmt::format("error {:.3e}", entry.error) : entry.report.failure,
                    entry.report.cpu_seconds));
    return true;
  }

  /// What the measure cannot judge is a failure of the variant, unless the case is not of its kind at all.
  double error_of(const Case& definition, const fs::path& folder, RunReport& report) const {
    try {
      return measure_->evaluate({definition, folder, reference_});
    } catch (const CaseError&) {
      throw;
    } catch (const std::exception& error) {
      report.failure = "no error measured";
      report.message = error.what();
      return NAN;
    }
  }

  int stop() const {
    fmt::print(stderr, "interrupted; the same command continues the study in {}\n", folder_.string());
    return exit_code::interrupted;
  }

  void say(const std::string& line) const {
    if (arguments_.quiet) return;
    fmt::print("{}\n", line);
    std::fflush(stdout);
  }

  /// False if no variant came through.
  bool report() const {
    bool any = false;
    for (const Row& row : rows_) any = any || row.failure.empty();
    if (!any) {
      std::string lines;
      for (const Row& row : rows_)
        lines += fmt::format("\n  {}: {}{}", row.variant.name(), row.failure,
                             row.runs.empty() ? "" : ": " + row.runs.front().report.message);
      throw std::runtime_error(fmt::format("{}: no variant has an error that could be charted{}", study_.file, lines));
    }
    if (arguments_.quiet) return true;
    fmt::print("the front, from cheap to exact:\n");
    std::vector<const Row*> front;
    for (const Row& row : rows_)
      if (row.on_front()) front.push_back(&row);
    std::ranges::sort(front, [](const Row* a, const Row* b) { return a->cpu_seconds < b->cpu_seconds; });
    for (const Row* row : front)
      fmt::print("  {:<48} error {:.3e}  {:.3g} s\n", row->variant.name(), row->error, row->cpu_seconds);
    fmt::print("chart in {}\n", folder_.string());
    return true;
  }

  const Study& study_;
  const Arguments& arguments_;
  std::unique_ptr<ErrorMeasure> measure_;
  std::vector<Row> rows_;
  std::vector<std::optional<Case>> cases_;  ///< parallel to rows_
  fs::path folder_, reference_;
  std::optional<Ledger> ledger_;
};

int execute(const Arguments& arguments) {
  const Study study = load_study(arguments.file);
  return StudyRun(study, arguments).execute();
}

std::function<int()> declare(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("study", arguments->file, "The study file (YAML), see docs/charts/README.md")->required();
  app.add_option("-o,--output", arguments->output,
                 "Folder for the table and the figure (default: results/charts/STUDY)");
  app.add_option("--threads", arguments->threads, "Threads of each run")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_flag("--force", arguments->force, "Begin anew; without it, what was run is not run again");
  app.add_flag("--no-picture", arguments->no_picture, "Draw nothing");
  app.add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  return [arguments] { return execute(*arguments); };
}

const bool registered =
    command_registry().add("chart", {"Run the variants of a case and chart error against cost", {}}, declare);

}  // namespace
}  // namespace sluice::chart
