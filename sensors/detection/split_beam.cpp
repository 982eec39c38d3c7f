// SPDX-License-Identifier: GPL-3.0-or-later
// Detects the bottom in the phase between a beam's halves. The code fits a line to the phase of the product
// of both signals. A search for the slope with the largest sum precedes weighted least squares. The line's
// zero is the detection.

#include "sensors/detection/split_beam.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sensors/detection/interferometry.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

constexpr double least_looks = 4, least_turn_rad = 0.5;

/// Samples [begin, end) about a position.
struct SpanAbout {
  std::ptrdiff_t begin = 0, end = 0;
};

SpanAbout about(double place, double half, std::size_t count) {
  const auto last = static_cast<double>(count);
  return {static_cast<std::ptrdiff_t>(std::clamp(std::ceil(place - half), 0.0, last)),
          static_cast<std::ptrdiff_t>(std::clamp(std::floor(place + half) + 1, 0.0, last))};
}

/// phase = slope (sample - zero).
struct PhaseLine {
  double zero = 0, slope_rad = 0;
};

/// Searches slopes up to sixteen times the slope at which the window is the main lobe. It selects the slope
/// with the largest coherent sum of the product, which phase wrapping does not disturb. From one slope to
/// the next the phase at the window's end changes by half a radian.
std::optional<PhaseLine> first_line(std::span<const Complex> product, SpanAbout span,
                                    const SplitBeamSearch& search) {
  constexpr double steepest = 16, step_rad = 0.5;
  const double half = std::max(search.half_window, 1.0), step = step_rad / half;
  const int most = static_cast<int>(std::min(std::numbers::pi, steepest * search.edge_rad / half) / step);
  Complex best = 0;
  double slope_rad = 0;
  for (int k = -most; k <= most; ++k) {
    const double own = k * step;
    const Complex turn = std::polar(1.0, -own);
    Complex back = std::polar(1.0, -own * (static_cast<double>(span.begin) - search.from)), sum = 0;
    for (std::ptrdiff_t at = span.begin; at < span.end; ++at, back *= turn)
      sum += product[static_cast<std::size_t>(at)] * back;
    if (std::norm(sum) <= std::norm(best)) continue;
    best = sum;
    slope_rad = own;
  }
  if (slope_rad == 0) return std::nullopt;
  return PhaseLine{search.from - std::arg(best) / slope_rad, slope_rad};
}

/// Sums of weighted least squares, with positions relative to `origin`.
struct LineSums {
  double weight = 0, place = 0, phase = 0, place2 = 0, both = 0;
  std::size_t samples = 0;
};

}  // namespace

double level_seabed_bend(double range_m, double sine, double step_m) {
  // From s = sqrt(1 - h^2 / r^2) the result is half of s'' / s'. Straight below the sonar there is no line.
  constexpr double least_sine = 0.05;
  const double cosine2 = 1 - sine * sine, bounded = std::max(sine, least_sine);
  return -0.5 * (3 + cosine2 / (bounded * bounded)) / range_m * step_m;
}

std::optional<SplitBeamDetection> split_beam_zero(std::span<const Complex> product,
                                                  const SplitBeamSearch& search) {
  if (!(search.half_window >= 0 && search.samples_a_look >= 1 && search.edge_rad > 0 &&
        search.edge_rad < std::numbers::pi))
    throw std::invalid_argument(
        "split beam: the window must have 0 or more samples, a look must have 1 or more samples, and the "
        "main lobe must end between phases of 0 and pi");
  std::optional<PhaseLine> line =
      first_line(product, about(search.from, search.half_window, product.size()), search);
  constexpr int rounds = 3;
  for (int round = 0; round < rounds && line; ++round) {
    // Restricts the fit to the part of the line within the main lobe and the window.
    const double half = std::min(search.half_window, search.edge_rad / std::abs(line->slope_rad));
    if (std::abs(line->zero - search.from) > search.half_window) return std::nullopt;
    const SpanAbout span = about(line->zero, half, product.size());
    const double origin = line->zero;
    const auto each = [&](auto use) {
      for (std::ptrdiff_t k = span.begin; k < span.end; ++k) {
        const Complex value = product[static_cast<std::size_t>(k)];
        const double weight = std::abs(value), straight = static_cast<double>(k) - origin;
        if (!(weight > 0)) continue;
        const double away = straight * (1 + search.bend * straight);
        const double expected = line->slope_rad * away;
        use(weight, away, expected + wrapped(std::arg(value) - expected));
      }
    };
    LineSums sums;
    each([&](double weight, double away, double phase) {
      ++sums.samples;
      sums.weight += weight;
      sums.place += weight * away;
      sums.phase += weight * phase;
    });
    const double looks = static_cast<double>(sums.samples) / search.samples_a_look;
    if (looks < least_looks || sums.samples < 3 || 2 * half * std::abs(line->slope_rad) < least_turn_rad)
      return std::nullopt;
    const double place = sums.place / sums.weight, phase = sums.phase / sums.weight;
    each([&](double weight, double away, double own) {
      sums.place2 += weight * (away - place) * (away - place);
      sums.both += weight * (away - place) * (own - phase);
    });
    const double slope_rad = sums.both / sums.place2;
    if (!(sums.place2 > 0) || slope_rad == 0) return std::nullopt;
    const double zero = place - phase / slope_rad;
    if (round + 1 == rounds) {
      double residual = 0;
      each([&](double weight, double away, double own) {
        const double off = own - phase - slope_rad * (away - place);
        residual += weight * off * off;
      });
      // Samples of one look are one observation. The variance of a sample of weight 1 is residual / n. The
      // factor n / (n - 2 looks) accounts for the two fitted parameters. The samples of a look count once,
      // and n cancels.
      const double variance = residual / (looks - 2);
      const double sigma =
          std::sqrt(variance * (1 / sums.weight + (zero - place) * (zero - place) / sums.place2)) /
          std::abs(slope_rad);
      if (std::abs(origin + zero - search.from) > search.half_window || !std::isfinite(sigma))
        return std::nullopt;
      return SplitBeamDetection{origin + zero, sigma, slope_rad, sums.samples};
    }
    line = PhaseLine{origin + zero, slope_rad};
  }
  return std::nullopt;
}

}  // namespace tubefoot
