#include "physics/two_phase/cell_coefficients.h"

#include <algorithm>

#include "core/parallel/multitarget.h"

namespace sluice {

namespace cell_coefficients {

constexpr std::size_t chunk_size = 64;

/// Numbers of CellSums, column by column.
template <int Dim>
using Columns = double[CellSums<Dim>::numbers][chunk_size];

template <int Dim>
SLUICE_ALWAYS_INLINE void transpose(const CellSums<Dim>* sums, std::size_t count, Columns<Dim>& number) {
  for (std::size_t c = 0; c < count; ++c) {
    const Lane* const lanes = sums[c].as_lanes();
    for (std::size_t n = 0; n < CellSums<Dim>::numbers; ++n) number[n][c] = lanes[n / lane_width][n % lane_width];
  }
}

/// For a chunk of cells, at `to`. (Multi-target functions need external linkage: the linker chooses among their
/// clones.)
template <int Dim>
SLUICE_MULTITARGET void set_chunk(const CellSums<Dim>* sums, std::size_t count, const StepCoefficients<Dim>& of_step,
                                  std::size_t to, CellCoefficients<Dim>& cells) {
  alignas(64) Columns<Dim> number;
  transpose<Dim>(sums, count, number);
  const StepCoefficients<Dim> step = of_step;
  alignas(64) double inverse_volume[chunk_size], specific[chunk_size], compliance[chunk_size];
  double* __restrict storage = cells.storage.data() + to;
  double* __restrict steadied = cells.steadied.data() + to;
  for (std::size_t c = 0; c < count; ++c) {
    inverse_volume[c] = number[0][c] > 0 ? 1 / number[0][c] : 0;
    specific[c] = number[1][c] * inverse_volume[c];
    compliance[c] = number[2][c] * inverse_volume[c];
    storage[c] = number[3][c] * inverse_volume[c] * step.corner_volume_per_dt;
    steadied[c] = compliance[c] > 0 ? step.kick * specific[c] * step.steadied : 0;
  }
  for (std::size_t a = 0; a < Dim; ++a) {
    double* __restrict implicit = cells.implicit[a].data() + to;
    double* __restrict old = cells.old[a].data() + to;
    double* __restrict push = cells.push[a].data() + to;
    for (std::size_t c = 0; c < count; ++c) {
      const double mobility = number[4 + a][c] * inverse_volume[c];
      const double inertial = step.kick * specific[c], lightness = step.density * specific[c];  // rho_w / rho
      const double projection = inertial + mobility * (1 - lightness);
      // At most as soft as a skeleton in which an elastic wave crosses a fiftieth of a cell.
      const double softest = step.softest[a] * specific[c];
      const double wanted = step.stabilised[a] * (compliance[c] < softest ? compliance[c] : softest) - projection;
      // The acceleration in Darcy's law holds the old pressure; explicitly, that is unstable where rho < 2 rho_w and
      // the soil is coarse.
      const double lagged = (lightness - 0.4) * mobility - inertial;
      const double most = wanted > lagged ? wanted : lagged, stabilisation = most > 0 ? most : 0;
      implicit[c] = projection + stabilisation;
      old[c] = step.increment * (projection - mobility) + stabilisation;
      push[c] = number[4 + Dim + a][c] * inverse_volume[c];
    }
  }
}

}  // namespace cell_coefficients

template <int Dim>
void CellCoefficients<Dim>::resize(std::size_t cells) {
  for (auto* by_axis : {&implicit, &old, &push})
    for (auto& column : *by_axis) column.resize(cells);
  storage.resize(cells);
  steadied.resize(cells);
}

template <int Dim>
void CellCoefficients<Dim>::set(std::size_t first, std::span<const CellSums<Dim>> sums,
                                const StepCoefficients<Dim>& step) {
  using namespace cell_coefficients;
  for (std::size_t c = 0; c < sums.size(); c += chunk_size)
    set_chunk<Dim>(sums.data() + c, std::min(chunk_size, sums.size() - c), step, first + c, *this);
}

template class CellCoefficients<2>;
template class CellCoefficients<3>;

}  // namespace sluice
