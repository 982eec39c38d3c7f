// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the random scenes of the proofs. All coordinates come from integers, so that a seed gives the same
// scenes on each machine.

#include "prove/small_scenes.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "geometry/numbers/int128.hpp"

namespace tubefoot::prove {
namespace {

constexpr std::int32_t range_end = 1 << WorldGrid::coordinate_bits;

GridPoint sum(GridPoint a, GridPoint b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
GridPoint times(std::int32_t s, GridPoint a) { return {s * a.x, s * a.y, s * a.z}; }

// No call or product contains two draws, because the compiler chooses the order of its operands. (In braces
// the order is from left to right.)

/// Returns s a + t b for s and t drawn from the ranges.
GridPoint combination(Random& random, std::int32_t s_from, std::int32_t s_to, GridPoint a,
                      std::int32_t t_from, std::int32_t t_to, GridPoint b) {
  const std::int32_t s = random.between(s_from, s_to), t = random.between(t_from, t_to);
  return sum(times(s, a), times(t, b));
}

/// Returns a point of a box about `centre`.
GridPoint near(Random& random, GridPoint centre, std::int32_t spread) {
  return sum(centre, {random.between(-spread, spread), random.between(-spread, spread),
                      random.between(-spread, spread)});
}

/// Adds facets of random points, some of which share vertices with earlier facets.
void add_random_triangles(Random& random, FacetMesh& mesh, int count, GridPoint centre, std::int32_t spread) {
  for (int k = 0; k < count; ++k) {
    std::array<VertexId, 3> v{};
    for (VertexId& id : v)
      id = !mesh.vertices.empty() && random.one_in(3)
               ? static_cast<VertexId>(random.index(mesh.vertices.size()))
               : add_vertex(mesh, near(random, centre, spread));
    add_facet(mesh, v[0], v[1], v[2]);
  }
}

// ---- Tubes

int orientation(GridPoint a, GridPoint b, GridPoint c) {
  return sign((Int128(a.y) * b.z - Int128(a.z) * b.y) * c.x + (Int128(a.z) * b.x - Int128(a.x) * b.z) * c.y +
              (Int128(a.x) * b.y - Int128(a.y) * b.x) * c.z);
}

bool is_pyramid(const TubeSet& set, const Tube& tube) {
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t other = 2; other < 4; ++other)
      if (orientation(set.rays[tube[k]], set.rays[tube[(k + 1) % 4]], set.rays[tube[(k + other) % 4]]) <= 0)
        return false;
  return true;
}

/// Returns cells x cells tubes between the rays through first + (i step_x, 0, j step_z), each displaced by
/// up to `jitter`. If the jitter folds a tube, it is drawn again with less jitter. With `jitter` 0 the rays
/// lie in common planes.
TubeSet lattice_tubes(Random& random, GridPoint first, std::int32_t step_x, std::int32_t step_z,
                      std::int32_t jitter = 0, std::int32_t cells = 2) {
  TubeSet set;
  set.reach = 1e12;
  const std::int32_t points = cells + 1;
  const auto at = [&](std::int64_t i, std::int64_t j) -> GridPoint {  // i step_x alone may be 2^31
    return {static_cast<std::int32_t>(first.x + i * step_x), first.y,
            static_cast<std::int32_t>(first.z + j * step_z)};
  };
  for (std::int32_t j = 0; j < cells; ++j)
    for (std::int32_t i = 0; i < cells; ++i) {
      const auto a = static_cast<std::uint32_t>(j * points + i), b = a + static_cast<std::uint32_t>(points);
      set.tubes.push_back({a, b, b + 1, a + 1});
    }
  for (;; jitter /= 2) {
    set.rays.clear();
    for (std::int32_t j = 0; j < points; ++j)
      for (std::int32_t i = 0; i < points; ++i) set.rays.push_back(near(random, at(i, j), jitter));
    if (std::all_of(set.tubes.begin(), set.tubes.end(), [&](const Tube& t) { return is_pyramid(set, t); }))
      return set;
  }
}

/// Tubes about (0, distance, 0) that extend by `half` to each side.
TubeSet centred_tubes(Random& random, std::int32_t distance, std::int32_t half, std::int32_t jitter = 0) {
  return lattice_tubes(random, {-half, distance, -half}, half, half, jitter);
}

// ---- Kinds

SmallScene random_triangles(Random& random) {
  SmallScene scene;
  const std::int32_t distance = 1 << random.between(6, 28);
  add_random_triangles(random, scene.mesh, random.between(3, 8), {0, distance, 0}, distance / 2);
  scene.tubes = centred_tubes(random, distance, distance / 3, distance / 8);
  return scene;
}

SmallScene tiny_lattice(Random& random) {
  SmallScene scene;
  add_random_triangles(random, scene.mesh, random.between(3, 8), {0, 4, 0}, 3);
  scene.tubes = centred_tubes(random, random.between(2, 4), 1);
  return scene;
}

SmallScene all_round(Random& random) {
  SmallScene scene;
  const std::int32_t size = random.one_in(3) ? 2 : 1 << random.between(4, 28);
  add_random_triangles(random, scene.mesh, random.between(3, 8), {0, 0, 0}, size);
  scene.tubes = random.one_in(2) ? centred_tubes(random, 1, random.between(1, 6))
                                 : centred_tubes(random, 1000, random.between(1000, 9000), 500);
  return scene;
}

SmallScene on_walls(Random& random) {
  SmallScene scene;
  const std::int32_t size = 1 << random.between(2, 12);
  scene.tubes = centred_tubes(random, size, size / 2, random.one_in(2) ? size / 8 : 0);
  const auto multiple = [&] { return random.between(1, 64); };
  for (int k = random.between(3, 6); k > 0; --k) {
    const Tube& tube = scene.tubes.tubes[random.index(tubes_per_scene)];
    std::array<GridPoint, 3> p{};
    // two of three vertices lie in this wall, so that it contains an edge
    const std::size_t wall = random.index(4);
    for (GridPoint& point : p) {
      const bool in_wall = &point != &p[2];
      const std::size_t w = in_wall && random.one_in(2) ? wall : random.index(4);
      const GridPoint a = scene.tubes.rays[tube[w]], b = scene.tubes.rays[tube[(w + 1) % 4]];
      switch (random.between(0, 3)) {
        case 0:
          point = times(multiple(), a);
          break;
        case 1:
          point = near(random, times(multiple(), a), size * 8);
          break;
        default:
          point = combination(random, 1, 64, a, -11, 52, b);
      }
    }
    add_facet(scene.mesh, p[0], p[1], p[2]);
  }
  return scene;
}

SmallScene coincident(Random& random) {
  SmallScene scene = random_triangles(random);
  FacetMesh& mesh = scene.mesh;
  const std::size_t count = mesh.facets.size();
  for (std::size_t f = 0; f < count; ++f)
    for (int copies = random.between(0, 2); copies > 0; --copies) {
      std::array<VertexId, 3> v = mesh.facets[f];
      random.shuffle(v);
      if (random.one_in(2))
        for (VertexId& id : v) id = add_vertex(mesh, GridPoint(mesh.vertices[id]));
      add_facet(mesh, v[0], v[1], v[2]);
    }
  return scene;
}

SmallScene coplanar(Random& random) {
  SmallScene scene;
  const std::int32_t scale = 1 << random.between(0, 22);
  for (int plane = random.between(1, 2); plane > 0; --plane) {
    const GridPoint origin{random.between(-1, 1) * scale, random.between(4, 9) * scale,
                           random.between(-1, 1) * scale},
        u{random.between(1, 2) * scale, random.between(-1, 1) * scale, 0},
        v{random.between(-1, 1) * scale, random.between(-1, 1) * scale, random.between(1, 2) * scale};
    const auto any = [&] { return sum(origin, combination(random, -2, 2, u, -2, 2, v)); };
    for (int k = random.between(2, 5); k > 0; --k) {
      const GridPoint a = any(), b = any(), c = any();
      add_facet(scene.mesh, a, b, c);
    }
  }
  scene.tubes = centred_tubes(random, 4 * scale, random.between(1, 2) * scale);
  return scene;
}

SmallScene layers(Random& random) {
  SmallScene scene;
  const std::int32_t distance = 1 << random.between(6, 27), size = distance / 2;
  const bool tilted = random.one_in(2);
  const std::int32_t tx = tilted ? random.between(-2, 2) : 0, tz = tilted ? random.between(-2, 2) : 0;
  const int count = random.between(2, 4);
  for (int layer = 0; layer < count; ++layer) {
    // A fan of four facets about a common point. A point moves within its layer, or (rarely) by one unit
    // out of it.
    const auto at = [&](std::int32_t x, std::int32_t z) {
      x += random.between(-size / 4, size / 4);
      z += random.between(-size / 4, size / 4);
      const std::int32_t y = distance + layer + (tx * x + tz * z) / 8 * (tilted ? 1 : 0);
      return add_vertex(scene.mesh, {x, y + (random.one_in(8) ? random.sign() : 0), z});
    };
    const VertexId c = at(0, 0),
                   corner[4] = {at(-size, -size), at(size, -size), at(size, size), at(-size, size)};
    for (int k = 0; k < 4; ++k)
      if (!random.one_in(6)) add_facet(scene.mesh, c, corner[k], corner[(k + 1) % 4]);
  }
  scene.tubes = centred_tubes(random, distance, size / 2, random.one_in(2) ? size / 8 : 0);
  return scene;
}

SmallScene edge_on(Random& random) {
  SmallScene scene;
  const std::int32_t distance = 1 << random.between(3, 24);
  const auto any = [&] { return near(random, {0, distance, 0}, distance / 2); };
  for (int k = random.between(2, 5); k > 0; --k) {
    const GridPoint a = any(), b = any();
    GridPoint c = combination(random, 0, 3, a, -1, 3, b);  // det(a, b, c) = 0
    if (random.one_in(2)) c = near(random, c, 1);
    add_facet(scene.mesh, a, b, c);
  }
  add_random_triangles(random, scene.mesh, random.between(1, 3), {0, distance * 2, 0}, distance);
  scene.tubes = centred_tubes(random, distance, distance / 3, random.one_in(2) ? distance / 8 : 0);
  return scene;
}

SmallScene apex_touched(Random& random) {
  SmallScene scene;
  const std::int32_t size = random.one_in(3) ? 3 : 1 << random.between(4, 26);
  const GridPoint apex{0, 0, 0};
  for (int k = random.between(1, 4); k > 0; --k) {
    const GridPoint a = near(random, apex, size), b = near(random, apex, size);
    const GridPoint off = random.one_in(3) ? near(random, apex, 1) : apex;  // or it misses by a unit
    switch (random.between(0, 2)) {
      case 0:
        add_facet(scene.mesh, off, a, b);
        break;
      case 1:
        add_facet(scene.mesh, a, sum(times(-random.between(1, 3), a), off), b);
        break;
      default:
        add_facet(scene.mesh, a, b, sum(off, times(-1, sum(a, b))));
    }
  }
  add_random_triangles(random, scene.mesh, random.between(1, 4), {0, size, 0}, size);
  scene.tubes = centred_tubes(random, 2 * size, random.between(1, 4) * size);
  return scene;
}

SmallScene slivers(Random& random) {
  SmallScene scene;
  const std::int32_t length = 1 << random.between(8, 28), distance = length;
  for (int k = random.between(1, 3); k > 0; --k) {
    // From a to c, and points along this line, at most a unit off it: a fan of triangles that share long
    // edges.
    const GridPoint step{random.between(-length, length) / 8, random.between(-length, length) / 16,
                         random.between(-length, length) / 8};
    const GridPoint a = sum({0, distance, 0}, times(-4, step));
    const VertexId from = add_vertex(scene.mesh, a), to = add_vertex(scene.mesh, sum(a, times(8, step)));
    for (int side = random.between(1, 3); side > 0; --side)
      add_facet(scene.mesh, from, to,
                add_vertex(scene.mesh, near(random, sum(a, times(random.between(1, 7), step)), 1)));
  }
  add_random_triangles(random, scene.mesh, random.between(1, 3), {0, distance, 0}, distance / 2);
  const std::int32_t half = std::max(1, distance / random.between(3, 64));
  scene.tubes = centred_tubes(random, distance, half, random.one_in(2) ? distance / 256 : 0);
  return scene;
}

SmallScene t_junctions(Random& random) {
  SmallScene scene;
  FacetMesh& mesh = scene.mesh;
  const std::int32_t step = 4 << random.between(0, 22), distance = 4 * step;
  const std::int32_t tx = random.between(-1, 1), tz = random.between(-1, 1);
  const bool cracked = random.one_in(2);
  const auto at = [&](std::int32_t x4, std::int32_t z4) {  // quarters of a step, in a tilted plane
    GridPoint p{x4 * (step / 4), distance + (tx * x4 + tz * z4) * (step / 4), z4 * (step / 4)};
    if (cracked && random.one_in(6)) p.y += random.sign();
    return add_vertex(mesh, p);
  };
  for (std::int32_t i = -1; i < 1; ++i) {  // columns whose rows start at different heights
    const std::int32_t shift = random.between(0, 3);
    const std::int32_t x0 = 4 * i, x1 = x0 + 4;
    VertexId left = at(x0, shift - 6), right = at(x1, shift - 6);
    for (std::int32_t j = -1; j < 2; ++j) {
      const VertexId up_left = at(x0, 4 * j + shift), up_right = at(x1, 4 * j + shift);
      add_facet(mesh, left, right, up_right);
      add_facet(mesh, left, up_right, up_left);
      left = up_left;
      right = up_right;
    }
  }
  scene.tubes = centred_tubes(random, distance, step / 4 * random.between(1, 6));
  return scene;
}

SmallScene range_ends(Random& random) {
  SmallScene scene;
  const auto coordinate = [&]() -> std::int32_t {
    const int sign = random.sign();
    switch (random.between(0, 4)) {
      case 0:
        return sign * range_end;
      case 1:
        return sign * (range_end - random.between(0, 2));
      case 2:
        return random.between(-(1 << 25), 1 << 25);
      default:
        return random.between(-range_end, range_end);
    }
  };
  const auto forward = [&] { return random.one_in(3) ? range_end : random.between(1 << 25, range_end); };
  for (int k = random.between(2, 6); k > 0; --k) {
    const auto any = [&] {
      return GridPoint{coordinate(), random.one_in(5) ? coordinate() : forward(), coordinate()};
    };
    const GridPoint a = any(), b = any(), c = any();
    add_facet(scene.mesh, a, b, c);
  }
  // Even coordinates, so that two rays of full length have a ray half way between them.
  const std::int32_t half = random.one_in(2) ? range_end : 2 * random.between(1 << 24, 1 << 29);
  scene.tubes =
      centred_tubes(random, random.one_in(2) ? range_end : 2 * random.between(1 << 24, 1 << 29), half);
  return scene;
}

SmallScene solids(Random& random) {
  SmallScene scene;
  FacetMesh& mesh = scene.mesh;
  const std::int32_t scale = random.one_in(2) ? 1 : 1 << random.between(4, 24);
  const GridPoint box{random.between(-1, 1) * scale, 6 * scale, random.between(-1, 1) * scale};
  const std::int32_t half = random.between(1, 2) * scale;
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  for (int k = 0; k < 8; ++k)
    add_vertex(mesh, sum(box, {k & 1 ? half : -half, k & 2 ? half : -half, k & 4 ? half : -half}));
  for (const auto& q : {std::array<VertexId, 4>{0, 1, 3, 2},
                        {4, 5, 7, 6},
                        {0, 1, 5, 4},
                        {2, 3, 7, 6},
                        {0, 2, 6, 4},
                        {1, 3, 7, 5}}) {
    add_facet(mesh, first + q[0], first + q[1], first + q[2]);
    add_facet(mesh, first + q[0], first + q[2], first + q[3]);
  }
  const GridPoint centre = near(random, {0, 6 * scale, 0}, scale * 2);
  const std::int32_t radius = random.between(1, 3) * scale;
  VertexId tip[3][2];
  for (int axis = 0; axis < 3; ++axis)
    for (int end = 0; end < 2; ++end) {
      const std::int32_t r = end ? radius : -radius;
      tip[axis][end] =
          add_vertex(mesh, sum(centre, {axis == 0 ? r : 0, axis == 1 ? r : 0, axis == 2 ? r : 0}));
    }
  for (int k = 0; k < 8; ++k) add_facet(mesh, tip[0][k & 1], tip[1][k >> 1 & 1], tip[2][k >> 2 & 1]);
  const std::int32_t reach = scale * random.between(1, 2);
  scene.tubes = centred_tubes(random, 4 * scale, reach, random.one_in(2) ? scale / 4 : 0);
  return scene;
}

void add_seabed(Random& random, FacetMesh& mesh, int n, std::int32_t cell, std::int32_t height,
                std::int32_t relief) {
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      add_vertex(mesh, {(2 * i - n) * (cell / 2), (j + 1) * cell, height + random.between(-relief, relief)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = first + static_cast<VertexId>(j * (n + 1) + i), b = a + 1,
                 c = a + static_cast<VertexId>(n) + 1, d = c + 1;
      add_facet(mesh, a, b, d);
      add_facet(mesh, a, d, c);
    }
}

SmallScene grazing_terrain(Random& random) {
  SmallScene scene;
  const std::int32_t cell = 1 << random.between(4, 26);
  const std::int32_t height = std::max(1, cell >> random.between(1, 12));
  add_seabed(random, scene.mesh, 2, cell, -height, random.between(1, 2) * height / 2 + 1);
  scene.tubes = lattice_tubes(random, {-cell / 2, cell, -height}, cell / 2, std::max(1, height / 2),
                              random.one_in(2) ? height / 8 : 0);
  return scene;
}

SmallScene needle_tubes(Random& random) {
  SmallScene scene;
  constexpr std::int32_t parts = 64, far = range_end / parts - 1;
  const GridPoint part{random.between(-far, far), far, random.between(-far, far)}, axis = times(parts, part);
  const std::int32_t step = random.between(1, 4);
  scene.tubes = lattice_tubes(random, sum(axis, {-step, 0, -step}), step, step);
  // Facets with an edge through the axis, or a unit from it.
  for (int k = random.between(2, 6); k > 0; --k) {
    const std::int32_t place = random.between(1, parts / 2);
    const GridPoint p = near(random, times(place, part), random.between(0, 1));
    const std::int32_t spread = random.one_in(2) ? 1 << random.between(0, 6) : p.y / 2;
    const GridPoint d = near(random, {0, 0, 0}, spread), e = near(random, p, spread);
    add_facet(scene.mesh, sum(p, d), near(random, sum(p, times(-1, d)), random.between(0, 1)), e);
  }
  return scene;
}

SmallScene pencils(Random& random) {
  SmallScene scene;
  const std::int32_t distance = 1 << random.between(3, 28);
  const GridPoint centre{0, distance, 0};
  const auto any = [&] { return add_vertex(scene.mesh, near(random, centre, distance / 2)); };
  const VertexId a = any(), b = any();
  for (int k = random.between(2, 6); k > 0; --k) add_facet(scene.mesh, a, b, any());
  for (int k = random.between(1, 4); k > 0; --k) {
    const VertexId p = any(), q = any();
    add_facet(scene.mesh, p, a, q);
  }
  scene.tubes = centred_tubes(random, distance, distance / 3, random.one_in(2) ? distance / 16 : 0);
  return scene;
}

constexpr std::array<SmallScene (*)(Random&), generator_names.size()> generators{
    random_triangles, tiny_lattice,    all_round,    on_walls, coincident,  coplanar,
    layers,           edge_on,         apex_touched, slivers,  t_junctions, range_ends,
    solids,           grazing_terrain, needle_tubes, pencils};

/// Gives equal points the same index, as loading does.
void weld(FacetMesh& mesh) {
  for (auto& facet : mesh.facets)
    for (VertexId& v : facet)
      for (VertexId w = 0; w < v; ++w)
        if (mesh.vertices[w] == mesh.vertices[v]) v = w;
}

/// Rotates the scene into one of six directions and moves it with its apex, as far as 32 bits permit.
void place(Random& random, SmallScene& scene) {
  const int turn = random.between(0, 2), sx = random.sign(), sy = random.sign();
  const auto turned = [&](GridPoint p) -> GridPoint {
    p = {sx * p.x, sy * p.y, sx * sy * p.z};  // a rotation, so that tubes keep their orientation
    return turn == 0 ? p : turn == 1 ? GridPoint{p.y, p.z, p.x} : GridPoint{p.z, p.x, p.y};
  };
  for (GridPoint& p : scene.mesh.vertices) p = turned(p);
  for (GridPoint& p : scene.tubes.rays) p = turned(p);
  if (random.one_in(4)) return;
  const GridPoint by = near(random, {0, 0, 0}, range_end - 1);
  scene.tubes.apex = by;
  for (GridPoint& p : scene.mesh.vertices) p = sum(p, by);
}

}  // namespace

SmallScene make_scene(std::uint64_t seed, std::uint64_t index) {
  Random random(seed, index);
  SmallScene scene = generators[index % generators.size()](random);
  weld(scene.mesh);
  place(random, scene);
  return scene;
}

SmallScene make_large_scene(std::uint64_t seed, int n) {
  Random random(seed);
  SmallScene scene;
  constexpr std::int32_t extent = 1 << 26;
  const std::int32_t cell = extent / n;
  add_seabed(random, scene.mesh, n, cell, -extent / 6, cell / 4);
  for (int k = 0; k < 3; ++k) {  // spires that rise from the seabed
    const GridPoint foot{random.between(-extent / 4, extent / 4), random.between(extent / 4, extent / 2),
                         -extent / 5};
    const VertexId tip = add_vertex(scene.mesh, sum(foot, {0, 0, extent / 6})),
                   base[3] = {add_vertex(scene.mesh, sum(foot, {extent / 40, 0, 0})),
                              add_vertex(scene.mesh, sum(foot, {-extent / 50, extent / 60, 0})),
                              add_vertex(scene.mesh, sum(foot, {-extent / 50, -extent / 60, 0}))};
    for (int side = 0; side < 3; ++side) add_facet(scene.mesh, tip, base[side], base[(side + 1) % 3]);
  }
  scene.tubes = lattice_tubes(random, {-extent / 4, extent / 2, -extent / 3}, extent / 10, extent / 10,
                              extent / 100, 5);
  return scene;
}

}  // namespace tubefoot::prove
