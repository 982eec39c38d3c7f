// SPDX-License-Identifier: GPL-3.0-or-later
// Embree in the simplest use by a ray engine, for validation/engines/embree_hurry.py (ctypes): float
// coordinates as given, rays that start at the sonar, first hit only.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "engine/rays/embree.hpp"

namespace {

constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();

}  // namespace

/// Finds the first hits. `corners` has nine floats per triangle and `directions` three per ray. Writes the
/// distance of each ray, in lengths of its direction, and its triangle. Without a hit, they are infinity
/// and 2^32 - 1. Returns 0 or the error of Embree.
extern "C" int hurried_first_hits(const float* corners, std::size_t triangles, const float* apex,
                                  const float* directions, std::size_t rays, float* distances,
                                  std::uint32_t* hits) {
  RTCDevice device = rtcNewDevice(nullptr);
  if (!device) return rtcGetDeviceError(nullptr);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * triangles));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles));
  if (vertices && indices) {
    std::copy_n(corners, 9 * triangles, vertices);
    for (std::size_t k = 0; k < 3 * triangles; ++k) indices[k] = static_cast<std::uint32_t>(k);
    rtcCommitGeometry(geometry);
    RTCScene scene = rtcNewScene(device);
    rtcAttachGeometry(scene, geometry);
    rtcCommitScene(scene);
    for (std::size_t k = 0; k < rays; ++k) {
      RTCRayHit ray{};
      ray.ray.org_x = apex[0];
      ray.ray.org_y = apex[1];
      ray.ray.org_z = apex[2];
      ray.ray.dir_x = directions[3 * k];
      ray.ray.dir_y = directions[3 * k + 1];
      ray.ray.dir_z = directions[3 * k + 2];
      ray.ray.tfar = std::numeric_limits<float>::infinity();
      ray.ray.mask = nothing;
      ray.hit.geomID = ray.hit.primID = RTC_INVALID_GEOMETRY_ID;
      tubefoot::first_hit(scene, ray);
      const bool met = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
      distances[k] = met ? ray.ray.tfar : std::numeric_limits<float>::infinity();
      hits[k] = met ? ray.hit.primID : nothing;
    }
    rtcReleaseScene(scene);
  }
  rtcReleaseGeometry(geometry);
  const int error = rtcGetDeviceError(device);
  rtcReleaseDevice(device);
  return error;
}
