/// Node: the tree of a case file, each part of which knows where it was written.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sluice {

/// Where something stands: file (or "--set key"), line and column from 1; line 0 if it stands nowhere.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
  std::string text() const;  ///< "dam.yaml:12:5", or the file alone when the line is 0
};

/// What the user did wrong: what, where, what is allowed. `what()` may hold several messages, one a line.
class CaseError : public std::runtime_error {
 public:
  CaseError(const Place& place, const std::string& message);
  explicit CaseError(const std::string& messages) : std::runtime_error(messages) {}
};

struct Node {
  enum class Kind { absent, scalar, list, map };
  Kind kind = Kind::absent;
  Place place;
  std::string scalar;
  bool quoted = false;                              ///< the scalar was written in quotes
  std::vector<Node> items;                          ///< list items or map values
  std::vector<std::pair<std::string, Place>> keys;  ///< map keys, parallel to items

  static Node text(const std::string& scalar);
  static Node list(std::vector<Node> items = {});
  static Node map();
  void set(const std::string& key, Node value);  ///< adds or replaces a value of a map
  void erase(const std::string& key);            ///< takes a value out of a map, if it is there

  explicit operator bool() const { return kind != Kind::absent; }
  const Node* find(const std::string& key) const;  ///< nullptr if this is no map or has no such key
  Node* find(const std::string& key);
};

/// Reads YAML. Throws CaseError where the file is missing or the syntax is broken, and on duplicate keys.
Node read_yaml_file(const std::string& file);
Node read_yaml_text(const std::string& text, const std::string& name);

/// The tree as YAML that reads back as the same tree; `indent` is that of the lines.
std::string yaml_text(const Node& node, int indent = 0);

/// "a list", "a map", "nothing", or the scalar in quotes: for messages.
std::string description(const Node& node);

/// The word of `allowed` nearest to `word` in edit distance, or "" if none is near.
std::string nearest_word(const std::string& word, const std::vector<std::string>& allowed);

/// "allowed: a, b, c; did you mean 'b'?": the end of a message about an unknown word.
std::string allowed_words(const std::string& word, const std::vector<std::string>& allowed);

}  // namespace sluice
