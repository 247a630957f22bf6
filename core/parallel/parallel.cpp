#include "core/parallel/parallel.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

namespace sluice {

namespace {

/// How long a thread spins before it lets the machine put it to sleep. Stages of a step follow each other within
/// microseconds; but where other programs want the cores, a spinning thread would keep its own team-mates from them.
constexpr auto patience = std::chrono::microseconds(60);

/// Waits until done() holds; sleeps on `word` once patience is over. `word` must change before done() becomes true.
template <class Word, class Done>
void wait_until(const std::atomic<Word>& word, const Done& done) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  for (;;) {
    const Word seen = word.load(std::memory_order_acquire);
    if (done(seen)) return;
    if (std::chrono::steady_clock::now() < give_up) {
#if defined(__x86_64__)
      for (int i = 0; i < 8; ++i) __builtin_ia32_pause();
#endif
    } else {
      word.wait(seen, std::memory_order_acquire);
    }
  }
}

/// What several threads write begins on a cache line of its own.
constexpr std::size_t cache_line = 64;

/// The items that a thread begins with; others may take from it. `next` holds the number of the call in its upper half
/// and the next free item in its lower half, so that nobody takes an item of another call than the one that he was
/// called to.
struct alignas(cache_line) Share {
  std::atomic<std::uint64_t> next{0};
  std::atomic<std::uint32_t> end{0};
};

class Team {
 public:
  explicit Team(int threads) : shares_(static_cast<std::size_t>(threads)) {
    for (int t = 1; t < threads; ++t) members_.emplace_back([this, t] { serve(t); });
  }
  ~Team() {
    closing_ = true;
    announce();
    for (auto& member : members_) member.join();
  }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int size() const { return static_cast<int>(shares_.size()); }

  /// Returns when all items are done. It does not wait for members that came too late to do any.
  void run(std::size_t count, const LoopBody& body) {
    assert(count < (std::size_t{1} << 31));
    const std::uint64_t threads = shares_.size(), items = count, call = calls_.load(std::memory_order_relaxed) + 1;
    body_ = body;
    undone_.store(static_cast<std::uint32_t>(items), std::memory_order_relaxed);
    // `next` before `end`: a member that is late from the last call must not find room in a share whose number is still
    // old.
    for (std::uint64_t t = 0; t < threads; ++t) {
      shares_[t].next.store(call << 32 | items * t / threads, std::memory_order_release);
      shares_[t].end.store(static_cast<std::uint32_t>(items * (t + 1) / threads), std::memory_order_release);
    }
    announce();
    work(static_cast<std::uint32_t>(call), 0);
    wait_until(undone_, [](std::uint32_t undone) { return undone == 0; });
  }

 private:
  void announce() {
    calls_.fetch_add(1, std::memory_order_release);
    calls_.notify_all();
  }

  void serve(int thread) {
    for (std::uint32_t heard = 0;;) {
      wait_until(calls_, [heard](std::uint32_t calls) { return calls != heard; });
      // In this order: the last call closes, and who has heard it must not miss that.
      heard = calls_.load(std::memory_order_acquire);
      if (closing_) return;
      work(heard, thread);
    }
  }

  /// Own share first, then what the others left.
  void work(std::uint32_t call, int thread) {
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      Share& share = shares_[(static_cast<std::size_t>(thread) + k) % shares_.size()];
      std::uint32_t done = 0;
      std::uint64_t next = share.next.load(std::memory_order_acquire);
      for (;;) {
        const std::uint32_t begin = static_cast<std::uint32_t>(next), last = share.end.load(std::memory_order_acquire);
        if (next >> 32 != call || begin >= last) break;
        // Large bites first, and small ones to end together. Items are not alike: no bite may be a large part of a
        // share.
        const std::uint32_t end = begin + std::max<std::uint32_t>(1, (last - begin) / 8);
        // If this succeeds the call is not over, and body_ and last are those of the call.
        if (!share.next.compare_exchange_weak(next, std::uint64_t{call} << 32 | end, std::memory_order_acq_rel))
          continue;
        next = std::uint64_t{call} << 32 | end;
        body_.work(body_.body, begin, end, thread);
        done += end - begin;
      }
      // Once a share, not once a bite: every thread writes here.
      if (done > 0 && undone_.fetch_sub(done, std::memory_order_acq_rel) == done) undone_.notify_all();
    }
  }

  std::vector<Share> shares_;
  std::vector<std::thread> members_;
  LoopBody body_{};
  std::atomic<std::uint32_t> calls_{0};
  alignas(cache_line) std::atomic<std::uint32_t> undone_{0};  // items of the call
  std::atomic<bool> closing_{false};
};

std::unique_ptr<Team>& team() {
  static auto the_team = std::make_unique<Team>(1);
  return the_team;
}

}  // namespace

int thread_count() { return team()->size(); }

void set_thread_count(int threads) {
  if (threads != thread_count()) team() = std::make_unique<Team>(std::max(1, threads));
}

void run_loop(std::size_t count, const LoopBody& body) {
  if (count == 0) return;
  if (thread_count() == 1)
    body.work(body.body, 0, count, 0);
  else
    team()->run(count, body);
}

}  // namespace sluice
