/// Columns: named arrays of doubles, one value (or vector component) per material point.
///
/// A column is declared once, with name, unit, number of components, role and a sentence. That list drives
/// allocation, sorting, checkpoints, output and the manual: no field can be forgotten.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sluice {

/// Column storage is aligned to this many bytes, and padded by as many doubles beyond its end, so that vector loops
/// may read past the last particle.
inline constexpr std::size_t column_alignment = 64;

enum class Role {
  state,   ///< needed to continue a run: sorted, checkpointed and, unless hidden, written to results
  derived  ///< recomputed within a step: allocated, not sorted, not checkpointed
};

struct ColumnSpec {
  std::string name;    ///< snake case, for example "equivalent_plastic_strain"
  std::string unit;    ///< SI, for example "Pa"; "1" for pure numbers
  int components = 1;  ///< stored apart: component k of all particles is contiguous
  Role role = Role::state;
  std::string sentence;  ///< what it is, with its sign convention
  bool output = true;    ///< written to results.h5
};

/// Identifies a declared column; valid for the Columns that returned it.
struct ColumnId {
  int index = -1;
};

class Columns {
 public:
  /// Declares a column, or finds the one already declared under this name with an equal specification.
  /// To be called before `resize`.
  ColumnId declare(const ColumnSpec& spec);

  /// Sets the number of particles; new values are zero, existing ones are kept.
  void resize(std::size_t size);
  std::size_t size() const { return size_; }

  double* data(ColumnId id, int component = 0) {
    return arrays_[static_cast<std::size_t>(id.index)][static_cast<std::size_t>(component)].get();
  }
  const double* data(ColumnId id, int component = 0) const {
    return arrays_[static_cast<std::size_t>(id.index)][static_cast<std::size_t>(component)].get();
  }
  /// All components of a column that has N of them.
  template <std::size_t N>
  std::array<const double*, N> pointers(ColumnId id) const {
    std::array<const double*, N> all;
    for (std::size_t c = 0; c < N; ++c) all[c] = data(id, static_cast<int>(c));
    return all;
  }
  std::span<double> values(ColumnId id, int component = 0) { return {data(id, component), size_}; }
  std::span<const double> values(ColumnId id, int component = 0) const { return {data(id, component), size_}; }

  const std::vector<ColumnSpec>& specs() const { return specs_; }
  const ColumnSpec& spec(ColumnId id) const { return specs_[static_cast<std::size_t>(id.index)]; }
  /// Throws std::out_of_range if no column has this name.
  ColumnId find(const std::string& name) const;
  bool contains(const std::string& name) const;

  /// Reorders every state column: new[i] = old[order[i]]. `order` may be shorter than `size()`: the particles that it
  /// does not name are dropped.
  void permute(std::span<const std::uint32_t> order);

  /// Bytes held by all columns.
  std::size_t memory() const;

 private:
  struct Free {
    Free() : Free(0) {}
    explicit Free(std::size_t doubles) : offset(doubles) {}
    void operator()(double* p) const;
    std::size_t offset;  ///< doubles from the beginning of the allocation
  };
  using Array = std::unique_ptr<double[], Free>;
  static Array allocate(std::size_t count);

  std::vector<ColumnSpec> specs_;
  std::vector<std::vector<Array>> arrays_;  // [column][component]
  Array spare_;                             // target of permutations, swapped with each column in turn
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace sluice
