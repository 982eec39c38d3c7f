// SPDX-License-Identifier: GPL-3.0-or-later
// Tests coherent signals of rough surfaces: quadrature rules, pulse bandwidths, covariances of elements,
// their low-rank factors, and signals of a fixed field of scatterers.

#include "engine/signal/coherent_signals.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "engine/signal/surface_scatterers.hpp"
#include "fixtures/world/histories.hpp"
#include "fixtures/world/signal_scenes.hpp"
#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using test::loudest_of;
using test::SignalView;
using test::worst_of;

constexpr double sound_speed = 1500;

/// Four elements across, one of them displaced, with a common transmitter.
CoherentReceiver receiver_at(glm::dvec3 place_m, double carrier_hz = 30e3, double sigma_s = 1e-4) {
  CoherentReceiver receiver;
  for (const double x : {-0.06, -0.02, 0.02, 0.06})
    receiver.channels.push_back({place_m, place_m + glm::dvec3(x, 0, 0)});
  receiver.pulse = gaussian_pulse(sigma_s);
  receiver.times = {5.0e-3, 25e3, 80};
  receiver.carrier_hz = carrier_hz;
  receiver.sound_speed_m_s = sound_speed;
  return receiver;
}

TEST(GaussRule, ItsErrorIsBounded) {
  for (int n = 1; n <= 8; ++n)
    for (const double change : {0.1, 1.0, 3.0}) {
      const GaussRule& rule = gauss_rule(n);
      double sum = 0;
      for (std::size_t k = 0; k < rule.node.size(); ++k)
        sum += rule.weight[k] * std::cos(change * rule.node[k]) / 2;
      EXPECT_LE(std::abs(sum - std::sin(change) / change), gauss_error(n, change) + 1e-15)
          << n << ' ' << change;
      EXPECT_GE(std::abs(sum - std::sin(change) / change) * 4 + 1e-15,
                gauss_error(n, change) * std::exp(-change))
          << n << ' ' << change;
    }
}

TEST(BasebandPulse, ItsWeighedBandIsThatOfItsSpectrum) {
  // The frequencies of a Gaussian pulse are Gaussian: E|x|^12 = 10395.
  const double sigma_s = 1e-4;
  const double wide = weighed_bandwidth_hz(gaussian_pulse(sigma_s), 12);
  EXPECT_NEAR(wide, 2 * std::pow(10395, 1.0 / 12) / (2 * pi * sigma_s), 1e-3 * wide);
  EXPECT_LT(wide, 0.5 * gaussian_pulse(sigma_s).bandwidth_hz);
  // For a rectangular spectrum the result is (integral of x^12)^(1/12) over its half.
  const BasebandPulse even{[](double t) { return t == 0 ? 1 : std::sin(pi * 1e4 * t) / (pi * 1e4 * t); },
                           -0.05, 0.05, 1e4};
  EXPECT_NEAR(weighed_bandwidth_hz(even, 12), 1e4 * std::pow(13, -1.0 / 12), 100);
}

// E|x|^24 of a normal x is 23!!. Short flanks have tails, which finer tolerances include.
TEST(BasebandPulse, ItsResolvedBandLeavesTheTolerance) {
  const double sigma_s = 1e-4, sigma_hz = 1 / (2 * std::sqrt(2.0) * pi * sigma_s);
  const double wide = 2 * sigma_hz * std::pow(316234143225.0, 1.0 / 24);
  EXPECT_NEAR(resolved_bandwidth_hz(gaussian_pulse(sigma_s), 12, 1e-6), wide, 1e-3 * wide);
  // For a coarse tolerance, errors of tails count at most twice.
  const double coarse = resolved_bandwidth_hz(gaussian_pulse(sigma_s), 12, 1e-2);
  EXPECT_LT(coarse, wide);
  EXPECT_GT(coarse, 0.9 * wide);
  const BasebandPulse rectangle{[](double) { return 1; }, 0, 1e-3, 2e3};
  double before = 5 * rectangle.bandwidth_hz;
  for (const double tolerance : {0.1, 1e-2, 1e-3}) {
    const double band = resolved_bandwidth_hz(rectangle, 12, tolerance);
    EXPECT_GE(band, before) << tolerance;
    before = band;
  }
  EXPECT_LE(before, 16e3);  // the limit of the search
}

