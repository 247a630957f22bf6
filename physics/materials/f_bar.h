/// F-bar's part of strain increments: their trace in the plane, or in space. docs/theory.md, eq. (26).
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/transfer/shape_kernels.h"

namespace sluice {

/// The trace of the strain increments of n particles, without zz in 2-D.
template <int Dim>
void volumetric_strain(const StrainIncrements<Dim>& strain, std::size_t n, double* __restrict trace) {
  std::copy_n(strain.strain[0], n, trace);
  for (std::size_t a = 1; a < Dim; ++a)
    for (std::size_t p = 0; p < n; ++p) trace[p] += strain.strain[a][p];
}

/// Changes the trace of the strain increments to `trace`, in equal parts; destroys `trace`.
template <int Dim>
void set_volumetric_strain(double* __restrict trace, std::size_t n, const StrainIncrements<Dim>& strain) {
  for (std::size_t a = 0; a < Dim; ++a)
    for (std::size_t p = 0; p < n; ++p) trace[p] -= strain.strain[a][p];
  for (std::size_t a = 0; a < Dim; ++a)
    for (std::size_t p = 0; p < n; ++p) strain.strain[a][p] += trace[p] / Dim;
}

}  // namespace sluice
