/// Lane: four doubles that are added and multiplied together. A node keeps its fields interleaved in lanes (mass and
/// momentum in one, force in another), so that a particle adds to a node with one vector operation.
#pragma once

namespace sluice {

using Lane = double __attribute__((vector_size(32)));

inline constexpr int lane_width = 4;

}  // namespace sluice
