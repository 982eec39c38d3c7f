// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/fresnel_transition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "engine/visibility/looks.hpp"
#include "geometry/footprints/shadow_borders.hpp"
#include "run/tiles_in_view.hpp"
#include "run/transmission_ends.hpp"

namespace tubefoot {

double fresnel_width_m(double to_edge_m, double beyond_edge_m, double wavelength_m) {
  return std::sqrt(wavelength_m * beyond_edge_m * (to_edge_m + beyond_edge_m) / (2 * to_edge_m));
}

std::optional<FresnelTransition> fresnel_transition(const Transmissions& transmissions, std::size_t s) {
  const Survey& survey = transmissions.survey();
  const SensorPings& pings = survey.sensors[s];
  const Sensor& sensor = *pings.sensor;
  const SharedTransmissions& group = survey.sensor_set->transmissions_of(s);
  const std::set<std::size_t> chosen{0, pings.times_s.size() / 2, pings.times_s.size() - 1};
  TransmissionsAround around(transmissions);
  struct Part {
    double width_m, length_m;
  };
  std::vector<Part> parts;
  // The last interval of a divided record has the largest reach.
  const std::size_t intervals = sensor.transmissions() / sensor.firings();
  for (const std::size_t ping : chosen)
    for (std::size_t number = intervals - 1; number < sensor.transmissions(); number += intervals) {
      const Transmission transmission = around.at(group, ping).of(group, ping, number);
      const double unit_m = transmission.scene().grid.unit_m(),
                   wavelength_m = pings.sound_speed_m_s / (1000 * sensor.frequency_khz(number));
      const TransmissionEnds ends(transmission, s);
      const TransmissionEnd& tx = ends.tx();
      for (const ShadowBorder& border : shadow_borders(
               *tx.mesh, tx.tubes, look(*tx.mesh, *tx.tree, tx.tubes, transmission.request().visibility)))
        parts.push_back({fresnel_width_m(border.to_edge * unit_m, border.beyond_edge * unit_m, wavelength_m) /
                             border.sine,
                         border.length * unit_m});
    }
  if (parts.empty()) return std::nullopt;
  std::ranges::sort(parts, {}, &Part::width_m);
  FresnelTransition transition{chosen.size(), 0, {}};
  for (const Part& part : parts) transition.length_m += part.length_m;
  constexpr std::array<double, 3> shares{0.05, 0.5, 0.95};
  for (std::size_t k = 0; k < shares.size(); ++k) {
    double left_m = shares[k] * transition.length_m;
    const auto reached = std::ranges::find_if(parts, [&](const Part& part) {
      left_m -= part.length_m;
      return left_m <= 0;
    });
    transition.width_m[k] = (reached == parts.end() ? parts.back() : *reached).width_m;
  }
  return transition;
}

std::string text_of(const FresnelTransition& transition) {
  return fmt::format(
      "{:.2g} m wide on the surface ({:.2g} to {:.2g} m), on {:.3g} m of shadow borders of {} "
      "ping{}",
      transition.width_m[1], transition.width_m[0], transition.width_m[2], transition.length_m,
      transition.pings, transition.pings == 1 ? "" : "s");
}

}  // namespace tubefoot
