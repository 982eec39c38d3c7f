// SPDX-License-Identifier: GPL-3.0-or-later
// Integrates polygons along their edges if the integrand depends on one cosine w. The integral over an arc
// of range r is the difference of an antiderivative A(w, r) at the arc's two ends (pattern_spans.cpp). These
// ends move along the edges of the polygon. Let s be the coordinate along an edge from its nearest point, so
// r dr = s ds. Let h(r) be the echo of an area element. The energy in a range sample is the integral of h(r)
// A(w(s), r(s)) s ds over the parts of the edges in this sample. The integrand has no singularity where a
// circle touches an edge, and no slabs are needed.
//
// A counts from the middle of a panel. An end may lie in a higher panel than another end of the same sample.
// Then the contribution between the two middles is added.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/echo/pattern_integral.hpp"

namespace tubefoot {
namespace {

/// Share of the tolerance for the truncation of the series.
constexpr double truncation_share = 0.25;
/// Mean widths of a polygon in panels. Below `thin` the contributions of both sides nearly cancel, and the
/// rule needs one more node. Below `thinnest` this method is not used.
constexpr double thin = 0.05, thinnest = 5e-4;
/// Limit of panels, because an end in the last panel affects all of them.
constexpr std::size_t most_panels = 16;

}  // namespace

/// Sample that contains a range: -1 before the first, the number of samples beyond the last.
int PatternIntegrator::sample_of(double range2) const {
  const int samples = int(borders2_.size()) - 1;
  const double guess =
      (std::sqrt(range2) - borders_.front()) / (borders_.back() - borders_.front()) * double(samples);
  int k = int(std::clamp(guess, -1.0, double(samples)));
  while (k < samples && range2 >= borders2_[std::size_t(k + 1)]) ++k;
  while (k >= 0 && range2 < borders2_[std::size_t(k)]) --k;
  return k;
}

/// Adds the current polygon, for which arcs_may_be_spans() is true. Returns false and adds nothing if the
/// angle is not a smooth function of the cosine over the whole polygon.
bool PatternIntegrator::add_edges() {
  if (!little_absorption_ || edges_.size() < 3 || !find_edge_path()) return false;
  if (way_.outside) return true;
  if (!find_panels()) return false;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    cut_edge(edges_[e], edges_[e + 1 == edges_.size() ? 0 : e + 1]);
    add_edge_nodes();
  }
  return true;
}

bool PatternIntegrator::find_edge_path() {
  const Axis& axis = receiver_->axes[receiver_->moments_axis];
  constexpr double far_away = std::numeric_limits<double>::infinity();
  double near2 = far_away, far2 = 0, lowest = far_away, highest = -far_away, least_side = far_away,
         most_side = -far_away, area = 0, longest2 = 0;
  for (const Edge& edge : edges_) {
    const glm::dvec2 start = edge.from * edge.along + edge.height * edge.aside;
    const double r2 = edge.nearest2 + edge.from * edge.from;
    near2 = std::min(near2, edge.from < 0 && edge.to > 0 ? edge.nearest2 : r2);
    far2 = std::max(far2, r2);
    const double w = (axis.away + glm::dot(axis.plane, start)) / std::sqrt(r2);
    lowest = std::min(lowest, w);
    highest = std::max(highest, w);
    const double side = axis.plane.y * start.x - axis.plane.x * start.y;
    least_side = std::min(least_side, side);
    most_side = std::max(most_side, side);
    const double length = edge.to - edge.from;
    area += edge.height * length / 2;
    longest2 = std::max(longest2, length * length);
  }
  if (!(least_side > 0 || most_side < 0)) return false;
  const double near = std::sqrt(near2), far = std::sqrt(far2);
  way_.outside = !(far2 > borders2_.front() && near2 < borders2_.back());
  if (way_.outside) return true;
  way_.nearest2 = near2;
  for (Edge& edge : edges_) edge.sample = sample_of(edge.nearest2 + edge.from * edge.from);
  const double origin = (lowest + highest) / 2, curved = longest2 / (2 * near2);
  way_.reach = (highest - lowest) / 2 + curved;
  // R increases with range, and the level is monotonic in range.
  const double steep2 = glm::dot(axis.plane, axis.plane);
  const double radius2 = steep2 * (1 - piece_.distance2 / near2), radius = std::sqrt(std::max(radius2, 0.0));
  const double off = std::max(std::abs(origin - axis.away / near), std::abs(origin - axis.away / far));
  const double room = radius - off;
  if (!(room > 4 * way_.reach)) return false;
  const double ratio = way_.reach / room;
  const double fourth = (ratio * ratio) * (ratio * ratio) / (1 - ratio);
  if (fourth > truncation_share * tolerance_) return false;
  const double steepness2 = radius2 - off * off, per_s2 = 1 / steepness2, reach = way_.reach;
  const double third = off * per_s2 * per_s2 * (1.5 + 2.5 * off * off * per_s2) * (reach * reach * reach);
  way_.lanes.cubic = third + fourth > truncation_share * tolerance_;
  way_.singular = std::min(std::sqrt(near2 - piece_.distance2), steepness2 * near / 4);
  // Mean width of the polygon's arcs, in cosines.
  way_.width = area * std::sqrt(steepness2) / (far * std::max(far - near, 1e-300));
  way_.lanes.away = axis.away;
  way_.lanes.steep2 = steep2;
  way_.lanes.distance2 = piece_.distance2;
  way_.lanes.origin = origin;
  way_.lanes.beta = beta_;
  way_.lanes.density = least_side > 0 ? -piece_.factor : piece_.factor;
  return true;
}

