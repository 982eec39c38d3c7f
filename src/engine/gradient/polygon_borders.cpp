// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/polygon_borders.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr int most_nodes = 20;
/// Bound of the integrand in the ellipses below, relative to its largest real value. It is e^3 for patterns
/// and models, and 1 / (1 - 0.8^2)^3 for powers of range.
constexpr double growth = 1e3;
constexpr double share_of_singularity = 0.8;

double ellipse_of(double imaginary_half_axis) {
  return imaginary_half_axis + std::sqrt(imaginary_half_axis * imaginary_half_axis + 1);
}

/// Parameter of the ellipse about [-half, half] through the point (along, across).
double ellipse_through(double along, double across, double half) {
  const double across2 = across * across, before = along - half, after = along + half;
  const double sum = (std::sqrt(before * before + across2) + std::sqrt(after * after + across2)) / (2 * half);
  return sum + std::sqrt(std::max(sum * sum - 1, 0.0));
}

int nodes_for(double ellipse, const BorderSmoothness& smooth) {
  const double needed = std::log(growth / smooth.tolerance) / (2 * std::log(ellipse));
  return int(std::ceil(std::min(needed, 1e6))) + 1 + (smooth.degree + 1) / 2;
}

double cross_product(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

}  // namespace

RangeCells::RangeCells(std::span<const double> bin_borders, std::span<const double> kinks) {
  std::size_t kink = 0;
  for (std::size_t k = 0; k < bin_borders.size(); ++k) {
    for (; kink < kinks.size() && kinks[kink] <= bin_borders[k]; ++kink)
      if (k > 0 && kinks[kink] > borders.back() && kinks[kink] < bin_borders[k]) {
        bin_of_cell.push_back(k - 1);
        borders.push_back(kinks[kink]);
      }
    if (k > 0) bin_of_cell.push_back(k - 1);
    borders.push_back(bin_borders[k]);
  }
}

std::size_t RangeCells::border_above(double range) const {
  return std::size_t(std::upper_bound(borders.begin(), borders.end(), range) - borders.begin());
}

std::size_t RangeCells::cell_at(double range) const {
  const std::size_t above = border_above(range);
  return above == 0 || above == borders.size() ? none : above - 1;
}

double EdgeStretch::angle() const {
  return aside == 0 ? 0 : std::atan2(aside * (to - from), aside * aside + from * to);
}

void PolygonBorders::cut(EdgeStretch& stretch, double from, double to, const BorderSmoothness& smooth,
                         const std::function<void(const EdgeStretch&)>& use) const {
  const double middle = (from + to) / 2, half = (to - from) / 2;
  if (!(half > 0)) return;
  const double singular = share_of_singularity * (smooth.pointed ? std::abs(stretch.aside) : stretch.nearest);
  const double outside = std::max(std::abs(middle) - half, 0.0);
  const double ellipse =
      std::min(ellipse_through(middle, singular, half),
               ellipse_of(smooth.angle_rad / 2 *
                          std::sqrt(stretch.nearest * stretch.nearest + outside * outside) / half));
  const int nodes = nodes_for(ellipse, smooth);
  if (nodes > most_nodes + (smooth.degree + 1) / 2 && half > 1e-12 * stretch.length) {
    // The nearest point divides a stretch that contains it, so that intervals double in length from there.
    const double at = from < 0 && to > 0 && outside == 0 && std::min(-from, to) > half / 16 ? 0 : middle;
    cut(stretch, from, at, smooth, use);
    cut(stretch, at, to, smooth, use);
    return;
  }
  stretch.from = from;
  stretch.to = to;
  stretch.rule = &gauss_rule(std::min(nodes, most_gauss_nodes));
  use(stretch);
}

