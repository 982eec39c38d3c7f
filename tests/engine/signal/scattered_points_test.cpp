// SPDX-License-Identifier: GPL-3.0-or-later
// Compares covariances with many draws of dense scatterers. The draws use no polygons: they take points on
// the facets, rays between the points and the sonar, and one sum.
#include <gtest/gtest.h>

#include <random>

#include "engine/signal/coherent_signals.hpp"
#include "engine/signal/gated_covariance.hpp"
#include "fixtures/world/signal_scenes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using test::SignalView;

constexpr double carrier_hz = 30e3, points_sound_speed = 1500,
                 wavenumber = 2 * pi * carrier_hz / points_sound_speed, absorption_db_per_m = 0.3;
const RangeSamples gates{4, 0.25, 10};
constexpr double sigma_s = 1.5e-4, first_s = 5.6e-3, interval_s = 4e-4;
constexpr std::size_t times = 7;

/// The echo of a scatterer in a channel: path length and amplitude, by Lambert's law.
struct Reception {
  double way_m = 0, amplitude = 0;
};
Reception received(const test::ScatteredPlaces::Place& place, const SignalChannel& channel) {
  const glm::dvec3 tx = channel.transmit_m - place.at_m, rx = channel.receive_m - place.at_m;
  const double r = glm::length(tx), s = glm::length(rx);
  const double sines = glm::dot(tx, place.normal) / r * glm::dot(rx, place.normal) / s;
  if (!(sines > 0)) return {};
  const double energy = SignalView::mu[place.material] * sines / (r * r * s * s) *
                        std::pow(10, -absorption_db_per_m * (r + s) / 10);
  return {r + s, std::sqrt(energy)};
}

/// Sums of y y* over draws, and of their squares.
class Draws {
 public:
  explicit Draws(std::size_t size) : size_(size), sum_(size * size), square_(size * size) {}
  void add(const std::vector<Complex>& y) {
    ++count_;
    for (std::size_t a = 0; a < size_; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const Complex product = y[a] * std::conj(y[b]);
        sum_[a * size_ + b] += product;
        square_[a * size_ + b] += std::norm(product);
      }
  }
  /// |difference| over its statistical error.
  double off(std::size_t a, std::size_t b, Complex expected) const {
    const Complex mean = sum_[a * size_ + b] / double(count_);
    const double variance = square_[a * size_ + b] / count_ - std::norm(mean);
    return std::abs(mean - expected) / std::sqrt(variance / count_);
  }
  double power(std::size_t a) const { return sum_[a * size_ + a].real() / count_; }

 private:
  std::size_t size_;
  std::vector<Complex> sum_;
  std::vector<double> square_;
  int count_ = 0;
};

