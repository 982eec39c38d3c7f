// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/pattern_integral.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/echo/scattering_cut.hpp"
#include "engine/scattering/density.hpp"
#include "geometry/integrals/polar_arcs.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

// Integrates echoes with patterns over slabs of range and over arcs in each slab, with Gauss-Legendre rules.
// The numbers of nodes follow from ellipses of analyticity (pattern_integral.hpp).

namespace tubefoot {
namespace {

constexpr int deepest = 60;

/// Vector rotated by a quarter turn counter-clockwise.
glm::dvec2 turned(glm::dvec2 a) { return {-a.y, a.x}; }

/// Computed range with bounds of its rounding error.
RangeEnclosure about(double range) { return {range * (1 - 1e-15), range * (1 + 1e-15)}; }

int sign(double x) { return (x > 0) - (x < 0); }

/// Parameter of the Bernstein ellipse about [-1, 1], scaled to an interval of half-length `half`, through
/// the point at (along, across) from the middle.
double ellipse_through(double along, double across, double half) {
  const double a = std::sqrt((along - half) * (along - half) + across * across);
  const double b = std::sqrt((along + half) * (along + half) + across * across);
  const double sum = (a + b) / (2 * half);
  return sum + std::sqrt(std::max(sum * sum - 1, 0.0));
}

/// Parameter of the ellipse within which an angle of half-width `half` has an imaginary part of at most 1.
double ellipse_of_arc(double half) { return 1 / half + std::sqrt(1 / (half * half) + 1); }

/// Sine and cosine to rounding, fast for the short arcs that are most frequent.
void sine_and_cosine(double x, double& sine, double& cosine) {
  if (std::abs(x) > 0.1) {
    sine = std::sin(x);
    cosine = std::cos(x);
    return;
  }
  const double y = x * x;
  if (y < 1e-5) {
    sine = x * (1 + y * (-1.0 / 6 + y * (1.0 / 120)));
    cosine = 1 + y * (-1.0 / 2 + y * (1.0 / 24));
    return;
  }
  sine = x * (1 + y * (-1.0 / 6 + y * (1.0 / 120 + y * (-1.0 / 5040 + y * (1.0 / 362880)))));
  cosine = 1 + y * (-1.0 / 2 + y * (1.0 / 24 + y * (-1.0 / 720 + y * (1.0 / 40320))));
}

}  // namespace

PatternIntegrator::PatternIntegrator(std::span<const double> borders_m, double beta_per_m,
                                     const BeamPatterns& patterns, double tolerance)
    : borders_(borders_m),
      beta_(beta_per_m),
      tolerance_(tolerance),
      patterns_(patterns),
      receiver_of_tube_(patterns.fan_of_tube.size(), 0) {
  for (int n = 1; n <= most_gauss_nodes; ++n) least_rho_[n] = std::pow(64.0 / 15 / tolerance, 0.5 / n);
  double longest = 0;
  for (std::size_t k = 0; k < borders_.size(); ++k) {
    borders2_.push_back(borders_[k] * borders_[k]);
    if (k == 0) continue;
    absorbed_.push_back(std::exp(-(beta_ * (borders_[k - 1] + borders_[k]))));
    longest = std::max(longest, borders_[k] - borders_[k - 1]);
  }
  little_absorption_ = beta_ * longest < EdgeLanes::largest_absorption;
}

void PatternIntegrator::settle(std::span<double> energy) {
  for (auto& receiver : receivers_) {
    if (!receiver->moments) continue;
    receiver->moments->finish(receiver->first, borders_.size() - 1, energy);
    receiver->moments->clear();
  }
}

void PatternIntegrator::finish(std::span<double> energy) {
  settle(energy);
  if (!has_negative_factor_)  // rounding may make small energies negative
    for (double& e : energy) e = std::max(e, 0.0);
  has_negative_factor_ = false;
  receivers_.clear();
  models_.clear();
  way_.panels.clear();  // panels of deleted receivers
  receiver_of_tube_.assign(receiver_of_tube_.size(), 0);
}

void PatternIntegrator::add(const PlanarPolygon& polygon, const FacetPlane& plane, const PlaneFrame& frame,
                            std::uint32_t tube, double factor, std::span<double> energy,
                            const ScatteringModel* model, const PlacedTexture& texture) {
  const std::size_t n = polygon.offsets.size();
  const auto [first_beam, end_beam] = patterns_.beams_of_tube[tube];
  if (n < 3 || first_beam == end_beam) return;
  receiver_ = &receiver_of(tube);
  first_beam_ = first_beam;
  piece_.distance = polygon.distance;
  piece_.distance2 = polygon.distance * polygon.distance;
  piece_.factor = factor;
  has_negative_factor_ = has_negative_factor_ || factor < 0;

  edges_.clear();
  bool inside = true;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 way = polygon.offsets[i + 1 == n ? 0 : i + 1] - polygon.offsets[i];
    const double length = glm::length(way);
    if (!(length > 0)) continue;
    const glm::dvec2 start = polygon.corner(i);
    Edge edge;
    edge.along = way / length;
    edge.aside = -turned(edge.along);
    edge.height = cross(start, edge.along);
    edge.from = glm::dot(start, edge.along);
    edge.to = glm::dot(polygon.corner(i + 1 == n ? 0 : i + 1), edge.along);
    edge.nearest2 = piece_.distance2 + edge.height * edge.height;
    inside = inside && edge.height > 0;
    edges_.push_back(edge);
  }
  piece_.foot_inside = inside;
  take_axes(polygon, plane, frame);
  take_texture(texture);
  const bool may_be_spans = arcs_may_be_spans();
  if (may_be_spans && model == nullptr && !density_ && add_edges()) return;

