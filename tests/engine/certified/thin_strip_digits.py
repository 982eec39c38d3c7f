#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the energies of thin strips between two apexes with 25 digits, by range bin.

These are the values in path_reference_test.cpp. The strip lies on the plane z = 0, along x. The program integrates in
plane Cartesian coordinates with mpmath, along x inside and along y outside.
"""
from mpmath import exp, findroot, log, mp, mpf, quad, sqrt

mp.dps = 40
MU = mpf(1) / 512
ABSORPTION = mpf("0.03125")  # dB/m
OUT, HOME = (mpf(0), mpf(0), mpf(10)), (mpf("1.5"), mpf("0.25"), mpf("9.75"))
FROM, TO = mpf(55), mpf(65)
BORDERS = [mpf(54) + mpf("2.5") * k for k in range(6)]


def distance(x, y, p):
    return sqrt((x - p[0]) ** 2 + (y - p[1]) ** 2 + p[2] ** 2)


def half(x, y):
    return (distance(x, y, OUT) + distance(x, y, HOME)) / 2


def density(x, y):
    beta = ABSORPTION * log(10) / 10
    r = [distance(x, y, OUT), distance(x, y, HOME)]
    return MU * OUT[2] * HOME[2] * exp(-beta * (r[0] + r[1])) / (r[0] * r[1]) ** 3


def along(y, lo, hi):
    """The integral along x between two half paths, which grow with x."""
    ends = []
    for border in (lo, hi):
        if border <= half(FROM, y):
            ends.append(FROM)
        elif border >= half(TO, y):
            ends.append(TO)
        else:
            ends.append(findroot(lambda x: half(x, y) - border, (FROM, TO), solver="anderson", tol=mpf(10) ** -70))
    return quad(lambda x: density(x, y), ends) if ends[1] > ends[0] else mpf(0)


if __name__ == "__main__":
    for width in (mpf(2) ** -6, mpf(2) ** -9):
        print(mp.nstr(width, 8))
        for lo, hi in zip(BORDERS, BORDERS[1:]):
            print(mp.nstr(quad(lambda y: along(y, lo, hi), [-width / 2, width / 2], maxdegree=5), 25))
