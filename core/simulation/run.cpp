#include "core/simulation/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <optional>

#include "core/case/resolved_case.h"
#include "core/output/archive.h"
#include "core/output/csv_table.h"
#include "core/output/file_aside.h"
#include "core/output/observation.h"
#include "core/output/pictures.h"
#include "core/output/results.h"
#include "core/output/summary.h"
#include "core/parallel/parallel.h"
#include "core/simulation/guard.h"
#include "core/simulation/interrupt.h"
#include "core/simulation/physics_module.h"
#include "core/simulation/progress.h"
#include "core/simulation/simulation.h"
#include "core/version.h"

namespace sluice {

namespace {

namespace fs = std::filesystem;
using SteadyClock = std::chrono::steady_clock;

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

/// Refuses a path on which a file stands where a folder is wanted.
void check_path(const fs::path& folder) {
  fs::path part;
  for (const auto& name : folder) {
    part /= name;
    std::error_code unreadable;  // is left to make_folder
    if (fs::exists(part, unreadable) && !fs::is_directory(part, unreadable))
      throw CaseError(fmt::format("the output folder {} cannot be made: {} is a file; take another --output",
                                  folder.string(), part.string()));
  }
}

/// Refuses to touch a folder that holds results, before anything is computed. The folder is made when the case has
/// proved sound.
void check_folder(const RunOptions& options) {
  check_path(options.folder);
  if (options.resume) {
    if (!fs::is_directory(options.folder))
      throw CaseError(fmt::format("--resume: there is no folder {}", options.folder.string()));
    return;
  }
  if (fs::is_directory(options.folder) && !fs::is_empty(options.folder) && !options.force)
    throw CaseError(
        fmt::format("the output folder {} is not empty; take another --output, continue it with --resume, or "
                    "overwrite it with --force",
                    options.folder.string()));
}

/// CPU time of this process, all threads [s].
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Adds the time until the end of the scope to what output has taken, on the clock and of the CPU.
class OutputTime {
 public:
  OutputTime(double& wall, double& cpu) : wall_(wall), cpu_(cpu) {}
  ~OutputTime() {
    wall_ += seconds_since(start_);
    cpu_ += cpu_seconds() - cpu_start_;
  }
  OutputTime(const OutputTime&) = delete;
  OutputTime& operator=(const OutputTime&) = delete;

 private:
  double &wall_, &cpu_;
  SteadyClock::time_point start_ = SteadyClock::now();
  double cpu_start_ = cpu_seconds();
};

/// Most bytes that this process has had in memory, as Linux counts them; 0 where it does not say.
double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0; word == "VmHWM:" && status >> kilobytes) return 1024 * kilobytes;
  return 0;
}

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Events at multiples of an interval of simulated time.
class Schedule {
 public:
  Schedule(double every, double now)
      : every_(every), count_(every > 0 ? std::floor(now / every * (1 + 1e-12)) + 1 : 0) {}
  double next() const { return every_ > 0 ? count_ * every_ : INFINITY; }
  bool due(double time) const { return time >= next() * (1 - 1e-12); }
  void pass(double time) {
    while (due(time)) ++count_;
  }

 private:
  double every_, count_;
};

class Run {
 public:
  Run(const Case& definition, const RunOptions& options)
      : case_(definition),
        options_(options),
        simulation_(Simulation::create(definition)),
        checkpoints_(options.folder) {
    if (options.resume) resume();
    for (const auto& o : case_.observe)
      observations_.push_back(make_observation(o, simulation_->particles(), case_.grid.cell));
    require_pictured_fields(case_, simulation_->particles());
    simulation_->require_time_step();
    // From here on the folder changes; what the user did wrong has been found by now.
    make_output_folder(options_.folder);
    if (!options.resume) clear_folder();
    open_outputs();
  }

