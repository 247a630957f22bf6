/// Benchmark of solvers/: `sluice_performance --solver`.
#pragma once

/// Prints seconds of analysis, factorization and solution for three orders of elimination and several sizes, and what
/// keeping the factor brings over sequences of drifting systems. `smoke`: the smallest sizes only, a few steps.
void measure_solvers(bool smoke);