  ranges_.clear();
  const auto corner_range = [&](std::size_t i) {
    const glm::dvec2 corner = polygon.corner(i);
    return about(std::sqrt(piece_.distance2 + glm::dot(corner, corner)));
  };
  RangeEnclosure from = corner_range(0);
  auto edge = edges_.begin();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = i + 1 == n ? 0 : i + 1;
    if (!(glm::length(polygon.offsets[next] - polygon.offsets[i]) > 0)) continue;
    const RangeEnclosure to = corner_range(next);
    ranges_.push_back({from, to, about(std::sqrt(edge->nearest2)), sign(edge->from), sign(edge->to)});
    from = to;
    ++edge;
  }
  std::optional<RangeEnclosure> foot;
  if (inside) foot = about(polygon.distance);
  slabs_.cut(ranges_, foot, inside, borders_);
  if (slabs_.slabs().empty()) return;
  piece_.model = nullptr;
  if (model != nullptr) take_model(*model);
  const std::vector<double> corners =
      model != nullptr ? corner_ranges_m(*model, piece_.distance) : std::vector<double>();

  const std::size_t samples = borders_.size() - 1;
  for (const PolarSlabs::Slab& slab : slabs_.slabs()) {
    stop_if_wanted();
    const auto crossings = slabs_.crossings(slab);
    piece_.full_circle = crossings.empty();
    piece_.q2 = piece_.distance2;
    for (const Crossing& c : crossings) piece_.q2 = std::max(piece_.q2, edges_[c.edge].nearest2);
    const auto t_of = [&](double r) { return std::sqrt(std::max(r * r - piece_.q2, 0.0)); };
    const double t0 = t_of(double(slab.lo)), t1 = t_of(double(slab.hi));
    if (!(t1 > t0)) continue;
    find_arcs(crossings, (t0 + t1) / 2);
    spans_ = may_be_spans && arcs_.size() == 1;
    if (receiver_->moments)
      receiver_->moments->begin(slab.sample);
    else
      sum_.assign(end_beam - first_beam, 0);
    if (model == nullptr) {
      integrate(t0, t1, 0);
    } else {
      double begin = t0;
      for (std::size_t k = 0; k < model->pieces().size(); ++k) {
        const double end = k < corners.size() ? std::clamp(t_of(corners[k]), begin, t1) : t1;
        piece_.model = &model->pieces()[k];
        integrate(begin, end, 0);
        begin = end;
      }
    }
    if (receiver_->moments) continue;
    for (std::size_t k = 0; k < sum_.size(); ++k) energy[(first_beam + k) * samples + slab.sample] += sum_[k];
  }
}

