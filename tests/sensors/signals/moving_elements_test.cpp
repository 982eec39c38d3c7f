// SPDX-License-Identifier: GPL-3.0-or-later
// Compares one scatterer of the surface field with the closed form of a point, for a moving vehicle.
#include <gtest/gtest.h>

#include <numbers>

#include "engine/signal/coherent_signals.hpp"
#include "sensors/signals/point_signals.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

TEST(MovingElements, HearAScattererOfTheGroundAsAPoint) {
  const double c = 1500, carrier_hz = 200e3, duration_s = 4e-3;
  // A square below the spacing of a field that has one scatterer there.
  const std::vector<double> mu{0.1};
  const std::vector<std::uint16_t> material{0};
  EchoModel law;
  law.material_mu = mu;
  law.material = material;
  VisiblePolygons seen;
  seen.corners_m = {{3, 14, -9}, {3, 14.04, -9}, {3.04, 14.04, -9}, {3.04, 14, -9}};
  seen.patches = {{0, {0, 0, 1}, 9, 0, 4, 0, 0}};
  SurfaceField field{1, 0.05};
  std::vector<PointScatterer> points;
  for (; points.size() != 1; ++field.seed) {
    points.clear();
    field.for_scatterers(seen.corners_m, {0, 0, 1}, [&](glm::dvec3 place, Complex z) {
      points.push_back({place, z});
    });
    if (points.size() == 1) break;
  }

  const VehicleMotion motion({{-1, {{0.1, -1.5, -2}, attitude_from_angles(0.2, 0.02, 0)}},
                              {1, {{0.3, 2.5, -2.1}, attitude_from_angles(0.5, 0, 0.03)}}},
                             {0}, false);
  const ElementArray array = line_array(3, {0.05, 0, 0}, {0.2, 0.5, 0});
  const TransmitWaveform waveform = continuous_wave_pulse(carrier_hz, duration_s, 0.5);
  const SignalSampling sampling{carrier_hz, 10e3, 0.015, 120};
  const ElementSignals expected = point_signals(points, array, waveform, sampling, motion, c);

  CoherentReceiver receiver;
  const PlaceMotion transmitter(motion, 0, array.transmitter_m, sampling.end_s());
  std::vector<PlaceMotion> elements;
  for (const glm::dvec3& place : array.receivers_m) elements.emplace_back(motion, 0, place, sampling.end_s());
  for (const PlaceMotion& element : elements) {
    SignalChannel channel;
    channel.transmit_motion = [&](double t) { return transmitter.at(t); };
    channel.receive_motion = [&](double t) { return element.at(t); };
    receiver.channels.push_back(channel);
  }
  receiver.pulse = {[&](double t) { return baseband_at(waveform, carrier_hz, t); }, 0, duration_s, 5e3};
  receiver.times = {sampling.first_s, sampling.rate_hz, sampling.samples};
  receiver.carrier_hz = carrier_hz;
  receiver.sound_speed_m_s = c;
  const ChannelSignals received = element_signals(seen, receiver, law, field, 1e-9);
  int echoes = 0;
  for (std::size_t e = 0; e < 3; ++e)
    for (std::size_t n = 0; n < sampling.samples; ++n) {
      const Complex point = expected.channel(0, e)[n];
      if (std::abs(point) < 1e-9) continue;
      ++echoes;
      // Phases are those of the path lengths. Amplitudes follow Lambert's law.
      EXPECT_LT(std::abs(std::arg(received.at(e, n) / point)), 2 * std::numbers::pi * 1e-9) << e << ' ' << n;
      const double t = sampling.time_s(n), above = elements[e].at(t).z + 9;
      const double rx = glm::distance(elements[e].at(t), points[0].position_m);
      EXPECT_NEAR(std::abs(received.at(e, n) / point), std::sqrt(0.1) * above / rx,
                  2e-3 * std::sqrt(0.1) * above / rx);
    }
  EXPECT_GT(echoes, 90);
}

}  // namespace
}  // namespace tubefoot
