// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/detection/sidescan_mosaic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

namespace tubefoot {
namespace {

/// Points of a strip are no farther apart than this part of a cell.
constexpr double points_per_cell = 3;
/// A strip longer than this many cells is an interval between lines that nobody ended.
constexpr double most_points = 1e6;

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("sidescan ping: " + what);
}

}  // namespace

SidescanMosaic::SidescanMosaic(double cell_m, std::size_t most_bytes) : cells_(cell_m, most_bytes) {}

void SidescanMosaic::add(const SidescanPing& ping) {
  require(std::isfinite(ping.altitude_m) && ping.altitude_m >= 0,
          fmt::format("its altitude is {} m, must be 0 or more", ping.altitude_m));
  require(std::isfinite(ping.first_m) && ping.first_m >= 0 && std::isfinite(ping.step_m) && ping.step_m > 0,
          fmt::format("ranges from {} m in steps of {} m: must be 0 or more, and positive", ping.first_m,
                      ping.step_m));
  const glm::dvec3 starboard = ping.pose.attitude * glm::dvec3(1, 0, 0),
                   forward = ping.pose.attitude * glm::dvec3(0, 1, 0);
  const glm::dvec2 track(ping.pose.position_m), ahead(forward);
  require(std::isfinite(track.x) && std::isfinite(track.y), "its position is not finite");
  require(glm::length(ahead) > 1e-3 && std::isfinite(starboard.x),
          "the sensor looks straight up or down: it has no heading");
  const glm::dvec2 heading = glm::normalize(ahead);
  Line line{track,
            {heading.y, -heading.x},
            ping.altitude_m,
            ping.first_m,
            ping.step_m,
            {ping.port.begin(), ping.port.end()},
            {ping.starboard.begin(), ping.starboard.end()}};
  if (before_) {
    fill_side(*before_, -1, before_->port, line, 0.5);
    fill_side(*before_, 1, before_->starboard_samples, line, 0.5);
    fill_side(line, -1, line.port, *before_, 0.5);
    fill_side(line, 1, line.starboard_samples, *before_, 0.5);
  } else {  // a line of no width yet: a ping alone is seen, and one among others weighs next to nothing
    fill_side(line, -1, line.port, line, 0);
    fill_side(line, 1, line.starboard_samples, line, 0);
  }
  before_ = std::move(line);
}

/// Fills the samples of one side from their own ping to `way` of the way to the same ground range of another.
void SidescanMosaic::fill_side(const Line& line, double side, const std::vector<float>& samples,
                               const Line& other, double way) {
  const double spacing_m = cells_.cell_m() / points_per_cell;
  const auto ground_range = [&](double slant_m) {
    return slant_m > line.altitude_m ? std::sqrt((slant_m - line.altitude_m) * (slant_m + line.altitude_m))
                                     : 0.0;
  };
  const auto steps_over = [&](double length_m) {
    const double steps = std::ceil(length_m / spacing_m);
    if (!(steps < most_points))
      throw std::runtime_error(
          fmt::format("a sidescan sample {:.3g} m long has too many points in cells of {} m: end the line, "
                      "or make the cells larger",
                      length_m, cells_.cell_m()));
    return std::max(1, static_cast<int>(steps));
  };
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (!std::isfinite(samples[k])) continue;
    const double slant_m = line.first_m + static_cast<double>(k) * line.step_m;
    const double near_m = ground_range(slant_m), far_m = ground_range(slant_m + line.step_m);
    if (!(far_m > near_m)) continue;  // water
    const int across = steps_over(far_m - near_m);
    for (int a = 0; a < across; ++a) {
      const double out_m = near_m + (far_m - near_m) * (a + 0.5) / across;
      const glm::dvec2 from = line.track + side * out_m * line.starboard;
      const glm::dvec2 to = from + way * (other.track + side * out_m * other.starboard - from);
      const double length_m = glm::distance(from, to);
      const int along = steps_over(length_m);
      constexpr double thread_m = 1e-9;  // width of a ping that has no neighbour
      const double area_m2 = (far_m - near_m) / across * std::max(length_m, thread_m) / along;
      for (int p = 0; p < along; ++p) {
        const glm::dvec2 at = from + (to - from) * ((p + 0.5) / along);
        cells_.add(at.x, at.y, samples[k], area_m2);
      }
    }
  }
}

}  // namespace tubefoot
