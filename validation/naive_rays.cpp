// SPDX-License-Identifier: GPL-3.0-or-later
// Embree in the simplest use by a ray engine, and its errors compared with exact visibility. The expected
// sampling error comes from several draws of points on the exact result.
#include "validation/naive_rays.hpp"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <stdexcept>

#include "engine/rays/embree.hpp"

namespace tubefoot::atlas {
namespace {

/// Sum over facets of |share of the points - exact area|.
double error_of_counts(const std::vector<FacetId>& facets, const Areas& truth) {
  std::map<FacetId, double> shares;
  for (const FacetId f : facets)
    if (f < several_there) shares[f] += 1.0 / double(facets.size());
  for (const auto& [facet, area] : truth) shares[facet] -= area.convert_to<double>();
  double sum = 0;
  for (const auto& [facet, difference] : shares) sum += std::abs(difference);
  return sum;
}

constexpr std::uint64_t first_seed = 20240501;

}  // namespace

struct NaiveRays::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  float apex[3];

  ~State() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
  void check(const char* what) const {
    if (const RTCError code = rtcGetDeviceError(device); code != RTC_ERROR_NONE)
      throw std::runtime_error(fmt::format("Embree failed while {} (error {})", what, int(code)));
  }
};

NaiveRays::NaiveRays(const Case& scene, Flags flags) : state_(std::make_unique<State>()) {
  state_->device = rtcNewDevice(nullptr);
  state_->check("starting");
  state_->scene = rtcNewScene(state_->device);
  rtcSetSceneFlags(state_->scene, flags == Flags::robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  RTCGeometry geometry = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), scene.mesh.vertices.size()));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), scene.mesh.facets.size()));
  state_->check("copying the facets");
  const double unit = std::ldexp(1.0, -scene.grid_exponent);
  const auto put = [&](float* out, GridPoint p) {
    out[0] = static_cast<float>(scene.origin_m.x + p.x * unit);
    out[1] = static_cast<float>(scene.origin_m.y + p.y * unit);
    out[2] = static_cast<float>(scene.origin_m.z + p.z * unit);
  };
  for (std::size_t v = 0; v < scene.mesh.vertices.size(); ++v) put(vertices + 3 * v, scene.mesh.vertices[v]);
  for (const auto& facet : scene.mesh.facets)
    for (const VertexId v : facet) *indices++ = v;
  put(state_->apex, scene.tubes.apex);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(state_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(state_->scene);
  state_->check("building its tree");
}

NaiveRays::~NaiveRays() = default;

FacetId NaiveRays::first_hit(glm::dvec3 direction) const {
  const glm::dvec3 d = glm::normalize(direction);
  RTCRayHit ray{};
  ray.ray.org_x = state_->apex[0];
  ray.ray.org_y = state_->apex[1];
  ray.ray.org_z = state_->apex[2];
  ray.ray.dir_x = static_cast<float>(d.x);
  ray.ray.dir_y = static_cast<float>(d.y);
  ray.ray.dir_z = static_cast<float>(d.z);
  ray.ray.tfar = std::numeric_limits<float>::infinity();
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  tubefoot::first_hit(state_->scene, ray);
  return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? nothing_there : ray.hit.primID;
}

std::vector<glm::dvec2> stratified(std::uint32_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto number = [&] { return double(random() >> 11) * 0x1p-53; };
  std::vector<glm::dvec2> points;
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const double u = (i + number()) / n;
      points.emplace_back(u, (j + number()) / n);
    }
  return points;
}

Sampling sampling_error(const CommonVisibility& truth, std::uint32_t n) {
  constexpr int draws = 8;
  double sum = 0, squares = 0;
  for (int draw = 1; draw <= draws; ++draw) {
    double error = 0;
    for (std::size_t t = 0; t < truth.tubes.size(); ++t) {
      const auto points = stratified(n, first_seed + 1000u * static_cast<unsigned>(draw) + t);
      error += error_of_counts(locate(truth.tubes[t].polygons, points, n), truth.tubes[t].areas);
    }
    error /= double(truth.tubes.size());
    sum += error;
    squares += error * error;
  }
  const double mean = sum / draws;
  return {n, mean, std::sqrt(std::max(0.0, squares / draws - mean * mean) * draws / (draws - 1))};
}

RayResult shoot(const Case& scene, const CommonVisibility& truth, NaiveRays::Flags flags, std::uint32_t n) {
  const NaiveRays rays(scene, flags);
  RayResult result;
  for (std::uint32_t t = 0; t < truth.tubes.size(); ++t) {
    const Chart chart(scene.tubes, t);
    const auto points = stratified(n, first_seed + t);
    const auto exact = locate(truth.tubes[t].polygons, points, n);
    std::vector<FacetId> met;
    for (const glm::dvec2 p : points) met.push_back(rays.first_hit(chart.direction(p)));
    for (std::size_t k = 0; k < met.size(); ++k) result.wrong += met[k] != exact[k];
    result.rays += met.size();
    result.error += error_of_counts(met, truth.tubes[t].areas) / double(truth.tubes.size());
  }
  return result;
}

bool fails(const RayResult& result, const Sampling& sampling) {
  return result.error > sampling.mean + 5 * sampling.deviation || result.wrong > 25;
}

}  // namespace tubefoot::atlas
