// SPDX-License-Identifier: GPL-3.0-or-later
// An engine of the test computes scenes of the benchmark suite from scene.json and OBJ files alone. It sends
// rays through the pyramids of the beams and tests each triangle.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>

#include "geometry/numbers/scalars.hpp"
#include "suite/answers.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

glm::dvec3 vector_of(const Json& json) { return {json[0], json[1], json[2]}; }

/// The axes of a pose as columns.
glm::dmat3 axes_of(const Json& pose) {
  return {vector_of(pose["starboard"]), vector_of(pose["forward"]), vector_of(pose["up"])};
}

struct ScatteringTriangle {
  glm::dvec3 a, e1, e2, normal;
  double mu;
};

/// The triangles of all surfaces at a ping.
std::vector<ScatteringTriangle> triangles_at(const AnsweredScene& scene, std::size_t ping) {
  std::vector<ScatteringTriangle> all;
  for (const Json& surface : scene.json["surfaces"])
    for (auto corners : triangles_of(scene, surface["obj"])) {
      if (surface.contains("pings"))
        for (glm::dvec3& corner : corners)
          corner = vector_of(surface["pings"][ping]["position_m"]) + axes_of(surface["pings"][ping]) * corner;
      const glm::dvec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0];
      all.push_back({corners[0], e1, e2, glm::normalize(glm::cross(e1, e2)), surface["mu"]});
    }
  return all;
}

/// A beam's transmission: pyramids in the axes of the pose, and the absorption.
struct JsonBeam {
  std::vector<std::array<glm::dvec3, 4>> pyramids;
  Json pose;
  double absorption_db_per_km = 0;
};

JsonBeam beam_of(const AnsweredScene& scene, std::size_t ping, std::size_t beam) {
  const Json& beams = scene.json["beams"];
  JsonBeam found{{}, scene.json["pings"][ping], scene.json["water"]["absorption_db_per_km"]};
  if (!beams.contains("sectors")) {
    const auto corner = [&](std::size_t border, const char* side) {
      const double a = scene.border_deg(border) * degree, e = beams[side].get<double>() * degree;
      return glm::dvec3{std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
    };
    found.pyramids.push_back({corner(beam, "lower_deg"), corner(beam + 1, "lower_deg"),
                              corner(beam + 1, "upper_deg"), corner(beam, "upper_deg")});
    return found;
  }
  for (const Json& pyramid : beams["pyramids"][beam]) {
    auto& corners = found.pyramids.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) corners[k] = vector_of(pyramid[k]);
  }
  for (const Json& sector : beams["sectors"])
    if (sector["first_beam"] <= beam && beam < sector["end_beam"]) {
      found.pose = sector["pings"][ping];
      found.absorption_db_per_km = sector["absorption_db_per_km"];
    }
  return found;
}

/// Adds the echoes of a beam: 10 x `rows` rays per pyramid.
void cast(const AnsweredScene& scene, const std::vector<ScatteringTriangle>& triangles, const JsonBeam& beam,
          int rows, std::span<double> samples) {
  const glm::dvec3 from = vector_of(beam.pose["position_m"]);
  const glm::dmat3 axes = axes_of(beam.pose);
  for (const auto& c : beam.pyramids) {
    // Only triangles with a corner near the axis of the pyramid, and large ones, can be hit. A pyramid is at
    // most 20 degrees high.
    const glm::dvec3 axis = glm::normalize(axes * (c[0] + c[1] + c[2] + c[3]));
    std::vector<const ScatteringTriangle*> near;
    for (const ScatteringTriangle& t : triangles)
      if (glm::length(t.e1) > 1 || glm::length(t.e2) > 1 ||
          glm::dot(glm::normalize(t.a - from), axis) > std::cos(25 * degree))
        near.push_back(&t);
    const auto at = [&](double u, double v) {
      return (1 - v) * ((1 - u) * c[0] + u * c[1]) + v * ((1 - u) * c[3] + u * c[2]);
    };
    constexpr int columns = 10;
    for (int i = 0; i < columns; ++i)
      for (int j = 0; j < rows; ++j) {
        const double u = (i + 0.5) / columns, v = (j + 0.5) / rows;
        const glm::dvec3 p = at(u, v), du = (at(1, v) - at(0, v)) / double(columns),
                         dv = (at(u, 1) - at(u, 0)) / double(rows);
        const double solid_angle = std::abs(glm::dot(p, glm::cross(du, dv))) / std::pow(glm::length(p), 3);
        const glm::dvec3 ray = axes * glm::normalize(p);
        double range = std::numeric_limits<double>::max();
        const ScatteringTriangle* hit = nullptr;
        for (const ScatteringTriangle* t : near) {
          const glm::dvec3 h = glm::cross(ray, t->e2), s = from - t->a, q = glm::cross(s, t->e1);
          const double det = glm::dot(t->e1, h), along = glm::dot(t->e2, q) / det, x = glm::dot(s, h) / det,
                       y = glm::dot(ray, q) / det;
          if (x >= 0 && y >= 0 && x + y <= 1 && along > 0 && along < range) range = along, hit = t;
        }
        const auto k = std::floor((range - scene.first_m()) / scene.step_m());
        if (hit != nullptr && k >= 0 && k < static_cast<double>(samples.size()))
          samples[static_cast<std::size_t>(k)] += hit->mu * std::abs(glm::dot(ray, hit->normal)) *
                                                  solid_angle / (range * range) *
                                                  std::pow(10, -beam.absorption_db_per_km * range / 5000);
      }
  }
}

/// Difference of blocks of 4 beams and 8 samples, relative to all energies.
double coarse_difference(const Array& a, const Array& b) {
  double difference = 0, all = 0;
  for (std::size_t p = 0; p < a.pings; ++p)
    for (std::size_t beam = 0; beam < a.beams; beam += 4)
      for (std::size_t k = 0; k < a.samples; k += 8) {
        double sum = 0;
        for (std::size_t i = beam; i < std::min(beam + 4, a.beams); ++i)
          for (std::size_t j = k; j < std::min(k + 8, a.samples); ++j) {
            sum += a.at(p, i, j) - b.at(p, i, j);
            all += b.at(p, i, j);
          }
        difference += std::abs(sum);
      }
  return difference / all;
}

TEST(SuiteMotionAnswers, AreThoseOfRaysThroughTheSceneInNumbers) {
  const TestFolder folder;
  for (const std::string set : {"", "another word"}) {
    std::vector<std::string> options{"--scenes", "half-sample,sectors,moving-object"};
    if (!set.empty()) options.insert(options.end(), {"--seed", set});
    const fs::path suite = packed(folder, "suite" + set, options);
    for (const std::string name : {"half-sample", "sectors", "moving-object"}) {
      const AnsweredScene scene(suite, name);
      Array rays = scene.energy;
      std::ranges::fill(rays.values, 0.0);
      for (std::size_t ping = 0; ping < rays.pings; ++ping) {
        const std::vector<ScatteringTriangle> triangles = triangles_at(scene, ping);
        for (std::size_t beam = 0; beam < rays.beams; ++beam)
          cast(scene, triangles, beam_of(scene, ping, beam), name == "moving-object" ? 400 : 30,
               std::span(rays.values).subspan((ping * rays.beams + beam) * rays.samples, rays.samples));
      }
      EXPECT_NEAR(rays.sum() / scene.energy.sum(), 1, 0.005) << name << set;
      EXPECT_LT(coarse_difference(rays, scene.energy), 0.03) << name << set;
    }
  }
}

}  // namespace
}  // namespace tubefoot
