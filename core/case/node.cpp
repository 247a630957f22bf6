#include "core/case/node.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace sluice {

std::string Place::text() const { return line == 0 ? file : fmt::format("{}:{}:{}", file, line, column); }

CaseError::CaseError(const Place& place, const std::string& message)
    : std::runtime_error(place.text().empty() ? message : place.text() + ": " + message) {}

Node Node::text(const std::string& scalar) {
  Node node;
  node.kind = Kind::scalar;
  node.scalar = scalar;
  return node;
}

Node Node::list(std::vector<Node> items) {
  Node node;
  node.kind = Kind::list;
  node.items = std::move(items);
  return node;
}

Node Node::map() {
  Node node;
  node.kind = Kind::map;
  return node;
}

void Node::erase(const std::string& key) {
  for (std::size_t i = keys.size(); i-- > 0;)
    if (keys[i].first == key) {
      keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(i));
      items.erase(items.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

void Node::set(const std::string& key, Node value) {
  if (Node* const found = find(key)) {
    *found = std::move(value);
    return;
  }
  keys.emplace_back(key, value.place);
  items.push_back(std::move(value));
}

const Node* Node::find(const std::string& key) const {
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i].first == key) return &items[i];
  return nullptr;
}

Node* Node::find(const std::string& key) { return const_cast<Node*>(static_cast<const Node*>(this)->find(key)); }

std::string description(const Node& node) {
  switch (node.kind) {
    case Node::Kind::absent:
      return "nothing";
    case Node::Kind::list:
      return fmt::format("a list of {}", node.items.size());
    case Node::Kind::map:
      return "a map";
    case Node::Kind::scalar:
      break;
  }
  return "'" + node.scalar + "'";
}

// ---- reading
// -----------------------------------------------------------------------------------------------------------

namespace {

/// Turns yaml-cpp's tree into ours. Aliases make a graph of it, which may hold cycles or be exponentially larger than
/// the text: both end in an error.
class TreeReader {
 public:
  explicit TreeReader(std::string file) : file_(std::move(file)) {}

  Node read(const YAML::Node& yaml, const Place& fallback) {
    Node node;
    node.place = place_of(yaml, fallback);
    if (++depth_ > 64) throw CaseError(node.place, "nested more than 64 deep; does an alias refer to itself?");
    if (++count_ > 2'000'000) throw CaseError(node.place, "more than 2 million values; do aliases multiply?");
    if (yaml.IsScalar()) {
      node.kind = Node::Kind::scalar;
      node.scalar = yaml.Scalar();
      node.quoted = yaml.Tag() == "!";
    } else if (yaml.IsSequence()) {
      node.kind = Node::Kind::list;
      for (const YAML::Node& item : yaml) node.items.push_back(read(item, node.place));
    } else if (yaml.IsMap()) {
      node.kind = Node::Kind::map;
      for (const auto& pair : yaml) read_pair(pair.first, pair.second, node);
    }
    --depth_;
    return node;
  }

 private:
  Place place_of(const YAML::Node& yaml, const Place& fallback) const {
    const YAML::Mark mark = yaml.Mark();
    return mark.is_null() ? fallback : Place{file_, mark.line + 1, mark.column + 1};
  }

  void read_pair(const YAML::Node& key, const YAML::Node& value, Node& map) {
    const Place place = place_of(key, map.place);
    if (!key.IsScalar()) throw CaseError(place, "a key must be a word");
    const std::string name = key.Scalar();
    for (const auto& [other, first] : map.keys)
      if (other == name)
        throw CaseError(place, fmt::format("the key '{}' occurs twice; the first is at {}", name, first.text()));
    map.keys.emplace_back(name, place);
    map.items.push_back(read(value, place));
    // yaml-cpp places what is not there on the line below.
    if (!map.items.back()) map.items.back().place = place;
  }

  std::string file_;
  int depth_ = 0, count_ = 0;
};

std::string missing_file_message(const std::filesystem::path& path) {
  std::string message = "no such file";
  std::vector<std::string> names;
  std::error_code error;
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".yaml" || entry.path().extension() == ".yml")
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  const std::string near = nearest_word(path.filename().string(), names);
  if (!near.empty()) message += "; did you mean '" + (path.parent_path() / near).string() + "'?";
  return message;
}

/// Counts the documents of a text. yaml-cpp's LoadAll makes documents of nothing for ever where one would begin with
/// what cannot begin one, such as a comma: here that is a syntax error.
class DocumentCounter : public YAML::EventHandler {
 public:
  explicit DocumentCounter(const std::string& text) {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(*this)) {
    }
  }
  std::size_t count() const { return count_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (count_ > 0 && mark.pos == start_.pos) throw YAML::ParserException(mark, "nothing can begin like this");
    start_ = mark;
    ++count_;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

 private:
  std::size_t count_ = 0;
  YAML::Mark start_;
};

}  // namespace

