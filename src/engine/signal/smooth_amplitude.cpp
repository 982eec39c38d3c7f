// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/smooth_amplitude.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

#include "geometry/integrals/polygon_transform.hpp"
#include "geometry/numbers/scalars.hpp"

// Computes the Kirchhoff integral of a smooth polygon for plane waves, with a bound of the error, and by its
// edges. Source: docs/notes/smooth-surfaces.md, "The integral".

namespace tubefoot {
namespace {

constexpr double four_pi = 4 * std::numbers::pi;

/// Integral of the squared distance from `place`, which is relative to the first corner.
double second_moment(std::span<const glm::dvec2> offsets, glm::dvec2 place) {
  double sum = 0;
  const std::size_t n = offsets.size();
  for (std::size_t k = 0; k < n; ++k) {
    const glm::dvec2 a = offsets[k] - place, b = offsets[k + 1 == n ? 0 : k + 1] - place;
    sum += cross(a, b) * (glm::dot(a, a) + glm::dot(a, b) + glm::dot(b, b)) / 12;
  }
  return std::abs(sum);
}

double range(double height, glm::dvec2 from_foot) {
  return std::sqrt(height * height + glm::dot(from_foot, from_foot));
}

}  // namespace

FarAmplitude far_amplitude(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, double k) {
  const double h = polygon.distance, g = rx.distance;
  if (!(h > 0) || !(g > 0) || polygon.offsets.size() < 3) return {};
  const glm::dvec2 middle = centroid_offset(polygon), place = polygon.first + middle;
  const double r = range(h, place), s = range(g, place - rx.foot);
  const std::complex<double> ik(0, k);
  // Density of the integral. Both heights are constant over the plane.
  const std::complex<double> density = -(h * (ik - 1 / r) / (r * r * s) + g * (ik - 1 / s) / (s * s * r));
  const glm::dvec2 gradient = k * (place / r + (place - rx.foot) / s);
  const double part = std::abs(area(polygon));
  FarAmplitude result;
  result.pressure = density / four_pi * phasor(k * (r + s) - glm::dot(gradient, middle)) *
                    polygon_transform(polygon.offsets, gradient);
  result.most = part * std::abs(density) / four_pi;

  // The second derivative of a range is at most its inverse. No point of the polygon is nearer than these
  // ranges.
  double reach = 0;
  for (const glm::dvec2& offset : polygon.offsets) reach = std::max(reach, glm::length(offset - middle));
  const double least_r = std::max(h, r - reach), least_s = std::max(g, s - reach);
  const double moment = second_moment(polygon.offsets, middle);
  const double bend = k / 2 * (1 / least_r + 1 / least_s) * moment;
  // Bounds of the slopes of both ranges.
  const double turn_r = std::min(1.0, (glm::length(place) + reach) / least_r),
               turn_s = std::min(1.0, (glm::length(place - rx.foot) + reach) / least_s);
  const auto slope = [k](double height, double near, double turn, double other, double other_turn) {
    return height / (near * near * other) *
           (k * (2 * turn / near + other_turn / other) + (3 * turn / near + other_turn / other) / near);
  };
  const double change =
      slope(h, least_r, turn_r, least_s, turn_s) + slope(g, least_s, turn_s, least_r, turn_r);
  result.error = (std::abs(density) * std::min(2 * part, bend) + change * std::sqrt(part * moment)) / four_pi;
  return result;
}

glm::dvec2 place_of_shortest_path(const PlanarPolygon& polygon, const PathCutter::Receiver& rx) {
  const glm::dvec2 shortest = rx.foot * (polygon.distance / (polygon.distance + rx.distance));
  PlanarPolygon about = polygon;
  about.first -= shortest;
  return polygon.first + nearest_point(about).offset;
}

double mean_sine(const PlanarPolygon& polygon, const PathCutter::Receiver& rx) {
  const double h = polygon.distance, g = rx.distance;
  if (!(h + g > 0)) return 0;
  const glm::dvec2 place = place_of_shortest_path(polygon, rx);
  return (h / range(h, place) + g / range(g, place - rx.foot)) / 2;
}

SmoothAmplitude::SmoothAmplitude(std::span<const double> wave_numbers_per_m, double tolerance)
    : wave_numbers_(wave_numbers_per_m.begin(), wave_numbers_per_m.end()), tolerance_(tolerance) {
  double before = 0;
  for (const double k : wave_numbers_) {
    if (!(k > before) || !std::isfinite(k))
      throw std::invalid_argument("wavenumbers must be positive, finite and increasing");
    before = k;
  }
  if (!(tolerance >= 0)) throw std::invalid_argument("the tolerance of plane waves must not be negative");
}

void SmoothAmplitude::add(const PlanarPolygon& polygon, const PathCutter::Receiver& rx,
                          const SmoothSurface& surface, std::span<std::complex<double>> out) {
  if (!(polygon.distance > 0) || !(rx.distance > 0) || polygon.offsets.size() < 3) return;
  const double sine = mean_sine(polygon, rx);
  // The error of plane waves increases with the wave number.
  std::size_t first = 0;
  for (; tolerance_ > 0 && first < wave_numbers_.size(); ++first) {
    const double k = wave_numbers_[first];
    const FarAmplitude far = far_amplitude(polygon, rx, k);
    if (!(far.error <= tolerance_ * far.most)) break;
    out[first] += surface.factor(sine, k) * far.pressure;
  }
  count_.far += first;
  if (first == wave_numbers_.size()) return;
  const std::span<const double> wave_numbers = std::span(wave_numbers_).subspan(first);
  count_.near += wave_numbers.size();
  edges_.assign(wave_numbers.size(), 0);
  EdgeForm form(
      [&](double path_m, std::span<std::complex<double>> values) {
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = phasor(wave_numbers[i] * path_m);
      },
      wave_numbers.size(), wave_numbers.back());
  form.add(polygon, rx, edges_);
  for (std::size_t i = 0; i < wave_numbers.size(); ++i)
    out[first + i] += surface.factor(sine, wave_numbers[i]) * edges_[i];
}

void SmoothAmplitude::add(const CommonVisibility& visibility,
                          const std::function<const SmoothSurface*(FacetId)>& surface_of,
                          std::span<std::complex<double>> out) {
  PlanarPolygon polygon;
  for (std::size_t number = visibility.first(); number < visibility.end(); ++number) {
    const SeenFacet facet = visibility[number];
    const SmoothSurface* surface = surface_of(facet.facet);
    if (surface == nullptr) continue;
    const PlaneFrame frame(facet.plane);
    const PathCutter::Receiver rx{facet.rx_distance_m, frame.project(visibility.rx_m())};
    for (std::uint32_t piece = 0; piece < facet.piece_count; ++piece) {
      polygon.assign(visibility.part(number, facet.first_piece + piece).corners_m, facet.plane, frame);
      add(polygon, rx, *surface, out);
    }
  }
}

void add_pulse_echo(const PlanarPolygon& polygon, const PathCutter::Receiver& rx,
                    const TransmittedPulse& pulse, double sound_speed, std::span<const double> times_s,
                    std::span<std::complex<double>> out) {
  EdgeForm form(
      [&](double path_m, std::span<std::complex<double>> values) {
        for (std::size_t i = 0; i < values.size(); ++i)
          values[i] = pulse.pressure(times_s[i] - path_m / sound_speed);
      },
      times_s.size(), pulse.growth_per_s / sound_speed);
  form.add(polygon, rx, out);
}

}  // namespace tubefoot