  int execute() {
    loop_cpu_start_ = cpu_seconds();
    Progress progress(options_.quiet, simulation_->time(), case_.end_time);
    const double row_interval = case_.output.history_every.value_or(case_.end_time / 1000);
    Schedule frames(case_.output.every, simulation_->time()), rows(row_interval, simulation_->time());
    if (!options_.resume) {
      write_row({0, "", simulation_->largest_speed()});
      results_->add_frame(simulation_->particles(), simulation_->time(), simulation_->steps());
      checkpoint();
    }
    try {
      while (simulation_->time() < case_.end_time) {
        const double until = std::min(case_.end_time, frames.next());
        const StepInfo info = advance(until);
        particle_steps_ += simulation_->particles().size();
        const bool at_end = simulation_->time() >= case_.end_time;
        if (row_interval <= 0 || rows.due(simulation_->time()) || at_end) write_row(info);
        rows.pass(simulation_->time());
        if (frames.due(simulation_->time()) || at_end) write_frame();
        frames.pass(simulation_->time());
        if (seconds_since(last_checkpoint_) > case_.output.checkpoint_every) checkpoint();
        progress.show(*simulation_, info);
        if (interrupted() && !at_end) return stop(progress);
      }
    } catch (const PhysicsError&) {
      progress.end_line();
      summarise_failure("physics_failed");
      throw;
    } catch (const std::runtime_error&) {
      progress.end_line();
      summarise_failure("run_failed");
      throw;
    }
    progress.end_line();
    checkpoint();
    results_->finish();
    summarise("end_time_reached");
    report();
    draw();
    return exit_code::done;
  }

 private:
  /// Takes away what would tell of an earlier run if this one were killed.
  void clear_folder() {
    checkpoints_.clear();
    fs::remove(options_.folder / "summary.json");
    fs::remove_all(options_.folder / "pictures");
  }

  void resume() {
    const Checkpoint checkpoint = checkpoints_.load_latest();
    for (const auto& warning : checkpoint.warnings) fmt::print(stderr, "warning: {}\n", warning);
    if (checkpoint.archive.texts.at("case") != identity())
      throw CaseError(
          fmt::format("--resume: the run in {} is of another case: what stands in the case file (or --set) has "
                      "changed, apart from end_time, output, outflow and the time step",
                      options_.folder.string()));
    simulation_->restore(checkpoint.archive);
    earlier_seconds_ = checkpoint.archive.reals.at("wall_seconds").at(0);
    earlier_particle_steps_ = checkpoint.archive.reals.at("particle_steps").at(0);
    earlier_cpu_seconds_ = checkpoint.archive.reals.at("step_cpu_seconds").at(0);
    if (!options_.quiet)
      fmt::print("resuming at time {:g} s, step {}, from {}\n", checkpoint.time, checkpoint.step,
                 checkpoint.file.string());
  }

  /// What must not change between the parts of a run: everything but when it ends, what it writes, advice, and the
  /// remedies that the messages of a failed run propose.
  std::string identity() const {
    Case same = case_;
    same.end_time = 1;
    same.output = {};
    same.observe.clear();
    same.outflow = {};
    same.advice = {};
    const SchemeCase usual;
    same.scheme.fixed_time_step = usual.fixed_time_step;
    same.scheme.courant = usual.courant;
    same.scheme.advection = usual.advection;
    same.scheme.strain_per_step = usual.strain_per_step;
    return resolved_yaml(same, simulation_->resolved_sections());
  }