bool PatternIntegrator::find_panels() {
  DirectionMoments& moments = *receiver_->moments;
  const double lowest = way_.lanes.origin - way_.reach, highest = way_.lanes.origin + way_.reach;
  const auto holds = [](const GainPanels::Panel& panel, double cosine) {
    return cosine >= panel.lo && cosine < panel.hi;
  };
  if (way_.panels.empty() || way_.of != &moments || !holds(way_.panel.front(), lowest) ||
      !holds(way_.panel.back(), highest)) {
    way_.of = &moments;
    way_.panels.clear();
    way_.panel.clear();
    way_.half.clear();
    for (double from = lowest; way_.panels.empty() || (from <= highest && way_.panels.size() <= most_panels);
         from = way_.panel.back().hi) {
      way_.panels.push_back(moments.find(from));
      way_.panel.push_back(moments.panel(way_.panels.back()));
      way_.half.push_back(1 / way_.panel.back().per_half);
    }
  }
  way_.at = 0;
  if (way_.panels.size() > most_panels) return false;
  const double width = way_.width * way_.panel.front().per_half / 2;
  if (!(width > thinnest)) return false;
  way_.spare = width < thin ? 1 : 0;
  way_.rows.assign(way_.panels.size(), {});
  return true;
}

/// Cuts an edge at range samples, and adds nodes for each part.
void PatternIntegrator::cut_edge(const Edge& edge, const Edge& next) {
  const Axis& axis = receiver_->axes[receiver_->moments_axis];
  const Change& change = receiver_->changes.front();
  way_.cells.clear();
  way_.nodes.count = 0;
  way_.lanes.nearest2 = edge.nearest2;
  way_.lanes.edge_level = axis.away + edge.height * glm::dot(axis.plane, edge.aside);
  way_.lanes.slope = glm::dot(axis.plane, edge.along);
  const auto steepness = [&](double s) {
    const double per_r2 = 1 / (edge.nearest2 + s * s), per_r = std::sqrt(per_r2);
    return std::abs(way_.lanes.slope - (way_.lanes.edge_level + way_.lanes.slope * s) * s * per_r2) * per_r;
  };
  const double steepest =
      (std::max(steepness(edge.from), steepness(edge.to)) + 2 * (edge.to - edge.from) / way_.nearest2) *
      change.scale;
  const auto add_cell = [&](double from, double to, int sample) {
    if (sample < 0 || sample >= int(absorbed_.size()) || !(to > from)) return;
    const auto k = std::size_t(sample);
    double half = (to - from) / 2;
    int parts = 1, n = 0;
    for (;; half /= 2, parts *= 2) {
      const double rho = 1 + 1.5 * (way_.singular / half - 0.5);
      n = 2;
      while (n <= most_gauss_nodes && rho < least_rho_[std::size_t(n)]) ++n;
      n = std::max(n, change.count.nodes(half * steepest, rho)) + way_.spare;
      if (n <= most_gauss_nodes || parts >= 1 << 20) break;
    }
    const GaussRule& rule = gauss_rule(std::min(n, most_gauss_nodes));
    const double middle_m = (borders_[k] + borders_[k + 1]) / 2;
    way_.cells.push_back({std::uint32_t(sample), std::uint32_t(way_.nodes.count)});
    for (int part = 0; part < parts; ++part)
      way_.nodes.add(rule, from + (2 * part + 1) * half, half, middle_m, absorbed_[k]);
  };
  // Range decreases while s is negative.
  int k = edge.sample;
  const int last = next.sample;
  int nearest = edge.from >= 0 ? k : edge.to <= 0 ? last : std::min(k, last);
  if (edge.from < 0 && edge.to > 0)
    while (nearest >= 0 && edge.nearest2 < borders2_[std::size_t(nearest)]) --nearest;
  const auto s_at = [&](int border) {
    return std::sqrt(std::max(borders2_[std::size_t(border)] - edge.nearest2, 0.0));
  };
  double from = edge.from;
  for (; k > nearest; --k) {
    const double to = std::clamp(-s_at(k), from, edge.to);
    add_cell(from, to, k);
    from = to;
  }
  for (; k < last; ++k) {
    const double to = std::clamp(s_at(k + 1), from, edge.to);
    add_cell(from, to, k);
    from = to;
  }
  add_cell(from, edge.to, k);
}