void PolygonBorders::edges(const PlanarPolygon& polygon, const RangeCells& cells,
                           const BorderSmoothness& smooth,
                           const std::function<void(const EdgeStretch&)>& use) {
  const std::size_t corners = polygon.offsets.size();
  for (std::size_t edge = 0; edge < corners; ++edge) {
    const glm::dvec2 first = polygon.corner(edge);
    const glm::dvec2 along = polygon.offsets[(edge + 1) % corners] - polygon.offsets[edge];
    EdgeStretch stretch;
    stretch.edge = edge;
    stretch.first = first;
    stretch.length = glm::length(along);
    if (!(stretch.length > 0)) continue;
    stretch.unit = along / stretch.length;
    stretch.begin = glm::dot(first, stretch.unit);
    stretch.aside = cross_product(first, stretch.unit);
    stretch.nearest = std::hypot(polygon.distance, stretch.aside);
    const double end = stretch.begin + stretch.length, nearest = stretch.nearest;
    breaks_.assign({stretch.begin, end});
    const double farthest = std::max(std::abs(stretch.begin), std::abs(end));
    const double closest = std::clamp(0.0, stretch.begin, end);
    for (std::size_t k = cells.border_above(std::sqrt(nearest * nearest + closest * closest) * (1 - 1e-15));
         k < cells.borders.size(); ++k) {
      const double border = cells.borders[k];
      const double x = std::sqrt(std::max((border - nearest) * (border + nearest), 0.0));
      if (x > farthest) break;
      for (const double place : {-x, x})
        if (place > stretch.begin && place < end) breaks_.push_back(place);
    }
    if (smooth.breaks) {
      shares_.clear();
      smooth.breaks(first, first + along, shares_);
      for (const double share : shares_) breaks_.push_back(stretch.begin + share * stretch.length);
    }
    for (const PlaneCone& kink : smooth.kinks) {
      // The square of the condition is a quadratic equation.
      const double slope = glm::dot(kink.along, stretch.unit),
                   level = glm::dot(kink.along, first - stretch.begin * stretch.unit) + kink.at_foot,
                   cosine2 = kink.cosine * kink.cosine, a = slope * slope - cosine2, b = slope * level,
                   c = level * level - cosine2 * nearest * nearest, discriminant = b * b - a * c;
      if (!(discriminant > 0)) continue;
      const double q = -(b + std::copysign(std::sqrt(discriminant), b));
      for (const double x : {q / a, c / q})
        if (x > stretch.begin && x < end) breaks_.push_back(x);
    }
    std::sort(breaks_.begin(), breaks_.end());
    for (std::size_t k = 0; k + 1 < breaks_.size(); ++k) {
      const double from = breaks_[k], to = breaks_[k + 1];
      const double middle = (from + to) / 2, range_in_middle = std::sqrt(nearest * nearest + middle * middle);
      stretch.cell = cells.cell_at(range_in_middle);
      if (stretch.cell != RangeCells::none) {
        cut(stretch, from, to, smooth, use);
      } else if (to > from && range_in_middle >= cells.borders.back()) {
        stretch.from = from;
        stretch.to = to;
        use(stretch);
      }
    }
  }
}

void PolygonBorders::arcs(const PlanarPolygon& polygon, const RangeCells& cells,
                          const BorderSmoothness& smooth, const std::function<void(const CircleArc&)>& use) {
  const double distance = polygon.distance, far = farthest_range(polygon);
  const std::size_t corners = polygon.offsets.size();
  std::size_t border = cells.border_above(std::max(nearest_point(polygon).range, distance));
  for (; border < cells.borders.size() && cells.borders[border] < far; ++border) {
    if (border > 0 && border < cells.size() && cells.bin_of_cell[border - 1] == cells.bin_of_cell[border])
      continue;  // a kink
    const double range = cells.borders[border];
    const double radius = std::sqrt((range - distance) * (range + distance));
    angles_.clear();
    for (std::size_t edge = 0; edge < corners; ++edge) {
      const glm::dvec2 first = polygon.corner(edge),
                       along = polygon.offsets[(edge + 1) % corners] - polygon.offsets[edge];
      const double length = glm::length(along);
      if (!(length > 0)) continue;
      const glm::dvec2 unit = along / length;
      const double begin = glm::dot(first, unit), aside = std::abs(cross_product(first, unit));
      if (!(aside < radius)) continue;
      const double reach = std::sqrt((radius - aside) * (radius + aside));
      for (const double x : {-reach, reach})
        if (x >= begin && x <= begin + length) {
          const glm::dvec2 p = first + (x - begin) * unit;
          angles_.push_back(std::atan2(p.y, p.x));
        }
    }
    for (const PlaneCone& kink : smooth.kinks) {
      const double level = (range * kink.cosine - kink.at_foot) / (radius * glm::length(kink.along));
      if (!(std::abs(level) < 1)) continue;
      const double middle = std::atan2(kink.along.y, kink.along.x), away = std::acos(level);
      for (const double angle : {middle - away, middle + away})
        angles_.push_back(std::remainder(angle, 2 * pi));
    }
    if (angles_.empty()) angles_.push_back(-pi);
    std::sort(angles_.begin(), angles_.end());
    angles_.push_back(angles_.front() + 2 * pi);
    for (std::size_t k = 0; k + 1 < angles_.size(); ++k) {
      const double from = angles_[k], to = angles_[k + 1], middle = (from + to) / 2;
      if (!(to > from)) continue;
      const glm::dvec2 at = radius * glm::dvec2(std::cos(middle), std::sin(middle)) - polygon.first;
      bool inside = true;
      for (std::size_t edge = 0; edge < corners && inside; ++edge)
        inside = cross_product(polygon.offsets[(edge + 1) % corners] - polygon.offsets[edge],
                               at - polygon.offsets[edge]) >= 0;
      if (!inside) continue;
      const int parts =
          std::max(1, int(std::ceil((to - from) * std::max(1.0, radius / (range * smooth.angle_rad)))));
      const double length = (to - from) / parts;
      const double half = length / 2 * std::max(1.0, radius / (range * smooth.angle_rad / 2));
      const int nodes = nodes_for(ellipse_of(1 / half), smooth);
      for (int part = 0; part < parts; ++part)
        use({border, radius, from + part * length, from + (part + 1) * length,
             &gauss_rule(std::min(nodes, most_gauss_nodes))});
    }
  }
}

}  // namespace tubefoot