Node read_yaml_text(const std::string& text, const std::string& name) {
  try {
    const std::size_t documents = DocumentCounter(text).count();
    const Place start{name, 1, 1};
    if (documents == 0) {
      Node nothing;
      nothing.place = start;
      return nothing;
    }
    Node node = TreeReader(name).read(YAML::Load(text), start);
    if (documents > 1)
      throw CaseError(start,
                      fmt::format("the file holds {} YAML documents (separated by ---); it must hold one", documents));
    return node;
  } catch (const YAML::Exception& error) {
    const Place place =
        error.mark.is_null() ? Place{name, 0, 0} : Place{name, error.mark.line + 1, error.mark.column + 1};
    throw CaseError(place, "YAML syntax: " + error.msg);
  }
}

Node read_yaml_file(const std::string& file) {
  if (!std::filesystem::exists(file)) throw CaseError(Place{file, 0, 0}, missing_file_message(file));
  if (std::filesystem::is_directory(file)) throw CaseError(Place{file, 0, 0}, "is a folder, not a file");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  // An empty file sets failbit of the target, not of the source.
  if (!stream) throw CaseError(Place{file, 0, 0}, "the file cannot be read");
  return read_yaml_text(text.str(), file);
}

// ---- writing
// -----------------------------------------------------------------------------------------------------------

namespace {

bool is_plain(const std::string& text) {
  if (text.empty() || text.back() == ' ' || text == "null" || text == "Null" || text == "NULL") return false;
  const auto alphanumeric = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  const bool negative = text.size() > 1 && text[0] == '-' && (alphanumeric(text[1]) || text[1] == '.');
  if (!alphanumeric(text[0]) && !negative) return false;
  return std::all_of(text.begin(), text.end(),
                     [&](char c) { return alphanumeric(c) || std::string("_-./+% ^()").find(c) != std::string::npos; });
}

std::string scalar_text(const std::string& text, bool quoted) {
  if (!quoted && is_plain(text)) return text;
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      result += std::string("\\") + c;
    else if (c == '\n')
      result += "\\n";
    else if (static_cast<unsigned char>(c) < 0x20)
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      result += c;
  }
  return result + "\"";
}

std::string flow_text(const Node& node) {
  std::vector<std::string> parts;
  switch (node.kind) {
    case Node::Kind::absent:
      return "null";
    case Node::Kind::scalar:
      return scalar_text(node.scalar, node.quoted);
    case Node::Kind::list:
      for (const Node& item : node.items) parts.push_back(flow_text(item));
      return fmt::format("[{}]", fmt::join(parts, ", "));
    case Node::Kind::map:
      for (std::size_t i = 0; i < node.items.size(); ++i)
        parts.push_back(scalar_text(node.keys[i].first, false) + ": " + flow_text(node.items[i]));
      return fmt::format("{{{}}}", fmt::join(parts, ", "));
  }
  return "";
}

bool holds_map(const Node& node) {
  return std::any_of(node.items.begin(), node.items.end(),
                     [](const Node& item) { return item.kind == Node::Kind::map || holds_map(item); });
}

/// One line for what is short and flat; `first` is the column where it would begin.
bool on_one_line(const Node& node, std::size_t first) {
  if (node.items.empty()) return true;
  if (node.kind == Node::Kind::map && holds_map(node)) return false;
  return first + flow_text(node).size() <= 110;
}

std::string block_text(const Node& node, int indent) {
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  std::string text;
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const bool is_list = node.kind == Node::Kind::list;
    const std::string head = margin + (is_list ? "-" : scalar_text(node.keys[i].first, false) + ":");
    const Node& item = node.items[i];
    if (on_one_line(item, head.size() + 1)) {
      text += head + " " + flow_text(item) + "\n";
    } else if (is_list) {
      // The first line of the item follows its dash.
      text += head + " " + block_text(item, indent + 2).substr(static_cast<std::size_t>(indent) + 2);
    } else {
      text += head + "\n" + block_text(item, indent + 2);
    }
  }
  return text;
}

}  // namespace

std::string yaml_text(const Node& node, int indent) {
  if (node.items.empty()) return std::string(static_cast<std::size_t>(indent), ' ') + flow_text(node) + "\n";
  return block_text(node, indent);
}

// ---- near words
// --------------------------------------------------------------------------------------------------------

namespace {

/// Letters in lower case; hyphens and blanks as underscores: what people mix up without noticing.
std::string folded(const std::string& word) {
  std::string result;
  for (const char c : word)
    result += c == '-' || c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// Insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b` (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& allowed) {
  const std::string target = folded(word);
  std::string nearest;
  std::size_t least = std::string::npos;
  if (target.size() > 100) return nearest;
  for (const std::string& candidate : allowed) {
    const std::size_t distance = edit_distance(target, folded(candidate));
    const std::size_t longer = std::max(target.size(), candidate.size());
    const bool near = distance == 0 || (distance <= std::max<std::size_t>(1, longer / 3) && distance < target.size());
    if (near && distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  if (!nearest.empty() || target.size() < 4) return nearest;
  // `poisson` for `poisson_ratio`
  for (const std::string& candidate : allowed)
    if (folded(candidate).find(target) != std::string::npos) return candidate;
  return nearest;
}

std::string allowed_words(const std::string& word, const std::vector<std::string>& allowed) {
  const std::string near = nearest_word(word, allowed);
  return fmt::format("allowed: {}{}", allowed.empty() ? "none" : fmt::format("{}", fmt::join(allowed, ", ")),
                     near.empty() ? "" : "; did you mean '" + near + "'?");
}

}  // namespace sluice
