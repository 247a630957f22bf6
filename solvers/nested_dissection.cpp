#include "solvers/nested_dissection.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <utility>

namespace sluice {
namespace {

/// Sets of this size are not cut further: they become one or few dense blocks of the factor in any order.
constexpr std::size_t leaf = 32;

template <int Dim>
class Dissection {
 public:
  explicit Dissection(std::span<const std::array<int, Dim>> places) : places_(places), order_(places.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    cut(order_);
  }
  std::vector<int> take_order() { return std::move(order_); }

 private:
  int coordinate(int place, std::size_t axis) const { return places_[static_cast<std::size_t>(place)][axis]; }

  /// Axis along which the box around `set` is longest, with the first and last coordinate there.
  std::tuple<std::size_t, int, int> longest_side(std::span<const int> set) const {
    std::array<int, Dim> low = places_[static_cast<std::size_t>(set[0])], high = low;
    for (const int place : set)
      for (std::size_t axis = 0; axis < Dim; ++axis) {
        low[axis] = std::min(low[axis], coordinate(place, axis));
        high[axis] = std::max(high[axis], coordinate(place, axis));
      }
    std::size_t longest = 0;
    for (std::size_t axis = 1; axis < Dim; ++axis)
      if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    return {longest, low[longest], high[longest]};
  }

  /// The thinnest layer that leaves at least 3/8 of the rest on either side; of equals, the one nearest to the middle.
  /// Where there is none, the layer in the middle. Sizes of the layers are in `layer_sizes_`.
  int best_layer(std::size_t size) const {
    int best = 0;
    std::size_t best_size = size + 1, best_imbalance = size, before = 0;
    bool best_balanced = false;
    for (std::size_t layer = 0; layer < layer_sizes_.size(); ++layer) {
      const std::size_t here = layer_sizes_[layer], after = size - before - here;
      const std::size_t imbalance = before > after ? before - after : after - before;
      const bool balanced = 8 * std::min(before, after) >= 3 * (before + after);
      const bool better = balanced != best_balanced ? balanced
                          : balanced                ? std::pair(here, imbalance) < std::pair(best_size, best_imbalance)
                                                    : imbalance < best_imbalance;
      if (better)
        best = static_cast<int>(layer), best_size = here, best_imbalance = imbalance, best_balanced = balanced;
      before += here;
    }
    return best;
  }

  void cut(std::span<int> set) {
    if (set.size() <= leaf) return;
    const auto [axis, low, high] = longest_side(set);
    if (low == high) return;
    layer_sizes_.assign(static_cast<std::size_t>(high - low) + 1, 0);
    for (const int place : set) ++layer_sizes_[static_cast<std::size_t>(coordinate(place, axis) - low)];
    const int separator = low + best_layer(set.size());

    // Before the separator, behind it, the separator itself.
    const auto part = [&, axis = axis](int place) {
      const int c = coordinate(place, axis);
      return c < separator ? 0u : c > separator ? 1u : 2u;
    };
    std::array<std::size_t, 4> begin{};
    for (const int place : set) ++begin[part(place) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    scratch_.assign(set.begin(), set.end());
    std::array<std::size_t, 4> next = begin;
    for (const int place : scratch_) set[next[part(place)]++] = place;
    cut(set.subspan(0, begin[1]));
    cut(set.subspan(begin[1], begin[2] - begin[1]));
  }

  std::span<const std::array<int, Dim>> places_;
  std::vector<int> order_, scratch_;
  std::vector<std::size_t> layer_sizes_;
};

}  // namespace

template <int Dim>
std::vector<int> nested_dissection(std::span<const std::array<int, Dim>> places) {
  return places.empty() ? std::vector<int>() : Dissection<Dim>(places).take_order();
}

template std::vector<int> nested_dissection<1>(std::span<const std::array<int, 1>>);
template std::vector<int> nested_dissection<2>(std::span<const std::array<int, 2>>);
template std::vector<int> nested_dissection<3>(std::span<const std::array<int, 3>>);

}  // namespace sluice
