#include "core/particles/columns.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>

namespace sluice {

namespace {
constexpr std::size_t padding = column_alignment;  // doubles beyond the end that vector loops may touch
}

void Columns::Free::operator()(double* p) const { std::free(p - offset); }

/// Large allocations begin on pages. A loop over twenty columns would then find particle p of all of them in the same
/// set of the cache, which holds fewer: the columns begin a few cache lines apart.
Columns::Array Columns::allocate(std::size_t count) {
  constexpr std::size_t line = column_alignment / sizeof(double), lines_in_page = 64;
  static std::size_t allocations = 0;
  const std::size_t offset = (allocations++ * 5 % lines_in_page) * line;
  const std::size_t bytes = (offset + count + padding) * sizeof(double);
  const std::size_t rounded = (bytes + column_alignment - 1) / column_alignment * column_alignment;
  auto* p = static_cast<double*>(std::aligned_alloc(column_alignment, rounded));
  if (p == nullptr) throw std::bad_alloc();
  std::memset(p, 0, rounded);
  return Array(p + offset, Free(offset));
}

ColumnId Columns::declare(const ColumnSpec& spec) {
  assert(spec.components >= 1);
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    if (specs_[i].name != spec.name) continue;
    if (specs_[i].components != spec.components || specs_[i].unit != spec.unit || specs_[i].role != spec.role)
      throw std::logic_error("column '" + spec.name + "' is declared twice, with different specifications");
    return {static_cast<int>(i)};
  }
  specs_.push_back(spec);
  auto& column = arrays_.emplace_back();
  for (int k = 0; k < spec.components; ++k) column.push_back(allocate(capacity_));
  return {static_cast<int>(specs_.size()) - 1};
}

void Columns::resize(std::size_t size) {
  if (size > capacity_) {
    for (auto& column : arrays_)
      for (auto& array : column) {
        Array larger = allocate(size);
        std::copy_n(array.get(), size_, larger.get());
        array = std::move(larger);
      }
    spare_.reset();
    capacity_ = size;
  }
  for (auto& column : arrays_)
    for (auto& array : column)
      if (size > size_) std::fill(array.get() + size_, array.get() + size, 0.0);
  size_ = size;
}

ColumnId Columns::find(const std::string& name) const {
  for (std::size_t i = 0; i < specs_.size(); ++i)
    if (specs_[i].name == name) return {static_cast<int>(i)};
  throw std::out_of_range("no column is called '" + name + "'");
}

bool Columns::contains(const std::string& name) const {
  return std::any_of(specs_.begin(), specs_.end(), [&](const ColumnSpec& s) { return s.name == name; });
}

void Columns::permute(std::span<const std::uint32_t> order) {
  assert(order.size() <= size_);
  if (!spare_) spare_ = allocate(capacity_);
  for (std::size_t c = 0; c < specs_.size(); ++c) {
    if (specs_[c].role != Role::state) continue;
    for (auto& array : arrays_[c]) {
      const double* from = array.get();
      double* to = spare_.get();
      for (std::size_t i = 0; i < order.size(); ++i) to[i] = from[order[i]];
      array.swap(spare_);
    }
  }
  size_ = order.size();
}

std::size_t Columns::memory() const {
  std::size_t arrays = spare_ ? 1 : 0;
  for (const auto& column : arrays_) arrays += column.size();
  return arrays * (capacity_ + padding) * sizeof(double);
}

}  // namespace sluice
