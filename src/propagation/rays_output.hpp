// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files/atomic_output.hpp"
#include "propagation/rays_request.hpp"

namespace tubefoot {

/// Returns one row per eigenray. A point without an eigenray has one row in which `eigenrays` is 0 and the
/// values of the ray are empty. Angles are positive downwards in the direction of travel.
std::string to_csv(const RaysRequest& request, const std::vector<PointArrivals>& points);

/// Returns one row per point of each traced ray: its launch, borders of layers, reflections and end. Points
/// on the arcs between them (event `arc`) are at most 1 degree of direction apart.
std::string to_csv(const RaysRequest& request, const std::vector<FanRay>& fan);

/// Ray paths of the picture.
struct DrawnRay {
  std::vector<RayNode> nodes;
  int turns = 0, surface_reflections = 0, bottom_reflections = 0;
};
std::vector<DrawnRay> drawn(const RaysRequest& request, const std::vector<PointArrivals>& points);
std::vector<DrawnRay> drawn(const std::vector<FanRay>& fan);

/// Draws ray paths over range and depth, with the sound speed profile beside them, as SVG. `points`: (range,
/// depth) of the receivers in m.
std::string to_svg(const RaysRequest& request, const std::vector<DrawnRay>& rays,
                   const std::vector<std::pair<double, double>>& points);

/// A picture file, .svg or .png. It is written completely or not at all.
class RaysPicture {
 public:
  /// Throws UsageError, before any computation, for another suffix or an unusable place.
  RaysPicture(const std::filesystem::path& file, const Inputs& inputs);
  void write(const std::string& svg);

 private:
  OutputFile file_;
  bool svg_;
};

}  // namespace tubefoot
