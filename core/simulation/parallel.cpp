#include "core/simulation/parallel.h"

#include <algorithm>
#include <atomic>
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

/// The items that a thread begins with; others may take from it.
struct alignas(64) Share {
  std::atomic<std::size_t> next{0};
  std::size_t end = 0;
};

class Team {
 public:
  explicit Team(int threads) : shares_(static_cast<std::size_t>(threads)) {
    for (int t = 1; t < threads; ++t) members_.emplace_back([this, t] { serve(t); });
  }
  ~Team() {
    closing_ = true;
    call();
    for (auto& member : members_) member.join();
  }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int size() const { return static_cast<int>(shares_.size()); }

  void run(std::size_t count, const LoopBody& body) {
    const std::size_t threads = shares_.size();
    chunk_ = std::max<std::size_t>(1, count / (threads * 16));
    for (std::size_t t = 0; t < threads; ++t) {
      shares_[t].next.store(count * t / threads, std::memory_order_relaxed);
      shares_[t].end = count * (t + 1) / threads;
    }
    body_ = body;
    busy_.store(static_cast<std::uint32_t>(threads - 1), std::memory_order_relaxed);
    call();
    work(0);
    wait_until(busy_, [](std::uint32_t busy) { return busy == 0; });
  }

 private:
  void call() {
    calls_.fetch_add(1, std::memory_order_release);
    calls_.notify_all();
  }

  void serve(int thread) {
    for (std::uint32_t heard = 0;; ++heard) {
      wait_until(calls_, [heard](std::uint32_t calls) { return calls != heard; });
      if (closing_) return;
      work(thread);
      if (busy_.fetch_sub(1, std::memory_order_release) == 1) busy_.notify_all();
    }
  }

  void work(int thread) {
    const std::size_t threads = shares_.size();
    for (std::size_t k = 0; k < threads; ++k) {
      Share& share = shares_[(static_cast<std::size_t>(thread) + k) % threads];
      for (;;) {
        const std::size_t begin = share.next.fetch_add(chunk_, std::memory_order_relaxed);
        if (begin >= share.end) break;
        body_.work(body_.body, begin, std::min(begin + chunk_, share.end), thread);
      }
    }
  }

  std::vector<Share> shares_;
  std::vector<std::thread> members_;
  LoopBody body_{};
  std::size_t chunk_ = 1;
  std::atomic<std::uint32_t> calls_{0}, busy_{0};
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
