#include "core/chart/ledger.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <thread>

#include "core/output/csv_table.h"
#include "core/output/file_aside.h"

namespace sluice::chart {

namespace {

constexpr const char* header =
    "identity,variant,repetition,version,error,failure,message,cpu_s,process_cpu_s,peak_memory_bytes,steps,particles,"
    "particle_steps,"
    "factorizations,iterations\n";
constexpr std::size_t columns = 15;

/// On one line, for rows are lines.
std::string cell(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return csv_text(text);
}

std::string row_of(const Entry& e) {
  const RunReport& r = e.report;
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", e.identity, cell(e.variant), e.repetition,
                     cell(e.version), e.error, cell(r.failure), cell(r.message), r.cpu_seconds, r.process_cpu,
                     r.peak_memory, r.steps, r.particles, r.particle_steps, r.factorizations, r.iterations);
}

Entry entry_of(const std::vector<std::string>& cells) {
  const auto number = [&](std::size_t i) { return std::strtod(cells[i].c_str(), nullptr); };
  Entry e;
  e.identity = cells[0];
  e.variant = cells[1];
  e.repetition = static_cast<int>(number(2));
  e.version = cells[3];
  e.error = number(4);
  e.report.failure = cells[5];
  e.report.message = cells[6];
  e.report.cpu_seconds = number(7);
  e.report.process_cpu = number(8);
  e.report.peak_memory = number(9);
  e.report.steps = number(10);
  e.report.particles = number(11);
  e.report.particle_steps = number(12);
  e.report.factorizations = number(13);
  e.report.iterations = number(14);
  return e;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY)) {
  using namespace std::chrono_literals;
  const auto patience = std::chrono::steady_clock::now() + 3s;
  while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    if (std::chrono::steady_clock::now() > patience) {
      close(descriptor_);
      throw std::runtime_error(
          fmt::format("another study works in {}; wait until it ends, or take another --output", folder.string()));
    }
    std::this_thread::sleep_for(2ms);
  }
}

FolderLock::~FolderLock() { close(descriptor_); }

Ledger::Ledger(std::filesystem::path file, bool start_anew) : file_(std::move(file)), lock_(file_.parent_path()) {
  if (!start_anew && std::filesystem::exists(file_)) read();
  std::string text = header;
  for (const Entry& entry : entries_) text += row_of(entry);
  replace_text_file(file_, text);
  out_.open(file_, std::ios::app);
  if (!out_) throw std::runtime_error(fmt::format("{} cannot be written", file_.string()));
}

void Ledger::read() {
  std::ifstream in(file_);
  std::stringstream all;
  all << in.rdbuf();
  std::string text = all.str();
  if (!text.starts_with(header))
    throw std::runtime_error(
        fmt::format("{} is no table of runs of this version; `--force` begins anew", file_.string()));
  text.erase(0, std::string(header).size());
  for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
    const auto cells = csv_cells(text.substr(0, end));
    if (cells.size() == columns) entries_.push_back(entry_of(cells));
  }
}

void Ledger::append(const Entry& entry) {
  out_ << row_of(entry) << std::flush;
  if (!out_) throw std::runtime_error(fmt::format("{} cannot be written", file_.string()));
  entries_.push_back(entry);
}

const Entry* Ledger::find(const std::string& identity, int repetition) const {
  const auto found = std::ranges::find_if(
      entries_, [&](const Entry& e) { return e.identity == identity && e.repetition == repetition; });
  return found == entries_.end() ? nullptr : &*found;
}

}  // namespace sluice::chart
