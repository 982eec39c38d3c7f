// SPDX-License-Identifier: GPL-3.0-or-later
// Writes environment files of BELLHOP, by its documentation (EnvironmentalFile.html of the Acoustics
// Toolbox).
#include "propagation/bellhop_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "files/usage_error.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr int beams = 5001;

/// A count, and the values on one line.
std::string counted(const std::vector<double>& values, double unit) {
  std::string text = fmt::format("{}\n", values.size());
  for (const double value : values) fmt::format_to(std::back_inserter(text), "{:.17g} ", value / unit);
  return text + "/\n";
}

/// Letters, digits and blanks of a text, because the title stands between quotation marks.
std::string plain(const std::string& text) {
  std::string result;
  for (const char c : text)
    if (std::string_view("'\"\\/").find(c) == std::string_view::npos && c >= ' ' && c <= '~') result += c;
  return result.substr(0, 70);
}

}  // namespace

std::vector<double> beam_angles_deg(const std::vector<PointArrivals>& points) {
  double steepest = 1 * degree;
  for (const PointArrivals& point : points)
    for (const RayArrival& ray : point.arrivals) steepest = std::max(steepest, std::abs(ray.launch_rad));
  const double widest_deg = std::min(89.0, 1.1 * steepest / degree);
  return {-widest_deg, widest_deg};
}

std::string bellhop_environment(const RaysRequest& request, const BellhopRun& run) {
  const double surface_m = request.options.surface_m, source_m = request.depth_m(request.source_m);
  if (!std::isfinite(surface_m))
    throw UsageError(
        "--environment: BELLHOP needs a sea surface: add [sea_surface] to the scene, or use --profile");
  const SoundSpeedProfile& profile = request.water.profile;
  const bool reflects = std::isfinite(request.options.bottom_m);
  double bottom_m = request.options.bottom_m;
  if (!reflects) {  // everything that the run needs, and all layers
    bottom_m = std::max(profile.points().back().depth_m, source_m);
    for (const double depth_m : run.depths_m) bottom_m = std::max(bottom_m, depth_m);
    bottom_m = std::max(bottom_m * 1.01, surface_m + 1);
  }
  std::vector<double> depths_m{surface_m};
  for (const ProfilePoint& point : profile.points())
    if (point.depth_m > surface_m && point.depth_m < bottom_m) depths_m.push_back(point.depth_m);
  depths_m.push_back(bottom_m);

  std::string text = fmt::format("'{}'\n{:.17g}\n1\n'CVW'\n{} 0.0 {:.17g}\n", plain(request.water_name),
                                 run.frequency_hz, depths_m.size(), bottom_m);
  for (const double depth_m : depths_m)
    fmt::format_to(std::back_inserter(text), "{:.17g} {:.17g} /\n", depth_m, profile.at(depth_m));
  text += reflects ? std::string("'R' 0.0\n")
                   : fmt::format("'A' 0.0\n{:.17g} {:.17g} 0.0 1.0 /\n", bottom_m, profile.at(bottom_m));
  text += counted({source_m}, 1);
  text += run.depths_m.empty() ? counted({source_m}, 1) : counted(run.depths_m, 1);
  text += counted(run.depths_m.empty() ? std::vector{run.ranges_m.back()} : run.ranges_m, 1000);
  if (run.depths_m.empty())
    text += "'R'\n" + counted(run.angles_deg, 1);
  else
    text += fmt::format("'A'\n{}\n{:.17g} {:.17g} /\n", beams, run.angles_deg.front(), run.angles_deg.back());
  // Step (0: automatic), and the depth in m and the range in km at which rays end. A ray run ends at the
  // range itself; arrivals need a step beyond.
  const double beyond = run.depths_m.empty() ? 1 : 1.01;
  return text + fmt::format("0.0 {:.17g} {:.17g}\n", 1.01 * bottom_m, beyond * run.ranges_m.back() / 1000);
}

}  // namespace tubefoot
