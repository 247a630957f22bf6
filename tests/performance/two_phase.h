/// Benchmark of physics/two_phase: `sluice_performance --two-phase`.
#pragma once

/// Prints what a step with pore water costs beside one without, where its time goes, how that scales, and how the
/// projection compares with the explicit step to the same end. `smoke`: the smallest sizes only, a few steps.
/// `step_alone`: only a step of the smallest size, and its stages.
void measure_two_phase(bool smoke, bool step_alone);