// Law Y1.
TEST(SmoothPieces, PhasesChangeByLessThanTheirBounds) {
  const unsigned seed = 8;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  double tightest = 0;
  for (const test::SignalScene& scene : test::signal_scenes()) {
    const SignalView view(scene, {0.0, 0.0, 0.0});
    const VisiblePolygons seen = view.patches();
    SignalExtent extent;
    for (int k = 0; k < 4; ++k) {
      extent.transmit_m.push_back(0.2 * glm::dvec3(share(random), share(random), share(random)));
      extent.receive_m.push_back(0.2 * glm::dvec3(share(random), share(random), share(random)));
    }
    extent.wavenumber_rad_m = 300;
    extent.band_rad_m = 20;
    std::vector<SmoothPieces::Chunk> chunks;
    for (const VisiblePolygon& patch : seen.patches) SmoothPieces(extent, 1.5).cut(seen, patch, chunks);
    for (const SmoothPieces::Chunk& chunk : chunks) {
      ASSERT_LE(chunk.change_u, 1.5 + 1e-9);
      ASSERT_LE(chunk.change_v, 1.5 + 1e-9);
      const int i = int(std::abs(share(random)) * chunk.count_u),
                j = int(std::abs(share(random)) * chunk.count_v);
      const glm::dvec3 middle = chunk.middle_m(i, j), at = middle +
                                                           share(random) * chunk.size_m.x / 2 * chunk.u +
                                                           share(random) * chunk.size_m.y / 2 * chunk.v;
      const auto motion = [&](glm::dvec3 p, std::size_t a) {
        return glm::distance(p, extent.transmit_m[a]) + glm::distance(p, extent.receive_m[3 - a]);
      };
      const double most = chunk.change_u + chunk.change_v;
      for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = 0; b < a; ++b) {
          const double phase =
              300 * std::abs((motion(at, a) - motion(at, b)) - (motion(middle, a) - motion(middle, b)));
          ASSERT_LE(phase, most);
          tightest = std::max(tightest, phase / most);
        }
        ASSERT_LE(20 * std::abs(motion(at, a) - motion(middle, a)), most);
      }
    }
  }
  EXPECT_GT(tightest, 0.1);
}

// Law Y2.
TEST(SeabedScatterers, TheirWeightsAreThePatchesAreas) {
  for (const test::SignalScene& scene : test::signal_scenes()) {
    const SignalView view(scene, {0.0, 0.0, 0.0});
    const VisiblePolygons seen = view.patches();
    SignalExtent extent;
    extent.transmit_m = extent.receive_m = {glm::dvec3(-0.1), glm::dvec3(0.1)};
    for (const double k : {0.0, 100.0, 400.0}) {
      extent.wavenumber_rad_m = k;
      extent.band_rad_m = k / 5;
      double sum = 0;
      for (const SurfaceScatterer& s : seabed_scatterers(seen, extent, 1e-6)) {
        sum += s.weight_m2;
        const VisiblePolygon& patch = seen.patches[s.patch];
        ASSERT_NEAR(glm::dot(s.place_m, patch.normal), -patch.distance_m, 1e-12);
      }
      EXPECT_NEAR(sum, seen.area_m2(), 1e-11 * seen.area_m2()) << scene.name;
    }
  }
}

TEST(SignalCovariances, OverAllTimeTheyAreEnergies) {
  // The integral of E|y|^2 over time is that of sigma A^2 dA, the sum over all range bins.
  const test::SignalScene scene = test::signal_scenes()[1];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  CoherentReceiver receiver = receiver_at(view.apex_m);
  receiver.channels = {{view.apex_m, view.apex_m}};
  receiver.times = {0, 25e3, 600};
  std::vector<SignalSample> samples;
  for (std::uint32_t k = 0; k < receiver.times.count; ++k) samples.push_back({0, k});
  const CovarianceMatrix r = signal_covariances(view.patches(), receiver, samples, view.model, 1e-8);
  double sum = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) sum += r.at(k, k).real() / receiver.times.rate_hz;
  const std::vector<std::uint32_t> beams(view.history.tubes.tubes.size(), 0);
  const double energy = test::total(integrate_echo(view.history, {1, beams}, {1, 20, 1}, view.model));
  EXPECT_NEAR(sum, energy, 1e-7 * energy);
}

