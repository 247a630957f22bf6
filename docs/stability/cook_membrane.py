#!/usr/bin/python3
"""Cook's membrane in plane strain by mixed finite elements: the reference of docs/stability/f04_locking.md.

    docs/stability/cook_membrane.py [elements along a side ...]

A tapered panel, 48 long, 44 high at the clamped left side and 16 at the right one (Cook 1974), E = 240.565, small strains.
Quadrilaterals with quadratic displacements and linear continuous pressures (Taylor and Hood), which do not lock at any Poisson
ratio, in a mesh that is finer towards the corners of the clamped side. Prints, over the number of elements:

  published   nu = 1/3, E = 70, shear 6.25 on the right side: the published vertical displacement of the upper right corner is 32.2
              to 32.3 (CoFEA benchmark 2, with CalculiX, Code_Aster and Elmer)
  edge        nu = 0.4999, shear 100 / 16 on the right side: the same corner
  strip       nu = 0.4999, the force 100 spread over the strip x > 44, as a test with particles can have it: the same corner, and the
              mean vertical displacement of the strip, which the tests compare with

Needs python3-numpy and python3-scipy.
"""
import sys

import numpy as np
from scipy.sparse import coo_matrix, bmat
from scipy.sparse.linalg import spsolve

GAUSS, WEIGHT = np.polynomial.legendre.leggauss(3)
NODES = np.array([-1.0, 0.0, 1.0])


def lagrange(nodes, at):
    """Values and slopes of the polynomials that are one at one of the nodes."""
    value, slope = np.ones(len(nodes)), np.zeros(len(nodes))
    for i, x in enumerate(nodes):
        others = np.delete(nodes, i)
        value[i] = np.prod((at - others) / (x - others))
        slope[i] = sum(np.prod(np.delete(at - others, j)) for j in range(len(others))) / np.prod(x - others)
    return value, slope


def shapes(nodes, xi, eta):
    (a, da), (b, db) = lagrange(nodes, xi), lagrange(nodes, eta)
    return np.outer(a, b).ravel(), np.stack([np.outer(da, b).ravel(), np.outer(a, db).ravel()])


def spaced(count, graded_to):
    """Points from 0 to 1, denser towards 0 ('start') or towards both ends ('ends')."""
    t = np.linspace(0, 1, count + 1)
    return t**2 if graded_to == "start" else t**2 * (3 - 2 * t)


def panel(x, t):
    return np.stack([x, 44 * x / 48 + t * (44 - 28 * x / 48)], -1)


def membrane(count, young, poisson, strip):
    """Displacement of the upper right corner, and the mean over x > 44, vertical; the whole load is 100."""
    shear, lame = young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    along = np.concatenate([44 * spaced(count, "start"), np.linspace(44, 48, count // 4 + 1)[1:]])
    across = spaced(count, "ends")
    nx, ny = len(along) - 1, len(across) - 1
    fine_x = np.sort(np.concatenate([along, (along[1:] + along[:-1]) / 2]))
    fine_t = np.sort(np.concatenate([across, (across[1:] + across[:-1]) / 2]))
    number = np.arange(len(fine_x) * len(fine_t)).reshape(len(fine_x), len(fine_t))
    coarse = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    rules = [(shapes(NODES, a, b), shapes(NODES[::2], a, b), wa * wb)
             for a, wa in zip(GAUSS, WEIGHT) for b, wb in zip(GAUSS, WEIGHT)]
    stiffness, coupling, storage, force = [], [], [], np.zeros(2 * number.size)
    weights = np.zeros(2 * number.size)  # of the mean over the strip
    for i in range(nx):
        for j in range(ny):
            mine = number[2 * i:2 * i + 3, 2 * j:2 * j + 3].ravel()
            place = panel(*np.meshgrid(fine_x[2 * i:2 * i + 3], fine_t[2 * j:2 * j + 3], indexing="ij")).reshape(-1, 2)
            rows, pressures = np.stack([2 * mine, 2 * mine + 1], 1).ravel(), coarse[i:i + 2, j:j + 2].ravel()
            K, B, S = np.zeros((18, 18)), np.zeros((4, 18)), np.zeros((4, 4))
            for (N, dN), (P, _), w in rules:
                jacobian = dN @ place
                volume = w * np.linalg.det(jacobian)
                grad = np.linalg.solve(jacobian, dN)
                strain = np.zeros((3, 18))
                strain[0, 0::2], strain[1, 1::2] = grad[0], grad[1]
                strain[2, 0::2], strain[2, 1::2] = grad[1], grad[0]
                K += volume * strain.T @ np.diag([2 * shear, 2 * shear, shear]) @ strain
                B -= volume * np.outer(P, strain[0] + strain[1])
                S += volume / lame * np.outer(P, P)
                if along[i] >= 44 - 1e-9:
                    weights[2 * mine + 1] += volume * N
            stiffness.append((np.repeat(rows, 18), np.tile(rows, 18), K.ravel()))
            coupling.append((np.repeat(pressures, 18), np.tile(rows, 4), B.ravel()))
            storage.append((np.repeat(pressures, 4), np.tile(pressures, 4), S.ravel()))
    weights /= weights.sum()
    if strip:
        force += 100 * weights
    else:
        for j in range(ny):  # Simpson's rule is exact
            force[2 * number[-1, 2 * j:2 * j + 3] + 1] += 100 * (across[j + 1] - across[j]) * np.array([1, 4, 1]) / 6

    def assembled(parts, shape):
        r, c, v = (np.concatenate(part) for part in zip(*parts))
        return coo_matrix((v, (r, c)), shape).tocsr()

    u, p = 2 * number.size, coarse.size
    free = np.setdiff1d(np.arange(u), np.stack([2 * number[0], 2 * number[0] + 1]).ravel())
    K, B, S = assembled(stiffness, (u, u)), assembled(coupling, (p, u)), assembled(storage, (p, p))
    system = bmat([[K[free][:, free], B[:, free].T], [B[:, free], -S]]).tocsc()
    solution = spsolve(system, np.concatenate([force[free], np.zeros(p)]))
    moved = np.zeros(u)
    moved[free] = solution[:len(free)]
    return moved[2 * number[-1, -1] + 1], weights @ moved


def main():
    print(f"{'elements':>8} {'published':>10} {'edge':>8} {'strip':>8} {'mean of strip':>14}")
    for count in [int(word) for word in sys.argv[1:]] or [8, 16, 32]:
        published = membrane(count, 70, 1 / 3, False)[0]
        edge = membrane(count, 240.565, 0.4999, False)[0]
        corner, mean = membrane(count, 240.565, 0.4999, True)
        print(f"{count:8d} {published:10.4f} {edge:8.4f} {corner:8.4f} {mean:14.4f}", flush=True)


if __name__ == "__main__":
    main()
