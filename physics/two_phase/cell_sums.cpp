#include "physics/two_phase/cell_sums.h"

namespace sluice {

namespace cell_sums {

enum class Kind { liquid, darcy, inertial };

constexpr int chunk_size = 64;

/// What the particles of a chunk add: numbers of CellSums, and those of the vertices.
template <int Dim>
struct Chunk {
  alignas(64) double number[CellSums<Dim>::lanes * lane_width][chunk_size];
  alignas(64) double wet_volume[chunk_size], pressure[chunk_size], expansion[chunk_size];  ///< V, V p, V div v
  alignas(64) double slope[Dim][chunk_size];    ///< V dp/dx h: change of V p to the next vertex
  alignas(64) double in_cell[Dim][chunk_size];  ///< share of the cell
  alignas(64) std::int32_t cell[chunk_size], vertex[chunk_size];
};

template <int Dim>
SLUICE_ALWAYS_INLINE void locate(const BlockParticles<Dim>& particles, std::uint32_t begin, int count, Chunk<Dim>& c) {
  alignas(64) std::int32_t number[chunk_size];
  for (int p = 0; p < count; ++p) c.cell[p] = c.vertex[p] = 0;
  for (int a = Dim - 1; a >= 0; --a) {
    locate_in_tile<Dim, true>(particles, a, begin, count, number, c.in_cell[a]);
    for (int p = 0; p < count; ++p) {
      c.cell[p] = c.cell[p] * cell_tile_width<Dim> + number[p];
      c.vertex[p] = c.vertex[p] * tile_width<Dim>(1) + number[p];
    }
  }
}

/// Volume and what goes with it, and the pressure at the lower corner of the cell.
template <int Dim>
SLUICE_ALWAYS_INLINE void weigh(const WaterBatch<Dim>& b, std::uint32_t begin, int count, Chunk<Dim>& c) {
  const double* __restrict volume = b.volume + begin;
  const double* __restrict mass = b.mass + begin;
  const double* __restrict porosity = b.porosity + begin;
  const double* __restrict wet = b.wet + begin;
  const double* __restrict pressure = b.pressure + begin;
  const double* __restrict divergence = b.divergence + begin;
  const double compliance = b.compliance, compressibility = b.compressibility;
#pragma GCC ivdep
  for (int p = 0; p < count; ++p) {
    const double v = wet[p] * volume[p];
    c.wet_volume[p] = c.number[0][p] = v;
    c.number[1][p] = v * volume[p] / mass[p];
    c.number[2][p] = v * compliance;
    c.number[3][p] = v * porosity[p] * compressibility;
    c.pressure[p] = v * pressure[p];
    c.expansion[p] = v * divergence[p];
  }
  for (int a = 0; a < Dim; ++a) {
    const double* __restrict gradient = b.pressure_gradient[a] + begin;
    const double h = b.particles.grid->cell[a];
#pragma GCC ivdep
    for (int p = 0; p < count; ++p) {
      c.slope[a][p] = c.wet_volume[p] * gradient[p] * h;
      c.pressure[p] -= c.slope[a][p] * c.in_cell[a][p];
    }
  }
}

/// Mobility and push along the axes, eqs. (40) and (44); returns the power that is dissipated.
template <int Dim, Kind What>
SLUICE_ALWAYS_INLINE double drive(const WaterBatch<Dim>& b, std::uint32_t begin, int count, Chunk<Dim>& c) {
  const double* __restrict wet = b.wet + begin;
  const double* __restrict porosity = b.porosity + begin;
  const double* __restrict mass = b.mass + begin;
  const double* __restrict volume = b.volume + begin;
  const double per_kick = 1 / b.kick, density = b.density;
  alignas(64) double factor[chunk_size], inertial[chunk_size];
  for (int p = 0; p < count; ++p) factor[p] = b.mobility.factor(porosity[p]);
  if constexpr (What == Kind::inertial)
    for (int p = 0; p < count; ++p)  // mu / (n^2 dt), mu = m_s m_w / rho per volume
      inertial[p] = density / porosity[p] * (1 - porosity[p] * (density * volume[p] / mass[p])) * per_kick;
  double dissipated = 0;
  for (int a = 0; a < Dim; ++a) {
    const double* __restrict change = b.change[a] + begin;
    const double* __restrict gradient = b.pressure_gradient[a] + begin;
    double* __restrict mobility = c.number[4 + a];
    double* __restrict push = c.number[4 + Dim + a];
    const double gravity = b.gravity[a];
    if constexpr (What == Kind::darcy) {
#pragma omp simd reduction(+ : dissipated)
      for (int p = 0; p < count; ++p) {
        const double mobile = c.wet_volume[p] * b.mobility.along(a, factor[p]);
        const double driven = density * (gravity - change[p] * per_kick), excess = driven - gradient[p];
        mobility[p] = mobile;
        push[p] = mobile * driven;
        dissipated += mobile * excess * excess;
      }
    } else {
      const double* __restrict relative = b.relative[a] + begin;
#pragma omp simd reduction(+ : dissipated)
      for (int p = 0; p < count; ++p) {
        const double resistance = 1 / b.mobility.along(a, factor[p]), flux = porosity[p] * relative[p];
        // 1 - rho_w / rho is the share of the relative velocity that counts beside that of the mixture.
        const double mobile = volume[p] * (1 - density * volume[p] / mass[p]) / (resistance + inertial[p]);
        const double driven = density * (gravity - change[p] * per_kick);
        const bool has_water = wet[p] != 0;  // a dry pore has no finite mobility
        mobility[p] = has_water ? mobile : 0;
        push[p] = has_water ? mobile * (driven + inertial[p] * flux) : 0;
        dissipated += has_water ? volume[p] * flux * flux * resistance : 0;
      }
    }
  }
  return dissipated;
}

template <int Dim>
SLUICE_ALWAYS_INLINE void add_to_vertices(const Chunk<Dim>& c, int p, Lane* vertices) {
  constexpr int row = tile_width<Dim>(1);
  const Lane base{c.wet_volume[p], c.pressure[p], c.expansion[p], 0};
  Lane* const first = vertices + c.vertex[p];
  const double x = c.in_cell[0][p], y = c.in_cell[1][p], z = Dim == 3 ? c.in_cell[Dim - 1][p] : 0;
  const Lane along_x{0, c.slope[0][p], 0, 0}, along_y{0, c.slope[1][p], 0, 0};
  for (int k = 0; k < (Dim == 3 ? 2 : 1); ++k) {
    Lane plane = base;
    double weight = 1;
    if constexpr (Dim == 3) {
      plane += k * Lane{0, c.slope[2][p], 0, 0};
      weight = k == 0 ? 1 - z : z;
    }
    Lane* const at = first + k * row * row;
    at[0] += weight * (1 - y) * (1 - x) * plane;
    at[1] += weight * (1 - y) * x * (plane + along_x);
    plane += along_y;
    at[row] += weight * y * (1 - x) * plane;
    at[row + 1] += weight * y * x * (plane + along_x);
  }
}

template <int Dim>
SLUICE_ALWAYS_INLINE void add_to_cell(const Chunk<Dim>& c, int p, CellSums<Dim>* cells) {
  Lane* const sums = cells[c.cell[p]].as_lanes();
  for (std::size_t l = 0; l < CellSums<Dim>::lanes; ++l) {
    const auto* n = c.number + lane_width * l;
    sums[l] += Lane{n[0][p], n[1][p], n[2][p], n[3][p]};
  }
}

/// (Multi-target functions need external linkage: the linker chooses among their clones.)
template <int Dim, Kind What>
SLUICE_MULTITARGET double add(const WaterBatch<Dim>& b, CellSums<Dim>* cells, Lane* vertices) {
  Chunk<Dim> c;
  constexpr std::size_t filled = What == Kind::liquid ? 4 : CellSums<Dim>::numbers;
  for (std::size_t n = filled; n < CellSums<Dim>::lanes * lane_width; ++n) std::fill_n(c.number[n], chunk_size, 0.0);
  double dissipated = 0;
  for (std::uint32_t begin = b.particles.begin; begin < b.particles.end; begin += chunk_size) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk_size, b.particles.end - begin));
    locate<Dim>(b.particles, begin, count, c);
    weigh<Dim>(b, begin, count, c);
    if constexpr (What != Kind::liquid) dissipated += drive<Dim, What>(b, begin, count, c);
    for (int p = 0; p < count; ++p) {
      add_to_cell<Dim>(c, p, cells);
      add_to_vertices<Dim>(c, p, vertices);
    }
  }
  return dissipated;
}

}  // namespace cell_sums

template <int Dim>
double add_water(const WaterBatch<Dim>& batch, CellSums<Dim>* cells, Lane* vertices) {
  using enum cell_sums::Kind;
  if (batch.liquid) return cell_sums::add<Dim, liquid>(batch, cells, vertices);
  return batch.relative[0] == nullptr ? cell_sums::add<Dim, darcy>(batch, cells, vertices)
                                      : cell_sums::add<Dim, inertial>(batch, cells, vertices);
}

template double add_water<2>(const WaterBatch<2>&, CellSums<2>*, Lane*);
template double add_water<3>(const WaterBatch<3>&, CellSums<3>*, Lane*);

}  // namespace sluice
