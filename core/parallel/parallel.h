/// Parallel loops. All threads of the program work here.
///
/// The work of an item must not depend on which thread does it, and items must write to places of their own: then the
/// answer is the same, bit for bit, on any number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

namespace sluice {

/// Number of threads that parallel loops use; the calling one is among them. Not to be changed within a loop.
int thread_count();
void set_thread_count(int threads);

/// A loop body without its type: does items [begin, end) as thread number `thread`.
struct LoopBody {
  void (*work)(const void* body, std::size_t begin, std::size_t end, int thread);
  const void* body;
};

/// Shares items 0 … count-1 among the threads: each begins with a contiguous share of its own and, when that is done,
/// helps the others. A thread that the machine has put aside therefore holds up little.
void run_loop(std::size_t count, const LoopBody& body);

/// Calls body(item) or body(item, thread) for item = 0 … count-1. Exceptions must not leave the body.
template <class Body>
void parallel_for(std::size_t count, const Body& body) {
  run_loop(count, {[](const void* erased, std::size_t begin, std::size_t end, int thread) {
                     const Body& typed = *static_cast<const Body*>(erased);
                     for (std::size_t i = begin; i < end; ++i) {
                       if constexpr (std::is_invocable_v<Body, std::size_t, int>)
                         typed(i, thread);
                       else
                         typed(i);
                     }
                   },
                   &body});
}

/// Consecutive items [begin, end) of a loop.
struct Items {
  std::size_t begin = 0, end = std::numeric_limits<std::size_t>::max();

  /// The part of it that a loop over `count` items has.
  Items within(std::size_t count) const { return {std::min(begin, count), std::min(end, count)}; }
};

inline constexpr Items everything;

/// The same for the items of a range.
template <class Body>
void parallel_for(Items items, const Body& body) {
  parallel_for(items.end - items.begin, [&](std::size_t i, int thread) {
    if constexpr (std::is_invocable_v<Body, std::size_t, int>)
      body(items.begin + i, thread);
    else
      body(items.begin + i);
  });
}

/// Cuts items 0 … count-1 in shares of `size`, so that light items are worth a call, and calls body(begin, end, number
/// of the share). Sums over a share that are added up in the order of the shares do not depend on the number of
/// threads.
template <class Body>
void parallel_shares(std::size_t count, std::size_t size, const Body& body) {
  parallel_for((count + size - 1) / size,
               [&](std::size_t share) { body(share * size, std::min(count, (share + 1) * size), share); });
}

/// Sum of term(item) over the items 0 … count-1, the same bits on any number of threads.
template <class Term>
double parallel_sum(std::size_t count, const Term& term) {
  constexpr std::size_t size = 1024;
  std::vector<double> sums((count + size - 1) / size);
  parallel_shares(count, size, [&](std::size_t begin, std::size_t end, std::size_t share) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += term(i);
    sums[share] = sum;
  });
  double total = 0;
  for (const double sum : sums) total += sum;
  return total;
}

}  // namespace sluice
