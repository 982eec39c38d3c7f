// SPDX-License-Identifier: GPL-3.0-or-later
// Tests channels whose ends move during propagation. The comparison is a sum over each scatterer, whose
// transmit times come from bisection.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "engine/signal/coherent_signals.hpp"
#include "engine/signal/moving_channels.hpp"
#include "engine/signal/surface_scatterers.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/world/signal_scenes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using test::loudest_of;
using test::SignalView;
using test::worst_of;

constexpr double c = 1500;

PlatformMotion straight(glm::dvec3 start_m, glm::dvec3 velocity_m_s) {
  return [=](double t) { return start_m + velocity_m_s * t; };
}
/// Motion of one end of a vehicle that advances, turns and heaves. The end has a lever arm from the middle
/// of the vehicle.
PlatformMotion turning(glm::dvec3 start_m, glm::dvec3 velocity_m_s, double rad_s, glm::dvec3 lever_m) {
  return [=](double t) {
    const double w = rad_s * t;
    return start_m + velocity_m_s * t +
           glm::dvec3(std::cos(w) * lever_m.x - std::sin(w) * lever_m.y,
                      std::sin(w) * lever_m.x + std::cos(w) * lever_m.y, lever_m.z + 0.05 * std::sin(7 * t));
  };
}
/// Motion from pose to pose, with a change of velocity at each pose.
PlatformMotion refracted(glm::dvec3 start_m, glm::dvec3 velocity_m_s, double interval_s) {
  return [=](double t) {
    const double n = std::floor(t / interval_s), share = t / interval_s - n;
    const auto pose = [&](double k) {
      return start_m + velocity_m_s * (k * interval_s) + 0.004 * glm::dvec3(std::sin(k), std::cos(3 * k), 0);
    };
    return (1 - share) * pose(n) + share * pose(n + 1);
  };
}

PlatformMotion way_of(const PlatformMotion& motion, glm::dvec3 place_m) {
  return motion ? motion : [=](double) { return place_m; };
}

