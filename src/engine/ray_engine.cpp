// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/ray_engine.hpp"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace tubefoot {
namespace {

/// A random number in [0, 1) that depends on its key alone (the finalizer of SplitMix64 over each part of the
/// key).
double uniform(std::uint64_t seed, std::uint64_t tube, std::uint64_t ray, std::uint64_t draw) {
  std::uint64_t state = 0;
  for (const std::uint64_t part : {seed, tube, ray, draw}) {
    state = (state ^ part) + 0x9e3779b97f4a7c15u;
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9u;
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebu;
    state ^= state >> 31;
  }
  return double(state >> 11) * 0x1p-53;
}

/// Solid angle of three directions; the triple product from differences, for the sake of narrow cells.
double solid_angle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double triple = glm::dot(a, glm::cross(b - a, c - a));
  return 2 *
         std::atan2(triple, la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

/// A tube as the cone over the bilinear patch of its corner rays. The patch is ruled both ways, so lines of
/// constant u or v are straight, cells of a (u, v) grid are tubes themselves, and their solid angles are
/// closed forms.
struct Patch {
  std::array<glm::dvec3, 4> corner;

  glm::dvec3 at(double u, double v) const {
    return (1 - v) * ((1 - u) * corner[0] + u * corner[1]) + v * ((1 - u) * corner[3] + u * corner[2]);
  }
  /// x . (dx/du x dx/dv), which is bilinear in u and v; over |x|^3 it is solid angle per du dv.
  double triple(double u, double v) const {
    const glm::dvec3 du = (1 - v) * (corner[1] - corner[0]) + v * (corner[2] - corner[3]);
    const glm::dvec3 dv = (1 - u) * (corner[3] - corner[0]) + u * (corner[2] - corner[1]);
    return glm::dot(at(u, v), glm::cross(du, dv));
  }
};

struct Cell {
  double u0, u1, v0, v1;
};

double solid_angle(const Patch& patch, const Cell& cell) {
  const glm::dvec3 a = patch.at(cell.u0, cell.v0), b = patch.at(cell.u1, cell.v0);
  const glm::dvec3 c = patch.at(cell.u1, cell.v1), d = patch.at(cell.u0, cell.v1);
  return solid_angle(a, b, c) + solid_angle(a, c, d);
}

/// A direction in a cell, uniform in solid angle: drawn uniformly in (u, v) and kept with a probability
/// proportional to the solid angle per du dv, whose largest value in the cell is bounded by its bilinear
/// numerator's at the corners and by |x| >= x . m for any unit m, which is linear along both rulings.
glm::dvec3 draw(const Patch& patch, const Cell& cell, std::uint64_t seed, std::uint64_t tube,
                std::uint64_t ray) {
  const glm::dvec3 middle = glm::normalize(patch.at((cell.u0 + cell.u1) / 2, (cell.v0 + cell.v1) / 2));
  double largest = 0, shortest = std::numeric_limits<double>::infinity();
  for (const double u : {cell.u0, cell.u1})
    for (const double v : {cell.v0, cell.v1}) {
      largest = std::max(largest, patch.triple(u, v));
      shortest = std::min(shortest, glm::dot(patch.at(u, v), middle));
    }
  const double bound = largest / (shortest * shortest * shortest);
  constexpr std::uint64_t patience = 1000;  // never needed: a quarter or more of the draws are kept
  for (std::uint64_t attempt = 0; attempt < patience; ++attempt) {
    const double u = cell.u0 + (cell.u1 - cell.u0) * uniform(seed, tube, ray, 3 * attempt);
    const double v = cell.v0 + (cell.v1 - cell.v0) * uniform(seed, tube, ray, 3 * attempt + 1);
    const glm::dvec3 x = patch.at(u, v);
    const double length = glm::length(x);
    const double density = patch.triple(u, v) / (length * length * length);
    if (uniform(seed, tube, ray, 3 * attempt + 2) * bound <= density) return x / length;
  }
  return middle;
}

/// The rays of one tube: how many, in how many rows.
struct Allotment {
  Patch patch;
  double solid_angle = 0;
  std::int64_t rays = 0, rows = 0;
  std::int64_t row_begin(std::int64_t row) const {
    // row * rays overflows no 64-bit integer for any number of rays that fits memory: rows is its square
    // root.
    return row * rays / rows;
  }
};

std::vector<Allotment> allot(const TubeSet& tubes, std::int64_t rays) {
  std::vector<Allotment> all(tubes.tubes.size());
  double total = 0;
  for (std::size_t t = 0; t < all.size(); ++t) {
    Patch& patch = all[t].patch;
    for (int k = 0; k < 4; ++k) {
      const GridPoint& ray = tubes.rays.at(tubes.tubes[t][k]);
      patch.corner[k] = glm::normalize(glm::dvec3(ray.x, ray.y, ray.z));
    }
    all[t].solid_angle = solid_angle(patch, {0, 1, 0, 1});
    for (const double u : {0.0, 1.0})
      for (const double v : {0.0, 1.0})
        if (!(patch.triple(u, v) >= 0) || !(all[t].solid_angle > 0))
          throw std::invalid_argument(fmt::format(
              "tube {} is not a convex pyramid with a solid angle: no rays can be drawn from it", t));
    total += all[t].solid_angle;
  }
  double before = 0;
  for (Allotment& tube : all) {
    const double after = before + tube.solid_angle;
    // Rounding the running total, not each share, keeps the sum at `rays`.
    const auto share = [&](double sum) { return std::int64_t(std::llround(double(rays) * (sum / total))); };
    tube.rays = rays == 0 ? 0 : std::max<std::int64_t>(share(after) - share(before), 1);
    before = after;
    const auto& c = tube.patch.corner;
    const double width = glm::length(c[1] - c[0]) + glm::length(c[2] - c[3]);
    const double height = glm::length(c[3] - c[0]) + glm::length(c[2] - c[1]);
    const double rows = std::round(std::sqrt(double(tube.rays) * height / width));
    tube.rows = std::int64_t(std::clamp(rows, 1.0, std::max(double(tube.rays), 1.0)));
  }
  return all;
}

/// Whether the apex lies exactly in the plane of a facet, corners relative to the apex in grid units.
bool plane_holds_apex(const std::array<std::array<std::int64_t, 3>, 3>& p) {
  using boost::multiprecision::int128_t;
  const auto minor = [&](int i, int j) { return int128_t(p[1][i]) * p[2][j] - int128_t(p[1][j]) * p[2][i]; };
  return p[0][0] * minor(1, 2) + p[0][1] * minor(2, 0) + p[0][2] * minor(0, 1) == 0;
}

void report(void* message, RTCError, const char* text) {
  if (text != nullptr) *static_cast<std::string*>(message) = text;
}

}  // namespace

struct RayScene::State {
  const FacetMesh& mesh;
  double unit_m;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::string message;

