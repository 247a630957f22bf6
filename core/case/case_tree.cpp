#include "core/case/case_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>

namespace sluice {

namespace {

std::string beside(const std::string& file, const std::string& name) {
  return (std::filesystem::path(file).parent_path() / name).string();
}

void merge_into(Node& base, Node&& over) {
  if (base.kind != Node::Kind::map || over.kind != Node::Kind::map) {
    base = std::move(over);
    return;
  }
  base.place = over.place;
  for (std::size_t i = 0; i < over.items.size(); ++i) {
    if (Node* const found = base.find(over.keys[i].first)) {
      const auto at = static_cast<std::size_t>(found - base.items.data());
      base.keys[at].second = over.keys[i].second;
      merge_into(*found, std::move(over.items[i]));
    } else {
      base.keys.push_back(over.keys[i]);
      base.items.push_back(std::move(over.items[i]));
    }
  }
}

void erase(Node& map, const std::string& key) {
  const auto at = map.find(key) - map.items.data();
  map.keys.erase(map.keys.begin() + at);
  map.items.erase(map.items.begin() + at);
}

/// `chain` holds the files that lead here, against files that extend each other.
Node extended_along(Node tree, std::vector<std::string> chain) {
  const Node* const entry = tree.find("extends");
  if (entry == nullptr) return tree;
  const Node name = *entry;
  if (name.kind != Node::Kind::scalar || name.scalar.empty())
    throw CaseError(name.place, fmt::format("extends: found {}; expected the name of a YAML file", description(name)));
  const std::string file = std::filesystem::path(beside(chain.back(), name.scalar)).lexically_normal().string();
  if (std::find(chain.begin(), chain.end(), file) != chain.end())
    throw CaseError(name.place, fmt::format("extends: '{}' leads back to itself", name.scalar));
  if (!std::filesystem::is_regular_file(file))
    throw CaseError(name.place, fmt::format("extends: there is no file '{}'", file));
  erase(tree, "extends");
  chain.push_back(file);
  Node base = extended_along(read_yaml_file(file), std::move(chain));
  merge_into(base, std::move(tree));
  return base;
}

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

void set_places(Node& node, const Place& place) {
  node.place = place;
  for (auto& [key, where] : node.keys) where = place;
  for (Node& item : node.items) set_places(item, place);
}

/// What looks like a list, a map or a quoted text is read as YAML; anything else is taken as it is, colons and all.
Node value_of(const Override& setting, const Place& place) {
  const std::size_t first = setting.value.find_first_not_of(' ');
  Node node;
  if (first == std::string::npos) {
    node.place = place;
    return node;
  }
  if (std::string("[{\"'").find(setting.value[first]) != std::string::npos)
    node = read_yaml_text(setting.value, place.file);
  else
    node = Node::text(setting.value.substr(first, setting.value.find_last_not_of(' ') + 1 - first));
  set_places(node, place);
  return node;
}

Node& item_of(Node& list, const std::string& part, const std::string& path, const Place& place) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error != std::errc() || end != part.data() + part.size() || index >= list.items.size())
    throw CaseError(place, fmt::format("'{}' is a list of {}; '{}' must be a number from 0 to {}", path,
                                       list.items.size(), part, static_cast<long>(list.items.size()) - 1));
  return list.items[index];
}

Node& child_of(Node& parent, const std::string& part, const std::string& path, const Place& place) {
  if (part.empty()) throw CaseError(place, "a part of the path is empty; expected KEY.KEY=VALUE");
  if (parent.kind == Node::Kind::list) return item_of(parent, part, path, place);
  if (parent.kind == Node::Kind::scalar)
    throw CaseError(place, fmt::format("'{}' is the value '{}' and has no key '{}'", path, parent.scalar, part));
  if (parent.kind == Node::Kind::absent) {
    parent = Node::map();
    parent.place = place;
  }
  if (parent.find(part) == nullptr) {
    Node fresh;
    fresh.place = place;
    parent.set(part, fresh);
  }
  return *parent.find(part);
}

void apply(const Override& setting, Node& tree) {
  const Place place{"--set " + setting.key, 0, 0};
  const Node value = value_of(setting, place);
  Node* node = &tree;
  std::string path;
  for (const std::string& part : split(setting.key)) {
    node = &child_of(*node, part, path, place);
    path += (path.empty() ? "" : ".") + part;
  }
  *node = value;
}

/// Files that a case names. Those that polygons come from are read once.
class NamedFiles {
 public:
  NamedFiles(std::string case_file, Problems& problems) : case_file_(std::move(case_file)), problems_(problems) {}