  void open_outputs() {
    Provenance provenance = Provenance::of_this_process();
    provenance.case_text = text_of(case_.file);
    provenance.resolved_case = resolved_yaml(case_, simulation_->resolved_sections());
    provenance.title = case_.title;
    provenance.version = version_text();
    provenance.threads = thread_count();
    provenance.grid = case_.grid;
    std::ofstream(options_.folder / "case.resolved.yaml") << provenance.resolved_case;

    std::vector<std::string> history = {"step", "time_s", "dt_s", "limiter", "max_speed_m_s"};
    for (const auto& energy : simulation_->energies()) history.push_back(energy.first + "_energy_J");
    for (const auto& [name, value] : simulation_->step_numbers()) history.push_back(name);
    std::vector<std::string> observed = {"step", "time_s"};
    for (std::size_t i = 0; i < observations_.size(); ++i)
      observed.push_back(case_.observe[i].name + "_" + unit_word(i));
    const double now = simulation_->time();
    if (options_.resume) {
      results_.emplace(options_.folder, provenance, simulation_->particles(), now);
      history_.emplace(options_.folder / "history.csv", history, "time_s", now);
      observed_.emplace(options_.folder / "observations.csv", observed, "time_s", now);
    } else {
      results_.emplace(options_.folder, provenance, simulation_->particles());
      history_.emplace(options_.folder / "history.csv", history);
      observed_.emplace(options_.folder / "observations.csv", observed);
    }
  }

  /// "m/s" as a word of a column name: "m_s".
  std::string unit_word(std::size_t i) const {
    std::string unit = observations_[i]->unit();
    std::replace(unit.begin(), unit.end(), '/', '_');
    return unit;
  }

  void write_row(const StepInfo& info) {
    const OutputTime clock(output_seconds_, output_cpu_seconds_);
    const double time = simulation_->time();
    std::vector<CsvTable::Cell> row = {simulation_->steps(), time, info.dt, info.limiter, info.speed};
    for (const auto& energy : simulation_->energies()) row.emplace_back(energy.second);
    for (const auto& [name, value] : simulation_->step_numbers()) row.emplace_back(value);
    history_->append(row);
    std::vector<CsvTable::Cell> observed = {simulation_->steps(), time};
    for (const auto& observation : observations_)
      observed.emplace_back(observation->evaluate(simulation_->particles()));
    observed_->append(observed);
  }

  StepInfo advance(double until) {
    try {
      return simulation_->advance(until);
    } catch (const std::runtime_error&) {
      keep_last_good_state();
      throw;
    }
  }

  /// A step that fails leaves particles half moved. The steps since the latest checkpoint, which come out the same bit
  /// for bit, are repeated up to the one before it, and that state is kept.
  void keep_last_good_state() {
    try {
      const std::int64_t good = simulation_->steps();
      simulation_->restore(checkpoints_.load_latest().archive);
      Schedule frames(case_.output.every, simulation_->time());
      while (simulation_->steps() < good && !interrupted()) {
        simulation_->advance(std::min(case_.end_time, frames.next()));
        frames.pass(simulation_->time());
      }
      checkpoint();
      write_frame();
    } catch (const std::exception& error) {
      fmt::print(stderr, "warning: the last good state could not be kept: {}\n", error.what());
    }
  }

  void write_frame() {
    const OutputTime clock(output_seconds_, output_cpu_seconds_);
    results_->add_frame(simulation_->particles(), simulation_->time(), simulation_->steps());
  }

  void checkpoint() {
    const OutputTime clock(output_seconds_, output_cpu_seconds_);
    Archive archive;
    simulation_->store(archive);
    archive.texts["case"] = identity();
    archive.reals["wall_seconds"] = {earlier_seconds_ + seconds_since(start_)};
    archive.reals["step_cpu_seconds"] = {step_cpu_seconds()};
    archive.reals["particle_steps"] = {earlier_particle_steps_ + static_cast<double>(particle_steps_)};
    checkpoints_.save(std::move(archive), simulation_->time(), simulation_->steps());
    last_checkpoint_ = SteadyClock::now();
  }

  /// CPU time of the steps, without the start and without output.
  double step_cpu_seconds() const {
    return earlier_cpu_seconds_ + cpu_seconds() - loop_cpu_start_ - output_cpu_seconds_;
  }

  int stop(Progress& progress) {
    progress.end_line();
    checkpoint();
    summarise("interrupted");
    fmt::print(stderr, "interrupted at time {:g} s; the same command with --resume continues the run in {}\n",
               simulation_->time(), options_.folder.string());
    return exit_code::interrupted;
  }

