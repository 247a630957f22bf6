/// RenewalRule on sequences whose best policy is known.
#include "solvers/renewal_rule.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sluice {
namespace {

struct Totals {
  int renewals = 0, trials = 0;
  double cost = 0;
};

/// Iterations of a solve with a preconditioner of age a: growth * a. One with a new one.
Totals run(RenewalRule& rule, double growth, int solves) {
  const auto [renewal, iteration] = rule.costs();
  Totals totals;
  int age = -1;  // none yet
  for (int i = 0; i < solves; ++i) {
    int before = 0;
    if (age >= 0 && !rule.renew()) {
      ++totals.trials;
      const int needed = static_cast<int>(std::lround(growth * (age + 1)));
      // Converges evenly from a distance of 1e10 to 1.
      bool done = true;
      for (before = 1; before < needed; ++before)
        if (rule.give_up(before, 1e10, std::pow(10.0, 10.0 * (1 - static_cast<double>(before) / needed)))) {
          done = false;
          break;
        }
      totals.cost += before * iteration;
      if (done) {
        rule.aged(needed);
        ++age;
        continue;
      }
    }
    rule.renewed(before, 1);
    age = 0;
    ++totals.renewals;
    totals.cost += renewal + iteration;
  }
  return totals;
}

// With costs of growth * iteration * age the mean cost of a cycle is least where its length is sqrt(2 F / growth):
// sqrt(2 * 100 / 1) = 14. The rule sees the cost of the last solve, not of the next, and is one or two late.
TEST(RenewalRule, FindsTheCheapestCycle) {
  RenewalRule rule({.renewal = 100, .iteration = 1});
  const Totals totals = run(rule, 1, 1400);
  EXPECT_GE(totals.renewals, 80);
  EXPECT_LE(totals.renewals, 100);
}

TEST(RenewalRule, KeepsWhatDoesNotAge) {
  RenewalRule rule({.renewal = 100, .iteration = 1});
  EXPECT_EQ(run(rule, 0, 1000).renewals, 1);
}

// Every trial is in vain. It costs a quarter of a renewal, and trials become as rare as one in 32 solves: with those of
// the beginning, 2 % more than renewing always.
TEST(RenewalRule, TriesInVainAtGrowingIntervals) {
  RenewalRule rule({.renewal = 100, .iteration = 1});
  const Totals totals = run(rule, 10000, 1000);
  EXPECT_EQ(totals.renewals, 1000);
  EXPECT_LE(totals.trials, 5 + 1000 / 32);
  EXPECT_LT(totals.cost, 1.02 * 1000 * 101);
  // Calm again: the next trial is a success, and others follow.
  EXPECT_LE(run(rule, 0, 1000).renewals, 33);
}

TEST(RenewalRule, GoesOnFromItsCounters) {
  for (const int interruption : {1, 7, 50}) {
    RenewalRule rule({.renewal = 100, .iteration = 1}), second;
    run(rule, 1, interruption);
    second.restore(rule.counters());
    const Totals a = run(rule, 1, 100), b = run(second, 1, 100);
    EXPECT_EQ(a.renewals, b.renewals);
    EXPECT_EQ(a.cost, b.cost);
  }
}

}  // namespace
}  // namespace sluice