void PatternIntegrator::take_model(const ScatteringModel& model) {
  const auto known =
      std::find_if(models_.begin(), models_.end(), [&](const ModelNodes& l) { return l.model == &model; });
  if (known != models_.end()) {
    model_nodes_ = &*known;
    return;
  }
  const double power = std::max(model.largest_power() - 2, 0.0);  // the nodes of the other factors suffice
                                                                  // for Lambert's law
  models_.push_back({&model, NodeCount([&](double y) { return model.growth(y); }, tolerance_),
                     NodeCount([&](double y) { return power * y; }, tolerance_)});
  model_nodes_ = &models_.back();
}

/// Angle of incidence on the circle t.
double PatternIntegrator::incidence_at(double t) const {
  return std::atan2(std::sqrt(std::max(piece_.q2 - piece_.distance2, 0.0) + t * t), piece_.distance);
}

void PatternIntegrator::take_axes(const PlanarPolygon& polygon, const FacetPlane& plane,
                                  const PlaneFrame& frame) {
  for (Axis& axis : receiver_->axes) {
    axis.away = -plane.distance_m * glm::dot(plane.normal, axis.direction);
    axis.plane = {glm::dot(frame.u, axis.direction), glm::dot(frame.v, axis.direction)};
  }
  for (Change& change : receiver_->changes) {
    change.along_axis = change.axis.has_value();
    if (!change.along_axis || !change.by_angle) continue;
    // The cosine differs from its value at the first corner by at most the distance of the farthest corner
    // in directions.
    const Axis& axis = receiver_->axes[*change.axis];
    const auto range = [&](glm::dvec2 p) { return std::sqrt(piece_.distance2 + glm::dot(p, p)); };
    const double r = range(polygon.first);
    double chord2 = 0;
    for (std::size_t i = 1; i < polygon.offsets.size(); ++i) {
      const glm::dvec2 p = polygon.corner(i);
      chord2 = std::max(chord2, 2 - 2 * (piece_.distance2 + glm::dot(p, polygon.first)) / (range(p) * r));
    }
    const double largest =
        std::abs(axis.away + glm::dot(axis.plane, polygon.first)) / r + std::sqrt(chord2 + 1e-14);
    change.along_axis = chord2 < 1 && largest < 0.9;
    if (change.along_axis) change.scale = 1 / std::sqrt(1 - largest * largest);
  }
}

void PatternIntegrator::take_texture(const PlacedTexture& texture) {
  texture_.field = texture.field;
  if (texture.field == nullptr) return;
  auto known = counts_.find(texture.field);
  if (known == counts_.end()) {
    const auto growth = [&](double away_m) { return std::log1p(texture.field->change(away_m)); };
    known = counts_.emplace(texture.field, NodeCount(growth, tolerance_)).first;
  }
  texture_.count = &known->second;
  texture_.plane = texture.plane;
}

double PatternIntegrator::s_at(const Crossing& crossing, double t2) const {
  return std::sqrt(std::max(t2 + (piece_.q2 - edges_[crossing.edge].nearest2), 0.0));
}

/// Intersection of the circle t and an edge, relative to the foot point.
glm::dvec2 PatternIntegrator::point_at(const Crossing& crossing, double t2) const {
  const Edge& edge = edges_[crossing.edge];
  const double s = s_at(crossing, t2);
  return (crossing.rising ? s : -s) * edge.along + edge.height * edge.aside;
}

/// Angle from the begin to the end of an arc.
double PatternIntegrator::angle_between(glm::dvec2 begin, glm::dvec2 end) const {
  const double along = glm::dot(begin, end), across = cross(begin, end);
  if (along > 0 && std::abs(across) < 0.1 * along) {
    const double x = across / along, y = x * x;
    const double angle =
        x *
        (1 - y * (1.0 / 3 -
                  y * (1.0 / 5 -
                       y * (1.0 / 7 - y * (1.0 / 9 - y * (1.0 / 11 - y * (1.0 / 13 - y * (1.0 / 15))))))));
    if (!(piece_.foot_inside && angle < -1e-9)) return angle;
  }
  const double angle = std::atan2(across, along);
  // An arc about an outside foot point is at most half a circle. Rounding may make a thin arc negative.
  return angle < (piece_.foot_inside ? -1e-9 : -pi / 2) ? angle + 2 * pi : angle;
}

