/// RenewalRule: when to make a preconditioner anew that ages with every solve.
///
/// With F the cost of making it and c_i that of the i-th solve since, the mean cost of a solve in this cycle is
/// (F + c_1 + ... + c_k) / k. It falls as long as the next solve costs less than the mean; when the next is expected to
/// cost more, a new cycle begins. An expectation that proves wrong is corrected in the course of the solve: iterations
/// that would go on for longer than F are given up. Where systems change so fast that an aged preconditioner does not
/// pay at all, it is tried again at growing intervals only, at most every 32nd solve.
#pragma once

#include <array>

namespace sluice {

class RenewalRule {
 public:
  /// In one unit, for example operations or seconds.
  struct Costs {
    double renewal = 0;
    double iteration = 0;
  };
  RenewalRule() = default;
  explicit RenewalRule(Costs costs) : costs_(costs) {}

  const Costs& costs() const { return costs_; }
  /// May change in the course of a cycle, as measurements come in.
  void set_costs(Costs costs) { costs_ = costs; }

  /// Before a solve with an aged preconditioner: make it anew first?
  bool renew() const;
  /// In a solve: would the aged preconditioner need longer than a new one? After `iterations`, which brought the
  /// distance from the goal (1 is reached) from `first` to `now`.
  bool give_up(int iterations, double first, double now) const;

  /// After a solve that made `iterations` with the preconditioner as it stood before.
  void aged(int iterations);
  /// After a solve that renewed, with `before` iterations given up before it and `after` with the new one.
  void renewed(int before, int after);

  /// For checkpoints.
  using Counters = std::array<double, 7>;
  Counters counters() const;
  void restore(const Counters& counters);

 private:
  void lengthen_interval();

  Costs costs_;
  double solves_ = 0;    ///< of this cycle
  double cost_ = 0;      ///< of this cycle, with the renewal
  double expected_ = 0;  ///< iterations of the next solve
  double interval_ = 0;  ///< solves between trials, where an aged preconditioner does not pay
  double wait_ = 0;      ///< solves until the next trial
};

}  // namespace sluice
