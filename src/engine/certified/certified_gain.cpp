// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_gain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/numbers/scalars.hpp"

// Encloses line, piston, Gaussian and tabulated beam patterns. Their bounds in the complex plane are e^(pi
// |Im z|) for sinc z, e^|Im z| for 2 J1(z) / z, and e^(c (Im a)^2) for e^(-c a^2). See
// docs/notes/certified-energies.md, section "Error of the quadrature".
namespace tubefoot {
namespace {

/// sin(pi x) / (pi x). Its slope is at most 1.3703, and its modulus at most 1 / (pi |x|).
Interval sinc(const Interval& x) {
  const double middle = x.lo + (x.hi - x.lo) / 2, nearest = std::nearbyint(middle),
               radius = std::max(x.hi - middle, middle - x.lo) * (1 + 1e-15);
  if (!(std::abs(middle) < 0x1p50)) return {-1, 1};
  double value = 1;
  if (middle != 0) {
    const double sine = std::sin(std::numbers::pi * (middle - nearest));  // the difference is exact
    value = (std::fmod(nearest, 2) == 0 ? sine : -sine) / (std::numbers::pi * middle);
  }
  const double off = 1.3704 * radius + std::abs(value) * 20 * 0x1p-52,
               least = x.lo > 0   ? x.lo
                       : x.hi < 0 ? -x.hi
                                  : 0,
               most = std::min(1.0, 0.3184 / std::max(least, 1e-300));
  return {std::max(value - off, -most), std::min(value + off, most)};
}

}  // namespace

CertifiedGain::CertifiedGain(const Directivity& directivity) : pattern(&directivity) {
  using Kind = Directivity::Kind;
  if (directivity.from_axis || (directivity.kind != Kind::gaussian && directivity.kind != Kind::table))
    return;
  const Ball centre(directivity.centre);
  centre_angle = atan2(centre, root(Ball(1) - squared(centre)));
}

Ball CertifiedGain::largest() const {
  // Slightly larger, for the rounding of the cubics of tables.
  const auto of_level = [](double db) {
    return exp(Ball(db * (1 + 1e-9) + 1e-9) * log(Ball(10)) / Ball(10));
  };
  static const Ball of_no_table = of_level(0);
  double most_db = 0;
  if (pattern->table)
    for (const auto& one : pattern->table->segments()) most_db = std::max(most_db, one.c[0]);
  return most_db == 0 ? of_no_table : of_level(most_db);
}

/// |sinc z| <= e^(pi |Im z|) and |2 J1(z) / z| <= e^|Im z|, because both are means of e^(i z s) over s. Also
/// |e^(-c a^2)| <= e^(c (Im a)^2). For a = asin w and for a = acos w, cosh(Im a) = (|w + 1| + |w - 1|) / 2.
double CertifiedGain::log_bound(const ComplexBall& w) const {
  const Directivity& d = *pattern;
  if (d.kind == Directivity::Kind::uniform) return 0;
  if (!w.is_finite()) return infinite;
  const auto reach = [](const Ball& x) { return std::max(std::abs(x.lo()), std::abs(x.hi())); };
  if (d.kind == Directivity::Kind::line) return d.growth(reach(w.imaginary())) * enclosure_factor;
  if (d.kind == Directivity::Kind::piston) {
    const ComplexBall u = ComplexBall(1.0) - squared(w);
    // (Im sqrt u)^2 = (|u| - Re u) / 2
    return 2 * d.size * std::sqrt(std::max(u.largest() - u.real().lo(), 0.0) / 2 * enclosure_factor) *
           enclosure_factor;
  }
  if (!(w.real().lo() > -1 && (d.from_axis || w.real().hi() < 1))) return infinite;
  const double stretch =
      ((w + ComplexBall(1.0)).largest() + (w - ComplexBall(1.0)).largest()) / 2 * enclosure_factor;
  const double y = std::acosh(std::max(stretch, 1.0)) * enclosure_factor;
  if (d.kind == Directivity::Kind::gaussian) return d.growth(y) * enclosure_factor;
  // A table is the cubic of one segment as a function of the angle.
  if (!(w.real().hi() < 1)) return infinite;
  ComplexBall angle;
  if (d.from_axis)
    acb_acos(angle.get(), w.get(), ball_bits);
  else
    acb_asin(angle.get(), w.get(), ball_bits);
  if (!d.from_axis) angle = angle - ComplexBall(centre_angle);
  const PatternTable::Segment& s = d.table->segments()[segment];
  const ComplexBall x = angle - ComplexBall(s.from);
  const ComplexBall level =
      ComplexBall(s.c[0]) + x * (ComplexBall(s.c[1]) + x * (ComplexBall(s.c[2]) + x * ComplexBall(s.c[3])));
  return level.real().hi() * 0.2302585092994046 + std::abs(level.real().hi()) * 1e-12;
}

double CertifiedGain::log_bound(const ComplexRange& w) const {
  const Directivity& d = *pattern;
  if (d.kind == Directivity::Kind::uniform) return 0;
  if (!w.is_finite()) return infinite;
  if (d.kind == Directivity::Kind::line) return d.growth(w.most_im() * enclosure_factor) * enclosure_factor;
  if (d.kind == Directivity::Kind::piston) {
    // |u| - Re u for u = 1 - w^2 = (1 - w) (1 + w), with Re u = 1 - x^2 + y^2.
    const double y = w.most_im(), x = w.most_re(),
                 size = std::hypot(std::max(w.re_hi - 1, 1 - w.re_lo), y) *
                        std::hypot(std::max(w.re_hi + 1, -1 - w.re_lo), y),
                 real = 1 - x * x + w.least_im() * w.least_im();
    // Im sqrt u = Im u / (2 Re sqrt u) is a second bound.
    double imaginary = std::sqrt(std::max(size - real, 0.0) / 2 + 1e-14);
    if (real > 1e-9) imaginary = std::min(imaginary, x * y / std::sqrt(real));
    return 2 * d.size * imaginary * enclosure_factor;
  }
  if (d.kind != Directivity::Kind::gaussian) return log_bound(w.ball());
  if (!(w.re_lo > -1 && (d.from_axis || w.re_hi < 1))) return infinite;
  // A sum of distances is convex, so its maximum lies at a corner.
  const double y = w.most_im();
  const auto to_ends = [&](double x) { return std::hypot(x + 1, y) + std::hypot(x - 1, y); };
  const double stretch = std::max(to_ends(w.re_lo), to_ends(w.re_hi)) / 2 * enclosure_factor;
  return d.growth(std::acosh(std::max(stretch, 1.0)) * enclosure_factor) * enclosure_factor;
}

Interval CertifiedGain::at(const Interval& w, bool by_segment, double most) const {
  const Directivity& d = *pattern;
  const auto as_ball = [&] {
    const Ball value = at(Ball::between(w.lo, w.hi), by_segment, Ball(most));
    const bool beyond = !value.is_finite() || (!by_segment && value.hi() > most);
    return beyond ? Interval(0, most) : Interval(value.lo(), value.hi());
  };
  if (d.kind == Directivity::Kind::line) {
    const Interval u = d.size * (w - d.centre);
    if (d.shading == 0) return squared(sinc(u));
    return squared(sinc(u) + d.shading / 2 * (sinc(u - 1.0) + sinc(u + 1.0)));
  }
  if (d.kind != Directivity::Kind::gaussian || !(w.lo >= -1 && w.hi <= 1)) return as_ball();
  const auto angle_of = [&](double x) { return d.from_axis ? std::acos(x) : std::asin(x); };
  const auto span = [](double a, double b) {
    return outwards(std::min(a, b), std::max(a, b), library_units);
  };
  Interval angle = span(angle_of(w.lo), angle_of(w.hi));
  if (!d.from_axis) angle = angle - span(std::asin(d.centre), std::asin(d.centre));
  const Interval four_ln2 = outwards(4 * std::numbers::ln2, 4 * std::numbers::ln2);
  const Interval value = exp(-(four_ln2 * squared(angle / d.size)));
  return {std::max(value.lo, 0.0), std::min(value.hi, most)};
}

Ball CertifiedGain::at(const Ball& w, bool by_segment, const Ball& otherwise) const {
  const Directivity& d = *pattern;
  const Ball size(d.size);
  switch (d.kind) {
    case Directivity::Kind::uniform:
      return Ball(1);
    case Directivity::Kind::line: {
      const auto sinc = [](const Ball& x) {
        Ball value;
        arb_sinc_pi(value.get(), x.get(), ball_bits);
        return value;
      };
      const Ball u = size * (w - Ball(d.centre));
      if (d.shading == 0) return squared(sinc(u));
      return squared(sinc(u) + Ball(d.shading / 2) * (sinc(u - Ball(1)) + sinc(u + Ball(1))));
    }
    case Directivity::Kind::piston: {
      // 2 J1(x) / x = 0F1(2; -x^2 / 4)
      Ball amplitude;
      const Ball z = squared(size) * (squared(w) - Ball(1)) / Ball(4), two(2);
      arb_hypgeom_0f1(amplitude.get(), two.get(), z.get(), 0, ball_bits);
      return squared(amplitude);
    }
    case Directivity::Kind::gaussian:
    case Directivity::Kind::table:
      break;
  }
  const Ball angle = angle_of(w);
  if (d.kind == Directivity::Kind::gaussian) return exp(-(Ball(4) * log(Ball(2)) * squared(angle / size)));
  const auto level_of = [&](std::size_t k) {
    const PatternTable::Segment& s = d.table->segments()[k];
    const Ball x = angle - Ball(s.from);
    return Ball(s.c[0]) + x * (Ball(s.c[1]) + x * (Ball(s.c[2]) + x * Ball(s.c[3])));
  };
  Ball level;
  if (by_segment) {
    level = level_of(segment);
  } else {
    if (!angle.is_finite()) return otherwise * Ball::between(0, 1);
    const std::size_t first = d.table->segment_at(angle.lo()), last = d.table->segment_at(angle.hi());
    level = level_of(first);
    for (std::size_t k = first + 1; k <= last; ++k) {
      const Ball own = level_of(k);
      arb_union(level.get(), level.get(), own.get(), ball_bits);
    }
  }
  return exp(level * log(Ball(10)) / Ball(10));
}

bool CertifiedGain::has_no_zero(const Ball& w) const {
  if (pattern->kind == Directivity::Kind::line && pattern->shading > 0) return at(w, false, Ball(0)).lo() > 0;
  if (pattern->kind == Directivity::Kind::line) {
    const Ball u = Ball(pattern->size) * (w - Ball(pattern->centre));
    // The zeros are the integers except 0.
    if (u.lo() > -1 && u.hi() < 1) return true;
    return std::floor(u.lo()) == std::floor(u.hi()) && u.lo() > std::floor(u.lo());
  }
  if (pattern->kind != Directivity::Kind::piston) return true;
  constexpr double first_zero_of_j1 = 3.83;  // slightly below the zero
  return (Ball(pattern->size) * root(Ball(1) - squared(w))).hi() < first_zero_of_j1 ||
         at(w, false, Ball(0)).lo() > 0;
}

/// Angle of which the pattern is a function.
Ball CertifiedGain::angle_of(const Ball& w) const {
  const Ball sine = root(Ball(1) - squared(w));
  return pattern->from_axis ? atan2(sine, w) : atan2(w, sine) - centre_angle;
}

/// Beyond a border, two neighbouring cubics differ by a third cubic. Its value and slope at the border are
/// only rounding errors.
double CertifiedGain::take_segment(const Ball& w) {
  if (pattern->kind != Directivity::Kind::table) return 0;
  const PatternTable& table = *pattern->table;
  const Ball angle = angle_of(w);
  if (!angle.is_finite()) return infinite;
  const auto most = [](const Ball& x) { return std::max(std::abs(x.lo()), std::abs(x.hi())); };
  segment = table.segment_at(angle.middle());
  const std::size_t first = table.segment_at(angle.lo()), last = table.segment_at(angle.hi());
  const auto jump = [&](std::size_t k, double beyond) {
    const auto &before = table.segments()[k].c, &after = table.segments()[k + 1].c;
    const Ball h = Ball(table.borders()[k]) - Ball(table.segments()[k].from), c1(before[1]), c2(before[2]),
               c3(before[3]);
    const double d0 = most(Ball(after[0]) - (Ball(before[0]) + h * (c1 + h * (c2 + h * c3)))),
                 d1 = most(Ball(after[1]) - (c1 + h * (Ball(2) * c2 + h * Ball(3) * c3))),
                 d2 = most(Ball(after[2]) - (c2 + h * Ball(3) * c3)), d3 = most(Ball(after[3]) - c3);
    return d0 + beyond * (d1 + beyond * (d2 + beyond * d3));
  };
  double level_db = 0;
  for (std::size_t k = segment; k < last; ++k) level_db += jump(k, angle.hi() - table.borders()[k]);
  for (std::size_t k = first; k < segment; ++k) level_db += jump(k, table.borders()[k] - angle.lo());
  return level_db * (std::numbers::ln10 / 10) * (1 + 1e-9);  // far above the rounding of these doubles
}

}  // namespace tubefoot