// Law Y3.
TEST(SignalCovariances, AreHermitianPositiveAndAsExactAsRequested) {
  for (const test::SignalScene& scene : test::signal_scenes()) {
    const SignalView view(scene, {0.0, 0.0, 0.0});
    CoherentReceiver receiver = receiver_at(view.apex_m);
    // Another ping from another position, from which everything is visible that the first ping sees.
    receiver.channels.push_back(
        {view.apex_m + glm::dvec3(0.1, 0, 0.02), view.apex_m + glm::dvec3(0.1, 0.03, 0)});
    receiver.channels.back().receive = {Directivity::Kind::line, {1, 0, 0}, false, 0, 3};
    std::vector<SignalSample> samples;
    for (std::uint32_t c = 0; c < 5; ++c)
      for (std::uint32_t k = 5; k < 40; k += 5) samples.push_back({c, k});
    const VisiblePolygons seen = view.patches();
    const CovarianceMatrix fine = signal_covariances(seen, receiver, samples, view.model, 1e-11);
    double loudest = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) loudest = std::max(loudest, fine.at(k, k).real());
    ASSERT_GT(loudest, 0);
    for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
      const CovarianceMatrix r = signal_covariances(seen, receiver, samples, view.model, tolerance);
      double worst = 0;
      for (std::size_t a = 0; a < samples.size(); ++a)
        for (std::size_t b = 0; b < samples.size(); ++b) {
          worst = std::max(worst, std::abs(r.at(a, b) - fine.at(a, b)));
          ASSERT_EQ(r.at(a, b), std::conj(r.at(b, a)));
        }
      EXPECT_LT(worst, 3 * tolerance * loudest) << scene.name << ' ' << tolerance;
      // throws if the matrix is not semi-definite
      EXPECT_LE(low_rank_factor(r, 1e-10).rest, 1e-10) << scene.name;
    }
  }
}

TEST(SignalCovariances, OfPolygonsInPartsAddUp) {
  const test::SignalScene scene = test::signal_scenes()[4];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  const CoherentReceiver receiver = receiver_at(view.apex_m);
  std::vector<SignalSample> samples;
  for (std::uint32_t c = 0; c < 4; ++c)
    for (std::uint32_t k = 5; k < 40; k += 7) samples.push_back({c, k});
  const VisiblePolygons seen = view.patches();
  VisiblePolygons fans = seen;  // triangles about a point within each polygon
  fans.patches.clear();
  fans.corners_m.clear();
  for (const VisiblePolygon& patch : seen.patches) {
    const auto corners = seen.corners(patch);
    glm::dvec3 middle(0);
    for (const glm::dvec3& c : corners) middle += c / double(corners.size());
    for (std::size_t k = 0; k < corners.size(); ++k) {
      VisiblePolygon part = patch;
      part.first_corner = std::uint32_t(fans.corners_m.size());
      part.corner_count = 3;
      for (const glm::dvec3& c : {corners[k], corners[(k + 1) % corners.size()], middle})
        fans.corners_m.push_back(c);
      fans.patches.push_back(part);
    }
  }
  const CovarianceMatrix whole = signal_covariances(seen, receiver, samples, view.model, 1e-9),
                         parts = signal_covariances(fans, receiver, samples, view.model, 1e-9);
  double loudest = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) loudest = std::max(loudest, whole.at(k, k).real());
  for (std::size_t k = 0; k < whole.value.size(); ++k)
    EXPECT_LT(std::abs(whole.value[k] - parts.value[k]), 3e-9 * loudest);
}