  /// In a region, and in the regions that it is made of.
  void resolve(Node* shapes) {
    if (shapes == nullptr) return;
    resolve_polygon(shapes);
    for (const char* const raster : {"below_raster", "above_raster"}) complete(shapes, raster);
    for (const char* const combination : {"union", "intersection", "difference"})
      if (Node* const regions = shapes->find(combination))
        for (Node& region : regions->items) resolve(&region);
  }

  /// The whole name of a file that must exist, so that the resolved case finds it from any folder.
  void complete(Node* section, const std::string& key) {
    Node* const name = section == nullptr ? nullptr : section->find(key);
    if (name == nullptr || name->kind != Node::Kind::scalar || name->scalar.empty()) return;
    const std::string file = path_of(*name, name->scalar);
    if (std::filesystem::is_regular_file(file)) {
      name->scalar = std::filesystem::absolute(file).lexically_normal().string();
      return;
    }
    problems_.add(name->place, fmt::format("{}: there is no file '{}'", key, file));
    erase(*section, key);
  }

 private:
  void resolve_polygon(Node* shapes) {
    Node* const polygon = shapes->find("polygon");
    if (polygon == nullptr || polygon->kind != Node::Kind::scalar) return;
    try {
      *polygon = find(*polygon);
    } catch (const CaseError& error) {
      problems_.add(polygon->place, error);
      // What is wrong is said: nothing is left that could be said again.
      erase(*shapes, "polygon");
    }
  }

  std::string path_of(const Node& reference, const std::string& name) const {
    return beside(reference.place.line == 0 ? case_file_ : reference.place.file, name);
  }

  Node find(const Node& reference) {
    const auto hash = reference.scalar.find('#');
    if (hash == std::string::npos || hash == 0 || hash + 1 == reference.scalar.size())
      throw CaseError(reference.place, fmt::format("polygon: found '{}'; expected points [[x, y], …] or FILE.yaml#NAME",
                                                   reference.scalar));
    const std::string name = reference.scalar.substr(hash + 1);
    const Node& file = read(reference, reference.scalar.substr(0, hash));
    const Node* const found = file.find(name);
    if (found == nullptr) {
      std::vector<std::string> names;
      for (const auto& [key, place] : file.keys) names.push_back(key);
      throw CaseError(reference.place, fmt::format("polygon: '{}' has no '{}'; {}", reference.scalar.substr(0, hash),
                                                   name, allowed_words(name, names)));
    }
    const Node* const inner = found->find("polygon");
    return inner != nullptr ? *inner : *found;
  }

  const Node& read(const Node& reference, const std::string& name) {
    const std::string file = path_of(reference, name);
    const auto known = files_.find(file);
    if (known != files_.end()) return known->second;
    if (!std::filesystem::is_regular_file(file))
      throw CaseError(reference.place, fmt::format("polygon: there is no file '{}'", file));
    return files_[file] = read_yaml_file(file);
  }

  std::string case_file_;
  Problems& problems_;
  std::map<std::string, Node> files_;
};

}  // namespace

void check_schema_version(const Node& version, Problems& problems) {
  if (version.kind != Node::Kind::scalar || version.scalar != "1")
    problems.add(version.place, fmt::format("schema: found {}; this version of the program knows schema 1 only",
                                            description(version)));
}

Node extended(Node tree, const std::string& file) {
  return extended_along(std::move(tree), {std::filesystem::path(file).lexically_normal().string()});
}

std::vector<Override> overrides_of(const std::vector<std::string>& settings) {
  std::vector<Override> overrides;
  for (const std::string& text : settings) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw CaseError(fmt::format("--set {}: expected KEY=VALUE, for example --set end_time=\"10 s\"", text));
    overrides.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return overrides;
}

void apply_overrides(const std::vector<Override>& overrides, Node& tree, Problems& problems) {
  for (const Override& setting : overrides) {
    try {
      apply(setting, tree);
    } catch (const CaseError& error) {
      problems.add({"--set " + setting.key, 0, 0}, error);
    }
  }
}

void resolve_files(Node& tree, const std::string& case_file, Problems& problems) {
  NamedFiles files(case_file, problems);
  if (Node* const bodies = tree.find("bodies"))
    for (Node& body : bodies->items) files.resolve(&body);
  if (Node* const observe = tree.find("observe"))
    for (Node& observation : observe->items) files.resolve(observation.find("region"));
  if (Node* const obstacles = tree.find("obstacles"))
    for (Node& obstacle : obstacles->items) files.resolve(&obstacle);
  if (Node* const loads = tree.find("surface_loads"))
    for (Node& load : loads->items) files.resolve(load.find("region"));
  files.complete(tree.find("initial_stress"), "file");
  Node* const water = tree.find("water");
  if (Node* const ponds = water != nullptr ? water->find("ponds") : nullptr)
    for (Node& pond : ponds->items) files.resolve(pond.find("region"));
}

}  // namespace sluice
