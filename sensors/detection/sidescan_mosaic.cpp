// SPDX-License-Identifier: GPL-3.0-or-later
// Projects sidescan pings onto map cells, corrected for slant range over a flat seabed. A sample at slant
// range r fills a strip at the distance sqrt(r^2 - altitude^2) from the track. The strip ends midway to the
// neighbouring pings.

#include "sensors/detection/sidescan_mosaic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tubefoot {
namespace {

/// Number of points per cell along a strip, at least.
constexpr double points_per_cell = 3;
/// A strip longer than this many cells indicates a gap between survey lines.
constexpr double most_points = 1e6;

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("sidescan ping: " + what);
}

/// A ping on the map: east and north of the track point; unit vector to starboard.
struct Place {
  glm::dvec2 track, starboard;
};

Place place_of(const Pose& pose) {
  const glm::dvec3 starboard = pose.attitude * glm::dvec3(1, 0, 0),
                   forward = pose.attitude * glm::dvec3(0, 1, 0);
  const glm::dvec2 track(pose.position_m), ahead(forward);
  require(std::isfinite(track.x) && std::isfinite(track.y), "the position is not finite");
  require(glm::length(ahead) > 1e-3 && std::isfinite(starboard.x),
          "the sensor looks straight up or down, so it has no heading");
  const glm::dvec2 heading = glm::normalize(ahead);
  return {track, {heading.y, -heading.x}};
}

/// The interval of ground range that a sample covers, and the number of steps that fill it.
struct SeabedInterval {
  std::size_t sample = 0;
  double near_m = 0, far_m = 0;
  int steps = 0;
};

class Strips {
 public:
  Strips(const SidescanPing& ping, double cell_m)
      : ping_(ping), own_(place_of(ping.pose)), spacing_m_(cell_m / points_per_cell), sums_(cell_m) {
    const auto ground_range = [&](double slant_m) {
      return slant_m > ping.altitude_m ? std::sqrt((slant_m - ping.altitude_m) * (slant_m + ping.altitude_m))
                                       : 0.0;
    };
    for (std::size_t k = 0; k < std::max(ping.port.size(), ping.starboard.size()); ++k) {
      const double slant_m = ping.first_m + static_cast<double>(k) * ping.step_m;
      const double near_m = ground_range(slant_m), far_m = ground_range(slant_m + ping.step_m);
      if (far_m > near_m)
        seabed_intervals_.push_back({k, near_m, far_m, steps_over(far_m - near_m)});  // other samples lie in
                                                                                      // the water column
    }
  }

  /// Fills both sides, from the ping to the fraction `way` of the distance to the same ground range of
  /// another ping.
  void fill(const Place& other, double way) {
    fill_side(-1, ping_.port, other, way);
    fill_side(1, ping_.starboard, other, way);
  }
  const Place& own() const { return own_; }
  CellSums take() { return std::move(sums_); }

 private:
  int steps_over(double length_m) const {
    if (length_m <= spacing_m_) return 1;
    const double steps = std::ceil(length_m / spacing_m_);
    if (!(steps < most_points))
      throw std::runtime_error(
          fmt::format("a sidescan sample with a length of {:.3g} m needs too many points in cells of {} m: "
                      "divide the survey line, or use larger cells",
                      length_m, sums_.cell_m()));
    return static_cast<int>(steps);
  }

  void fill_side(double side, std::span<const float> samples, const Place& other, double way) {
    for (const SeabedInterval& seabed : seabed_intervals_) {
      if (seabed.sample >= samples.size()) break;
      const float value = samples[seabed.sample];
      if (!std::isfinite(value)) continue;
      const double across_m = seabed.far_m - seabed.near_m;
      for (int a = 0; a < seabed.steps; ++a) {
        const double tx_m = seabed.near_m + across_m * (a + 0.5) / seabed.steps;
        const glm::dvec2 from = own_.track + side * tx_m * own_.starboard;
        const glm::dvec2 to = from + way * (other.track + side * tx_m * other.starboard - from);
        const double length_m = glm::distance(from, to);
        const int along = steps_over(length_m);
        constexpr double thread_m = 1e-9;  // width of a ping without neighbours
        const double area_m2 = across_m / seabed.steps * std::max(length_m, thread_m) / along;
        for (int p = 0; p < along; ++p) {
          const glm::dvec2 at = from + (to - from) * ((p + 0.5) / along);
          sums_.add(at.x, at.y, value, area_m2);
        }
      }
    }
  }

  const SidescanPing& ping_;
  Place own_;
  double spacing_m_;
  std::vector<SeabedInterval> seabed_intervals_;
  CellSums sums_;
};

}  // namespace

CellSums sums_on_map(const SidescanPing& ping, const Pose* before, const Pose* after, double cell_m) {
  require(std::isfinite(ping.altitude_m) && ping.altitude_m >= 0,
          fmt::format("the altitude is {} m, but must be 0 or more", ping.altitude_m));
  require(std::isfinite(ping.first_m) && ping.first_m >= 0 && std::isfinite(ping.step_m) && ping.step_m > 0,
          fmt::format(
              "ranges begin at {} m with a step of {} m, but must begin at 0 or more with a positive step",
              ping.first_m, ping.step_m));
  Strips strips(ping, cell_m);
  if (before)
    strips.fill(place_of(*before), 0.5);
  else  // A line of almost no width: an isolated ping remains visible, and beside other pings its weight is
        // negligible.
    strips.fill(strips.own(), 0);
  if (after) strips.fill(place_of(*after), 0.5);
  return strips.take();
}

}  // namespace tubefoot
