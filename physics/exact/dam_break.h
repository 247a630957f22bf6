/// Collapse of a column of water on a rigid floor: measured positions of the front. No exact solution, an experiment.
/// Source: Martin & Moyce (1952), An experimental study of the collapse of liquid columns on a rigid horizontal plane,
/// Philosophical Transactions of the Royal Society A 244, 312-324, figure 3, for columns of width a = 2.25 in = 0.05715
/// m and height n^2 a with n^2 = 2, as tabulated by PySPH (pysph/examples/db_exp_data.py, mm_data_2). T = t sqrt(n^2 g
/// / a), Z = distance of the front from the wall over a. The column needs a moment to get going behind the withdrawn
/// gate, so that early values lie later than in a computation.
#pragma once

#include <array>
#include <cmath>

namespace sluice::exact {

struct FrontPosition {
  double T, Z;
};

/// The first entry is the column before its release.
inline constexpr std::array<FrontPosition, 16> martin_moyce_front = {{{0, 1},
                                                                      {0.832, 1.217},
                                                                      {1.219, 1.474},
                                                                      {1.997, 2.292},
                                                                      {2.547, 2.995},
                                                                      {3.345, 4.134},
                                                                      {4.034, 4.944},
                                                                      {4.418, 5.881},
                                                                      {5.091, 6.980},
                                                                      {5.685, 7.945},
                                                                      {6.306, 8.966},
                                                                      {6.822, 9.986},
                                                                      {7.439, 10.963},
                                                                      {8.031, 11.977},
                                                                      {8.633, 13.005},
                                                                      {9.237, 13.970}}};

inline double dam_break_time(double t, double width, double gravity = 9.81) {
  return t * std::sqrt(2 * gravity / width);
}

/// Z at T, linearly between the measured values; not a number after the last of them.
inline double dam_break_front(double T) {
  for (std::size_t i = 1; i < martin_moyce_front.size(); ++i) {
    const FrontPosition a = martin_moyce_front[i - 1], b = martin_moyce_front[i];
    if (T >= a.T && T <= b.T) return a.Z + (b.Z - a.Z) * (T - a.T) / (b.T - a.T);
  }
  return NAN;
}

}  // namespace sluice::exact
