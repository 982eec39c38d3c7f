// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/flattened_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/certified/pattern_ambiguity.hpp"
#include "engine/certified/receiver_pair_integrand.hpp"
#include "geometry/numbers/enclosure_slack.hpp"

// Integrates pieces of flattened facets in ball arithmetic. The bounds of BistaticEnclosure then widen the
// result. They cover the factor, the half-path error at sample borders, the phase, patterns and the position
// of texture. See docs/notes/certified-energies.md, sections "Of two ends" and "Of two receivers".
namespace tubefoot {
namespace {

constexpr double whatever = 1e100;  // allowance for values that are not needed

/// Sums of a sample over pieces, without factors: both parts of the product as intervals, and upper bounds
/// of its size and of either energy.
struct Sums {
  Interval real, imag;
  double size = 0, energy = 0;

  void add(std::span<const Ball> values, const Interval& texture) {
    size += std::max(values[0].hi(), 0.0) * texture.hi;
    if (values.size() > 3) energy += std::max({values[3].hi(), values[4].hi(), 0.0}) * texture.hi;
    take(real, values[1], values[0], texture);
    take(imag, values[2], values[0], texture);
  }

 private:
  static void take(Interval& sum, const Ball& part, const Ball& size, const Interval& texture) {
    const double middle = texture.lo + (texture.hi - texture.lo) / 2,
                 off = (texture.hi - texture.lo) / 2 * std::max(size.hi(), 0.0) * (1 + enclosure_slack);
    sum.lo += part.lo() * middle - off;
    sum.hi += part.hi() * middle + off;
  }
};

/// Returns a piece of the flattened facet as a polygon.
CertifiedPolygon flattened(const ReceivedPiece& piece, const BistaticFacet& bistatic) {
  constexpr double units = 0x1p-49;  // rounding of corners (FootprintSharer)
  CertifiedPolygon plane;
  plane.distance = Ball(bistatic.transmit_distance_m);
  plane.u = {Ball(1), Ball(0), Ball(0)};
  plane.v = {Ball(0), Ball(1), Ball(0)};
  plane.away = {Ball(0), Ball(0), Ball(1)};
  std::vector<CertifiedPolygon::Point> points;
  for (const glm::dvec3& corner : piece.corners_m) {
    std::array<Ball, 3> two_way;
    for (int k = 0; k < 3; ++k) {
      Ball& own = two_way[std::size_t(k)] = Ball(corner[k]);
      own.add_error(Ball(units * (std::abs(corner[k]) + std::abs(corner[k] - piece.receiver_m[k]) +
                                  std::abs(piece.receiver_m[k]))));
      own = own - Ball(bistatic.to_plane.seen_m[k]);
    }
    const auto along = [&](int row) {
      Ball sum(bistatic.to_plane.lies_m[row]);
      for (int k = 0; k < 3; ++k) sum += Ball(bistatic.to_plane.linear[k][row]) * two_way[std::size_t(k)];
      return sum;
    };
    points.push_back({along(0), along(1)});
  }
  return part_of(plane, std::move(points));
}

/// Returns the apparent positions of a polygon for the receiver.
Towards seen_rx(const CertifiedPolygon& polygon, const BistaticFacet& bistatic) {
  std::vector<glm::dvec3> seen;
  for (const CertifiedPolygon::Point& p : polygon.points)
    seen.push_back(bistatic.receive_seen.at({p.x.middle(), p.y.middle()}));
  return Towards::places(seen);
}

/// Returns the map from coordinates of the plane to true positions.
FacetMap map_of(const LyingPlane& lies) {
  return {glm::dvec3(0), lies.foot_m, glm::dmat3(lies.u, lies.v, glm::dvec3(0))};
}

}  // namespace

FlattenedPieces::FlattenedPieces(const CertifiedRequest& request, FacetId facet, const ProvenFacet& upper,
                                 const ProvenFacet& lower, double shift_m)
    : request_(request),
      upper_(upper),
      lower_(lower),
      material_(request.model.material[facet]),
      samples_(request.borders, request.step_m, shift_m * (1 + enclosure_slack)),
      integrator_(samples_.borders()) {}

FlattenedPieces::FlattenedPieces(const CertifiedRequest& request, FacetId facet, const ProvenFacet& one)
    : FlattenedPieces(request, facet, one, one, one.proven.shift_m) {}

FlattenedPieces::FlattenedPieces(const CertifiedRequest& request, FacetId facet, const ProvenFacet& upper,
                                 const ProvenFacet& lower)
    // The shift is at least a small part of a sample, so that ellipses about a border are easily resolved.
    : FlattenedPieces(request, facet, upper, lower,
                      std::max({upper.proven.shift_m, lower.proven.shift_m, 1e-7 * request.step_m})) {}

CertifiedPathEnergy FlattenedPieces::energy_of(const ProvenFacet& facet) const {
  const ApexOverPlane tx{Ball(facet.bistatic.transmit_distance_m), Ball(0), Ball(0)},
      rx{Ball(facet.bistatic.receive_distance_m), Ball(facet.bistatic.receive_foot_m.x),
         Ball(facet.bistatic.receive_foot_m.y)};
  const auto model_of = [&](std::size_t e) {
    return facet.proven.model[e] ? &*facet.proven.model[e] : nullptr;
  };
  return {{tx, facet.bistatic.transmit_seen}, {rx, facet.bistatic.receive_seen},     request_.model.path,
          {model_of(0), model_of(1)},         request_.model.material_mu[material_], request_.beta_per_m};
}

void FlattenedPieces::add_energies(const ReceivedPiece& piece, std::uint32_t receive_tube,
                                   std::pair<std::uint32_t, std::uint32_t> beams, BinIntervals& bins) {
  const std::uint32_t first = beams.first, end = beams.second;
  const auto& [bistatic, proven] = upper_;
  const CertifiedPolygon polygon = flattened(piece, bistatic);
  if (polygon.edges.size() < 3) return;

  const EchoModel& model = request_.model;
  const CertifiedPathEnergy energy = energy_of(upper_);
  const ApexOverPlane tx = energy.tx().over(), rx = energy.rx().over();
  const TexturedPolygon textured = request_.textured(polygon, material_, map_of(bistatic.lies));
  const Interval even = textured.factor_bounds();
  const std::size_t row = request_.row();
  // Within the shift of a border between samples, the whole energy is uncertain in any case.
  const auto allowance = [&](double relative, double parts) {
    return CertifiedPathIntegrator::Allowance{
        relative, [this, row, first, parts](std::size_t beam, std::size_t sample) {
          const std::size_t bin = (first + beam) * row + std::min(sample / 2, row - 1);
          return std::max(request_.target[bin] / (sample % 2 == 1 ? parts : parts / 8), least_allowed);
        }};
  };
  const Interval& factor = proven.factor;

  // Energies of the untextured seabed without patterns, by sample. They scale the errors due to patterns and
  // texture.
  std::map<std::size_t, double> plain;
  double all_plain = 0;
  const bool weighed = model.patterns != nullptr;
  const double texture_change = textured.change_over(proven.place_off_m);
  if (weighed || texture_change > 0) {
    CertifiedPathIntegrand integrand(energy, {}, nullptr);
    integrator_.add(polygon, tx, {&rx, 1}, integrand, allowance(0.05, 20),
                    [&](std::size_t sample, std::span<const Interval> values) {
                      plain[sample] += values[0].hi;
                      all_plain += values[0].hi;
                    });
  }
  const auto plain_of = [&](std::size_t sample) {
    const auto found = plain.find(sample);
    return found != plain.end() ? found->second : all_plain;
  };

  CertifiedPathGains gains;
  std::vector<PatternAmbiguity> ambiguities(end - first);
  if (weighed) {
    const TransmitPattern& transmit = model.patterns->transmit[model.patterns->fan_of_tube[receive_tube]];
    const std::span receive = std::span(model.patterns->receive).subspan(first, end - first);
    gains = {energy.tx(), energy.rx(), transmit, receive};
    const PatternAmbiguity tx_ambiguity(transmit, Towards::places(piece.corners_m), proven);
    const Towards back = seen_rx(polygon, bistatic);
    for (std::size_t b = 0; b < receive.size(); ++b) {
      ambiguities[b] = tx_ambiguity;
      ambiguities[b].take_rx(receive[b], back, proven);
    }
  }
  std::map<std::size_t, std::vector<Interval>> found;  // by sample, summed over all cells
  textured.each_part([&](const CertifiedPolygon& part, const CertifiedCell* cell) {
    CertifiedPathIntegrand integrand(energy, gains, cell);
    integrator_.add(part, tx, {&rx, 1}, integrand,
                    allowance(request_.tolerance / 8, 200 * textured.parts() * even.hi),
                    [&](std::size_t sample, std::span<const Interval> values) {
                      std::vector<Interval>& sums = found[sample];
                      sums.resize(values.size());
                      for (std::size_t b = 0; b < values.size(); ++b) {
                        sums[b].lo += std::max(values[b].lo, 0.0) * even.lo;
                        sums[b].hi += std::max(values[b].hi, 0.0) * even.hi;
                      }
                    });
  });
  const double largest_texture = textured.range().hi();
  for (auto& [sample, sums] : found) {
    const double most_plain = (weighed || texture_change > 0) ? plain_of(sample) : 0;
    for (std::size_t b = 0; b < sums.size(); ++b) {
      double off = 0;
      // Cutting a sliver may lose its part of a cell. The energy with the largest texture value bounds that
      // of the part.
      const double most = most_plain * largest_texture * ambiguities[b].most_tx * ambiguities[b].most_rx;
      if (weighed && !(sums[b].hi <= std::numeric_limits<double>::max())) sums[b].hi = most;
      if (weighed) off += ambiguities[b].of(sums[b].hi, most_plain * largest_texture);
      if (texture_change > 0)
        off += texture_change * most_plain * (weighed ? ambiguities[b].most_tx * ambiguities[b].most_rx : 1);
      samples_.add(std::uint32_t(first + b), std::uint32_t(sample),
                   std::max(sums[b].lo - off, 0.0) * factor.lo * (1 - enclosure_slack),
                   (sums[b].hi + off) * factor.hi * (1 + enclosure_slack), bins);
    }
  }
}

void FlattenedPieces::add_products(double wavenumber_rad_m, const ReceivedPiece& upper,
                                   const ReceivedPiece& lower, Products& found) {
  const EchoModel& model = request_.model;
  const std::size_t row = request_.row();
  const CertifiedPolygon seen = flattened(upper, upper_.bistatic), other = flattened(lower, lower_.bistatic);
  if (seen.edges.size() < 3 || other.edges.size() < 3) return;
  const auto [part, uncertain] = common_part(seen, other);
  const bool is_any = part.edges.size() >= 3;
  if (!is_any && !(uncertain.hi() > 0)) return;
  const bool weighed = model.patterns != nullptr;
  ReceiverPairPath by_upper{energy_of(upper_), {}}, by_lower{energy_of(lower_), {}};
  const ApexOverPlane tx = by_upper.energy.tx().over(),
                      homes[2]{by_upper.energy.rx().over(), by_lower.energy.rx().over()};
  const ReceiverPairPhase phase(homes[0], homes[1], wavenumber_rad_m);
  const std::span both = std::span(homes).first(phase.growth > 0 ? 2 : 1);
  // Either energy of an untextured seabed without patterns. Their mean bounds the square root of their
  // product.
  CertifiedPathIntegrand plain[2]{{by_upper.energy, {}, nullptr}, {by_lower.energy, {}, nullptr}};
  PatternAmbiguity ambiguity;
  if (weighed) {
    const std::span receive = std::span(model.patterns->receive).first(1);
    const TransmitPattern& transmit = model.patterns->transmit.front();
    ambiguity = PatternAmbiguity(transmit, Towards::places(upper.corners_m), upper_.proven);
    for (const auto& [two_way, by, polygon] :
         {std::tuple(&by_upper, &upper_, &seen), {&by_lower, &lower_, &other}}) {
      two_way->gains = {two_way->energy.tx(), two_way->energy.rx(), transmit, receive};
      ambiguity.take_rx(receive.front(), seen_rx(*polygon, by->bistatic), by->proven);
    }
  }
  const CertifiedTexture* texture = request_.textures[material_].get();
  const double largest_texture = texture != nullptr ? texture->range().hi() : 1;
  const Interval factor(std::sqrt(upper_.proven.factor.lo * lower_.proven.factor.lo) * (1 - enclosure_slack),
                        std::sqrt(upper_.proven.factor.hi * lower_.proven.factor.hi) * (1 + enclosure_slack));
  const double largest =
      factor.hi * largest_texture * ambiguity.most_tx * ambiguity.most_rx * (1 + enclosure_slack);
  const auto allowance = [&](double relative, double parts, int which) {
    return CertifiedPathIntegrator::Allowance{
        relative, [this, row, parts, which](std::size_t value, std::size_t sample) {
          if (value > 2 || (which >= 0 && int(sample % 2) != which)) return whatever;
          return std::max(request_.target[2 * row + std::min(sample / 2, row - 1)] / parts, least_allowed);
        }};
  };

  // Adds points that one receiver receives next to a border, and points that may or may not be common to
  // both.
  const auto add_ambiguous = [&](std::size_t sample, std::span<const Ball> values) {
    samples_.add(0, std::uint32_t(sample), 0, std::max(values[0].hi(), 0.0) / 2 * largest, found.ambiguous);
  };
  if (uncertain.hi() > 0)
    for (CertifiedPathIntegrand& energy : plain)
      integrator_.add(seen, tx, both.first(1), energy, allowance(1, 1, 2), add_ambiguous, uncertain);
  if (!is_any) return;
  const bool wide = samples_.too_wide();
  for (const ApexOverPlane& rx : both.first(wide ? 1 : both.size()))
    for (CertifiedPathIntegrand& energy : plain)
      integrator_.add(part, tx, {&rx, 1}, energy, allowance(0.1, 8, wide ? -1 : 0),
                      [&](std::size_t sample, std::span<const Ball> values) {
                        if (wide || sample % 2 == 0) add_ambiguous(sample, values);
                      });
  if (wide) return;

  const TexturedPolygon textured = request_.textured(part, material_, map_of(upper_.bistatic.lies));
  const Interval even = textured.factor_bounds();
  const double change = textured.change_over(upper_.proven.place_off_m);
  // Energies that scale the errors due to patterns and texture.
  std::map<std::size_t, double> alone[2];
  std::map<std::size_t, Sums> sums;
  if (weighed || change > 0)
    for (std::size_t r = 0; r < 2; ++r)
      integrator_.add(
          part, tx, both, plain[r], allowance(0.05, 20, 1),
          [&](std::size_t sample, std::span<const Ball> values) { alone[r][sample] += values[0].hi(); });
  textured.each_part([&](const CertifiedPolygon& polygon, const CertifiedCell* cell) {
    ReceiverPairIntegrand integrand(by_upper, by_lower, phase, cell, weighed);
    integrator_.add(
        polygon, tx, both, integrand, allowance(request_.tolerance / 8, 200 * textured.parts() * even.hi, 1),
        [&](std::size_t sample, std::span<const Ball> values) { sums[sample].add(values, even); });
  });
  const double turn = std::min(
      2.0, wavenumber_rad_m * ReceiveRanges::largest_difference_m(upper_.proven.rx, lower_.proven.rx));
  for (const auto& [sample, own] : sums) {
    if (sample % 2 == 0) continue;  // counted with the points next to a border
    double off = 0;
    if (weighed || change > 0) {
      const double most = std::max(alone[0][sample], alone[1][sample]);
      if (weighed) off += ambiguity.of(std::max(own.energy, own.size), most * largest_texture);
      off += change * most * ambiguity.most_tx * ambiguity.most_rx;
    }
    const double middle = factor.middle(),
                 apart = ((factor.hi - factor.lo) / 2 + factor.hi * turn) * own.size + factor.hi * off;
    for (const auto& [beam, sum] : {std::pair(std::size_t{0}, own.real), {std::size_t{1}, own.imag}}) {
      Interval& bin = found.sure[beam * row + sample / 2];
      bin.lo += sum.lo * middle - apart * (1 + enclosure_slack);
      bin.hi += sum.hi * middle + apart * (1 + enclosure_slack);
    }
  }
}

}  // namespace tubefoot
