/// Ghost penalty: holds nodes that material hardly reaches to a straight continuation of the displacements inside.
/// docs/theory.md, eq. (29h).
///
/// Where the edge of a body cuts little off the support of a node, that node's stiffness is a small number times a
/// force that need not be as small, and Newton's method is sent away by displacements of many cells. The penalty is on
/// second differences of the displacement across the edge. It is zero for motions that are linear in space, rotations
/// and even strains, so that convergence in the cell size stays of second order.
///
/// References: E. Burman, Ghost penalty, C. R. Math. 348 (2010); W. M. Coombs, Ghost stabilisation of the material
/// point method for stable quasi-static and dynamic analysis of large deformation problems, Int. J. Numer. Meth. Eng.
/// 124 (2023), who penalises jumps of gradients; on a regular grid these are second differences.
#pragma once

#include <Eigen/SparseCore>

#include "physics/materials/materials.h"
#include "physics/statics/grid_unknowns.h"

namespace sluice {

/// The lower triangle of the penalty's stiffness [N/m], of all unknowns that have numbers. `strength` is in units of 2
/// G: 0.001 is what a node with about so much of its volume has by itself; 0: no penalty.
template <int Dim>
Eigen::SparseMatrix<double> ghost_penalty(const Scene<Dim>& scene, const Materials<Dim>& materials,
                                          const Unknowns<Dim>& unknowns, double strength);

extern template Eigen::SparseMatrix<double> ghost_penalty<2>(const Scene<2>&, const Materials<2>&, const Unknowns<2>&,
                                                             double);
extern template Eigen::SparseMatrix<double> ghost_penalty<3>(const Scene<3>&, const Materials<3>&, const Unknowns<3>&,
                                                             double);

}  // namespace sluice
