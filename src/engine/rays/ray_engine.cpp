// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_engine.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <string>

#include "engine/rays/embree.hpp"
#include "geometry/numbers/int128.hpp"
#include "geometry/steps/steps.hpp"

namespace tubefoot {
namespace {

/// A facet's plane: normal . x = distance, metres from the grid's origin; the normal has unit length, or is 0
/// for a facet of no area. Rounded from the exact integers.
struct RayPlane {
  glm::dvec3 normal;
  double distance_m;
};

RayPlane plane_of(const FacetMesh& mesh, FacetId facet, double unit_m) {
  const auto& [a, b, c] = mesh.facets[facet];
  const GridPoint &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
  const Int128 qx = Int128(q.x) - p.x, qy = Int128(q.y) - p.y, qz = Int128(q.z) - p.z;
  const Int128 rx = Int128(r.x) - p.x, ry = Int128(r.y) - p.y, rz = Int128(r.z) - p.z;
  const Int128 nx = qy * rz - qz * ry, ny = qz * rx - qx * rz, nz = qx * ry - qy * rx;
  if (nx == 0 && ny == 0 && nz == 0) return {glm::dvec3(0), 0};
  const glm::dvec3 normal{double(nx), double(ny), double(nz)};
  const double length = glm::length(normal);
  return {normal / length, double(nx * p.x + ny * p.y + nz * p.z) / length * unit_m};
}

/// Whether the apex lies exactly in the plane of a facet, corners relative to the apex in grid units.
bool plane_holds_apex(const std::array<std::array<std::int64_t, 3>, 3>& p) {
  const auto minor = [&](int i, int j) { return Int128(p[1][i]) * p[2][j] - Int128(p[1][j]) * p[2][i]; };
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
  std::vector<RayPlane> planes;

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
    // Embree asks now and then whether to go on.
    rtcSetSceneProgressMonitorFunction(
        scene, [](void*, double) { return !stop_wanted(); }, nullptr);
    rtcCommitScene(scene);
    stop_if_wanted();
    check("building its tree");
  }