double* PatternIntegrator::row_of(std::uint32_t sample, std::size_t panel) {
  constexpr std::uint32_t together = DirectionMoments::samples_of_block;
  EdgePath::Rows& rows = way_.rows[panel];
  if (const std::uint32_t block = sample / together; rows.block != block)
    rows = {block, receiver_->moments->row(block * together, way_.panels[panel])};
  return rows.first + sample % together * DirectionMoments::row_size;
}

void PatternIntegrator::add_edge_nodes() {
  EdgeNodes& nodes = way_.nodes;
  if (nodes.count == 0) return;
  DirectionMoments& moments = *receiver_->moments;
  find_ends(way_.lanes, nodes);
  for (std::size_t i = 0; i < nodes.count; ++i) {
    const double w = nodes.cosine[i];
    while (way_.at + 1 < way_.panel.size() && w >= way_.panel[way_.at].hi) ++way_.at;
    while (way_.at > 0 && w < way_.panel[way_.at].lo) --way_.at;
    nodes.panel[i] = std::uint32_t(way_.at);
    nodes.middle[i] = way_.panel[way_.at].middle;
    nodes.half[i] = way_.half[way_.at];
    nodes.per_half[i] = way_.panel[way_.at].per_half;
  }
  turn_to_panels(way_.lanes.origin, nodes);
  for (std::size_t c = 0; c < way_.cells.size(); ++c) {
    const std::uint32_t sample = way_.cells[c].sample;
    const std::size_t end = c + 1 < way_.cells.size() ? way_.cells[c + 1].first : nodes.count;
    for (std::size_t i = way_.cells[c].first; i < end;) {
      const std::uint32_t at = nodes.panel[i];
      std::size_t to = i + 1;
      while (to < end && nodes.panel[to] == at) ++to;
      add_end_moments(nodes, i, to, way_.lanes.cubic, row_of(sample, at));
      if (at > 0) {
        EndLevels sum{};
        for (std::size_t k = i; k < to; ++k)
          for (std::size_t l = 0; l < sum.size(); ++l) sum[l] += nodes.level[l][k];
        for (std::uint32_t lower = 0; lower < at; ++lower)
          moments.add_across(way_.panels[lower], row_of(sample, lower), sum, way_.lanes.origin);
      }
      i = to;
    }
  }
}

}  // namespace tubefoot