TEST(LowRankFactor, GivesBackTheMatrixAndRefusesOthers) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> gauss;
  constexpr std::size_t n = 20, rank = 6;
  std::vector<Complex> l(n * rank);
  for (Complex& v : l) v = {gauss(random), gauss(random)};
  CovarianceMatrix r{n, std::vector<Complex>(n * n)};
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t k = 0; k < rank; ++k) r.at(a, b) += l[a * rank + k] * std::conj(l[b * rank + k]);
  const LowRankFactor factor = low_rank_factor(r);
  EXPECT_EQ(factor.rank, rank);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      Complex sum = 0;
      for (std::size_t k = 0; k < factor.rank; ++k)
        sum += factor.column[k * n + a] * std::conj(factor.column[k * n + b]);
      EXPECT_LT(std::abs(sum - r.at(a, b)), 1e-12 * r.at(a, a).real() + 1e-11);
    }
  CovarianceMatrix none{2, {1, 2, 2, 1}};
  EXPECT_THROW(low_rank_factor(none), std::invalid_argument);
}

// 16 elements at 2 wavelengths see +-0.2 rad: 30 wavelengths times 0.4 are 12.
TEST(LowRankFactor, AnArraysRankIsItsSpaceBandwidthProduct) {
  const double wavelength = 0.01, range = 20;
  VisiblePolygons sector;  // a strip across under the sonar
  const double half = range * std::tan(0.2);
  sector.corners_m = {
      {-half, 0.01, -range}, {half, 0.01, -range}, {half, -0.01, -range}, {-half, -0.01, -range}};
  sector.patches = {{0, {0, 0, 1}, range, 0, 4, 0, 0}};
  const std::vector<double> mu{0.1};
  const std::vector<std::uint16_t> material{0};
  CoherentReceiver receiver;
  for (int k = 0; k < 16; ++k) receiver.channels.push_back({{}, {2 * wavelength * (k - 7.5), 0, 0}});
  receiver.pulse = gaussian_pulse(1e-3);  // much longer than the strip is deep
  receiver.times = {2 * range / sound_speed, 20e3, 1};
  receiver.carrier_hz = sound_speed / wavelength;
  std::vector<SignalSample> samples;
  for (std::uint32_t c = 0; c < 16; ++c) samples.push_back({c, 0});
  const LowRankFactor factor =
      low_rank_factor(signal_covariances(sector, receiver, samples, {mu, material}, 1e-8), 1e-2);
  EXPECT_GE(factor.rank, 12u);
  EXPECT_LE(factor.rank, 14u);
}

/// The direct sum over the scatterers of the field.
ChannelSignals by_every_scatterer(const VisiblePolygons& seen, const CoherentReceiver& receiver,
                                  const EchoModel& model, const SurfaceField& field) {
  ChannelSignals all{receiver.channels.size(), receiver.times.count, {}};
  all.value.assign(all.channels * all.samples, 0);
  const double k = 2 * pi * receiver.carrier_hz / receiver.sound_speed_m_s;
  for (const VisiblePolygon& patch : seen.patches) {
    std::vector<glm::dvec3> corners;
    for (const glm::dvec3& c : seen.corners(patch)) corners.push_back(c + seen.origin_m);
    field.for_scatterers(corners, patch.normal, [&](glm::dvec3 place, Complex z) {
      for (std::size_t c = 0; c < all.channels; ++c) {
        const ChannelOnPolygon::Reception received =
            ChannelOnPolygon(receiver.channels[c], seen, patch, model).at(place - seen.origin_m);
        for (std::size_t n = 0; n < all.samples; ++n)
          all.value[c * all.samples + n] +=
              z * std::polar(received.amplitude, k * received.path_m) *
              receiver.pulse.at(receiver.times.time_s(n) - received.path_m / receiver.sound_speed_m_s);
      }
    });
  }
  return all;
}

TEST(ElementSignals, AreTheSumOverAllScatterersOfTheField) {
  for (const std::size_t number : {0u, 1u, 4u}) {
    const test::SignalScene scene = test::signal_scenes()[number];
    const SignalView view(scene, {0.0, 0.0, 0.0});
    CoherentReceiver receiver = receiver_at(view.apex_m);
    receiver.times.count = 50;
    receiver.channels[1].receive = {Directivity::Kind::line, {1, 0, 0}, false, 0, 3};
    const SurfaceField field{7, 0.015};
    EchoModel model = view.model;
    model.absorption_db_per_m = 0.1;
    const VisiblePolygons seen = view.patches();
    const ChannelSignals direct = by_every_scatterer(seen, receiver, model, field);
    const double loudest = loudest_of(direct);
    ASSERT_GT(loudest, 0);
    double before = 1;
    for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
      const double worst = worst_of(element_signals(seen, receiver, model, field, tolerance), direct);
      EXPECT_LT(worst, 3 * std::max(tolerance, 1e-6) * loudest) << scene.name << ' ' << tolerance;
      EXPECT_LT(worst, before);
      before = std::max(worst, 1e-6 * loudest);
    }
  }
}

