// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/beds/facet_fineness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>

namespace tubefoot {
namespace {

constexpr double share = 1.0 / 16, finest = 3e-4, coarsest = 1.0 / 50, usual_range = 0.25;
constexpr double usual_sound_speed_m_s = 1500;

/// What a sensor tells apart.
struct Resolution {
  double sample_m = 0, beam_deg = 0, farthest_m = 0;
};

Resolution resolution(const DidsonDescription& d) {
  return {d.window_length_m / d.samples, std::min(d.horizontal_deg / d.beams, d.vertical_deg),
          d.window_start_m + d.window_length_m};
}
Resolution resolution(const SidescanDescription& d) {
  return {d.sampling_frequency_khz ? usual_sound_speed_m_s / (2000 * *d.sampling_frequency_khz)
                                   : (d.range_max_m - d.range_min_m) / d.samples,
          d.along_track_deg, d.range_max_m};
}
Resolution resolution(const MultibeamDescription& d) {
  return {(d.range_max_m - d.range_min_m) / d.samples, std::min(d.beam_across_deg, d.along_track_deg),
          d.range_max_m};
}
Resolution resolution(const ImagingDescription& d) {
  return {(d.range_max_m - d.range_min_m) / d.samples, std::min(d.horizontal_deg / d.beams, d.vertical_deg),
          d.range_max_m};
}
Resolution resolution(const EchosounderDescription& d) {
  return {(d.range_max_m - d.range_min_m) / d.samples, d.beam_deg, d.range_max_m};
}

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
  if (object.chord_error_m) return {*object.chord_error_m, "as the scene says"};
  const double radius_m = largest_radius_m(object);
  FacetFineness found{std::numeric_limits<double>::infinity(), ""};
  for (const SensorDescription& sensor : scene.sensors) {
    const Resolution r = std::visit([](const auto& kind) { return resolution(kind); }, sensor.kind);
    const double beam_m = r.beam_deg * std::numbers::pi / 180 * usual_range * r.farthest_m;
    const double told_apart_m = std::min(r.sample_m, beam_m);
    if (!(share * told_apart_m < found.chord_error_m)) continue;
    found = {share * told_apart_m,
             fmt::format("a sixteenth of what '{}' tells apart, {:.3g} m {}", sensor.name, told_apart_m,
                         r.sample_m <= beam_m ? "of range" : "across a beam")};
  }
  if (!(found.chord_error_m <= coarsest * radius_m)) return {coarsest * radius_m, "a fiftieth of the radius"};
  if (found.chord_error_m < finest * radius_m)
    return {finest * radius_m, "the finest that is made unasked, more than " + found.from};
  return found;
}

}  // namespace tubefoot
