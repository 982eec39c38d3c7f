// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "sensors/model/angles.hpp"
#include "sensors/model/sensor.hpp"

// Angular resolution of integer rays. A wall is a plane through two rays, each coordinate of which is
// rounded to 2^-30 (geometry/tubes/tube.hpp).
namespace tubefoot {
namespace {

double span(const std::vector<double>& edges) { return edges.empty() ? 0 : edges.back() - edges.front(); }

}  // namespace

void Sensor::refuse_narrow() const {
  const auto refuse = [this](double width_rad, const char* what, const char* remedy) {
    // Rounding may reduce a width that is exactly at the limit.
    if (width_rad < narrowest_rad * (1 - 1e-9))
      throw InputError(
          description_.place,
          fmt::format("the width of {} of sensor '{}' is {:.3g} degrees, but the resolution of directions is "
                      "6e-8 degrees: at least {:g} degrees are needed; {}",
                      what, description_.name, degrees(width_rad), degrees(narrowest_rad), remedy));
  };
  const char* widen = "widen the beams, or use fewer beams";
  for (const BeamAxis& beam : beams_) {
    refuse(beam.azimuth_width_rad, "the beams in azimuth", widen);
    refuse(beam.elevation_width_rad, "the beams in elevation", widen);
  }
  for (const Transmission& transmission : transmissions_)
    for (const AngularGrid& sector : transmission.sectors) {
      const char* overlap = "widen the transmit sector, the receive sector, or both";
      refuse(span(sector.azimuth_edges_rad), "the transmit and receive sector", overlap);
      refuse(span(sector.elevation_edges_rad), "the transmit and receive sector", overlap);
    }
}

double Sensor::wall_rounding() const {
  double narrowest = std::numeric_limits<double>::infinity();
  for (const BeamAxis& beam : beams_)
    narrowest = std::min({narrowest, beam.azimuth_width_rad, beam.elevation_width_rad});
  constexpr double of_two_walls = 1.7320508 * 0x1p-30;  // half a unit in each of three coordinates
  return of_two_walls / narrowest;
}

}  // namespace tubefoot