  void add_facets() {
    planes.resize(mesh.facets.size());
    for (FacetId facet = 0; facet < planes.size(); ++facet) planes[facet] = plane_of(mesh, facet, unit_m);
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

  /// Traces the rays of a source and appends their hits to `hits`; returns the end.
  RayHit* trace(GridPoint apex, double reach_m, RaySource source, RayHit* hits,
                const RaysOnwards* onwards) const;
  bool on_plane(GridPoint apex, glm::dvec3 direction, double embree_range_m, RayHit& hit) const;
  bool meet_beyond(GridPoint apex, glm::dvec3 direction, double from_m, double reach_m, RayHit& hit) const;
};

namespace {

/// Turns a packet; lanes that leave no window are not valid, the others have its number as their tube.
void send_onwards(const RaysOnwards& onwards, RayPacket& packet, int* valid) {
  for (int k = 0; k < packet.count; ++k) {
    const glm::dvec3 d = onwards.turn * glm::dvec3(packet.x[k], packet.y[k], packet.z[k]);
    packet.x[k] = d.x;
    packet.y[k] = d.y;
    packet.z[k] = d.z;
    valid[k] = 0;
    onwards.windows.find(d, [&](std::uint32_t window) {
      valid[k] = -1;
      packet.tube[k] = window;
    });
  }
}

}  // namespace

RayHit* RayScene::State::trace(GridPoint apex, double reach_m, RaySource source, RayHit* hits,
                               const RaysOnwards* onwards) const {
  constexpr int lanes = RayPacket::size;
  alignas(64) int valid[lanes];
  RTCRayHit16 rays;
  std::fill_n(rays.ray.org_x, lanes, float(apex.x * unit_m));
  std::fill_n(rays.ray.org_y, lanes, float(apex.y * unit_m));
  std::fill_n(rays.ray.org_z, lanes, float(apex.z * unit_m));
  std::fill_n(rays.ray.tnear, lanes, 0.0f);
  std::fill_n(rays.ray.time, lanes, 0.0f);
  std::fill_n(rays.ray.mask, lanes, ~0u);
  std::fill_n(rays.ray.id, lanes, 0u);
  std::fill_n(rays.ray.flags, lanes, 0u);
  std::fill_n(rays.hit.instID[0], lanes, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(valid, lanes, -1);

  RayPacket packet;
  packet.x = packet.y = packet.z = {};
  while (source.next(packet)) {
    if (packet.count < lanes) std::fill_n(valid + packet.count, lanes - packet.count, 0);
    if (onwards != nullptr) send_onwards(*onwards, packet, valid);
    for (int k = 0; k < lanes; ++k) {
      rays.ray.dir_x[k] = float(packet.x[k]);
      rays.ray.dir_y[k] = float(packet.y[k]);
      rays.ray.dir_z[k] = float(packet.z[k]);
      rays.ray.tfar[k] = float(reach_m);
      rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    }
    first_hits(valid, scene, rays);
    for (int k = 0; k < packet.count; ++k) {
      if (rays.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
      const glm::dvec3 direction(packet.x[k], packet.y[k], packet.z[k]);
      hits->facet = rays.hit.primID[k];
      if (!on_plane(apex, direction, double(rays.ray.tfar[k]), *hits) &&
          !meet_beyond(apex, direction, double(rays.ray.tfar[k]), reach_m, *hits))
        continue;
      hits->tube = packet.tube[k];
      hits->solid_angle_sr = packet.weight[k];
      hits->direction = glm::vec3(direction);
      ++hits;
    }
  }
  return hits;
}

/// Range and grazing angle from the facet's plane in double; false if the plane contains the apex.
bool RayScene::State::on_plane(GridPoint apex, glm::dvec3 direction, double embree_range_m,
                               RayHit& hit) const {
  const RayPlane& plane = planes[hit.facet];
  const glm::dvec3 place = unit_m * glm::dvec3(apex.x, apex.y, apex.z);
  const double across = glm::dot(plane.normal, place), offset = plane.distance_m - across;
  const double descent = glm::dot(plane.normal, direction), range = offset / descent;
  hit.slant_range_m = range;
  hit.sine_grazing = std::abs(descent);
  const auto corners = [&] {
    std::array<std::array<std::int64_t, 3>, 3> p{};
    for (int k = 0; k < 3; ++k) {
      const GridPoint& vertex = mesh.vertices[mesh.facets[hit.facet][k]];
      p[k] = {std::int64_t(vertex.x) - apex.x, std::int64_t(vertex.y) - apex.y,
              std::int64_t(vertex.z) - apex.z};
    }
    return p;
  };
  // A hundred times what rounding can do to the offset; beyond, the exact sign is not in doubt.
  if (std::abs(offset) <= 1e-13 * (std::abs(plane.distance_m) + glm::length(place)) &&
      plane_holds_apex(corners()))
    return false;
  // At grazing incidence the ray may meet the plane away from the facet, where Embree's float saw a hit.
  if (hit.sine_grazing < 0.01 || !(std::abs(range - embree_range_m) <= 1e-6 * embree_range_m)) {
    double farthest = 0;
    for (const auto& p : corners())
      farthest = std::max(farthest, unit_m * glm::length(glm::dvec3(p[0], p[1], p[2])));
    hit.slant_range_m =
        range > 0 ? std::clamp(range, std::min(std::abs(offset), farthest), farthest) : embree_range_m;
  }
  return true;
}

/// The first facet beyond one whose plane contains the apex.
bool RayScene::State::meet_beyond(GridPoint apex, glm::dvec3 direction, double from_m, double reach_m,
                                  RayHit& hit) const {
  RTCRayHit ray{};
  ray.ray.org_x = float(apex.x * unit_m);
  ray.ray.org_y = float(apex.y * unit_m);
  ray.ray.org_z = float(apex.z * unit_m);
  ray.ray.dir_x = float(direction.x);
  ray.ray.dir_y = float(direction.y);
  ray.ray.dir_z = float(direction.z);
  ray.ray.mask = ~0u;
  ray.ray.tfar = float(from_m);
  do {
    ray.ray.tnear = std::nextafter(ray.ray.tfar, std::numeric_limits<float>::infinity());
    ray.ray.tfar = float(reach_m);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.primID = RTC_INVALID_GEOMETRY_ID;
    first_hit(scene, ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit.facet = ray.hit.primID;
  } while (!on_plane(apex, direction, double(ray.ray.tfar), hit));
  return true;
}

const FacetMesh& RayScene::mesh() const { return state_->mesh; }

bool RayScene::reaches(GridPoint apex, glm::dvec3 direction, double range_m,
                       const std::function<bool(FacetId)>& same) const {
  const State& s = *state_;
  const glm::dvec3 place = s.unit_m * glm::dvec3(apex.x, apex.y, apex.z);
  const double uncertain = 1e-6 * (range_m + glm::length(place));
  RTCRayHit ray{};
  ray.ray.org_x = float(place.x);
  ray.ray.org_y = float(place.y);
  ray.ray.org_z = float(place.z);
  ray.ray.dir_x = float(direction.x);
  ray.ray.dir_y = float(direction.y);
  ray.ray.dir_z = float(direction.z);
  ray.ray.mask = ~0u;
  for (;;) {
    ray.ray.tfar = float(1.001 * range_m + uncertain);  // where the facet is met, even at a grazing angle
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.primID = RTC_INVALID_GEOMETRY_ID;
    first_hit(s.scene, ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    const double met = double(ray.ray.tfar);
    if (same(ray.hit.primID) || std::abs(met - range_m) <= uncertain) return true;
    if (met > range_m) return false;
    RayHit hit;
    hit.facet = ray.hit.primID;
    if (s.on_plane(apex, direction, met, hit)) return false;
    ray.ray.tnear = std::nextafter(ray.ray.tfar, std::numeric_limits<float>::infinity());
  }
}

RayScene::RayScene(const FacetMesh& mesh, const WorldGrid& grid)
    : state_(std::make_unique<State>(mesh, grid)) {
  state_->build();
}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

void trace_rays(const RayScene& scene, const RayPlan& plan, std::int64_t first, std::int64_t end,
                History& history, const RaysOnwards* onwards) {
  const std::int64_t chunk = plan.rays_at_a_time();  // a task
  const TubeSet& tubes = history.tubes;
  const double reach_m = tubes.reach * history.grid_unit_m;
  const std::int64_t rays = end - first, chunks = (rays + chunk - 1) / chunk;
  history.hits.resize(std::size_t(rays));
  RayHit* const hits = history.hits.data();
  std::vector<RayHit*> ends(static_cast<std::size_t>(chunks));
  tbb::parallel_for(std::int64_t{0}, chunks, [&](std::int64_t c) {
    stop_if_wanted();
    const std::int64_t begin = c * chunk;
    ends[c] = scene.state_->trace(onwards != nullptr ? onwards->apex : tubes.apex, reach_m,
                                  RaySource(plan, first + begin, first + std::min(begin + chunk, rays)),
                                  hits + begin, onwards);
  });
  RayHit* last = hits;
  for (std::int64_t c = 0; c < chunks; ++c) {
    RayHit* const begin = hits + c * chunk;
    last = last == begin ? ends[c] : std::move(begin, ends[c], last);
  }
  history.hits.resize(std::size_t(last - hits));
}

void trace_rays(const RayScene& scene, History& history, const RaySettings& settings,
                std::span<const std::uint32_t> beam_of_tube, const std::function<void()>& take,
                const RaysOnwards* onwards) {
  constexpr std::int64_t portion = std::int64_t{1} << 18;
  const RayPlan plan(history.tubes, settings, beam_of_tube);
  Steps steps("portions of rays", std::size_t((plan.rays() + portion - 1) / portion));
  for (std::int64_t first = 0; first < plan.rays(); first += portion) {
    trace_rays(scene, plan, first, std::min(first + portion, plan.rays()), history, onwards);
    take();
    steps.done();
  }
}

History trace_rays(const RayScene& scene, TubeSet tubes, double grid_unit_m, const RaySettings& settings,
                   std::span<const std::uint32_t> beam_of_tube) {
  History history;
  history.tubes = std::move(tubes);
  history.grid_unit_m = grid_unit_m;
  const RayPlan plan(history.tubes, settings, beam_of_tube);
  trace_rays(scene, plan, 0, plan.rays(), history);
  return history;
}

}  // namespace tubefoot