  /// What went wrong matters more than a summary that cannot be written.
  void summarise_failure(const std::string& reason) {
    try {
      summarise(reason);
    } catch (const std::exception& error) {
      fmt::print(stderr, "warning: {}\n", error.what());
    }
  }

  void summarise(const std::string& reason) {
    Summary s;
    s.exit_reason = reason;
    s.version = version_text();
    s.time = simulation_->time();
    s.steps = simulation_->steps();
    s.particles = static_cast<std::int64_t>(simulation_->particles().size());
    s.threads = thread_count();
    const double here = seconds_since(start_);
    s.wall_seconds = earlier_seconds_ + here;
    s.particle_steps_per_second = (earlier_particle_steps_ + static_cast<double>(particle_steps_)) / s.wall_seconds;
    s.stage_seconds = simulation_->stage_seconds();
    s.stage_seconds["output"] = output_seconds_;
    for (std::size_t i = 0; i < observations_.size(); ++i)
      s.observations[case_.observe[i].name] = observations_[i]->evaluate(simulation_->particles());
    s.extra["particle_steps"] = earlier_particle_steps_ + static_cast<double>(particle_steps_);
    s.extra["step_cpu_seconds"] = step_cpu_seconds();
    s.extra["peak_memory_bytes"] = peak_memory();
    s.extra["removed_particles"] = static_cast<double>(simulation_->removed_particles());
    for (const auto& [name, value] : simulation_->totals()) s.extra[name] = value;
    if (const Node* const verdict = case_.advice.find("verdict"))
      for (std::size_t i = 0; i < verdict->items.size(); ++i)
        s.verdict.emplace_back(verdict->keys[i].first, verdict->items[i].scalar);
    s.extra["particle_bytes"] = static_cast<double>(simulation_->memory());
    write_summary(options_.folder / "summary.json", s);
    summary_ = s;
  }

  /// The pictures that the case asks for. A run does not fail for want of Python.
  void draw() const {
    if (case_.output.pictures.empty()) return;
    if (!draw_pictures({options_.folder, case_.output.pictures, case_.output.picture_times, true, true}))
      fmt::print(stderr, "warning: the pictures could not be drawn; the results are complete, try `sluice plot {}`\n",
                 options_.folder.string());
    else if (!options_.quiet)
      fmt::print("pictures in {}\n", (options_.folder / "pictures").string());
  }

  void report() const {
    if (options_.quiet) return;
    fmt::print("done: {} steps of {} particles in {:.2f} s on {} thread{}: {:.3g} million particle-steps per second\n",
               summary_.steps, summary_.particles, summary_.wall_seconds, summary_.threads,
               summary_.threads == 1 ? "" : "s", summary_.particle_steps_per_second / 1e6);
    for (const auto& [stage, seconds] : summary_.stage_seconds) fmt::print("  {:<10}{:9.2f} s\n", stage, seconds);
    for (std::size_t i = 0; i < observations_.size(); ++i)
      fmt::print("  {} = {:.4g} {}\n", case_.observe[i].name, summary_.observations.at(case_.observe[i].name),
                 observations_[i]->unit());
    fmt::print("results in {}\n", options_.folder.string());
  }

  const Case& case_;
  const RunOptions& options_;
  SteadyClock::time_point start_ = SteadyClock::now(), last_checkpoint_ = start_;
  std::unique_ptr<Simulation> simulation_;
  CheckpointStore checkpoints_;
  std::optional<ResultsWriter> results_;
  std::optional<CsvTable> history_, observed_;
  std::vector<std::unique_ptr<Observation>> observations_;
  std::size_t particle_steps_ = 0;
  double earlier_seconds_ = 0, earlier_particle_steps_ = 0, earlier_cpu_seconds_ = 0;
  double output_seconds_ = 0, output_cpu_seconds_ = 0, loop_cpu_start_ = 0;
  Summary summary_;
};

}  // namespace

int run_case(const Case& definition, const RunOptions& options) {
  check_folder(options);
  watch_for_interruption();
  return Run(definition, options).execute();
}

}  // namespace sluice
