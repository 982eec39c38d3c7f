// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/own_engine_part.hpp"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include "run/own_engine.hpp"

namespace tubefoot {
namespace {

/// Throws std::domain_error if a cross product exceeds the geometric mean of the two energies. `channels`:
/// [4][beam][sample].
void check_coherence(const Transmission& transmission, std::size_t s, std::span<const double> channels) {
  constexpr double rounding = 1e-6;
  const std::size_t cells = channels.size() / 4,
                    samples = static_cast<std::size_t>(transmission.sensor(s).samples().count);
  for (std::size_t k = 0; k < cells; ++k) {
    const double upper = channels[k], lower = channels[cells + k],
                 product = std::hypot(channels[2 * cells + k], channels[3 * cells + k]);
    if (!(product <= (1 + rounding) * std::sqrt(upper) * std::sqrt(lower)))
      throw std::domain_error(fmt::format(
          "engine '{}': invalid covariance in beam {} and sample {} of {}: its magnitude is {:.6g} J/m2, "
          "more than the geometric mean of the energies of both receivers, {:.6g} J/m2 and {:.6g} J/m2",
          transmission.request().own_engine->name, k / samples, k % samples, transmission.name(), product,
          upper, lower));
  }
}

}  // namespace

void add_own_engine(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  for (const std::size_t s : plan.sensors) {
    if (sums.chosen(s).pings == 0) continue;
    const Sensor& sensor = transmission.sensor(s);
    std::vector<double> energy(static_cast<std::size_t>(sensor.channels() * transmission.beams(s)) *
                               static_cast<std::size_t>(sensor.samples().count));
    transmission.request().own_engine->echo(transmission, s, energy);
    if (sensor.has_receiver_pair()) check_coherence(transmission, s, energy);
    sums.add(transmission, s, 1, energy);
  }
}

}  // namespace tubefoot
