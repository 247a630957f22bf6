/// Parallel loops. All threads of the program start here.
///
/// The work of an item must not depend on which thread does it, and items must write to places of their own: then the
/// answer is the same, bit for bit, on any number of threads.
#pragma once

#include <cstddef>
#include <vector>

#if defined(SLUICE_STD_THREADS)
#include <thread>
#else
#include <omp.h>
#endif

namespace sluice {

/// Number of threads that parallel loops use.
int thread_count();
void set_thread_count(int threads);

/// Calls body(item) for item = 0 … count-1, a contiguous range of items a thread.
template <class Body>
void parallel_for(std::size_t count, const Body& body) {
#if defined(SLUICE_STD_THREADS)
  const auto threads = static_cast<std::size_t>(thread_count());
  std::vector<std::thread> team;
  for (std::size_t t = 0; t < threads; ++t)
    team.emplace_back([&, t] {
      for (std::size_t i = count * t / threads; i < count * (t + 1) / threads; ++i) body(i);
    });
  for (auto& member : team) member.join();
#else
#pragma omp parallel for schedule(static) num_threads(thread_count())
  for (std::size_t i = 0; i < count; ++i) body(i);
#endif
}

/// Calls body(item, range) for all items bounds[range] <= item < bounds[range + 1]; each range is the work of one
/// thread, in order. There are thread_count() ranges.
template <class Body>
void parallel_ranges(const std::vector<std::size_t>& bounds, const Body& body) {
  parallel_for(bounds.size() - 1, [&](std::size_t range) {
    for (std::size_t i = bounds[range]; i < bounds[range + 1]; ++i) body(i, range);
  });
}

}  // namespace sluice
