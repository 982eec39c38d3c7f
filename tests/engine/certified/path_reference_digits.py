#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""40 digits of what a triangle returns between two apexes, by sample: the values in path_reference_test.cpp.

Plane Cartesian coordinates, x outside, y inside, by mpmath's own quadrature: nothing of the program's way.
"""
from mpmath import exp, findroot, log, mp, mpf, quad, sqrt

mp.dps = 45
MU = mpf(1) / 512
ABSORPTION = mpf("0.0625")  # dB/m
OUT, HOME = (mpf(-1), mpf("0.5"), mpf(6)), (mpf("1.5"), mpf(-1), mpf(4))
# z = x / 4 on the bed: (x, y) of the corners, in order of x
A, B, C = (mpf(1), mpf(-1)), (mpf(2), mpf(3)), (mpf(5), mpf(1))
BORDERS = [mpf("4.5"), mpf("5.25"), mpf(6), mpf("6.75")]


def ranges(x, y):
    z = x / 4
    return [sqrt((x - p[0]) ** 2 + (y - p[1]) ** 2 + (z - p[2]) ** 2) for p in (OUT, HOME)]


def half(x, y):
    return sum(ranges(x, y)) / 2


def density(x, y):
    beta = ABSORPTION * log(10) / 10
    r = ranges(x, y)
    scale = sqrt(1 + mpf(1) / 16)  # of the plane's normal (-1/4, 0, 1), and of its area over that in plan
    height = [(p[2] - p[0] / 4) / scale for p in (OUT, HOME)]
    return MU * height[0] * height[1] * exp(-beta * (r[0] + r[1])) / (r[0] * r[1]) ** 3 * scale


def line(p, q, x):
    return p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0])


def sample(lo, hi):
    """What lies between two half paths."""
    # Breaks of x: corners, and where a border crosses an edge or turns (its least and greatest x).
    xs = {A[0], B[0], C[0]}
    for border in (lo, hi):
        for p, q in ((A, B), (B, C), (A, C)):
            steps = [p[0] + (q[0] - p[0]) * k / 400 for k in range(401)]
            f = lambda x: half(x, line(p, q, x)) - border
            for s, t in zip(steps, steps[1:]):
                if f(s) * f(t) < 0:
                    xs.add(findroot(f, (s, t), solver="anderson", tol=mpf(10) ** -80))
    xs = sorted(xs)

    def row(x):
        y0, y1 = line(A, C, x), (line(A, B, x) if x < B[0] else line(B, C, x))
        ys = [y0, y1]
        for border in (lo, hi):
            f = lambda y: half(x, y) - border
            steps = [y0 + (y1 - y0) * k / 12 for k in range(13)]
            for s, t in zip(steps, steps[1:]):
                if f(s) * f(t) < 0:
                    ys.append(findroot(f, (s, t), solver="anderson", tol=mpf(10) ** -80))
        ys.sort()
        total = mpf(0)
        for s, t in zip(ys, ys[1:]):
            if t > s and lo <= half(x, (s + t) / 2) < hi:
                total += quad(lambda y: density(x, y), [s, t], maxdegree=5)
        return total

    return sum(quad(row, [s, t], maxdegree=5) for s, t in zip(xs, xs[1:]))


if __name__ == "__main__":
    print([mp.nstr(half(*p), 8) for p in (A, B, C)])
    for lo, hi in zip(BORDERS, BORDERS[1:]):
        print(mp.nstr(sample(lo, hi), 40))
