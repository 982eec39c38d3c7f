#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""40 digits of what a triangle returns between two apexes, and to both ends of a staff, by sample: the values in
path_reference_test.cpp and receiver_pair_reference_test.cpp.

Plane Cartesian coordinates, x outside, y inside, by mpmath's own quadrature: nothing of the program's way.
"""
from mpmath import cos, exp, findroot, log, mp, mpf, quad, sin, sqrt

mp.dps = 45
MU = mpf(1) / 512
ABSORPTION = mpf("0.0625")  # dB/m
OUT, HOME = (mpf(-1), mpf("0.5"), mpf(6)), (mpf("1.5"), mpf(-1), mpf(4))
# A staff about HOME: the doubles that its axis is.
AXIS, BASELINE, WAVENUMBER = (mpf(0), mpf(0.6), mpf(0.8)), mpf("0.25"), mpf(64)
ENDS = [tuple(h + side * BASELINE / 2 * a for h, a in zip(HOME, AXIS)) for side in (1, -1)]
# z = x / 4 on the bed: (x, y) of the corners, in order of x
A, B, C = (mpf(1), mpf(-1)), (mpf(2), mpf(3)), (mpf(5), mpf(1))
BORDERS = [mpf("4.5"), mpf("5.25"), mpf(6), mpf("6.75")]


def distance(x, y, p):
    return sqrt((x - p[0]) ** 2 + (y - p[1]) ** 2 + (x / 4 - p[2]) ** 2)


def half(x, y, home=HOME):
    return (distance(x, y, OUT) + distance(x, y, home)) / 2


def density(x, y, home=HOME):
    beta = ABSORPTION * log(10) / 10
    r = [distance(x, y, OUT), distance(x, y, home)]
    scale = sqrt(1 + mpf(1) / 16)  # of the plane's normal (-1/4, 0, 1), and of its area over that in plan
    height = [(p[2] - p[0] / 4) / scale for p in (OUT, home)]
    return MU * height[0] * height[1] * exp(-beta * (r[0] + r[1])) / (r[0] * r[1]) ** 3 * scale


def product(turned):
    def value(x, y):
        phase = WAVENUMBER * (distance(x, y, ENDS[0]) - distance(x, y, ENDS[1]))
        return sqrt(density(x, y, ENDS[0]) * density(x, y, ENDS[1])) * turned(phase)

    return value


def line(p, q, x):
    return p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0])


def sample(lo, hi, homes=(HOME,), value=density):
    """What lies between two half paths, to all of the homes."""
    curves = [(border, home) for border in (lo, hi) for home in homes]
    # Breaks of x: corners, where a border crosses an edge, and where two homes' borders cross.
    xs = {A[0], B[0], C[0]}
    for border, home in curves:
        for p, q in ((A, B), (B, C), (A, C)):
            steps = [p[0] + (q[0] - p[0]) * k / 400 for k in range(401)]
            f = lambda x: half(x, line(p, q, x), home) - border
            for s, t in zip(steps, steps[1:]):
                if f(s) * f(t) < 0:
                    xs.add(findroot(f, (s, t), solver="anderson", tol=mpf(10) ** -80))

    def span(x):
        return line(A, C, x), (line(A, B, x) if x < B[0] else line(B, C, x))

    def crossings(x, border, home):
        y0, y1 = span(x)
        f = lambda y: half(x, y, home) - border
        steps = [y0 + (y1 - y0) * k / 12 for k in range(13)]
        return [
            findroot(f, (s, t), solver="anderson", tol=mpf(10) ** -80)
            for s, t in zip(steps, steps[1:])
            if f(s) * f(t) < 0
        ]

    for border in (lo, hi) if len(homes) > 1 else ():
        # Along one home's border, how far off the other's half path is.
        def apart(x):
            met = crossings(x, border, homes[0])
            return half(x, met[0], homes[1]) - border if met else None

        steps = [A[0] + (C[0] - A[0]) * (k + mpf("0.5")) / 200 for k in range(200)]
        for s, t in zip(steps, steps[1:]):
            f, g = apart(s), apart(t)
            if f is not None and g is not None and f * g < 0:
                xs.add(findroot(apart, (s, t), solver="anderson", tol=mpf(10) ** -80))
    xs = sorted(xs)

    def row(x):
        ys = sorted([*span(x), *(y for curve in curves for y in crossings(x, *curve))])
        total = mpf(0)
        for s, t in zip(ys, ys[1:]):
            if t > s and all(lo <= half(x, (s + t) / 2, home) < hi for home in homes):
                total += quad(lambda y: value(x, y), [s, t], maxdegree=5)
        return total

    return sum(quad(row, [s, t], maxdegree=5) for s, t in zip(xs, xs[1:]))


if __name__ == "__main__":
    print([mp.nstr(half(*p), 8) for p in (A, B, C)])
    for lo, hi in zip(BORDERS, BORDERS[1:]):
        print(mp.nstr(sample(lo, hi), 40))
    print("upper, lower, real and imaginary part of the product")
    for row in [((ENDS[0],), lambda x, y: density(x, y, ENDS[0])), ((ENDS[1],), lambda x, y: density(x, y, ENDS[1])),
                (ENDS, product(cos)), (ENDS, product(sin))]:
        print([mp.nstr(sample(lo, hi, *row), 40) for lo, hi in zip(BORDERS, BORDERS[1:])])
