/// Registries: the places where materials, physics modules, shape functions … make themselves known by name.
///
/// Whatever registers itself is found by case files, listed by `sluice list` and documented by `sluice schema`, with no
/// edit elsewhere. Registration happens before main, in the file of the thing that is registered.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/case/node.h"

namespace sluice {

/// The part of a registry that needs no knowledge of what it makes.
class Catalogue {
 public:
  struct Entry {
    std::string summary;                                 ///< one sentence
    std::function<std::vector<struct FieldDoc>()> keys;  ///< the keys of its section in a case file; may be empty
  };
  Catalogue(std::string kind, std::string plural);
  ~Catalogue();
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;

  const std::string& kind() const { return kind_; }      ///< "material"
  const std::string& plural() const { return plural_; }  ///< "materials", the word for `sluice list`
  const std::map<std::string, Entry>& entries() const { return entries_; }
  std::vector<std::string> names() const;
  /// Throws CaseError at `where`, with the nearest valid word, if `name` is not registered.
  void require(const std::string& name, const Place& where) const;

  /// All catalogues of the program, by plural name; those without one are left out.
  static std::map<std::string, Catalogue*>& all();

 protected:
  std::map<std::string, Entry> entries_;

 private:
  std::string kind_, plural_;
};

/// `Factory` is whatever makes the product, usually std::function<std::unique_ptr<X>(...)>.
template <class Factory>
class Registry : public Catalogue {
 public:
  using Catalogue::Catalogue;

  bool add(const std::string& name, Entry entry, Factory factory) {
    entries_[name] = std::move(entry);
    factories_[name] = std::move(factory);
    return true;
  }
  const Factory& find(const std::string& name, const Place& where) const {
    require(name, where);
    return factories_.at(name);
  }

 private:
  std::map<std::string, Factory> factories_;
};

}  // namespace sluice
