// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/pattern_levels.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "geometry/numbers/scalars.hpp"

// Finds the two-way peak of transmit and receive patterns by a search on the sphere. The search visits the
// peak cones of both patterns and their intersections, and then climbs uphill. Also inverts patterns to
// ranges of cosines.

namespace tubefoot {
namespace {

using Kind = Directivity::Kind;

double zero_angle(const Directivity& p) {
  return p.from_axis ? 0 : std::asin(std::clamp(p.centre, -1.0, 1.0));
}
/// Returns the cosine of an angle in the pattern's own sense. Angles beyond the last direction are clamped to
/// it.
double cosine_of(const Directivity& p, double angle_rad) {
  if (p.from_axis) return std::cos(std::clamp(angle_rad, 0.0, pi));
  return std::sin(std::clamp(angle_rad + zero_angle(p), -pi / 2, pi / 2));
}

/// Returns the cosine at which a pattern is largest.
double peak_cosine(const Directivity& p) {
  if (p.kind != Kind::table) return p.from_axis ? 1 : p.centre;
  // A table is monotone between its angles. Both ends of the range of possible angles are candidates too.
  double best = cosine_of(p, -pi);
  const auto consider = [&](double cosine) {
    if (p.gain_at(cosine) > p.gain_at(best)) best = cosine;
  };
  consider(cosine_of(p, pi));
  for (const double angle : p.table->borders()) consider(cosine_of(p, angle));
  return best;
}

/// Returns two directions orthogonal to each other and to a unit vector.
std::pair<glm::dvec3, glm::dvec3> across(glm::dvec3 d) {
  const glm::dvec3 other = std::abs(d.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(d, other));
  return {u, glm::cross(d, u)};
}

/// Records the largest value of a function of direction, and its direction.
template <class Gain>
class Summit {
 public:
  explicit Summit(const Gain& gain) : gain_(gain) {}

  void visit(glm::dvec3 direction) {
    const double found = gain_(direction);
    if (!(found > best_)) return;
    best_ = found;
    at_ = direction;
  }
  /// Visits directions around a cone about an axis.
  void visit_cone(glm::dvec3 axis, double cosine, int steps) {
    const auto [u, v] = across(axis);
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    for (int k = 0; k < steps; ++k) {
      const double turn = 2 * pi * k / steps;
      visit(cosine * axis + sine * (std::cos(turn) * u + std::sin(turn) * v));
    }
  }
  /// Visits the intersections of two cones. If there is none, visits the direction half way between them.
  void visit_crossing(glm::dvec3 a, double cosine_a, glm::dvec3 b, double cosine_b) {
    const double g = glm::dot(a, b), rest = 1 - g * g;
    if (!(rest > 1e-12)) return;
    const glm::dvec3 in_plane =
        ((cosine_a - g * cosine_b) / rest) * a + ((cosine_b - g * cosine_a) / rest) * b;
    const double left = 1 - glm::dot(in_plane, in_plane);
    if (left <= 0) return visit(glm::normalize(in_plane));
    const glm::dvec3 out = std::sqrt(left / rest) * glm::cross(a, b);
    visit(in_plane + out);
    visit(in_plane - out);
  }
  /// Climbs uphill from the best direction and returns the largest value.
  double climbed() {
    constexpr double first_rad = 0.05, last_rad = 1e-5;
    int left = 1000;
    for (double step = first_rad; step > last_rad && left > 0; step /= 2, --left) {
      const double before = best_;
      const auto [u, v] = across(at_);
      for (const glm::dvec3 two_way : {u, -u, v, -v, u + v, u - v, v - u, -u - v})
        visit(glm::normalize(at_ + step * two_way));
      if (best_ > before * (1 + 1e-6)) step *= 2;  // continues with the same step
    }
    return best_;
  }