// Pulses with flanks of any length, and without flanks.
TEST(ElementSignals, AreThatSumForFlanksOfAnyLength) {
  const test::SignalScene scene = test::signal_scenes()[1];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  CoherentReceiver receiver = receiver_at(view.apex_m);
  const double length_s = 4e-4;
  for (const double sweep_hz : {0.0, 2e4})
    for (const double taper : {0.0, 0.02, 0.1, 0.5}) {
      const auto envelope = [=](double t) {
        const double flank = taper * length_s / 2, from_end = std::min(t, length_s - t),
                     size = from_end < flank ? (1 - std::cos(pi * from_end / flank)) / 2 : 1;
        return std::polar(size, -pi * sweep_hz * t * (t / length_s - 1));
      };
      receiver.pulse = {envelope, 0, length_s, sweep_hz + 2 * (1 + taper) / length_s};
      set_flanks(receiver.pulse, taper, sweep_hz);
      receiver.times = {5e-3, 40e3, 130};
      const SurfaceField field{7, 0.03};
      const VisiblePolygons seen = view.patches();
      const ChannelSignals direct = by_every_scatterer(seen, receiver, view.model, field);
      const double loudest = loudest_of(direct);
      ASSERT_GT(loudest, 0);
      for (const double tolerance : {1e-2, 1e-3, 1e-5})
        EXPECT_LT(worst_of(element_signals(seen, receiver, view.model, field, tolerance), direct),
                  3 * tolerance * loudest)
            << sweep_hz << ' ' << taper << ' ' << tolerance;
    }
}

TEST(ElementSignals, TheSamePoseHasTheSameBitsForAnyThreads) {
  const test::SignalScene scene = test::signal_scenes()[1];
  const SignalView view(scene, {0.0, 0.0, 0.0}), again(scene, {0.0, 0.0, 0.0});
  const CoherentReceiver receiver = receiver_at(view.apex_m);
  const SurfaceField field{9, 0.02};
  const ChannelSignals one = element_signals(view.patches(), receiver, view.model, field);
  const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(one.value, element_signals(again.patches(), receiver, again.model, field).value);
  SurfaceField other = field;
  other.seed = 10;
  const ChannelSignals two = element_signals(view.patches(), receiver, view.model, other);
  EXPECT_GT(worst_of(one, two), 0.1 * loudest_of(one));
  EXPECT_EQ(drawn_signals(view.patches(), receiver, view.model, 1, 0).value,
            drawn_signals(again.patches(), receiver, again.model, 1, 0).value);
}

/// Compares covariances of draws with expected ones, in units of their statistical errors.
class DrawnCovariances {
 public:
  explicit DrawnCovariances(std::size_t size) : size_(size), sum_(size * size) {}
  void add(const std::vector<Complex>& y) {
    ++draws_;
    for (std::size_t a = 0; a < size_; ++a)
      for (std::size_t b = 0; b < size_; ++b) sum_[a * size_ + b] += y[a] * std::conj(y[b]);
  }
  /// Returns the largest |difference| over sqrt(R_aa R_bb / draws).
  double worst(const CovarianceMatrix& expected, double least_share) const {
    double loudest = 0, most = 0;
    for (std::size_t a = 0; a < size_; ++a) loudest = std::max(loudest, expected.at(a, a).real());
    for (std::size_t a = 0; a < size_; ++a)
      for (std::size_t b = 0; b < size_; ++b) {
        const double size = std::sqrt(expected.at(a, a).real() * expected.at(b, b).real());
        if (size < least_share * loudest) continue;
        most = std::max(most, std::abs(sum_[a * size_ + b] / double(draws_) - expected.at(a, b)) / size *
                                  std::sqrt(double(draws_)));
      }
    return most;
  }

 private:
  std::size_t size_;
  std::vector<Complex> sum_;
  int draws_ = 0;
};

