# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves of an octree instead of surfaces, as HoloOcean describes its imaging sonar.

Sources: E. Potokar et al., "HoloOcean: realistic sonar simulation", IROS 2022, and the pages about the sensor at
byu-holoocean.github.io/holoocean-docs (octree, imaging-sonar-sensor). The world consists of cubes of size OctreeMin that a
surface intersects, each with a normal. Leaves with a positive cosine of incidence are sorted into bins of azimuth and
elevation (ElevationBins: ten per degree), from near to far. In each bin, all leaves after the first cluster are in shadow. A
cluster ends where the distance to the next leaf exceeds ShadowEpsilon (four leaves). A leaf returns R^2 cos. A bin of the
picture is the mean of its leaves, with multiplicative normal and additive Rayleigh noise. The picture is NPY of floats,
(frames,) RangeBins x AzimuthBins, nearest first, from port. Not included: multipath, the exponential noise of ranges, and
materials beyond R^2 = mu.
"""
import numpy as np

from known import Known, near_shadow

TITLE = "Octree leaves as in HoloOcean"
PICTURE = "sonar.npy"
IDEAL = None
OCTREE_MIN = 0.02
FRAMES, ADD_SIGMA, MULTIPLY_SIGMA = 1, 0.0, 0.0


def named(cells):
    """One number for the three of a cell: quicker to sort."""
    return ((cells[:, 0] + 2**20) << 42) + ((cells[:, 1] + 2**20) << 21) + cells[:, 2] + 2**20


def names_of(numbers):
    """The three of it."""
    return np.stack([numbers >> 42, numbers >> 21 & 2**21 - 1, numbers & 2**21 - 1], axis=1) - 2**20


def leaves(scene, sonar, size):
    """Centres, normals and strengths of the cubes of an even grid that surfaces go through, by points on them."""
    centres, normals, strengths = [], [], []
    spacing = 0.5 * size
    for triangle, normal, mu in zip(scene.triangles, scene.normal, scene.mu):
        for part in parts_near(triangle, sonar, 1.0):
            # Barycentric points no farther apart than the spacing.
            longest = max(np.linalg.norm(part[i] - part[j]) for i, j in ((0, 1), (1, 2), (2, 0)))
            n = int(np.ceil(longest / spacing)) + 1
            i, j = np.divmod(np.arange((n + 1) ** 2), n + 1)
            i, j = i[i + j <= n] / n, j[i + j <= n] / n
            points = part[0] + i[:, None] * (part[1] - part[0]) + j[:, None] * (part[2] - part[0])
            cells = names_of(np.unique(named(np.floor(points / size).astype(np.int64))))
            centres.append(cells)
            normals.append(np.broadcast_to(normal, cells.shape))
            strengths.append(np.full(len(cells), mu))
    cells = np.concatenate(centres)
    _, first = np.unique(named(cells), return_index=True)  # whichever surface was there first
    first.sort()
    return (cells[first] + 0.5) * size, np.concatenate(normals)[first], np.concatenate(strengths)[first]


def parts_near(triangle, sonar, longest):
    """The triangle in parts no longer than that, without those that the sonar cannot reach."""
    waiting = [triangle]
    while waiting:
        part = waiting.pop()
        middle = part.mean(axis=0)
        radius = np.linalg.norm(part - middle, axis=1).max()
        distance, azimuth, _ = sonar.seen_from_here(middle[None])
        if distance[0] - radius > sonar.edges[-1]:
            continue
        if distance[0] > radius and abs(azimuth[0]) > sonar.half_fan + np.arcsin(min(1, radius / distance[0])) + 0.1:
            continue
        sides = [np.linalg.norm(part[i] - part[(i + 1) % 3]) for i in range(3)]
        if max(sides) <= longest:
            yield part
            continue
        k = int(np.argmax(sides))
        a, b, c = part[k], part[(k + 1) % 3], part[(k + 2) % 3]
        half = (a + b) / 2
        waiting += [np.array([a, half, c]), np.array([half, b, c])]


def lit(sonar, ranges, azimuth, elevation, epsilon):
    """Which leaves belong to the first cluster of their bin of azimuth and elevation."""
    rows = int(np.ceil(10 * np.degrees(sonar.height)))
    column = np.floor((azimuth + sonar.half_fan) / sonar.width).astype(int)
    row = np.floor((elevation + sonar.height / 2) / sonar.height * rows).astype(int)
    cell = column * rows + row
    order = np.lexsort((ranges, cell))
    new = np.diff(cell[order], prepend=-1) != 0
    gap = (np.diff(ranges[order], prepend=0) > epsilon) & ~new
    behind = np.cumsum(gap)
    # Gaps since the bin's first leaf.
    start = np.maximum.accumulate(np.where(new, np.arange(len(order)), 0))
    first = np.empty(len(order), bool)
    first[order] = behind - behind[start] == 0
    return first


def render(scene, sonar, path, tools, size=None, frames=FRAMES, add=ADD_SIGMA, multiply=MULTIPLY_SIGMA):
    size = size or OCTREE_MIN
    places, normals, strengths = leaves(scene, sonar, size)
    ranges, azimuth, elevation = sonar.seen_from_here(places)
    # Leaves nearer than the picture are not looked for.
    there = ((ranges >= sonar.edges[0]) & (ranges < sonar.edges[-1]) & (np.abs(azimuth) < sonar.half_fan)
             & (np.abs(elevation) < sonar.height / 2))
    places, normals, strengths = places[there], normals[there], strengths[there]
    ranges, azimuth, elevation = ranges[there], azimuth[there], elevation[there]
    cosine = (normals * (sonar.apex - places)).sum(axis=1) / ranges
    facing = cosine > 0
    ranges, azimuth, elevation, cosine, strengths = (x[facing] for x in (ranges, azimuth, elevation, cosine, strengths))
    seen = lit(sonar, ranges, azimuth, elevation, 4 * size)
    beam = np.floor((azimuth + sonar.half_fan) / sonar.width).astype(int)
    mean = sonar.mean(beam[seen], sonar.bin_of(ranges[seen]), (strengths * cosine)[seen]).T
    random = np.random.default_rng(1)
    noisy = [mean * (1 + multiply * random.standard_normal(mean.shape)) + add * random.rayleigh(size=mean.shape)
             for _ in range(frames)]
    np.save(path, np.maximum(0, noisy).astype(np.float32))


def declared(sonar):
    return ["--profile", "holoocean"]


def recipe(scene, sonar):
    return [{"step": "mean", "least_share": 0.5}, {"step": "range-law", "exponent": 2, "absorption_db_per_km": scene.absorption_db_per_km}]


def known(scene, sonar, truth):
    # A flat bed at a height of whole leaves is taken for the leaf above it, whose middle is half a leaf higher.
    flat = scene.triangles[np.abs(scene.normal[:, 2]) > 0.999]
    bed = flat[np.abs(flat[:, :, 2] / OCTREE_MIN - np.rint(flat[:, :, 2] / OCTREE_MIN)).max(axis=1) < 1e-6]
    result = [near_shadow(scene, sonar, truth)]
    if len(bed):
        lowest = -sonar.directions(0.0, -sonar.height / 2)[2]
        moved = -OCTREE_MIN / 2 / lowest / sonar.step
        result.append(Known("sample-shift", float(moved), "samples", "the seabed is half a leaf too high: its near edge moves by this distance, "
                            "objects by less, and ends of shadows in the opposite direction", within=1.0))
    result += [Known("range-scale", None, "of the range", "second effect of the same cause", may=True),
               Known("scalloped-edge", float(OCTREE_MIN * np.cos(sonar.height) / sonar.step), "samples",
                     "the near edge of the seabed follows rows of leaves", may=True, within=1.0),
               Known("blur", None, "bins", "leaves are displaced by up to half a leaf", may=True),
               Known("shadow-sides", 0.5, "beams", "one leaf in a bin of azimuth and elevation hides the whole bin behind it", may=True)]
    return result
