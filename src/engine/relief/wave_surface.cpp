// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/wave_surface.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "engine/relief/portable_random.hpp"

// The phase of a component at a node is a sum of three parts: along east, along north, and over time. The
// products of their cosines and sines give the heights of a whole lattice with few trigonometric functions.
// Those are long double, so that all x86 machines compute the same heights.

namespace tubefoot {
namespace {

using Real = long double;

constexpr int direction_cells = 24;
/// Ratio of the frequencies at the ends of a cell. The peak of JONSWAP is about four cells wide.
constexpr Real frequency_ratio = 1.05L;
constexpr double longest_of_peak = 0.5;
/// Cells with a smaller share of the energy of their frequency have no component.
constexpr Real least_share = 1e-7L;

/// Random numbers of a cell of the spectrum: a place in the cell, from 0 to 1, and a phase.
struct CellRandom {
  double frequency, direction, cosine, sine;
};

CellRandom cell_random(std::uint64_t seed, std::int64_t frequency, std::int64_t direction) {
  constexpr std::uint64_t of_places = 0x7761766573, of_phases = 0x7068617365;
  // The squares of two normal deviates sum to an exponential deviate, which their angle does not influence.
  const auto uniform = [](std::array<double, 2> z) { return portable_exp(-(z[0] * z[0] + z[1] * z[1]) / 2); };
  const std::array<double, 2> phase = normal_pair(seed, of_phases, frequency, direction),
                              place = normal_pair(seed, of_places, frequency, direction);
  const double length = std::sqrt(phase[0] * phase[0] + phase[1] * phase[1]);
  return {uniform(phase), uniform(place), phase[0] / length, phase[1] / length};
}

/// Returns the shares of the energy by cell of the angle from the mean direction, which begins at -pi.
std::array<Real, direction_cells> shares_of(double exponent) {
  constexpr int nodes = 64;
  std::array<Real, direction_cells> shares{};
  Real sum = 0;
  for (int cell = 0; cell < direction_cells; ++cell)
    for (int k = 0; k < nodes; ++k) {
      const Real angle = std::numbers::pi_v<Real> * (2 * (cell + (k + 0.5L) / nodes) / direction_cells - 1);
      const Real share = std::pow(std::abs(std::cos(angle / 2)), static_cast<Real>(2 * exponent));
      shares[static_cast<std::size_t>(cell)] += share;
      sum += share;
    }
  for (Real& share : shares) share /= sum;
  return shares;
}

void add_phases(Real wavenumber, std::span<const double> places_m, std::vector<double>& cosines,
                std::vector<double>& sines) {
  for (const double place : places_m) {
    cosines.push_back(static_cast<double>(std::cos(wavenumber * place)));
    sines.push_back(static_cast<double>(std::sin(wavenumber * place)));
  }
}

}  // namespace

WaveSurface::WaveSurface(const WaveSpectrum& spectrum, const WaveDirections& directions, double shortest_m,
                         std::uint64_t seed) {
  constexpr Real pi = std::numbers::pi_v<Real>, degree = pi / 180;
  const std::array<Real, direction_cells> shares = shares_of(directions.exponent);
  const Real first = longest_of_peak * spectrum.peak_rad_s(), end = deep_water_frequency(shortest_m);
  Real lo = first;
  for (std::int64_t band = 0; lo < end; ++band) {
    const Real hi = first * std::pow(frequency_ratio, static_cast<Real>(band + 1)), to = std::min(hi, end);
    const Real variance = spectrum.variance_m2(static_cast<double>(lo), static_cast<double>(to));
    for (int cell = 0; cell < direction_cells; ++cell) {
      const Real share = shares[static_cast<std::size_t>(cell)];
      if (share < least_share) continue;
      const CellRandom random = cell_random(seed, band, cell);
      const Real frequency = lo * std::pow(to / lo, static_cast<Real>(random.frequency)),
                 direction = directions.towards_deg * degree +
                             pi * (2 * (cell + random.direction) / direction_cells - 1),
                 wavenumber = frequency * frequency / standard_gravity_m_s2;
      components_.push_back(
          {static_cast<double>(std::sqrt(2 * variance * share)), static_cast<double>(frequency),
           static_cast<double>(wavenumber * std::sin(direction)),
           static_cast<double>(wavenumber * std::cos(direction)), random.cosine, random.sine});
    }
    lo = hi;
  }
}

double WaveSurface::variance_m2() const {
  double sum = 0;
  for (const Component& c : components_) sum += c.amplitude_m * c.amplitude_m / 2;
  return sum;
}

double WaveSurface::slope_variance() const {
  double sum = 0;
  for (const Component& c : components_)
    sum += c.amplitude_m * c.amplitude_m / 2 * (c.east_rad_m * c.east_rad_m + c.north_rad_m * c.north_rad_m);
  return sum;
}

double WaveSurface::bound_m() const {
  double sum = 0;
  for (const Component& c : components_) sum += c.amplitude_m;
  return sum;
}

WaveLattice::WaveLattice(const WaveSurface& surface, std::span<const double> east_m,
                         std::span<const double> north_m)
    : columns_(east_m.size()), rows_(north_m.size()) {
  for (const WaveSurface::Component& c : surface.components()) {
    waves_.push_back({c.amplitude_m, c.frequency_rad_s, c.cosine, c.sine});
    add_phases(c.east_rad_m, east_m, east_cosine_, east_sine_);
    add_phases(c.north_rad_m, north_m, north_cosine_, north_sine_);
  }
}

std::vector<double> WaveLattice::heights_m(double time_s) const {
  std::vector<double> cosine, sine;  // of the phase at the origin, times the amplitude
  for (const Wave& wave : waves_) {
    const Real turned = static_cast<Real>(wave.frequency_rad_s) * time_s;
    const double c = static_cast<double>(std::cos(turned)), s = static_cast<double>(std::sin(turned));
    cosine.push_back(wave.amplitude_m * (wave.cosine * c + wave.sine * s));
    sine.push_back(wave.amplitude_m * (wave.sine * c - wave.cosine * s));
  }
  std::vector<double> heights(columns_ * rows_, 0.0);
  for (std::size_t row = 0; row < rows_; ++row) {
    double* const height = heights.data() + row * columns_;
    for (std::size_t k = 0; k < waves_.size(); ++k) {
      const double nc = north_cosine_[k * rows_ + row], ns = north_sine_[k * rows_ + row],
                   c = cosine[k] * nc - sine[k] * ns, s = sine[k] * nc + cosine[k] * ns;
      const double* const ec = east_cosine_.data() + k * columns_;
      const double* const es = east_sine_.data() + k * columns_;
      for (std::size_t column = 0; column < columns_; ++column)
        height[column] += c * ec[column] - s * es[column];
    }
  }
  return heights;
}

}  // namespace tubefoot