 private:
  const Gain& gain_;
  double best_ = -1;
  glm::dvec3 at_{0, 0, 1};
};

double one_way_peak(const Directivity& p) { return p.gain_at(peak_cosine(p)); }

}  // namespace

double two_way_peak(const TransmitPattern& sent, const Directivity& received) {
  const auto gain = [&](glm::dvec3 d) { return sent.gain(d) * received.gain(d); };
  if (sent.beams.size() == 1 && sent.beams[0].kind == Kind::uniform) return one_way_peak(received);
  constexpr int around = 72, around_each = 24;
  Summit summit(gain);
  const double received_cosine = peak_cosine(received);
  summit.visit_cone(received.axis, received_cosine, around);
  for (const Directivity& beam : sent.beams) {
    const double cosine = peak_cosine(beam);
    summit.visit_cone(beam.axis, cosine, around_each);
    summit.visit_crossing(beam.axis, cosine, received.axis, received_cosine);
  }
  return summit.climbed();
}

std::vector<double> gains_below_peak(const BeamPatterns& patterns, double level_db, bool apart) {
  const double factor = std::pow(10, -level_db / 10);
  std::vector<std::optional<std::uint32_t>> fan(patterns.receive.size());
  for (std::size_t tube = 0; tube < patterns.beams_of_tube.size(); ++tube)
    for (std::uint32_t beam = patterns.beams_of_tube[tube].first; beam < patterns.beams_of_tube[tube].second;
         ++beam)
      fan[beam] = patterns.fan_of_tube[tube];
  std::vector<double> least;
  for (std::size_t beam = 0; beam < fan.size(); ++beam) {
    const Directivity& received = patterns.receive[beam];
    double peak = 0;  // of a beam that receives no tube
    if (fan[beam]) {
      const TransmitPattern& sent = patterns.transmit[*fan[beam]];
      peak =
          apart ? two_way_peak(sent, Directivity()) * one_way_peak(received) : two_way_peak(sent, received);
    }
    least.push_back(factor * peak);
  }
  return least;
}

std::vector<double> receive_gains_below_peak(const BeamPatterns& patterns, double level_db) {
  const double factor = std::pow(10, -level_db / 10);
  std::vector<double> least;
  for (const Directivity& received : patterns.receive) least.push_back(factor * one_way_peak(received));
  return least;
}

CosineRange cosines_of_gain(const Directivity& p, double least) {
  if (!(least > 0)) return {};
  const auto between = [&](double from_rad, double to_rad) -> CosineRange {
    constexpr double rounding = 1e-9;
    if (!p.from_axis) return {cosine_of(p, from_rad) - rounding, cosine_of(p, to_rad) + rounding};
    return {cosine_of(p, to_rad) - rounding, 1};
  };
  switch (p.kind) {
    case Kind::line: {
      // |sin| <= 1. Shading decreases the modulus beyond u = 2, where it is |sinc u| |1 - s u^2 / (u^2 - 1)|.
      const double bound = 1 / (pi * std::sqrt(least));
      const double off = (p.shading == 0 ? bound : std::max(2.0, bound)) / p.size;
      return {p.centre - off, p.centre + off};
    }
    case Kind::gaussian: {
      if (least > 1) return {1, -1};
      const double angle = p.size * std::sqrt(std::log(1 / least) / (4 * std::numbers::ln2));
      return between(-angle, angle);
    }
    case Kind::table: {
      const std::vector<double>& angles = p.table->borders();
      const double level_db = 10 * std::log10(least);
      constexpr double beyond = 10;  // larger than any angle
      double from = beyond, to = -beyond;
      for (std::size_t k = 0; k < angles.size(); ++k) {
        if (p.table->level_db(angles[k]) < level_db - 1e-9) continue;
        from = std::min(from, k > 0 ? angles[k - 1] : -beyond);
        to = std::max(to, k + 1 < angles.size() ? angles[k + 1] : beyond);
      }
      return from > to ? CosineRange{1, -1} : between(from, to);
    }
    case Kind::uniform:
    case Kind::piston:  // equal in front and behind
      break;
  }
  return {};
}

}  // namespace tubefoot