/// Pairs the crossings of a slab. Each arc runs from a crossing into the polygon to the next crossing out of
/// it.
void PatternIntegrator::find_arcs(std::span<const Crossing> crossings, double t) {
  arcs_.clear();
  std::size_t rising = 0;
  for (const Crossing& c : crossings) rising += c.rising;
  if (2 * rising != crossings.size()) return;  // a very narrow slab due to rounding
  if (crossings.size() == 2) {
    const bool first = crossings[0].rising;
    arcs_.push_back({crossings[first ? 0 : 1], crossings[first ? 1 : 0]});
    return;
  }
  sorted_.clear();
  for (const Crossing& c : crossings) {
    const glm::dvec2 p = point_at(c, t * t);
    sorted_.emplace_back(std::atan2(p.y, p.x), c);
  }
  std::sort(sorted_.begin(), sorted_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  pair_crossings<double>(sorted_, [&](const Crossing& begin, const Crossing& end) {
    arcs_.push_back({begin, end});
    return true;
  });
}

/// Distance of the nearest singularities from the origin of t. They lie on the imaginary axis, at circles
/// that shrink to the foot point or touch another edge.
double PatternIntegrator::nearest_singularity() const {
  double nearest2 = piece_.full_circle ? piece_.distance2 : piece_.q2 - piece_.distance2;
  for (const Arc& arc : arcs_)
    for (const std::uint32_t e : {arc.begin.edge, arc.end.edge}) {
      const double gap2 = piece_.q2 - edges_[e].nearest2;
      if (gap2 > 1e-13 * piece_.q2) nearest2 = std::min(nearest2, gap2);
    }
  return std::sqrt(nearest2);
}

void PatternIntegrator::integrate(double t0, double t1, int depth) {
  const double half = (t1 - t0) / 2, middle = t0 + half;
  if (!(half > 0)) return;
  // The ellipse passes at three quarters of the distance to the singularity, where the integrand is still of
  // its usual size.
  const double rho = 1 + 0.75 * (ellipse_through(middle, nearest_singularity(), half) - 1);
  int n = 1;
  while (n <= most_gauss_nodes && rho < least_rho_[n]) ++n;
  if (n <= most_gauss_nodes)
    n = std::max(n, spans_ ? nodes_along_spans(t0, t1, rho) : nodes_along(t0, t1, rho));
  if (n > most_gauss_nodes && depth < deepest) {
    integrate(t0, middle, depth + 1);
    integrate(middle, t1, depth + 1);
    return;
  }
  const GaussRule& rule = gauss_rule(std::min(n, most_gauss_nodes));
  if (spans_ && n <= most_gauss_nodes && add_spans(t0, t1, rule)) return;
  for (std::size_t i = 0; i < rule.node.size(); ++i)
    add_circle(middle + half * rule.node[i], half * rule.weight[i]);
}

/// `stretched_by`: the larger range divided by the smaller one.
int PatternIntegrator::nodes_of_model(double t0, double t1, double stretched_by, double rho) const {
  constexpr double curved = 1.3 / 2;  // margin for the curved path
  return std::max(model_nodes_->by_angle.nodes(curved * (incidence_at(t1) - incidence_at(t0)), rho),
                  model_nodes_->by_range.nodes(curved * std::log(stretched_by), rho));
}

/// Number of nodes for the change of patterns and texture as the ends of arcs, or a full circle, move. The
/// rule for a product needs the maximum over its factors.
int PatternIntegrator::nodes_along(double t0, double t1, double rho) const {
  const double middle = (t0 + t1) / 2;
  const std::array<double, 3> t2{t0 * t0, middle * middle, t1 * t1};
  const double r0 = std::sqrt(piece_.q2 + t2[0]);
  std::array<double, 3> over_r{};
  for (std::size_t i = 0; i < 3; ++i) over_r[i] = 1 / std::sqrt(piece_.q2 + t2[i]);
  const auto moved = [&] {
    double most = piece_.full_circle ? t1 - t0 : 0;
    for (const Arc& arc : arcs_)
      for (const Crossing& c : {arc.begin, arc.end}) most = std::max(most, s_at(c, t2[2]) - s_at(c, t2[0]));
    return 1.3 * most;  // margin for the curved path
  };
  int n = piece_.model != nullptr ? nodes_of_model(t0, t1, over_r[0] / over_r[2], rho) : 1;
  if (texture_.field != nullptr)
    n = std::max(n, texture_.count->nodes(texture_.plane.stretch * moved() / 2, rho));
  for (const Change& change : receiver_->changes) {
    double extent = 0;
    if (change.along_axis && !piece_.full_circle) {
      const Axis& axis = receiver_->axes[*change.axis];
      for (const Arc& arc : arcs_)
        for (const Crossing& c : {arc.begin, arc.end}) {
          std::array<double, 3> w{};
          for (std::size_t i = 0; i < 3; ++i)
            w[i] = (axis.away + glm::dot(axis.plane, point_at(c, t2[i]))) * over_r[i];
          const double curved = std::abs(w[0] - 2 * w[1] + w[2]) / 2;
          extent = std::max(extent, std::abs(w[2] - w[0]) / 2 + 4 * curved);
        }
      extent *= change.scale;
    } else {
      extent = moved() / r0 / 2;
    }
    n += change.count.nodes(extent, rho) - 1;
  }
  return n;
}

/// `half`: half of an arc as an angle about the foot point. `radius`: radius of the circle on the unit
/// sphere. `circle_radius_m`: its radius in the plane of the facet. For an imaginary part h <= 1 of the
/// angle, the imaginary part of the cosine is at most radius sinh(h) <= 1.18 radius h.
int PatternIntegrator::nodes_of_arc(double half, double circle_radius_m, double radius) const {
  const double ellipse = ellipse_of_arc(half);
  int n = texture_.field != nullptr
              ? texture_.count->nodes(1.18 * half * circle_radius_m * texture_.plane.stretch, ellipse)
              : 1;
  for (const Change& change : receiver_->changes) {
    double steep = radius;
    if (change.along_axis) {
      const Axis& axis = receiver_->axes[*change.axis];
      steep = change.scale * (std::abs(axis.aside) + std::abs(axis.ahead) * std::min(1.0, 3 * half));
    }
    n += change.count.nodes(1.18 * half * steep, ellipse) - 1;
  }
  return n;
}

void PatternIntegrator::add_circle(double t, double weight) {
  const double t2 = t * t, r2 = piece_.q2 + t2, per_r = 1 / std::sqrt(r2);
  const double circle_radius_m = std::sqrt(std::max(r2 - piece_.distance2, 0.0));
  const double per_r2 = per_r * per_r;
  const double sigma =  // Lambert's law divided by mu and the squared distance
      piece_.model == nullptr
          ? per_r2
          : ScatteringModel::in_piece(*piece_.model, std::atan2(circle_radius_m, piece_.distance),
                                      piece_.distance * per_r);
  const double radial =
      piece_.factor * weight * t *
      (density_ ? density_(r2 * per_r) : density_by_reciprocal(sigma, per_r2, 2 * (r2 * per_r), beta_));
  if (piece_.full_circle) add_arc(per_r, circle_radius_m, {1, 0}, pi, radial);
  for (const Arc& arc : arcs_) {
    const glm::dvec2 begin = point_at(arc.begin, t2), end = point_at(arc.end, t2);
    const double half = angle_between(begin, end) / 2;
    const glm::dvec2 middle = begin + end;
    if (std::abs(half) < 1)
      add_arc(per_r, circle_radius_m, middle * (1 / glm::length(middle)), half, radial);
    else
      add_arc(per_r, circle_radius_m,
              (std::cos(half) * begin + std::sin(half) * turned(begin)) / glm::length(begin), half, radial);
  }
}

/// Sets directions and places over an arc as functions of the angle from its middle.
void PatternIntegrator::face(glm::dvec2 ahead, double circle_radius_m, double radius) {
  for (Axis& axis : receiver_->axes) {
    axis.ahead = radius * glm::dot(axis.plane, ahead);
    axis.aside = radius * glm::dot(axis.plane, turned(ahead));
  }
  if (texture_.field == nullptr) return;
  texture_.ahead = circle_radius_m * (ahead.x * texture_.plane.u + ahead.y * texture_.plane.v);
  texture_.aside = circle_radius_m * (ahead.x * texture_.plane.v - ahead.y * texture_.plane.u);
}

void PatternIntegrator::add_arc(double per_r, double circle_radius_m, glm::dvec2 middle, double half,
                                double weight) {
  const double radius = circle_radius_m * per_r;
  for (Axis& axis : receiver_->axes) axis.level = axis.away * per_r;
  // Long arcs, as a full circle, are divided into panels.
  int panels = 1;
  for (double share = std::abs(half);; share /= 2, panels *= 2) {
    const glm::dvec2 ahead =
        panels == 1 ? middle : std::cos(half - share) * middle - std::sin(half - share) * turned(middle);
    face(ahead, circle_radius_m, radius);
    const int n = nodes_of_arc(share, circle_radius_m, radius);
    if (n > most_gauss_nodes && panels < 1 << 20) continue;
    const GaussRule& rule = gauss_rule(std::min(n, most_gauss_nodes));
    if (panels == 1) {
      add_panel(half, weight, rule);
      return;
    }
    break;
  }
  const double part = half / panels;
  for (int p = 0; p < panels; ++p) {
    const double turn = -half + (2 * p + 1) * part;
    const glm::dvec2 ahead = std::cos(turn) * middle + std::sin(turn) * turned(middle);
    face(ahead, circle_radius_m, radius);
    add_panel(part, weight,
              gauss_rule(std::min(nodes_of_arc(std::abs(part), circle_radius_m, radius), most_gauss_nodes)));
  }
}

void PatternIntegrator::add_panel(double half, double weight, const GaussRule& rule) {
  Receiver& receiver = *receiver_;
  const std::size_t nodes = rule.node.size();
  std::array<double, most_gauss_nodes> sine, cosine, share, direction;
  for (std::size_t i = 0; i < nodes; ++i) {
    sine_and_cosine(half * rule.node[i], sine[i], cosine[i]);
    share[i] = weight * half * rule.weight[i];
  }
  if (texture_.field != nullptr)
    for (std::size_t i = 0; i < nodes; ++i)
      share[i] *= texture_.field->factor(texture_.plane.foot_m + cosine[i] * texture_.ahead +
                                         sine[i] * texture_.aside);
  const auto at = [&](const Axis& axis, std::size_t i) {
    return axis.level + axis.ahead * cosine[i] + axis.aside * sine[i];
  };
  std::array<double, most_gauss_nodes> sent;
  sent.fill(1);
  if (!receiver.transmit.empty())
    for (std::size_t i = 0; i < nodes; ++i) {
      sent[i] = 0;
      for (Term& term : receiver.transmit) sent[i] += term.gain->value(at(receiver.axes[term.axis], i));
      share[i] *= sent[i];
    }
  if (receiver.moments) {
    for (std::size_t i = 0; i < nodes; ++i) direction[i] = at(receiver.axes[receiver.moments_axis], i);
    receiver.moments->add(std::span(direction).first(nodes), std::span(share).first(nodes));
    return;
  }
  const std::size_t beams = sum_.size();
  for (std::size_t beam = 0; beam < beams; ++beam) {
    if (!may_be_received(beam, half)) continue;
    std::optional<Term>* own = receiver.uniform ? nullptr : &receiver.receive[beam];
    for (std::size_t i = 0; i < nodes; ++i) {
      const double gain = own && *own ? (*own)->gain->value(at(receiver.axes[(*own)->axis], i)) : 1;
      if (patterns_.receives(first_beam_ + beam, sent[i] * gain)) sum_[beam] += share[i] * gain;
    }
  }
}

/// Whether a beam may receive the current arc. Only a few of many beams have the arc near their peak.
bool PatternIntegrator::may_be_received(std::size_t beam, double half) const {
  const Receiver& receiver = *receiver_;
  if (receiver.audible.empty() || !receiver.receive[beam]) return true;
  const Axis& axis = receiver.axes[receiver.receive[beam]->axis];
  const double turned = std::min(std::abs(half), pi / 2);  // the sine does not increase beyond it
  const double middle = axis.level + axis.ahead,
               off = std::abs(axis.ahead) * (1 - std::cos(half)) + std::abs(axis.aside) * std::sin(turned);
  return middle + off >= receiver.audible[beam].lo && middle - off <= receiver.audible[beam].hi;
}

}  // namespace tubefoot
