// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <string>

#include "engine/rays/ray_tracing.hpp"
#include "geometry/steps/steps.hpp"

// Builds Embree's hierarchy for a mesh and traces packets of rays in it. Hits that rounding may affect are
// computed again, one by one, in double and with exact integers.

namespace tubefoot {
namespace {

/// Embree's text about the last error in this thread. Embree reports errors in the thread that called it.
thread_local std::string message;

void report(void*, RTCError, const char* text) {
  if (text != nullptr) message = text;
}

/// Throws if Embree has recorded an error in this thread since the last call.
void check(RTCDevice device, const char* what) {
  const RTCError code = rtcGetDeviceError(device);
  if (code != RTC_ERROR_NONE)
    throw std::runtime_error(fmt::format("Embree failed while {}: {} (error {})", what,
                                         message.empty() ? "no message" : message, int(code)));
}

/// The one device of all scenes, for the lifetime of the process. A device takes one of the 1024
/// thread-specific keys of a process (PTHREAD_KEYS_MAX). One device per scene would limit the number of
/// simultaneous scenes.
RTCDevice shared_device() {
  static const RTCDevice shared = [] {
    RTCDevice made = rtcNewDevice(nullptr);
    check(made, "starting");
    rtcSetDeviceErrorFunction(made, report, nullptr);
    return made;
  }();
  return shared;
}

/// Requests to stop a build, which any of Embree's threads checks. All builds share these threads, so a
/// thread's own flag may be that of another build.
struct StopOfBuild {
  const std::atomic<bool>* of_caller = stop_requested_of_thread;

  static bool go_on(void* stop, double) {
    const auto* of_caller = static_cast<const StopOfBuild*>(stop)->of_caller;
    return !stop_requested.load(std::memory_order_relaxed) &&
           (of_caller == nullptr || !of_caller->load(std::memory_order_relaxed));
  }
};

}  // namespace

void RayScene::State::build() {
  const RTCDevice device = shared_device();
  message.clear();
  rtcGetDeviceError(device);  // clears an error of a stopped build of this thread
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  if (!mesh.facets.empty()) add_facets(device);
  // Embree calls the monitor from time to time.
  StopOfBuild stop;
  rtcSetSceneProgressMonitorFunction(scene, &StopOfBuild::go_on, &stop);
  rtcCommitScene(scene);
  rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
  stop_if_wanted();
  check(device, "building its tree");
}

void RayScene::State::add_facets(RTCDevice device) {
  planes = RayPlanes(mesh, unit_m);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.facets.size()));
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    check(device, "copying the facets");
    throw std::runtime_error("Embree ran out of memory for the facets");
  }
  for (const GridPoint& p : mesh.vertices)
    for (const std::int32_t coordinate : {p.x, p.y, p.z}) *vertices++ = float(coordinate * unit_m);
  for (const auto& facet : mesh.facets)
    for (const VertexId vertex : facet) *indices++ = vertex;
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

namespace {

/// Turns the directions of a packet. Lanes outside of all apertures become invalid; the other lanes get the
/// number of their aperture as tube.
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

void RayScene::State::trace(GridPoint apex, double reach_m, const std::function<bool(RayPacket&)>& next,
                            HitWriter& hits, const RaysOnwards* onwards) const {
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
  std::uint32_t number = 0;
  for (; next(packet); number += std::uint32_t(packet.count)) {
    if (packet.count != last_count) {
      std::fill_n(valid, lanes, 0);
      std::fill_n(valid, packet.count, -1);
      last_count = packet.count;
    }
    if (onwards != nullptr) send_onwards(*onwards, packet, valid);
    round_directions(packet, rays.ray.dir_x, rays.ray.dir_y, rays.ray.dir_z);
    for (int k = 0; k < lanes; ++k) {
      // Without AVX-512, Embree 3 ignores `valid` in packets of sixteen rays. It skips rays with tfar <
      // tnear.
      rays.ray.tfar[k] = valid[k] != 0 ? float(reach_m) : -1.0f;
      rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    }
    first_hits(valid, scene, rays);
    append_hits(apex, reach_m, packet, rays, number, hits);
  }
}

void RayScene::State::append_hits(GridPoint apex, double reach_m, const RayPacket& packet,
                                  const RTCRayHit16& rays, std::uint32_t number, HitWriter& hits) const {
  constexpr int lanes = RayPacket::size;
  std::array<FacetId, lanes> facet;
  const int some = met_facets(rays.hit.geomID, rays.hit.primID, RTC_INVALID_GEOMETRY_ID, packet.count, facet);
  if (some == 0) return;
  MetPlanes met;
  planes.meet(apex, packet, facet, rays.ray.tfar, met);
  if (some == lanes && met.any_doubtful == 0)
    return write_hits(packet, met, facet, rays.ray.dir_x, rays.ray.dir_y, rays.ray.dir_z,
                      hits.whole_block(number));
  for (int k = 0; k < packet.count; ++k) {
    if (rays.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
    RayHit hit{facet[k],         packet.tube[k],
               met.range_m[k],   met.sine_grazing[k],
               packet.weight[k], {rays.ray.dir_x[k], rays.ray.dir_y[k], rays.ray.dir_z[k]}};
    if (met.doubtful[k] != 0) {
      const glm::dvec3 direction(packet.x[k], packet.y[k], packet.z[k]);
      const auto embree_range = double(rays.ray.tfar[k]);
      if (!planes.meet(apex, direction, embree_range, hit) &&
          !meet_beyond(apex, direction, embree_range, reach_m, hit))
        continue;
    }
    hits.append(number + std::uint32_t(k), hit);
  }
}

/// Finds the first facet beyond one whose plane contains the apex.
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
    ray.ray.tfar = float(1.001 * range_m + uncertain);  // beyond the facet, even at a grazing angle
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

}  // namespace tubefoot
