// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "compare/measures/echo_errors.hpp"

// Simulates a sonar over a plane with two spheres and a wall, in closed form by rays, with any faults of an
// engine.
namespace tubefoot {

/// Faults of an engine. Angles are in degrees.
struct Mistakes {
  double beam_shift = 0, sample_shift = 0;  ///< towards larger numbers
  bool mirror = false, halves_swapped = false;
  double azimuth_scale = 0, range_scale = 0;  ///< relative excess
  int tangent_views = 0;
  double scallop_samples = 0;  ///< depth of the three arcs of the near edge
  bool near_clipping = false;  ///< objects nearer than the range gate cast no shadow
  double cut_m = 0;            ///< no echo from shorter ranges
  double law = 0, gain = 1;    ///< energies times r^law and gain
  bool no_shadow = false;      ///< the seabed is visible through the objects
  double noise = 0;            ///< deviation relative to the mean echo, clipped at 0
  double speckle = 0;          ///< relative deviation of single bins
  double blur = 0;             ///< variance, bins^2
  double range_blur = 0;       ///< variance at the last range bin, which grows with the square of the range
  double taper = 0;            ///< part of the fan's height at either end in which the gain falls to 0
  bool ping_gains = false;     ///< the gains of three pings are 1, 0.4 and 2
  bool one_material = false;   ///< objects scatter as the seabed does
  bool mean = false;           ///< mean instead of sum over the rays of a bin, without spreading
  int bits = 0;                ///< of amplitude
};

/// The fan: 72 beams of 0.75 degrees, 200 samples of 8 cm from 4 m on.
class PlantedFan {
 public:
  static constexpr std::size_t beams = 72, samples = 200;
  static constexpr double beam_deg = 0.75, first_m = 4, sample_m = 0.08;

  explicit PlantedFan(std::size_t number_of_pings = 1) : pings(number_of_pings) {
    for (std::size_t b = 0; b < beams; ++b)
      azimuths_deg.push_back((static_cast<double>(b) - (beams - 1) / 2.0) * beam_deg);
    for (std::size_t s = 0; s < samples; ++s)
      ranges_m.push_back(first_m + (static_cast<double>(s) + 0.5) * sample_m);
    elevation_deg.assign(pings * beams * samples, NAN);
    object.assign(elevation_deg.size(), none);
    caster.assign(elevation_deg.size(), none);
    truth = picture({}, 12, 3000, 1);
    label();
  }

  EchoShape shape() const { return {pings, beams, samples}; }

  /// Computes the energies by stratified rays in columns and rows of each beam.
  std::vector<double> picture(const Mistakes& mistakes, int columns, int rows, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> within(0, 1);
    std::vector<double> all;
    for (std::size_t ping = 0; ping < pings; ++ping) {
      std::vector<double> energy(beams * samples), rays(beams * samples);
      for (std::size_t b = 0; b < beams; ++b)
        for (int c = 0; c < columns; ++c)
          for (int r = 0; r < rows; ++r) {
            const double place = static_cast<double>(b) + (c + within(random)) / columns - beams / 2.0;
            cast(mistakes, ping, b, azimuth_of(mistakes, place * beam_deg), (r + within(random)) / rows,
                 1.0 / columns / rows, energy, rays);
          }
      for (std::size_t k = 0; mistakes.mean && k < energy.size(); ++k) energy[k] /= std::max(rays[k], 1e-300);
      energy = received(mistakes, std::move(energy), random);
      constexpr std::array<double, 3> gains{1, 0.4, 2};
      for (double& e : energy) e *= mistakes.ping_gains ? gains[ping % 3] : 1;
      all.insert(all.end(), energy.begin(), energy.end());
    }
    return all;
  }

  static constexpr std::uint16_t none = 0xffff;
  std::size_t pings;
  std::vector<double> azimuths_deg, ranges_m, truth;
  /// Mean elevation of the rays of each bin, and the object that they meet. `caster` is 0 in the shadow of
  /// the rod before the range gate.
  std::vector<float> elevation_deg;
  std::vector<std::uint16_t> object, caster;

 private:
  static constexpr double radians = M_PI / 180, height_m = 3, low_deg = -32, high_deg = -8;

  /// Returns the true direction of the energy that an engine shows at a nominal azimuth.
  static double azimuth_of(const Mistakes& m, double nominal_deg) {
    double azimuth = nominal_deg;
    const double half = beams * beam_deg / 2;
    if (m.tangent_views > 0) {
      const double view = half / m.tangent_views;
      const double number = std::clamp(std::floor((azimuth + half) / (2 * view)), 0.0, m.tangent_views - 1.0);
      const double middle = -half + (2 * number + 1) * view;
      azimuth = middle + std::atan((azimuth - middle) / view * std::tan(view * radians)) / radians;
    }
    azimuth -= m.beam_shift * beam_deg;
    azimuth /= 1 + m.azimuth_scale;
    if (m.mirror) azimuth = -azimuth;
    if (m.halves_swapped) azimuth += azimuth < 0 ? half : -half;
    return azimuth;
  }