// Compares three methods for the same covariance: the field of the surface, quadrature rules with random
// amplitudes, and R = L L^H.
TEST(ElementSignals, FieldRulesAndFactorsDrawTheSameCovariances) {
  const std::uint64_t seed = 20261124;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const test::SignalScene scene = test::signal_scenes()[1];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  CoherentReceiver receiver = receiver_at(view.apex_m);
  receiver.times = {5.6e-3, 4e3 * 10, 8};
  std::vector<SignalSample> samples;
  for (std::uint32_t c = 0; c < 4; ++c)
    for (std::uint32_t k = 0; k < 8; k += 2) samples.push_back({c, k});
  const VisiblePolygons seen = view.patches();
  const CovarianceMatrix expected = signal_covariances(seen, receiver, samples, view.model, 1e-8);
  const LowRankFactor factor = low_rank_factor(expected, 1e-10);
  constexpr int draws = 250;
  DrawnCovariances by_field(samples.size()), by_rule(samples.size()), by_factor(samples.size());
  const auto picked = [&](const ChannelSignals& signals) {
    std::vector<Complex> y;
    for (const SignalSample& s : samples) y.push_back(signals.at(s.channel, s.sample));
    return y;
  };
  const double spacing = 0.06;
  for (int n = 0; n < draws; ++n) {
    by_field.add(
        picked(element_signals(seen, receiver, view.model, {seed + std::uint64_t(n), spacing}, 1e-3)));
    by_rule.add(picked(drawn_signals(seen, receiver, view.model, seed, std::uint32_t(n), 1e-3)));
    by_factor.add(drawn_samples(factor, seed, std::uint32_t(n)));
  }
  // |difference|^2 draws / (R_aa R_bb) is exponential with mean 1 (a = b: chi squared of 1), for 256
  // values.
  EXPECT_LT(by_field.worst(expected, 1e-3), 5.5);
  EXPECT_LT(by_rule.worst(expected, 1e-3), 5.5);
  EXPECT_LT(by_factor.worst(expected, 1e-3), 5.5);
  EXPECT_GT(by_field.worst(expected, 1e-3), 1);
}

// Signals at another pose have the coherence that the covariances state, for the commonly visible part.
TEST(ElementSignals, AnotherPoseSeesTheSameSurface) {
  const std::uint64_t seed = 77;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const test::SignalScene scene = test::signal_scenes()[0];
  const SignalView here(scene, {0.0, 0.0, 0.0}), there(scene, {0.03, 0.0, 0.01});
  const auto pose = [&](const SignalView& view) {
    CoherentReceiver receiver = receiver_at(view.apex_m);
    receiver.channels = {{view.apex_m, view.apex_m}};
    receiver.times = {6.0e-3, 30e3, 36};
    return receiver;
  };
  const CoherentReceiver a = pose(here), b = pose(there);
  CoherentReceiver both = a;
  both.channels.push_back(b.channels[0]);
  const VisiblePolygons seen_here = here.patches(), seen_there = there.patches();
  const VisiblePolygons common = common_patches(seen_here, seen_there);
  EXPECT_LT(common.area_m2(), seen_here.area_m2());
  EXPECT_GT(common.area_m2(), 0.9 * seen_here.area_m2());
  constexpr int draws = 400;
  std::vector<SignalSample> all;
  for (std::uint32_t c = 0; c < 2; ++c)
    for (std::uint32_t k = 0; k < 36; k += 9) all.push_back({c, k});
  CovarianceMatrix expected = signal_covariances(common, both, all, here.model, 1e-8);
  const auto own = [&](const VisiblePolygons& seen, const CoherentReceiver& receiver, std::size_t first) {
    std::vector<SignalSample> samples;
    for (std::uint32_t k = 0; k < 36; k += 9) samples.push_back({0, k});
    const CovarianceMatrix r = signal_covariances(seen, receiver, samples, here.model, 1e-8);
    for (std::size_t x = 0; x < 4; ++x)
      for (std::size_t y = 0; y < 4; ++y) expected.at(first + x, first + y) = r.at(x, y);
  };
  own(seen_here, a, 0);
  own(seen_there, b, 4);
  DrawnCovariances drawn(8);
  for (int n = 0; n < draws; ++n) {
    const SurfaceField field{seed + std::uint64_t(n), 0.06};
    const ChannelSignals y = element_signals(seen_here, a, here.model, field, 1e-3),
                         z = element_signals(seen_there, b, there.model, field, 1e-3);
    std::vector<Complex> row;
    for (std::size_t k = 0; k < 36; k += 9) row.push_back(y.at(0, k));
    for (std::size_t k = 0; k < 36; k += 9) row.push_back(z.at(0, k));
    drawn.add(row);
  }
  EXPECT_LT(drawn.worst(expected, 1e-3), 5);
  // The poses are neither the same nor uncorrelated.
  const double coherence =
      std::abs(expected.at(0, 4)) / std::sqrt(expected.at(0, 0).real() * expected.at(4, 4).real());
  EXPECT_GT(coherence, 0.3);
  EXPECT_LT(coherence, 0.95);
}

