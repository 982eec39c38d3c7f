// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/surfaces/facet_fineness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "scene/description/scene_description.hpp"

namespace tubefoot {
namespace {

constexpr double share = 1.0 / 16, finest = 3e-4, coarsest = 1.0 / 50, usual_range = 0.25;

double largest_radius_m(const ObjectDescription& object) {
  struct {
    double operator()(const SpherePrimitive& s) const { return s.radius_m; }
    double operator()(const CylinderPrimitive& c) const { return c.radius_m; }
    double operator()(const ConePrimitive& c) const { return std::max(c.radius_m, c.top_radius_m); }
    double operator()(const MeshFile&) const { return 0; }
    double operator()(const BoxPrimitive&) const { return 0; }
  } radius;
  return std::visit(radius, object.kind) * *std::max_element(object.scale.begin(), object.scale.end());
}

}  // namespace

FacetFineness facet_fineness(const SceneDescription& scene, const ObjectDescription& object) {
  if (object.chord_error_m) return {*object.chord_error_m, "from the scene"};
  const double radius_m = largest_radius_m(object);
  FacetFineness found{std::numeric_limits<double>::infinity(), ""};
  for (const SensorDescription& sensor : scene.sensors) {
    const SensorFigures r = figures_of(sensor);
    const double beam_m = r.beam_deg * std::numbers::pi / 180 * usual_range * r.farthest_m;
    const double resolved_m = std::min(r.sample_m, beam_m);
    if (!(share * resolved_m < found.chord_error_m)) continue;
    found = {share * resolved_m,
             fmt::format("a sixteenth of the resolution of '{}', {:.3g} m {}", sensor.name, resolved_m,
                         r.sample_m <= beam_m ? "in range" : "across a beam")};
  }
  if (!(found.chord_error_m <= coarsest * radius_m)) return {coarsest * radius_m, "a fiftieth of the radius"};
  if (found.chord_error_m < finest * radius_m)
    return {finest * radius_m, "the finest default, which is coarser than " + found.from};
  return found;
}

}  // namespace tubefoot