  State(const FacetMesh& facet_mesh, const WorldGrid& grid) : mesh(facet_mesh), unit_m(grid.unit_m()) {}
  ~State() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void check(const char* what) const {
    const RTCError code = rtcGetDeviceError(device);
    if (code != RTC_ERROR_NONE)
      throw std::runtime_error(fmt::format("Embree failed while {}: {} (error {})", what,
                                           message.empty() ? "no message" : message, int(code)));
  }

  void build() {
    device = rtcNewDevice(nullptr);
    check("starting");
    rtcSetDeviceErrorFunction(device, report, &message);
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    if (!mesh.facets.empty()) add_facets();
    rtcCommitScene(scene);
    check("building its tree");
  }

  void add_facets() {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.facets.size()));
    if (vertices == nullptr || indices == nullptr) {
      rtcReleaseGeometry(geometry);
      check("copying the facets");
      throw std::runtime_error("Embree has no memory for the facets");
    }
    for (const GridPoint& p : mesh.vertices)
      for (const std::int32_t coordinate : {p.x, p.y, p.z}) *vertices++ = float(coordinate * unit_m);
    for (const auto& facet : mesh.facets)
      for (const VertexId vertex : facet) *indices++ = vertex;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }

  /// The first facet along a ray, with its range and grazing angle from the facet's plane in double.
  bool meet(GridPoint apex, glm::dvec3 direction, double reach_m, RayHit& hit) const {
    RTCRayHit ray{};
    ray.ray.org_x = float(apex.x * unit_m);
    ray.ray.org_y = float(apex.y * unit_m);
    ray.ray.org_z = float(apex.z * unit_m);
    ray.ray.dir_x = float(direction.x);
    ray.ray.dir_y = float(direction.y);
    ray.ray.dir_z = float(direction.z);
    ray.ray.mask = ~0u;
    while (true) {
      ray.ray.tfar = float(reach_m);
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      ray.hit.primID = RTC_INVALID_GEOMETRY_ID;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcIntersect1(scene, &context, &ray);
      if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
      hit.facet = ray.hit.primID;
      if (on_plane(apex, direction, double(ray.ray.tfar), hit)) return true;
      ray.ray.tnear = std::nextafter(ray.ray.tfar, std::numeric_limits<float>::infinity());
    }
  }

  bool on_plane(GridPoint apex, glm::dvec3 direction, double embree_range, RayHit& hit) const {
    std::array<std::array<std::int64_t, 3>, 3> p{};
    std::array<glm::dvec3, 3> corner;
    double farthest = 0;
    for (int k = 0; k < 3; ++k) {
      const GridPoint& vertex = mesh.vertices[mesh.facets[hit.facet][k]];
      p[k] = {std::int64_t(vertex.x) - apex.x, std::int64_t(vertex.y) - apex.y,
              std::int64_t(vertex.z) - apex.z};
      corner[k] = unit_m * glm::dvec3(double(p[k][0]), double(p[k][1]), double(p[k][2]));
      farthest = std::max(farthest, glm::length(corner[k]));
    }
    if (plane_holds_apex(p)) return false;
    const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double length = glm::length(normal);
    const double descent = glm::dot(normal, direction), offset = glm::dot(normal, corner[0]);
    const double range = offset / descent;
    // At grazing incidence the ray may meet the plane away from the facet, where Embree's float saw a hit.
    hit.slant_range_m =
        range > 0 ? std::clamp(range, std::min(std::abs(offset) / length, farthest), farthest) : embree_range;
    hit.grazing_angle_rad = std::atan2(std::abs(descent), glm::length(glm::cross(normal, direction)));
    return true;
  }
};

