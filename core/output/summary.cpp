#include "core/output/summary.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "core/output/file_aside.h"

namespace sluice {

void write_summary(const std::filesystem::path& path, const Summary& summary) {
  nlohmann::ordered_json json;
  json["exit_reason"] = summary.exit_reason;
  json["time"] = summary.time;
  json["steps"] = summary.steps;
  json["particles"] = summary.particles;
  json["threads"] = summary.threads;
  json["wall_seconds"] = summary.wall_seconds;
  json["particle_steps_per_second"] = summary.particle_steps_per_second;
  json["stage_seconds"] = summary.stage_seconds;
  json["observations"] = summary.observations;
  for (const auto& [name, value] : summary.extra) json[name] = value;
  for (const auto& [name, value] : summary.verdict) {
    double number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error == std::errc() && end == value.data() + value.size())
      json["advice"][name] = number;
    else
      json["advice"][name] = value;
  }
  json["version"] = summary.version;
  const auto invalid_utf8 = nlohmann::ordered_json::error_handler_t::replace;
  replace_text_file(path, json.dump(2, ' ', false, invalid_utf8) + '\n');
}

}  // namespace sluice