TEST(ElementSignals, OfNothingAreSilence) {
  const CoherentReceiver receiver = receiver_at({0, 0, 0});
  const std::vector<SignalSample> samples{{0, 1}, {3, 2}};
  for (const Complex& v : element_signals({}, receiver, {}, {}).value) EXPECT_EQ(v, 0.0);
  for (const Complex& v : drawn_signals({}, receiver, {}, 1, 0).value) EXPECT_EQ(v, 0.0);
  for (const Complex& v : signal_covariances({}, receiver, samples, {}).value) EXPECT_EQ(v, 0.0);
  // Signals are also zero before the first echo and behind a plate.
  const test::SignalScene scene = test::signal_scenes()[0];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  CoherentReceiver early = receiver_at(view.apex_m);
  early.times = {0, 25e3, 20};
  for (const Complex& v : element_signals(view.patches(), early, view.model, {1, 0.02}).value)
    EXPECT_EQ(v, 0.0);
  const CoherentReceiver below = receiver_at({0, 4.5, -20});
  VisiblePolygons seabed = view.patches();
  std::erase_if(seabed.patches, [](const VisiblePolygon& patch) { return patch.normal.z < 0.9; });
  for (const Complex& v : element_signals(seabed, below, view.model, {1, 0.05}).value) EXPECT_EQ(v, 0.0);
}

TEST(ElementSignals, RefuseWhatIsNone) {
  const test::SignalScene scene = test::signal_scenes()[0];
  const SignalView view(scene, {0.0, 0.0, 0.0});
  const VisiblePolygons seen = view.patches();
  const SurfaceField field;
  const auto refuses = [&](const auto& change) {
    CoherentReceiver receiver = receiver_at(view.apex_m);
    SurfaceField its = field;
    change(receiver, its);
    EXPECT_THROW(element_signals(seen, receiver, view.model, its), std::invalid_argument);
  };
  refuses([](CoherentReceiver& r, SurfaceField&) { r.channels.clear(); });
  refuses([](CoherentReceiver& r, SurfaceField&) { r.carrier_hz = 0; });
  refuses([](CoherentReceiver& r, SurfaceField&) { r.sound_speed_m_s = -1; });
  refuses([](CoherentReceiver& r, SurfaceField&) { r.times.count = 0; });
  refuses([](CoherentReceiver& r, SurfaceField&) { r.times.rate_hz = r.pulse.bandwidth_hz / 2; });
  refuses([](CoherentReceiver& r, SurfaceField&) { r.pulse.envelope = nullptr; });
  refuses([](CoherentReceiver&, SurfaceField& f) { f.spacing_m = 0; });
  refuses([](CoherentReceiver&, SurfaceField& f) { f.spacing_m = 1e-10; });
  refuses([](CoherentReceiver&, SurfaceField& f) {
    f.texture = SurfaceTexture::gamma;
    f.shape = -1;
  });
  const std::vector<SignalSample> beyond{{9, 0}};
  EXPECT_THROW(signal_covariances(seen, receiver_at(view.apex_m), beyond, view.model), std::invalid_argument);
  EXPECT_THROW(signal_covariances(seen, receiver_at(view.apex_m), {}, view.model, 2), std::invalid_argument);
  EXPECT_THROW(gaussian_pulse(0), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
