/// A run beside the same run with a restart and on other threads.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/parallel/parallel.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {

/// Runs what make() gives to `until` on one thread, and once more with a restart after some steps, from where it goes
/// on with three: columns must have the same bits. Returns the first.
template <class Make>
std::unique_ptr<Simulation> run_and_resume(const Make& make, double until, int steps_before_restart,
                                           const std::vector<std::string>& columns) {
  const auto run = [until](Simulation& simulation) {
    while (simulation.time() < until) simulation.advance(until);
  };
  std::unique_ptr<Simulation> reference = make();
  const auto first = make();
  run(*reference);
  take_steps(*first, steps_before_restart, until);
  Archive archive;
  first->store(archive);
  set_thread_count(3);
  const auto resumed = make();
  resumed->restore(archive);
  run(*resumed);
  set_thread_count(1);
  for (const std::string& column : columns)
    EXPECT_EQ(by_id(reference->particles(), column), by_id(resumed->particles(), column)) << column;
  return reference;
}

}  // namespace sluice