/// Returns the transmit time of the sound that arrives at t, by bisection.
double sent_at(double t, glm::dvec3 x, const PlatformMotion& transmit, const PlatformMotion& receive) {
  const double there = t - glm::distance(x, receive(t)) / c;
  double low = there - 0.2, high = there;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (middle + glm::distance(x, transmit(middle)) / c < there ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Returns the amplitude from Lambert's law, spreading, absorption and patterns, for the ends at these
/// positions.
double amplitude_of(glm::dvec3 x, glm::dvec3 normal, double mu, double db_per_m, glm::dvec3 from,
                    glm::dvec3 to, const SignalChannel& channel) {
  const glm::dvec3 tx = from - x, rx = to - x;
  const double r = glm::length(tx), s = glm::length(rx),
               sines = glm::dot(tx, normal) / r * glm::dot(rx, normal) / s;
  if (!(glm::dot(tx, normal) > 0 && glm::dot(rx, normal) > 0)) return 0;
  return std::sqrt(mu * sines * std::pow(10, -db_per_m * (r + s) / 10)) / (r * s) *
         amplitude_pattern(channel.transmit, -tx / r) * amplitude_pattern(channel.receive, -rx / s);
}

/// Sums each scatterer for each channel and sample.
ChannelSignals by_every_moving_end(const VisiblePolygons& seen, const CoherentReceiver& receiver,
                                   const EchoModel& model, const SurfaceField& field) {
  ChannelSignals all{receiver.channels.size(), receiver.times.count, {}};
  all.value.assign(all.channels * all.samples, 0);
  const double k = 2 * pi * receiver.carrier_hz / c;
  for (const VisiblePolygon& patch : seen.patches) {
    std::vector<glm::dvec3> corners;
    for (const glm::dvec3& corner : seen.corners(patch)) corners.push_back(corner + seen.origin_m);
    const double mu = model.material_mu[model.material[patch.facet]];
    field.for_scatterers(corners, patch.normal, [&](glm::dvec3 x, Complex z) {
      for (std::size_t n = 0; n < all.channels; ++n) {
        const SignalChannel& channel = receiver.channels[n];
        const PlatformMotion transmit = way_of(channel.transmit_motion, channel.transmit_m),
                             receive = way_of(channel.receive_motion, channel.receive_m);
        for (std::size_t m = 0; m < all.samples; ++m) {
          const double t = receiver.times.time_s(m);
          // The sample is far from any echo of the scatterer.
          const double about = t - (glm::distance(x, transmit(0)) + glm::distance(x, receive(t))) / c;
          if (about < 1.1 * receiver.pulse.begin_s - 1e-4 || about > 1.1 * receiver.pulse.end_s + 1e-4)
            continue;
          const double s = sent_at(t, x, transmit, receive);
          const Complex g = receiver.pulse.at(s);
          if (g == 0.0) continue;
          const glm::dvec3 from = transmit(s), to = receive(t);
          all.value[n * all.samples + m] +=
              z * g *
              std::polar(amplitude_of(x, patch.normal, mu, model.absorption_db_per_m, from, to, channel),
                         k * (glm::distance(x, from) + glm::distance(x, to)));
        }
      }
    });
  }
  return all;
}

/// Three elements and a transmitter on one vehicle.
CoherentReceiver receiver_on(glm::dvec3 place_m, const std::function<PlatformMotion(glm::dvec3)>& motion) {
  CoherentReceiver receiver;
  for (const double x : {-0.06, 0.0, 0.05})
    receiver.channels.push_back({place_m, place_m + glm::dvec3(x, 0.01, 0)});
  receiver.channels[1].receive = {Directivity::Kind::line, {1, 0, 0}, false, 0, 3};
  if (motion)
    for (SignalChannel& channel : receiver.channels) {
      channel.transmit_motion = motion(channel.transmit_m);
      channel.receive_motion = motion(channel.receive_m);
    }
  receiver.pulse = gaussian_pulse(1e-4);
  receiver.times = {5.2e-3, 25e3, 36};
  receiver.carrier_hz = 30e3;
  receiver.sound_speed_m_s = c;
  return receiver;
}

TEST(MovingEnds, HearTheSumOverAllScatterersOfTheField) {
  const std::function<PlatformMotion(glm::dvec3)> motions[] = {
      [](glm::dvec3 p) {
        return straight(p, {1.5, 1, -0.2});
      },
      [](glm::dvec3 p) {
        return straight(p, {-12, 15, 5});
      },
      [](glm::dvec3 p) {
        return turning(p, {2, -1, 0.3}, 3, {0.4, -0.3, 0.1});
      },
      [](glm::dvec3 p) {
        return refracted(p, {1, 2, 0}, 7e-4);
      }};
  for (const std::size_t number : {0u, 1u, 4u}) {
    const test::SignalScene scene = test::signal_scenes()[number];
    const SignalView view(scene, {0.0, 0.0, 0.0});
    const VisiblePolygons seen = view.patches();
    EchoModel model = view.model;
    model.absorption_db_per_m = 0.1;
    const SurfaceField field{7, number == 0 ? 0.035 : 0.06};
    for (std::size_t k = 0; k < 4; ++k) {
      const CoherentReceiver receiver = receiver_on(view.apex_m, motions[k]);
      const ChannelSignals direct = by_every_moving_end(seen, receiver, model, field);
      const double loudest = loudest_of(direct);
      ASSERT_GT(loudest, 0);
      // The signals differ from those of transmitters and receivers at rest.
      EXPECT_GT(worst_of(element_signals(seen, receiver_on(view.apex_m, {}), model, field), direct),
                0.03 * loudest);
      double before = 1;
      for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
        const double worst = worst_of(element_signals(seen, receiver, model, field, tolerance), direct);
        EXPECT_LT(worst, 3 * std::max(tolerance, 1e-6) * loudest)
            << scene.name << ", way " << k << ' ' << tolerance;
        EXPECT_LT(worst, before);
        before = std::max(worst, 1e-6 * loudest);
      }
    }
  }
}

TEST(MovingEnds, OneEndMayMoveAndTheOtherRest) {
  const test::SignalScene scene = test::signal_scenes()[1];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  const VisiblePolygons seen = view.patches();
  const SurfaceField field{3, 0.06};
  CoherentReceiver receiver = receiver_on(view.apex_m, {});
  receiver.channels[0].transmit_motion = straight(view.apex_m, {0, 9, -3});
  receiver.channels[1].receive_motion = turning(view.apex_m, {3, 0, 0}, 2, {0, 0.5, 0});
  const ChannelSignals direct = by_every_moving_end(seen, receiver, view.model, field);
  const ChannelSignals moving = element_signals(seen, receiver, view.model, field, 1e-6);
  EXPECT_LT(worst_of(moving, direct), 3e-6 * loudest_of(direct));
  // Channel 2 is at rest, and the others move. It equals the channel of a receiver at rest, to the error of
  // the pulse tables.
  const ChannelSignals fixed = element_signals(seen, receiver_on(view.apex_m, {}), view.model, field, 1e-6);
  for (std::size_t n = 0; n < fixed.samples; ++n)
    EXPECT_LT(std::abs(fixed.at(2, n) - moving.at(2, n)), 5e-6 * loudest_of(direct));
}

TEST(MovingEnds, AtRestHearTheSameBits) {
  const test::SignalScene scene = test::signal_scenes()[1];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  const VisiblePolygons seen = view.patches();
  const SurfaceField field{9, 0.02};
  const CoherentReceiver fixed = receiver_on(view.apex_m, {}),
                         still = receiver_on(view.apex_m, [](glm::dvec3 p) { return straight(p, {}); }),
                         creeping = receiver_on(view.apex_m, [](glm::dvec3 p) {
                           return straight(p, {1e-7, 2e-7, 0});
                         });
  const ChannelSignals at_rest = element_signals(seen, fixed, view.model, field),
                       drawn = drawn_signals(seen, fixed, view.model, 1, 0);
  EXPECT_EQ(at_rest.value, element_signals(seen, still, view.model, field).value);
  EXPECT_EQ(drawn.value, drawn_signals(seen, still, view.model, 1, 0).value);
  // A velocity of a tenth of a micrometre per second takes another path through the program.
  EXPECT_LT(worst_of(at_rest, element_signals(seen, creeping, view.model, field)),
            5e-6 * loudest_of(at_rest));
  EXPECT_LT(worst_of(drawn, drawn_signals(seen, creeping, view.model, 1, 0)), 5e-6 * loudest_of(drawn));
}

TEST(MovingEnds, HaveTheSameBitsForAnyThreads) {
  const test::SignalScene scene = test::signal_scenes()[2];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  const VisiblePolygons seen = view.patches();
  const SurfaceField field{9, 0.03};
  const CoherentReceiver receiver = receiver_on(view.apex_m, [](glm::dvec3 p) {
    return refracted(p, {1, 2, 0}, 7e-4);
  });
  const ChannelSignals one = element_signals(seen, receiver, view.model, field),
                       two = drawn_signals(seen, receiver, view.model, 1, 0);
  const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(one.value, element_signals(seen, receiver, view.model, field).value);
  EXPECT_EQ(two.value, drawn_signals(seen, receiver, view.model, 1, 0).value);
}

/// One scatterer: a square smaller than the spacing of the field, facing upwards.
struct OnePlace {
  explicit OnePlace(glm::dvec3 about_m) {
    const double spacing = 0.05;
    for (std::uint64_t seed = 1;; ++seed) {
      field = {seed, spacing};
      seen = {};
      seen.corners_m = {{-0.02, -0.02, 0}, {-0.02, 0.02, 0}, {0.02, 0.02, 0}, {0.02, -0.02, 0}};
      for (glm::dvec3& corner : seen.corners_m) corner += about_m;
      seen.patches = {{0, {0, 0, 1}, -about_m.z, 0, 4, 0, 0}};
      int count = 0;
      field.for_scatterers(seen.corners_m, {0, 0, 1}, [&](glm::dvec3 p, Complex s) {
        ++count;
        x = p;
        z = s;
      });
      if (count == 1) return;
    }
  }
  EchoModel model() const {
    EchoModel its;
    its.material_mu = mu;
    its.material = material;
    return its;
  }
  static constexpr std::array<double, 1> mu{0.1};
  static constexpr std::array<std::uint16_t, 1> material{0};
  VisiblePolygons seen;
  SurfaceField field;
  glm::dvec3 x{0};
  Complex z;
};

/// A pulse of one frequency with constant amplitude.
BasebandPulse even_pulse(double duration_s) {
  return {[=](double) { return Complex(1 / std::sqrt(duration_s)); }, 0, duration_s, 40 / duration_s};
}

// A wavelength is one turn. Phases are accurate to 1e-9 of a turn and amplitudes to 1e-9, over pulses of up
// to 50 ms.
TEST(MovingEnds, KeepPhasesToABillionthOfAWavelength) {
  const OnePlace place({1, 9, -4});
  const glm::dvec3 start(0.1, 0.2, -0.3);
  struct Case {
    const char* name;
    PlatformMotion transmit, receive;
  };
  const Case cases[] = {
      {"slow", straight(start, {0, 2, 0}), straight(start + glm::dvec3(0.3, 0, 0), {0, 2, 0})},
      {"20 m/s", straight(start, {12, 16, 0}), straight(start + glm::dvec3(0.3, 0, 0), {12, 16, 0})},
      {"turning", turning(start, {2, 3, 0}, 1.5, {1, 0.5, 0}), turning(start, {2, 3, 0}, 1.5, {-1, 0.2, 0})},
      {"bent", refracted(start, {5, 1, 0}, 6.1e-3),
       refracted(start + glm::dvec3(0.1, 0, 0), {5, 1, 0}, 6.1e-3)}};
  for (const double duration_s : {1e-4, 2e-3, 50e-3})
    for (const double carrier_hz : {30e3, 400e3})
      for (const Case& its : cases) {
        CoherentReceiver receiver;
        receiver.channels = {{start, start, {}, {}, its.transmit, its.receive}};
        receiver.pulse = even_pulse(duration_s);
        receiver.times = {0.01, std::max(60 / duration_s, 20e3), 0};
        receiver.times.count = std::size_t((duration_s + 0.006) * receiver.times.rate_hz);
        receiver.carrier_hz = carrier_hz;
        const ChannelSignals received =
            element_signals(place.seen, receiver, place.model(), place.field, 1e-12);
        int echoes = 0;
        double worst = 0;
        for (std::size_t n = 0; n < receiver.times.count; ++n) {
          const double t = receiver.times.time_s(n), s = sent_at(t, place.x, its.transmit, its.receive);
          if (s < 1e-9 || s > duration_s - 1e-9) {
            if (s < -1e-9 || s > duration_s + 1e-9) {
              EXPECT_EQ(received.at(0, n), 0.0);
            }
            continue;
          }
          ++echoes;
          const glm::dvec3 from = its.transmit(s), to = its.receive(t);
          const double path = glm::distance(place.x, from) + glm::distance(place.x, to);
          const Complex expected = place.z / std::sqrt(duration_s) *
                                   std::polar(amplitude_of(place.x, {0, 0, 1}, 0.1, 0, from, to, {}),
                                              2 * pi * carrier_hz * path / c);
          worst = std::max(worst, std::abs(received.at(0, n) - expected) / std::abs(expected));
        }
        EXPECT_GT(echoes, 2);
        EXPECT_LT(worst, 2 * pi * 1e-9) << its.name << ", " << duration_s << " s, " << carrier_hz << " Hz";
      }
}

TEST(MovingEnds, ShiftFrequenciesAsDopplerSays) {
  const OnePlace place({0, 30, -6});
  const double carrier_hz = 100e3, duration_s = 20e-3;
  for (const double speed : {-20.0, -2.0, 0.5, 5.0, 20.0})
    for (const double angle : {0.0, 0.6, 1.3}) {
      // The motion is at an angle to the direction of the scatterer.
      const glm::dvec3 towards = glm::normalize(place.x),
                       across = glm::normalize(glm::cross(towards, glm::dvec3(0, 0, 1))),
                       velocity = speed * (std::cos(angle) * towards + std::sin(angle) * across);
      CoherentReceiver receiver;
      receiver.channels = {{{}, {}, {}, {}, straight({}, velocity), straight({}, velocity)}};
      receiver.pulse = even_pulse(duration_s);
      receiver.times = {0.039, 20e3, 520};
      receiver.carrier_hz = carrier_hz;
      const ChannelSignals received = element_signals(place.seen, receiver, place.model(), place.field);
      const auto power = [&](double frequency_hz) {
        Complex sum = 0;
        // With e^{-i omega t}, higher frequencies turn in the opposite direction.
        for (std::size_t n = 0; n < received.samples; ++n)
          sum += received.at(0, n) * std::polar(1.0, 2 * pi * frequency_hz * receiver.times.time_s(n));
        return std::norm(sum);
      };
      double best = 0, step = 20;
      for (double f = -4000; f <= 4000; f += step)
        if (power(f) > power(best)) best = f;
      for (; step > 1e-3; step /= 2)
        for (const double f : {best - step, best + step})
          if (power(f) > power(best)) best = f;
      // The ends approach at v cos, and the angle increases slightly during propagation.
      const double closing = speed * std::cos(angle), exact = carrier_hz * 2 * closing / (c - closing);
      const double turned = std::abs(speed * speed * std::sin(angle) * std::sin(angle)) / 30 * 0.05;
      EXPECT_NEAR(best, exact, 0.05 + 2.5 * carrier_hz / c * turned) << speed << ' ' << angle;
      EXPECT_NEAR(best, 2 * closing * carrier_hz / c,
                  0.05 + 2.5 * carrier_hz / c * turned + 0.03 * std::abs(exact));
    }
}

// For each sound that A transmits at s and B receives at t, B transmits at -t and A receives at -s. The
// paths are traversed backwards.
TEST(MovingEnds, AreReciprocalBackwardsInTime) {
  const OnePlace place({1, 9, -4});
  const PlatformMotion a = turning({0.1, 0.2, -0.3}, {6, 9, 0}, 1.5, {1, 0.5, 0}),
                       b = straight({-0.4, 0.6, 0.2}, {-3, 8, 1});
  CoherentReceiver receiver;
  receiver.channels = {{{}, {}, {}, {}, a, b}};
  receiver.pulse = even_pulse(2e-3);
  receiver.carrier_hz = 200e3;
  for (const double t : {0.0130, 0.0134, 0.0138}) {
    receiver.times = {t, 40e3, 1};
    const Complex there = element_signals(place.seen, receiver, place.model(), place.field, 1e-12).value[0];
    const double s = sent_at(t, place.x, a, b);
    ASSERT_GT(s, 0);
    ASSERT_LT(s, 2e-3);
    // The clock runs backwards from a time within the second pulse.
    const double zero = t + 1e-3;
    CoherentReceiver back = receiver;
    back.channels[0].transmit_motion = [=](double time) { return b(zero - time); };
    back.channels[0].receive_motion = [=](double time) { return a(zero - time); };
    back.times.first_s = zero - s;
    const Complex rx = element_signals(place.seen, back, place.model(), place.field, 1e-12).value[0];
    EXPECT_GT(std::abs(there), 0);
    EXPECT_LT(std::abs(there - rx), 2 * pi * 1e-9 * std::abs(there)) << t;
  }
}

// Law Y1 for moving ends: the phases of the channels at one sample, minus the phase of the path to the
// middle of all channels.
TEST(MovingEnds, PhasesChangeOverPiecesByLessThanTheirBounds) {
  const unsigned seed = 5;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  double tightest = 0;
  for (const test::SignalScene& scene : test::signal_scenes()) {
    const SignalView view(scene, {0.0, 0.0, 0.0});
    const VisiblePolygons seen = view.patches();
    const CoherentReceiver receiver = receiver_on(view.apex_m, [](glm::dvec3 p) {
      return turning(p, {8, 14, 3}, 3, {0.4, -0.3, 0.1});
    });
    const MovingEnds ends(receiver, seen.origin_m);
    SignalExtent extent;
    extent.products = false;
    extent.wavenumber_rad_m = 3000;  // so that phases count
    MovingChannels channels(ends, seen, view.model, extent, 1e-3);
    for (const VisiblePolygon& patch : seen.patches) {
      if (!channels.look_at(patch)) continue;
      const SignalExtent its = channels.extent();
      std::vector<SmoothPieces::Chunk> chunks;
      SmoothPieces(its, 1.5).cut(seen, patch, chunks);
      for (const SmoothPieces::Chunk& chunk : chunks) {
        const int i = int(std::abs(share(random)) * chunk.count_u),
                  j = int(std::abs(share(random)) * chunk.count_v);
        const glm::dvec3 middle = seen.origin_m + chunk.middle_m(i, j),
                         at = middle + share(random) * chunk.size_m.x / 2 * chunk.u +
                              share(random) * chunk.size_m.y / 2 * chunk.v;
        for (const SignalChannel& channel : receiver.channels) {
          // A sample that receives both.
          const double arrives =
              (glm::distance(at, channel.transmit_m) + glm::distance(at, channel.receive_m)) / c;
          const double t = arrives + 3e-4 * share(random);
          const auto path = [&](glm::dvec3 x) {
            const double s = sent_at(t, x, channel.transmit_motion, channel.receive_motion);
            return glm::distance(x, channel.transmit_motion(s)) +
                   glm::distance(x, channel.receive_motion(t)) - glm::distance(x, its.transmit_m[0]) -
                   glm::distance(x, its.receive_m[0]);
          };
          const double phase = 3000 * std::abs(path(at) - path(middle)),
                       most = chunk.change_u + chunk.change_v;
          ASSERT_LE(phase, most) << scene.name;
          tightest = std::max(tightest, phase / most);
        }
      }
    }
  }
  EXPECT_GT(tightest, 0.1);
}

TEST(MovingEnds, RefuseWaysThatAreNone) {
  const test::SignalScene scene = test::signal_scenes()[0];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  const VisiblePolygons seen = view.patches();
  const auto refuses = [&](const PlatformMotion& motion, const std::string& what) {
    CoherentReceiver receiver = receiver_on(view.apex_m, {});
    receiver.channels[1].receive_motion = motion;
    expect_refused([&] { element_signals(seen, receiver, view.model, {1, 0.05}); }, what);
    expect_refused([&] { drawn_signals(seen, receiver, view.model, 1, 0); }, what);
    receiver.channels[1].receive_motion = nullptr;
    receiver.channels[2].transmit_motion = motion;
    EXPECT_THROW(element_signals(seen, receiver, view.model, {1, 0.05}), std::invalid_argument);
  };
  refuses(straight({}, {c, 0, 0}), "the receiver of channel 1 moves at");
  refuses(straight({}, {0, -4000, 0}), "as fast as sound");
  refuses([](double) { return glm::dvec3(NAN, 0, 0); }, "not finite");
  refuses([](double t) { return glm::dvec3(0, t > 0.0055 || std::abs(t) < 1e-4 ? HUGE_VAL : 0, 0); },
          "not finite");
  refuses([](double t) { return glm::dvec3(std::floor(t * 3e3), 0, 0); }, "as fast as sound");
  CoherentReceiver moving = receiver_on(view.apex_m, [](glm::dvec3 p) { return straight(p, {1, 0, 0}); });
  const std::vector<SignalSample> samples{{0, 1}};
  expect_refused([&] { signal_covariances(seen, moving, samples, view.model); },
                 "transmitters and receivers at rest");
}

}  // namespace
}  // namespace tubefoot
