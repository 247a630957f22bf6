#include "solvers/renewal_rule.h"

#include <algorithm>
#include <cmath>

namespace sluice {
namespace {
/// Iterations are judged once they have cost this part of a renewal: the first ones tell little.
constexpr double trial = 0.25;
constexpr double longest_interval = 31;
}  // namespace

bool RenewalRule::renew() const { return wait_ > 0 || expected_ * costs_.iteration * solves_ > cost_; }

bool RenewalRule::give_up(int iterations, double first, double now) const {
  if (iterations * costs_.iteration < trial * costs_.renewal) return false;
  // Convergence is taken to go on at the rate so far.
  const double remaining = iterations * std::log(now) / std::log(first / now);
  return !(now < first && remaining * costs_.iteration < costs_.renewal + costs_.iteration);
}

/// The first solve with an aged preconditioner was dearer than a renewal: wait, longer each time.
void RenewalRule::lengthen_interval() { interval_ = wait_ = std::min(2 * interval_ + 1, longest_interval); }

void RenewalRule::aged(int iterations) {
  if (iterations * costs_.iteration <= costs_.renewal + costs_.iteration)
    interval_ = 0;
  else if (solves_ == 1)
    lengthen_interval();
  expected_ = solves_ > 1 ? (expected_ + iterations) / 2 : iterations;
  solves_ += 1;
  cost_ += iterations * costs_.iteration;
}

void RenewalRule::renewed(int before, int after) {
  if (wait_ > 0)
    wait_ -= 1;
  else if (before > 0 && solves_ == 1)
    lengthen_interval();
  solves_ = 1;
  cost_ = costs_.renewal + after * costs_.iteration;
  expected_ = after;
}

RenewalRule::Counters RenewalRule::counters() const {
  return {costs_.renewal, costs_.iteration, solves_, cost_, expected_, interval_, wait_};
}

void RenewalRule::restore(const Counters& counters) {
  costs_ = {counters[0], counters[1]};
  solves_ = counters[2], cost_ = counters[3], expected_ = counters[4], interval_ = counters[5], wait_ = counters[6];
}

}  // namespace sluice
