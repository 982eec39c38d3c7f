// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/receiver_pair_integrand.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/numbers/complex_ranges.hpp"
#include "geometry/numbers/scalars.hpp"

// Encloses sqrt(E_upper E_lower) times the cosine and sine of the phase between two receivers. In the complex
// plane e^|Im z| bounds the moduli of cos z and sin z. See docs/notes/certified-energies.md, section "Two
// receivers".
namespace tubefoot {
namespace {

/// Returns the corners of a polygon without those at very short edges, whose directions are hardly known.
/// The result is an inscribed polygon. Each omitted corner removes an area of at most half the product of
/// its edges, which is added to `ambiguous`.
std::vector<CertifiedPolygon::Point> without_short_edges(const CertifiedPolygon& polygon, Ball& ambiguous) {
  std::vector<CertifiedPolygon::Point> kept;
  double widest = 0;
  for (const CertifiedPolygon::Point& p : polygon.points)
    widest = std::max({widest, p.x.hi() - p.x.lo(), p.y.hi() - p.y.lo()});
  const double around = polygon.perimeter.hi(), shortest = std::sqrt(4 * widest * around);
  const auto is_short = [&](const CertifiedPolygon::Point& p, const CertifiedPolygon::Point& q) {
    const double length = root(squared(q.x - p.x) + squared(q.y - p.y)).hi();
    if (length > shortest) return false;
    ambiguous += Ball(length) * Ball(around);
    return true;
  };
  for (const CertifiedPolygon::Point& p : polygon.points)
    if (kept.empty() || !is_short(kept.back(), p)) kept.push_back(p);
  while (kept.size() > 1 && is_short(kept.back(), kept.front())) kept.pop_back();
  return kept;
}

}  // namespace

ReceiverPairPhase::ReceiverPairPhase(const CertifiedEnd& tx, const ReceiverBaseline& receiver_pair,
                                     const glm::dvec3& middle_m)
    : along(tx.trace(receiver_pair.axis)),
      turn(Ball(-2) * Ball(receiver_pair.baseline_m) * Ball(receiver_pair.wavenumber_rad_m)),
      growth(std::abs(turn.middle()) / 2) {
  for (int k = 0; k < 3; ++k) along.at_foot += Ball(-middle_m[k]) * Ball(receiver_pair.axis[k]);
}

ReceiverPairPhase::ReceiverPairPhase(const ApexOverPlane& upper, const ApexOverPlane& lower,
                                     double wavenumber_rad_m)
    : turn(wavenumber_rad_m) {
  const Ball x = upper.x - lower.x, y = upper.y - lower.y, height = upper.height - lower.height;
  along.at_foot = height * (upper.height + lower.height) + x * (upper.x + lower.x) + y * (upper.y + lower.y);
  along.along_u = Ball(-2) * x;
  along.along_v = Ball(-2) * y;
  growth = wavenumber_rad_m * std::hypot(x.middle(), y.middle(), height.middle());
}

double ReceiverPairIntegrand::scale_m(const PlanePlace<Ball>& p) const {
  return std::min(upper_.energy.scale_m(p), lower_.energy.scale_m(p)) * upper_.gains.smooth_rad() /
         (1 + phase_.growth);
}

void ReceiverPairIntegrand::at(const PlanePlace<Ball>& p, std::vector<Ball>& values) const {
  const Ball tx = upper_.energy.tx().range(p), up = upper_.energy.rx().range(p),
             down = lower_.energy.rx().range(p);
  std::vector<Ball> one{upper_.energy.density_at(p, tx, up)}, other{lower_.energy.density_at(p, tx, down)};
  upper_.gains.weigh(p, tx, up, one);
  lower_.gains.weigh(p, tx, down, other);
  Ball size = root(one[0] * other[0]);
  if (texture_ != nullptr) size = size * texture_->factor_at(p.x, p.y);
  Ball sine, cosine;
  sin_cos(phase_.turn * phase_.along.at(p.x, p.y) / (up + down), sine, cosine);
  values = {size, size * cosine, size * sine};
  if (with_energies_)
    for (const Ball& energy : {one[0], other[0]})
      values.push_back(texture_ == nullptr ? energy : energy * texture_->factor_at(p.x, p.y));
}

bool ReceiverPairIntegrand::take(const PlanePlace<Ball>& box, std::vector<double>& off) {
  const Ball tx = upper_.energy.tx().range(box);
  std::vector<double> one(1, 0), other(1, 0);
  upper_.gains.take_segments(box, tx, upper_.energy.rx().range(box), one);
  lower_.gains.take_segments(box, tx, lower_.energy.rx().range(box), other);
  for (double& value : off) value = (one[0] + other[0]) / 2;
  if (with_energies_) off[3] = one[0], off[4] = other[0];
  if (!upper_.energy.take_pieces(box) || !lower_.energy.take_pieces(box)) return false;
  // Square roots of patterns have corners at the zeros of the patterns.
  return upper_.gains.has_no_zero(box, upper_.energy.rx().range(box)) &&
         lower_.gains.has_no_zero(box, lower_.energy.rx().range(box));
}

void ReceiverPairIntegrand::take_whole() {
  for (ReceiverPairPath* two_way : {&upper_, &lower_}) {
    two_way->gains.take_tables();
    two_way->energy.take_all_pieces();
  }
}

void ReceiverPairIntegrand::log_bounds(const PlanePlace<ComplexBall>& p, std::vector<double>& bounds) const {
  CertifiedEnd::Bound tx, up, down;
  std::vector<double> one{upper_.energy.log_bound(p, tx, up)}, other{lower_.energy.log_bound(p, tx, down)};
  bounds.assign(values(), infinite);
  if (!(one[0] < infinite && other[0] < infinite)) return;
  upper_.gains.weigh(p, tx, up, one);
  lower_.gains.weigh(p, tx, down, other);
  const double texture = texture_ != nullptr ? std::log(texture_->largest_at(p.x, p.y)) + 1e-9 : 0;
  double size = (one[0] + other[0]) / 2 + 1e-9;
  if (texture_ != nullptr) size += texture;
  // |cos z| and |sin z| are at most e^|Im z|.
  const ComplexBall ranges =
      tight_root(upper_.energy.rx().range2(p)) + tight_root(lower_.energy.rx().range2(p));
  const ComplexRange phase(ComplexBall(phase_.turn) * phase_.along.at(p.x, p.y) * tight_inverse(ranges));
  if (std::isnan(size) || !phase.is_finite()) return;
  const double turned = size + phase.most_im() * (1 + 1e-12) + 1e-9;
  bounds = {size, turned, turned};
  if (with_energies_)
    for (const double energy : {one[0], other[0]}) bounds.push_back(energy + texture + 1e-9);
}

std::pair<CertifiedPolygon, Ball> common_part(const CertifiedPolygon& one, const CertifiedPolygon& other) {
  CertifiedPolygon left = one;
  Ball ambiguous;
  const std::vector<CertifiedPolygon::Point> points = without_short_edges(other, ambiguous);
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n && !left.points.empty(); ++i) {
    const CertifiedPolygon::Point &a = points[i], &b = points[i + 1 == n ? 0 : i + 1];
    const Ball dx = b.x - a.x, dy = b.y - a.y, length = root(squared(dx) + squared(dy));
    if (!length.surely_positive()) {
      ambiguous += Ball(length.hi()) * one.perimeter;  // cuts off no more than its length
      continue;
    }
    std::vector<Ball> height;
    double level = 0;
    for (const CertifiedPolygon::Point& p : left.points) {
      height.push_back((dx * (p.y - a.y) - dy * (p.x - a.x)) / length);
      level = std::max(level, 2 * (height.back().hi() - height.back().lo()));
    }
    // Points nearer to the line than this count as lying on it.
    ambiguous += Ball(2 * level) * one.perimeter;
    auto sides = split(left.points, height, level);
    if (sides[0].empty()) continue;
    left = part_of(one, std::move(sides[1]));
  }
  return {std::move(left), Ball(ambiguous.hi())};
}

}  // namespace tubefoot