TEST(ScatteredPoints, HaveTheCovariancesOfThePolygonsTheyLieOn) {
  const unsigned seed = 190626;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gauss(0, std::sqrt(0.5));
  int compared = 0, over_three = 0;
  for (const test::SignalScene& scene : test::signal_scenes()) {
    const SignalView view(scene, {0.0, 0.0, 0.0});
    const VisiblePolygons seen = view.patches();
    const std::vector<SignalChannel> channels{{view.apex_m, view.apex_m + glm::dvec3(0.02, 0, 0)},
                                              {view.apex_m, view.apex_m - glm::dvec3(0.02, 0, 0.01)},
                                              {view.apex_m + glm::dvec3(0.02, 0, 0.03), view.apex_m}};
    const test::ScatteredPlaces places(scene);
    const double area = places.area_m2();

    // Each draw has new positions and circular amplitudes.
    constexpr int draws = 300, each = 4000;
    // The scatterers are denser than the resolution of the sector width and of these range gates.
    const double wavelength = points_sound_speed / carrier_hz,
                 bandwidth_hz = points_sound_speed / (2 * gates.step_m);
    ASSERT_GT(each / area, 2 * bandwidth_hz / points_sound_speed * (2 * SignalView::width / wavelength))
        << scene.name;
    const std::size_t gated = std::size_t(gates.count) * channels.size(), timed = times * channels.size();
    Draws by_gate(gated), by_time(timed);
    std::size_t hidden = 0, in_sector = 0;
    for (int n = 0; n < draws; ++n) {
      std::vector<Complex> y(gated), z(timed);
      for (int k = 0; k < each; ++k) {
        const auto place = places(random);
        if (!view.in_sector(place.at_m)) continue;
        ++in_sector;
        if (!places.seen(place, view.apex_m)) {
          ++hidden;
          continue;
        }
        auto towards = place;  // the side that the sonar is on
        if (glm::dot(place.normal, view.apex_m - place.at_m) < 0) towards.normal = -place.normal;
        const Complex field = std::sqrt(area / each) * Complex(gauss(random), gauss(random));
        for (std::size_t c = 0; c < channels.size(); ++c) {
          const Reception h = received(towards, channels[c]);
          if (h.amplitude == 0) continue;
          const Complex echo = field * std::polar(h.amplitude, wavenumber * h.way_m);
          const double gate = std::floor((h.way_m / 2 - gates.first_m) / gates.step_m);
          if (gate >= 0 && gate < gates.count) y[c * std::size_t(gates.count) + std::size_t(gate)] += echo;
          for (std::size_t t = 0; t < times; ++t) {
            const double late = (first_s + double(t) * interval_s - h.way_m / points_sound_speed) / sigma_s;
            z[c * times + t] += echo * std::exp(-late * late / 2) / std::sqrt(sigma_s * std::sqrt(pi));
          }
        }
      }
      by_gate.add(y);
      by_time.add(z);
    }
    EXPECT_GT(double(hidden), 0.01 * double(in_sector)) << scene.name << " has no shadow";

    EchoModel model = view.model;
    model.absorption_db_per_m = absorption_db_per_m;
    const auto compare = [&](const Draws& drawn, std::size_t a, std::size_t b, Complex expected,
                             double loudest) {
      if (std::sqrt(drawn.power(a) * drawn.power(b)) < 1e-3 * loudest) return;
      if (std::abs(expected) == 0) return;
      const double off = drawn.off(a, b, expected);
      ++compared;
      over_three += off > 3;
      EXPECT_LT(off, 5.5) << scene.name << ' ' << a << ' ' << b << ' ' << expected;
    };
    const auto loudest = [](const Draws& drawn, std::size_t size) {
      double most = 0;
      for (std::size_t a = 0; a < size; ++a) most = std::max(most, drawn.power(a));
      return most;
    };
    const std::size_t count = std::size_t(gates.count);
    for (std::size_t c = 0; c < channels.size(); ++c)
      for (std::size_t d = 0; d <= c; ++d) {
        const SampleCovariances r =
            gated_covariances(seen, channels[c], channels[d], gates, wavenumber, model, 1e-8);
        for (std::size_t k = 0; k < count; ++k)
          for (std::size_t j = 0; j < count; ++j)
            if (c * count + k >= d * count + j)
              compare(by_gate, c * count + k, d * count + j, r.at(int(k), int(j)), loudest(by_gate, gated));
      }
    CoherentReceiver receiver{channels,
                              gaussian_pulse(sigma_s),
                              {first_s, 1 / interval_s * 16, 16 * times},
                              carrier_hz,
                              points_sound_speed};
    std::vector<SignalSample> samples;
    for (std::uint32_t c = 0; c < channels.size(); ++c)
      for (std::uint32_t t = 0; t < times; ++t) samples.push_back({c, 16 * t});
    const CovarianceMatrix r = signal_covariances(seen, receiver, samples, model);
    for (std::size_t a = 0; a < timed; ++a)
      for (std::size_t b = 0; b <= a; ++b) compare(by_time, a, b, r.at(a, b), loudest(by_time, timed));
  }
  EXPECT_GT(compared, 1000);
  // off^2 is approximately exponential: e^-9, or less for real values
  EXPECT_LT(over_three, 0.02 * compared);
  RecordProperty("compared", compared);
}

}  // namespace
}  // namespace tubefoot
