// SPDX-License-Identifier: GPL-3.0-or-later
#include "pure_embree.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "engine/rays/embree.hpp"

using namespace tubefoot;

struct PureEmbree::State {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  float apex[3];
  std::vector<float> x, y, z;
};

PureEmbree::PureEmbree(const FacetMesh& mesh, const TubeSet& tubes, double unit_m, int side)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST);  // as in the ray engine
  RTCGeometry geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.facets.size()));
  for (const GridPoint& p : mesh.vertices)
    for (const std::int32_t coordinate : {p.x, p.y, p.z}) *vertices++ = float(coordinate * unit_m);
  for (const auto& facet : mesh.facets) indices = std::copy(facet.begin(), facet.end(), indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(s.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(s.scene);

  const GridPoint& apex = tubes.apex;
  s.apex[0] = float(apex.x * unit_m);
  s.apex[1] = float(apex.y * unit_m);
  s.apex[2] = float(apex.z * unit_m);
  glm::dvec3 corner[4];
  for (int k = 0; k < 4; ++k) {
    const GridPoint& ray = tubes.rays[tubes.tubes[0][k]];
    corner[k] = glm::normalize(glm::dvec3(ray.x, ray.y, ray.z));
  }
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> jitter;
  for (int block = 0; block < side * side / 16; ++block)
    for (int k = 0; k < 16; ++k) {
      const double u = (block % (side / 4) * 4 + k % 4 + jitter(random)) / side;
      const double v = (block / (side / 4) * 4 + k / 4 + jitter(random)) / side;
      const glm::dvec3 d = glm::normalize((1 - v) * ((1 - u) * corner[0] + u * corner[1]) +
                                          v * ((1 - u) * corner[3] + u * corner[2]));
      s.x.push_back(float(d.x));
      s.y.push_back(float(d.y));
      s.z.push_back(float(d.z));
    }
}

PureEmbree::~PureEmbree() {
  rtcReleaseScene(state_->scene);
  rtcReleaseDevice(state_->device);
}

long PureEmbree::trace() const {
  const State& s = *state_;
  alignas(64) int valid[16];
  RTCRayHit16 rays{};
  std::fill_n(valid, 16, -1);
  std::fill_n(rays.ray.org_x, 16, s.apex[0]);
  std::fill_n(rays.ray.org_y, 16, s.apex[1]);
  std::fill_n(rays.ray.org_z, 16, s.apex[2]);
  std::fill_n(rays.ray.mask, 16, ~0u);
  std::fill_n(rays.hit.instID[0], 16, RTC_INVALID_GEOMETRY_ID);
  long hits = 0;
  for (std::size_t first = 0; first < s.x.size(); first += 16) {
    std::copy_n(&s.x[first], 16, rays.ray.dir_x);
    std::copy_n(&s.y[first], 16, rays.ray.dir_y);
    std::copy_n(&s.z[first], 16, rays.ray.dir_z);
    std::fill_n(rays.ray.tfar, 16, 1e9f);
    std::fill_n(rays.hit.geomID, 16, RTC_INVALID_GEOMETRY_ID);
    first_hits(valid, s.scene, rays);
    hits += std::count_if(rays.hit.geomID, rays.hit.geomID + 16,
                          [](unsigned id) { return id != RTC_INVALID_GEOMETRY_ID; });
  }
  return hits;
}