RayScene::RayScene(const FacetMesh& mesh, const WorldGrid& grid)
    : state_(std::make_unique<State>(mesh, grid)) {
  state_->build();
}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

History trace_rays(const RayScene& scene, TubeSet tubes, double grid_unit_m, std::int64_t rays,
                   std::uint64_t seed) {
  if (rays < 0)
    throw std::invalid_argument(fmt::format("the number of rays must not be negative, not {}", rays));
  History history;
  history.tubes = std::move(tubes);
  history.grid_unit_m = grid_unit_m;
  const TubeSet& set = history.tubes;
  const std::vector<Allotment> allotments = allot(set, rays);
  const double reach_m = set.reach * grid_unit_m;

  struct Row {
    std::uint32_t tube;
    std::int64_t row;
    std::vector<RayHit> hits;
  };
  std::vector<Row> rows;
  for (std::uint32_t t = 0; t < allotments.size(); ++t)
    for (std::int64_t r = 0; r < (allotments[t].rays > 0 ? allotments[t].rows : 0); ++r)
      rows.push_back({t, r, {}});

  const auto trace = [&](Row& row) {
    const Allotment& tube = allotments[row.tube];
    const std::int64_t begin = tube.row_begin(row.row), end = tube.row_begin(row.row + 1);
    const double v0 = double(begin) / double(tube.rays), v1 = double(end) / double(tube.rays);
    for (std::int64_t ray = begin; ray < end; ++ray) {
      const double cells = double(end - begin);
      const Cell cell{double(ray - begin) / cells, double(ray - begin + 1) / cells, v0, v1};
      const glm::dvec3 direction = draw(tube.patch, cell, seed, row.tube, std::uint64_t(ray));
      RayHit hit;
      hit.tube = row.tube;
      if (!scene.state_->meet(set.apex, direction, reach_m, hit)) continue;
      hit.solid_angle_sr = solid_angle(tube.patch, cell);
      hit.direction = glm::vec3(direction);
      row.hits.push_back(hit);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows.size()),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) trace(rows[i]);
                    });

  for (const Row& row : rows) history.hits.insert(history.hits.end(), row.hits.begin(), row.hits.end());
  return history;
}

}  // namespace tubefoot