  struct Hit {
    double range_m = INFINITY, strength = 0;  ///< mu times the sine of the grazing angle
    std::uint16_t object = 0;                 ///< 0: seabed, 1: an object
  };

  /// One ray: its share of the height of the fan, and the gain of the engine's vertical pattern there.
  static double taper_at(const Mistakes& m, double share) {
    if (m.taper == 0) return 1;
    const double x = std::clamp(std::min(share, 1 - share) / m.taper, 0.0, 1.0);
    return x * x * (3 - 2 * x);
  }

  static Hit sphere(const std::array<double, 3>& d, const std::array<double, 3>& centre, double radius,
                    double mu) {
    const double along = d[0] * centre[0] + d[1] * centre[1] + d[2] * (centre[2] - height_m);
    const double squared = centre[0] * centre[0] + centre[1] * centre[1] +
                           (centre[2] - height_m) * (centre[2] - height_m) - along * along;
    if (squared > radius * radius || along < 0) return {};
    const double half = std::sqrt(radius * radius - squared);
    return {along - half, mu * half / radius, 1};
  }

  static Hit wall(const std::array<double, 3>& d, double ahead_m) {  // from (2, 11, 0) to (4, 12, 1.2)
    const std::array<double, 2> from{2, 11 - ahead_m}, way{2, 1},
        normal{-1 / std::sqrt(5.0), 2 / std::sqrt(5.0)};
    const double speed = d[0] * normal[0] + d[1] * normal[1];
    const double r = (from[0] * normal[0] + from[1] * normal[1]) / speed;
    const double u = ((r * d[0] - from[0]) * way[0] + (r * d[1] - from[1]) * way[1]) / 5,
                 z = height_m + r * d[2];
    if (!(r > 0) || u < 0 || u > 1 || z < 0 || z > 1.2) return {};
    return {r, 0.6 * std::abs(speed), 1};
  }

  struct Ray {
    Hit seabed, object;
    bool behind_rod = false;  ///< the end of a rod before the range gate hides both
    double elevation = 0;
  };

  /// The sonar moves by 0.4 m per ping.
  static Ray trace(std::size_t ping, double azimuth_deg, double elevation) {
    const double azimuth = azimuth_deg * radians, ahead_m = 0.4 * static_cast<double>(ping);
    const std::array<double, 3> d{std::sin(azimuth) * std::cos(elevation),
                                  std::cos(azimuth) * std::cos(elevation), std::sin(elevation)};
    const double seabed_m = height_m / -d[2], x = seabed_m * d[0], y = seabed_m * d[1] + ahead_m;
    Ray ray;
    ray.seabed = {seabed_m,
                  (0.2 + 0.06 * std::sin(1.9 * x + 0.7 * y) + 0.05 * std::sin(1.1 * x - 2.3 * y)) * -d[2], 0};
    ray.object = std::min({sphere(d, {-2.2, 7 - ahead_m, 0.6}, 0.6, 1),
                           sphere(d, {1.0, 8.6 - ahead_m, 0.5}, 0.45, 0.8), wall(d, ahead_m)},
                          [](const Hit& a, const Hit& b) { return a.range_m < b.range_m; });
    ray.behind_rod = std::isfinite(sphere(d, {0.75, 2.4, 1.95}, 0.2, 1).range_m);
    ray.elevation = elevation;
    return ray;
  }

  static double low_of(const Mistakes& m, std::size_t beam) {
    if (m.scallop_samples == 0) return low_deg;
    // Arcs of three views, deepest in their middles.
    const double view = static_cast<double>(beam) / beams * 3, off = 2 * (view - std::floor(view)) - 1;
    const double metres = m.scallop_samples * sample_m * (1 - off * off),
                 near = height_m / std::sin(-low_deg * radians);
    return -std::asin(height_m / (near + metres)) / radians;
  }

  void cast(const Mistakes& m, std::size_t ping, std::size_t beam, double azimuth_deg, double share,
            double weight, std::vector<double>& energy, std::vector<double>& rays) const {
    const double low = low_of(m, beam);
    const double elevation = (low + share * (high_deg - low)) * radians;
    weight *= (high_deg - low) / (high_deg - low_deg) * std::cos(elevation);
    const double gain = taper_at(m, share);
    Ray ray = trace(ping, azimuth_deg, elevation);
    if (ray.behind_rod && !m.near_clipping) return;
    if (m.one_material) ray.object.strength *= 0.25;
    if (ray.object.range_m < ray.seabed.range_m) {
      put(m, beam, ray.object, weight, gain, energy, rays);
      if (!m.no_shadow) return;
    }
    put(m, beam, ray.seabed, weight, gain, energy, rays);
  }

