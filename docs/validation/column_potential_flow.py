#!/usr/bin/python3
"""Front of a collapsing column of water, twice as high as wide, as potential flow: no viscosity, no friction.

    docs/validation/column_potential_flow.py [nodes] [largest step] [end]

Prints the front Z = x / a over T = t sqrt(2 g / a), for docs/two_phase_validation.md and the test of the dam break. Mixed
Eulerian-Lagrangian boundary elements: linear elements on the free surface, images in bed and wall, Runge-Kutta steps of
second order, nodes spread anew in every step and smoothed in every fourth. Lengths are in a, and g = 1/2 makes times T.
Ends at about T = 1.6, where the tip becomes thinner than the elements. 80 and 100 nodes agree to 0.01 in Z.
"""
import sys

import numpy as np
from scipy.interpolate import CubicSpline, interp1d

GRAVITY = 0.5
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(6)
POINTS, WEIGHTS = (POINTS + 1) / 2, WEIGHTS / 2


def normal_velocity(x, phi):
    """Out of the water, from the potential, at the nodes (ordered from the wall to the bed)."""
    n = len(x)
    along = np.diff(x, axis=0)
    length = np.hypot(*along.T)
    normal = np.stack([-along[:, 1], along[:, 0]], 1) / length[:, None]
    double, single = np.zeros((n, n)), np.zeros((n, n))
    element = np.arange(n - 1)
    for mirror in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        source = x * np.array(mirror)
        near = np.zeros((n, n - 1), bool)  # where the logarithm is singular: integrated exactly below
        if mirror == (1, 1):
            near[element, element] = near[element + 1, element] = True
        elif mirror == (-1, 1):
            near[0, 0] = True
        elif mirror == (1, -1):
            near[-1, -1] = True
        for point, weight in zip(POINTS, WEIGHTS):
            r = (x[:-1] + point * along)[None] - source[:, None]
            square = np.where(near, 1, (r**2).sum(2))
            log = np.where(near, 0, 0.5 * np.log(square)) * length * weight
            flux = np.where(near, 0, (r * normal[None]).sum(2) / square) * length * weight
            for end, shape in ((0, 1 - point), (1, point)):
                single[:, end : n - 1 + end] += log * shape
                double[:, end : n - 1 + end] += flux * shape

    def add_singular(node, at, end):
        size = length[at]
        single[node, at + end] += size * (np.log(size) / 2 - 0.75)
        single[node, at + 1 - end] += size * (np.log(size) / 2 - 0.25)

    for node in range(n):
        if node < n - 1:
            add_singular(node, node, 0)
        if node > 0:
            add_singular(node, node - 1, 1)
    add_singular(0, 0, 0)  # the images of the ends
    add_singular(n - 1, n - 2, 1)
    return np.linalg.solve(single, (double - np.diag(double.sum(1))) @ phi)  # a constant potential moves nothing


def arc(x):
    return np.r_[0, np.cumsum(np.hypot(*np.diff(x, axis=0).T))]


def slope(f, s, odd_at_wall, odd_at_bed, k=4):
    """Derivative along the surface, continued by symmetry beyond its ends."""
    left = (2 * f[0] - f[1 : k + 1] if odd_at_wall else f[1 : k + 1])[::-1]
    right = (2 * f[-1] - f[-k - 1 : -1] if odd_at_bed else f[-k - 1 : -1])[::-1]
    where = np.r_[-s[1 : k + 1][::-1], s, 2 * s[-1] - s[-k - 1 : -1][::-1]]
    return np.gradient(np.r_[left, f, right], where, edge_order=2)[k:-k]


def rates(x, phi):
    s = arc(x)
    t = np.stack([slope(x[:, 0], s, True, False), slope(x[:, 1], s, False, True)], 1)
    t /= np.hypot(*t.T)[:, None]
    n = np.stack([-t[:, 1], t[:, 0]], 1)
    u = slope(phi, s, False, False)[:, None] * t + normal_velocity(x, phi)[:, None] * n
    u[0, 0] = u[-1, 1] = 0
    return u, 0.5 * (u**2).sum(1) - GRAVITY * x[:, 1]


def places(total, nodes):
    """Closer together towards the bed."""
    z = np.linspace(0, 1, nodes)
    return total * (0.5 * z + 0.5 * (1 - (1 - z) ** 2))


def smooth(f):
    result = f.copy()
    result[2:-2] = (-f[:-4] + 4 * f[1:-3] + 10 * f[2:-2] + 4 * f[3:-1] - f[4:]) / 16
    return result


def column(nodes, radius=0.1):
    """Its upper edge is rounded."""
    angle = np.linspace(np.pi / 2, 0, 40)
    top = np.stack([np.linspace(0, 1 - radius, 60)[:-1], np.full(59, 2.0)], 1)
    edge = np.stack([1 - radius + radius * np.cos(angle), 2 - radius + radius * np.sin(angle)], 1)
    side = np.stack([np.ones(120), np.linspace(2 - radius, 0, 121)[1:]], 1)
    x = np.concatenate([top, edge, side])
    return interp1d(arc(x), x, axis=0)(places(arc(x)[-1], nodes))


def main(nodes=100, largest_step=0.01, end=1.6):
    x, phi, time, step = column(nodes), np.zeros(nodes), 0.0, 0
    while time < end:
        u, f = rates(x, phi)
        dt = min(largest_step, 0.3 * np.hypot(*np.diff(x, axis=0).T).min() / max(np.hypot(*u.T).max(), 0.05))
        u, f = rates(x + 0.5 * dt * u, phi + 0.5 * dt * f)
        x, phi, time, step = x + dt * u, phi + dt * f, time + dt, step + 1
        x[0, 0] = x[-1, 1] = 0
        s = arc(x)
        x, phi = CubicSpline(s, x)(places(s[-1], nodes)), CubicSpline(s, phi)(places(s[-1], nodes))
        if step % 4 == 0:
            x, phi = np.stack([smooth(x[:, 0]), smooth(x[:, 1])], 1), smooth(phi)
        x[0, 0] = x[-1, 1] = 0
        if int(time / 0.2) != int((time - dt) / 0.2):
            print(f"T {time:.3f}  Z {x[-1, 0]:.3f}  height / 2a {x[0, 1] / 2:.3f}", flush=True)


if __name__ == "__main__":
    main(*[kind(word) for kind, word in zip((int, float, float), sys.argv[1:])])
