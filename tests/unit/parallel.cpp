#include "core/parallel/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace sluice {
namespace {

/// Restores the number of threads that the other tests run with.
class Threads {
 public:
  explicit Threads(int wanted) : before_(thread_count()) { set_thread_count(wanted); }
  ~Threads() { set_thread_count(before_); }

 private:
  int before_;
};

TEST(Parallel, DoesEveryItemOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    const Threads use(threads);
    for (const std::size_t count : {0u, 1u, 2u, 7u, 1000u}) {
      std::vector<std::atomic<int>> done(count);
      parallel_for(count, [&](std::size_t i, int thread) {
        EXPECT_GE(thread, 0);
        EXPECT_LT(thread, threads);
        ++done[i];
      });
      for (const auto& times : done) ASSERT_EQ(times, 1) << threads << " threads, " << count << " items";
    }
  }
}

// Short loops after each other, of different lengths, with more threads than cores: members are often still looking for
// work of the last loop when the next one begins. An item lost or done twice would hang the loop, or show in the sum.
TEST(Parallel, LoopsInCloseOrderDoNotMix) {
  const Threads use(6);
  std::vector<std::size_t> sum(64, 0);
  std::size_t expected = 0;
  for (std::size_t loop = 0; loop < 20000; ++loop) {
    const std::size_t count = 1 + loop * 7 % 64;
    parallel_for(count, [&](std::size_t i) { sum[i] += loop; });
    expected += loop * count;
  }
  std::size_t total = 0;
  for (const std::size_t s : sum) total += s;
  EXPECT_EQ(total, expected);
}

// A team ends right after a loop, while members still hear of that loop: one that missed the end would never be joined.
TEST(Parallel, TeamsEndWhileTheirMembersWakeUp) {
  for (int team = 0; team < 3000; ++team) {
    const Threads use(2 + team % 3);
    int sum[3] = {};
    parallel_for(3, [&](std::size_t i) { ++sum[i]; });
    ASSERT_EQ(sum[0] + sum[1] + sum[2], 3);
  }
}

}  // namespace
}  // namespace sluice