  /// Labels of the bins from the middles of the beams.
  void label() {
    constexpr int rows = 3000;
    for (std::size_t column = 0; column < pings * beams; ++column) {
      std::vector<double> sums(samples), counts(samples);
      for (int r = 0; r < rows; ++r) {
        const double elevation = (low_deg + (r + 0.5) / rows * (high_deg - low_deg)) * radians;
        const Ray ray = trace(column / beams, azimuths_deg[column % beams], elevation);
        const Hit& hit = ray.object.range_m < ray.seabed.range_m ? ray.object : ray.seabed;
        const double place = (hit.range_m - first_m) / sample_m;
        if (place < 0 || place >= samples) continue;
        const auto s = static_cast<std::size_t>(place);
        if (ray.behind_rod) {
          caster[column * samples + s] = 0;
          continue;
        }
        object[column * samples + s] = hit.object;
        sums[s] += elevation / radians;
        ++counts[s];
      }
      for (std::size_t s = 0; s < samples; ++s)
        if (counts[s] > 0) elevation_deg[column * samples + s] = static_cast<float>(sums[s] / counts[s]);
    }
  }

  static void put(const Mistakes& m, std::size_t beam, const Hit& hit, double weight, double gain,
                  std::vector<double>& energy, std::vector<double>& rays) {
    const double shown = hit.range_m * (1 + m.range_scale) + m.sample_shift * sample_m;
    const double place = (shown - first_m) / sample_m;
    if (place < 0 || place >= samples || hit.range_m < m.cut_m) return;
    const double r = hit.range_m;
    const std::size_t bin = beam * samples + static_cast<std::size_t>(place);
    rays[bin] += weight;
    energy[bin] += weight * gain * hit.strength * (m.mean ? 1 : 1 / (r * r)) *
                   (m.law == 0 ? 1 : std::pow(r, m.law)) * m.gain;
  }

  /// Spreads each bin along range by a Gaussian whose variance grows with the square of the range.
  static void spread(double variance_at_end, std::vector<double>& energy) {
    const std::vector<double> sharp = energy;
    std::fill(energy.begin(), energy.end(), 0.0);
    constexpr double last_m = first_m + samples * sample_m;
    for (std::size_t k = 0; k < sharp.size(); ++k) {
      const int s = static_cast<int>(k % samples);
      const double r = first_m + (s + 0.5) * sample_m, variance = variance_at_end * r * r / last_m / last_m;
      std::array<double, 25> kernel{};
      double sum = 0;
      for (int j = -12; j <= 12; ++j)
        sum += kernel[static_cast<std::size_t>(j + 12)] = std::exp(-j * j / (2 * variance));
      for (int j = -12; j <= 12; ++j)
        if (s + j >= 0 && s + j < static_cast<int>(samples))
          energy[k + static_cast<std::size_t>(j)] +=
              sharp[k] * kernel[static_cast<std::size_t>(j + 12)] / sum;
    }
  }

  /// Applies the receiver effects after the rays: speckle, blur, noise, bits.
  static std::vector<double> received(const Mistakes& m, std::vector<double> energy, std::mt19937& random) {
    std::normal_distribution<double> normal(0, 1);
    if (m.speckle > 0)
      for (double& e : energy) e *= std::max(0.0, 1 + m.speckle * normal(random));
    if (m.range_blur > 0) spread(m.range_blur, energy);
    if (m.blur > 0) {  // a kernel of 5 x 5
      std::array<double, 5> kernel{};
      double sum = 0;
      for (int k = -2; k <= 2; ++k)
        sum += kernel[static_cast<std::size_t>(k + 2)] = std::exp(-k * k / (2 * m.blur));
      for (double& k : kernel) k /= sum;
      const std::vector<double> sharp = energy;
      for (int b = 0; b < int(beams); ++b)
        for (int s = 0; s < int(samples); ++s) {
          double total = 0;
          for (int i = -2; i <= 2; ++i)
            for (int j = -2; j <= 2; ++j)
              if (b + i >= 0 && b + i < int(beams) && s + j >= 0 && s + j < int(samples))
                total += kernel[static_cast<std::size_t>(i + 2)] * kernel[static_cast<std::size_t>(j + 2)] *
                         sharp[static_cast<std::size_t>((b + i) * int(samples) + s + j)];
          energy[static_cast<std::size_t>(b * int(samples) + s)] = total;
        }
    }
    double mean = 0, lit = 0, top = 0;
    for (const double e : energy) mean += e, lit += e > 0, top = std::max(top, e);
    mean /= lit;
    if (m.noise > 0)
      for (double& e : energy) e = std::max(0.0, e + m.noise * mean * normal(random));
    if (m.bits > 0) {
      const double levels = std::ldexp(1, m.bits) - 1;
      for (double& e : energy) e = std::pow(std::round(std::sqrt(e / top) * levels) / levels, 2) * top;
    }
    return energy;
  }
};

}  // namespace tubefoot
