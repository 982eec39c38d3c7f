// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_engine.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>

#include "engine/rays/embree.hpp"
#include "engine/rays/ray_planes.hpp"
#include "geometry/steps/steps.hpp"

namespace tubefoot {
namespace {

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
  RayPlanes planes;

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
    planes = RayPlanes(mesh, unit_m);
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
  RayHit* append_hits(GridPoint apex, double reach_m, const RayPacket& packet, const RTCRayHit16& rays,
                      RayHit* hits) const;
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
  int last_count = lanes;
  while (source.next(packet)) {
    if (packet.count != last_count) {
      std::fill_n(valid, lanes, 0);
      std::fill_n(valid, packet.count, -1);
      last_count = packet.count;
    }
    if (onwards != nullptr) send_onwards(*onwards, packet, valid);
    for (int k = 0; k < lanes; ++k) {
      rays.ray.dir_x[k] = float(packet.x[k]);
      rays.ray.dir_y[k] = float(packet.y[k]);
      rays.ray.dir_z[k] = float(packet.z[k]);
      rays.ray.tfar[k] = float(reach_m);
      rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    }
    first_hits(valid, scene, rays);
    hits = append_hits(apex, reach_m, packet, rays, hits);
  }
  return hits;
}

RayHit* RayScene::State::append_hits(GridPoint apex, double reach_m, const RayPacket& packet,
                                     const RTCRayHit16& rays, RayHit* hits) const {
  constexpr int lanes = RayPacket::size;
  std::array<FacetId, lanes> facet{};
  bool some = false;
  for (int k = 0; k < packet.count; ++k) {
    if (rays.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
    facet[k] = rays.hit.primID[k];
    some = true;
  }
  if (!some) return hits;
  const MetPlanes met = planes.meet(apex, packet, facet, rays.ray.tfar);
  for (int k = 0; k < packet.count; ++k) {
    if (rays.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
    hits->facet = facet[k];
    hits->slant_range_m = met.range_m[k];
    hits->sine_grazing = met.sine_grazing[k];
    if (met.doubtful[k] != 0) {
      const glm::dvec3 direction(packet.x[k], packet.y[k], packet.z[k]);
      const auto embree_range = double(rays.ray.tfar[k]);
      if (!planes.meet(apex, direction, embree_range, *hits) &&
          !meet_beyond(apex, direction, embree_range, reach_m, *hits))
        continue;
    }
    hits->tube = packet.tube[k];
    hits->solid_angle_sr = packet.weight[k];
    hits->direction = {rays.ray.dir_x[k], rays.ray.dir_y[k], rays.ray.dir_z[k]};
    ++hits;
  }
  return hits;
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
  } while (!planes.meet(apex, direction, double(ray.ray.tfar), hit));
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
    if (s.planes.meet(apex, direction, met, hit)) return false;
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

namespace {

/// Hits of chunks of rays, one behind the other in one array. A chunk that begins when those before it are
/// all done writes where its hits belong; others write where they belong if nothing misses, and are moved as
/// soon as those before them are done, while a cache still has them.
class HitsInOrder {
 public:
  HitsInOrder(RayHit* hits, std::int64_t chunk, std::int64_t chunks)
      : hits_(hits), last_(hits), chunk_(chunk), parts_(std::size_t(chunks)) {}

  RayHit* begin(std::int64_t c) {
    const std::lock_guard lock(mutex_);
    return parts_[c].begin = c == next_ ? last_ : hits_ + c * chunk_;
  }
  void end(std::int64_t c, RayHit* end) {
    const std::lock_guard lock(mutex_);
    parts_[c].end = end;
    for (; next_ < std::int64_t(parts_.size()) && parts_[next_].end != nullptr; ++next_) {
      const Part& part = parts_[next_];
      last_ = part.begin == last_ ? part.end : std::move(part.begin, part.end, last_);
    }
  }
  std::size_t count() const { return std::size_t(last_ - hits_); }

 private:
  struct Part {
    RayHit *begin = nullptr, *end = nullptr;
  };
  RayHit *hits_, *last_;
  std::int64_t chunk_, next_ = 0;  // the first that is not done
  std::vector<Part> parts_;
  std::mutex mutex_;
};

}  // namespace

void trace_rays(const RayScene& scene, const RayPlan& plan, std::int64_t first, std::int64_t end,
                History& history, const RaysOnwards* onwards) {
  const std::int64_t chunk = plan.rays_at_a_time();  // a task
  const TubeSet& tubes = history.tubes;
  const double reach_m = tubes.reach * history.grid_unit_m;
  const std::int64_t rays = end - first, chunks = (rays + chunk - 1) / chunk;
  history.hits.resize(std::size_t(rays));
  HitsInOrder in_order(history.hits.data(), chunk, chunks);
  tbb::parallel_for(std::int64_t{0}, chunks, [&](std::int64_t c) {
    stop_if_wanted();
    const std::int64_t begin = c * chunk;
    RayHit* const hits = in_order.begin(c);
    in_order.end(c, scene.state_->trace(onwards != nullptr ? onwards->apex : tubes.apex, reach_m,
                                        RaySource(plan, first + begin, first + std::min(begin + chunk, rays)),
                                        hits, onwards));
  });
  history.hits.resize(in_order.count());
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
