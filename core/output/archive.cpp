#include "core/output/archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/output/file_aside.h"
#include "core/output/hdf5_file.h"

namespace sluice {

namespace {

constexpr std::int64_t archive_version = 1;
constexpr const char* sequence_name = "checkpoint.sequence";
constexpr const char* step_name = "checkpoint.step";
constexpr const char* time_name = "checkpoint.time";
constexpr const char* particles_prefix = "particles.";

/// FNV-1a over 64-bit words, with a rotation so that high bits reach low ones. Any single changed word changes the sum.
class Checksum {
 public:
  void add(const void* data, std::size_t bytes) {
    add_word(bytes);
    const auto* from = static_cast<const unsigned char*>(data);
    for (; bytes >= sizeof(std::uint64_t); bytes -= sizeof(std::uint64_t), from += sizeof(std::uint64_t)) {
      std::uint64_t word;
      std::memcpy(&word, from, sizeof word);
      add_word(word);
    }
    std::uint64_t rest = 0;
    if (bytes > 0) std::memcpy(&rest, from, bytes);
    add_word(rest);
  }
  void add(const std::string& text) { add(text.data(), text.size()); }
  std::uint64_t value() const { return sum_; }

 private:
  void add_word(std::uint64_t word) { sum_ = std::rotl((sum_ ^ word) * 0x100000001b3ULL, 29); }
  std::uint64_t sum_ = 0xcbf29ce484222325ULL;
};

template <class T>
void save_group(Hdf5File& file, const std::string& group, const std::map<std::string, std::vector<T>>& entries) {
  file.create_group(group);
  for (const auto& [name, values] : entries) {
    if (name.empty() || name.find('/') != std::string::npos)
      throw std::invalid_argument("'" + name + "' cannot name an entry of an archive");
    file.write(group + "/" + name, values);
  }
}

template <class T>
void load_group(const Hdf5File& file, const std::string& group, std::map<std::string, std::vector<T>>& entries) {
  for (const auto& name : file.members(group)) entries[name] = file.read<T>(group + "/" + name);
}

Archive load_checked(const Hdf5File& file) {
  const auto version = file.integer_attribute("/", "sluice_archive_version").at(0);
  if (version != archive_version)
    throw std::runtime_error(
        fmt::format("{}: has format version {}; this program reads version {}", file.name(), version, archive_version));
  Archive archive;
  load_group(file, "reals", archive.reals);
  load_group(file, "integers", archive.integers);
  std::map<std::string, std::vector<std::uint8_t>> texts;
  load_group(file, "texts", texts);
  for (const auto& [name, bytes] : texts) archive.texts[name] = {bytes.begin(), bytes.end()};
  const auto stored = std::bit_cast<std::uint64_t>(file.integer_attribute("/", "checksum").at(0));
  if (stored != checksum(archive))
    throw std::runtime_error(file.name() + ": is damaged: its contents do not agree with their checksum");
  return archive;
}

std::string column_key(const ColumnSpec& spec, int component) {
  return fmt::format("{}column.{}.{}", particles_prefix, spec.name, component);
}

/// Number of components of each column that the archive holds.
std::map<std::string, int> stored_columns(const Archive& archive) {
  const std::string prefix = std::string(particles_prefix) + "column.";
  std::map<std::string, int> columns;
  for (auto entry = archive.reals.lower_bound(prefix); entry != archive.reals.end(); ++entry) {
    if (entry->first.compare(0, prefix.size(), prefix) != 0) break;
    ++columns[entry->first.substr(prefix.size(), entry->first.rfind('.') - prefix.size())];
  }
  return columns;
}

void require_same_columns(std::map<std::string, int> stored, const Particles& particles) {
  for (const auto& spec : particles.columns.specs()) {
    if (spec.role != Role::state) continue;
    const auto found = stored.find(spec.name);
    if (found == stored.end()) throw std::runtime_error("the checkpoint has no column '" + spec.name + "'");
    if (found->second != spec.components)
      throw std::runtime_error(fmt::format("column '{}' has {} components in the checkpoint and {} in this case",
                                           spec.name, found->second, spec.components));
    stored.erase(found);
  }
  if (!stored.empty())
    throw std::runtime_error("the checkpoint has a column '" + stored.begin()->first + "' that this case has not");
}

template <class Map>
const typename Map::mapped_type& entry(const Map& entries, const std::string& name) {
  const auto found = entries.find(name);
  if (found == entries.end()) throw std::runtime_error("the checkpoint has no entry '" + name + "'");
  return found->second;
}

std::vector<std::int32_t> narrowed(const std::vector<std::int64_t>& values) {
  std::vector<std::int32_t> result(values.size());
  std::transform(values.begin(), values.end(), result.begin(), [](auto v) { return static_cast<std::int32_t>(v); });
  return result;
}

/// Sequence number of a checkpoint; nothing if it cannot be read.
std::optional<std::int64_t> stored_sequence(const std::filesystem::path& path) {
  try {
    return Hdf5File(path, Hdf5File::Mode::read).read<std::int64_t>(std::string("integers/") + sequence_name).at(0);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace

std::uint64_t checksum(const Archive& archive) {
  Checksum sum;
  const auto add_numbers = [&](const auto& entries) {
    for (const auto& [name, values] : entries) {
      sum.add(name);
      sum.add(values.data(), values.size() * sizeof values[0]);
    }
  };
  add_numbers(archive.reals);
  add_numbers(archive.integers);
  for (const auto& [name, text] : archive.texts) {
    sum.add(name);
    sum.add(text);
  }
  return sum.value();
}

void save_archive(const std::filesystem::path& path, const Archive& archive) {
  FileAside aside(path);
  Hdf5File file(aside.path(), Hdf5File::Mode::create);
  file.set_attribute("/", "sluice_archive_version", archive_version);
  file.set_attribute("/", "checksum", std::bit_cast<std::int64_t>(checksum(archive)));
  save_group(file, "reals", archive.reals);
  save_group(file, "integers", archive.integers);
  std::map<std::string, std::vector<std::uint8_t>> texts;
  for (const auto& [name, text] : archive.texts) texts[name].assign(text.begin(), text.end());
  save_group(file, "texts", texts);
  file.close();
  aside.commit(FileAside::Durability::power);
}

Archive load_archive(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw std::runtime_error(path.string() + ": does not exist");
  try {
    return load_checked(Hdf5File(path, Hdf5File::Mode::read));
  } catch (const std::length_error&) {
    throw std::runtime_error(path.string() + ": is damaged: an entry has an impossible size");
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(path.string() + ": is damaged, or needs more memory than there is");
  }
}

void store_particles(const Particles& particles, Archive& archive) {
  const std::string prefix = particles_prefix;
  archive.integers[prefix + "id"].assign(particles.id.begin(), particles.id.end());
  archive.integers[prefix + "material"].assign(particles.material.begin(), particles.material.end());
  archive.integers[prefix + "material_count"] = {static_cast<std::int64_t>(particles.material_names.size())};
  for (std::size_t i = 0; i < particles.material_names.size(); ++i)
    archive.texts[fmt::format("{}material_name.{}", prefix, i)] = particles.material_names[i];
  const auto& specs = particles.columns.specs();
  for (std::size_t c = 0; c < specs.size(); ++c) {
    if (specs[c].role != Role::state) continue;
    for (int k = 0; k < specs[c].components; ++k) {
      const auto values = particles.columns.values({static_cast<int>(c)}, k);
      archive.reals[column_key(specs[c], k)].assign(values.begin(), values.end());
    }
  }
}

void restore_particles(const Archive& archive, Particles& particles) {
  const std::string prefix = particles_prefix;
  require_same_columns(stored_columns(archive), particles);
  const auto id = narrowed(entry(archive.integers, prefix + "id"));
  particles.resize(id.size());
  particles.id = id;
  particles.material = narrowed(entry(archive.integers, prefix + "material"));
  if (particles.material.size() != id.size())
    throw std::runtime_error(
        fmt::format("the checkpoint has {} ids but {} materials", id.size(), particles.material.size()));
  particles.material_names.resize(static_cast<std::size_t>(entry(archive.integers, prefix + "material_count").at(0)));
  for (std::size_t i = 0; i < particles.material_names.size(); ++i)
    particles.material_names[i] = entry(archive.texts, fmt::format("{}material_name.{}", prefix, i));
  const auto& specs = particles.columns.specs();
  for (std::size_t c = 0; c < specs.size(); ++c) {
    if (specs[c].role != Role::state) continue;
    for (int k = 0; k < specs[c].components; ++k) {
      const auto& values = entry(archive.reals, column_key(specs[c], k));
      if (values.size() != id.size())
        throw std::runtime_error(fmt::format("column '{}' has {} values in the checkpoint for {} particles",
                                             specs[c].name, values.size(), id.size()));
      std::copy(values.begin(), values.end(), particles.columns.data({static_cast<int>(c)}, k));
    }
  }
}

CheckpointStore::CheckpointStore(std::filesystem::path folder) : folder_(std::move(folder)) {
  const auto first = stored_sequence(file(0)), second = stored_sequence(file(1));
  sequence_ = std::max(first.value_or(0), second.value_or(0));
  next_slot_ = first.value_or(0) <= second.value_or(0) ? 0 : 1;
}

std::filesystem::path CheckpointStore::file(int slot) const { return folder_ / fmt::format("checkpoint_{}.h5", slot); }

void CheckpointStore::save(Archive archive, double time, std::int64_t step) {
  archive.integers[sequence_name] = {sequence_ + 1};
  archive.integers[step_name] = {step};
  archive.reals[time_name] = {time};
  save_archive(file(next_slot_), archive);
  ++sequence_;
  next_slot_ = 1 - next_slot_;
}

Checkpoint CheckpointStore::load_latest() {
  // A file without a legible number may be the newest: it comes first, and leaves its warning.
  constexpr auto unknown = std::numeric_limits<std::int64_t>::max();
  const bool second_is_newer = stored_sequence(file(1)).value_or(unknown) > stored_sequence(file(0)).value_or(unknown);
  std::vector<std::string> warnings;
  for (const int slot : {second_is_newer ? 1 : 0, second_is_newer ? 0 : 1}) {
    if (!std::filesystem::exists(file(slot))) continue;
    try {
      Checkpoint found;
      found.archive = load_archive(file(slot));
      found.time = entry(found.archive.reals, time_name).at(0);
      found.step = entry(found.archive.integers, step_name).at(0);
      found.file = file(slot);
      found.warnings = warnings;
      next_slot_ = 1 - slot;
      return found;
    } catch (const std::runtime_error& error) {
      warnings.push_back(error.what());
    }
  }
  std::string message = "no usable checkpoint in " + folder_.string();
  for (const auto& warning : warnings) message += "\n  " + warning;
  throw std::runtime_error(message);
}

bool CheckpointStore::any() const { return std::filesystem::exists(file(0)) || std::filesystem::exists(file(1)); }

void CheckpointStore::clear() {
  for (const int slot : {0, 1}) std::filesystem::remove(file(slot));
  sequence_ = 0;
  next_slot_ = 0;
}

}  // namespace sluice
