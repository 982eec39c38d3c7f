// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/paired_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/certified_path_energy.hpp"

namespace tubefoot {
namespace {

constexpr double slack = 1e-9;  // far above the rounding of the doubles that it is laid on

/// The cosines between an axis and directions.
Ball cosines_of(const glm::dvec3& axis, const Towards& towards) {
  const double range = glm::length(towards.centre_m);
  if (!(range > towards.radius_m)) return Ball::between(-1, 1);
  const double middle = glm::dot(axis, towards.centre_m) / range,
               apart = std::asin(towards.radius_m / range) * (1 + slack) + slack;
  return Ball::between(std::max(middle - apart, -1.0), std::min(middle + apart, 1.0));
}

double most_of(const Directivity& pattern, const Towards& towards) {
  const CertifiedGain gain(pattern);
  if (gain.is_uniform()) return 1;
  const double most = gain.largest().hi(),
               there = gain.at(cosines_of(pattern.axis, towards), false, gain.largest()).hi();
  return there < most ? there : most;
}
double most_of(const MirrorLoss& loss, const Towards& towards) {
  double exponent = 0;
  for (const glm::dvec3& normal : loss.rough_normals) {
    const Ball sine = cosines_of(normal, towards);
    const double least =
        sine.lo() <= 0 && sine.hi() >= 0 ? 0 : std::min(std::abs(sine.lo()), std::abs(sine.hi()));
    exponent += std::max(0.0, least * least - loss.bend * (1 - least * least));
  }
  return loss.factor * std::exp(-loss.roughness * exponent) * (1 + slack);
}
double most_of(const TransmitPattern& transmit, const Towards& towards) {
  double sum = 0;
  for (const Directivity& beam : transmit.beams) sum += most_of(beam, towards);
  return sum;
}

/// How much the root of a pattern may change where a direction is off by an angle, and its cosine with the
/// pattern's axis by a part of itself besides. Steepest are sinc x = sin(pi x) / (pi x) with 1.3703, 2 J1(x)
/// / x with 0.37 (by x^2: 1/8), and exp(-2 ln 2 (a / size)^2) with 1.0099 / size.
double root_change(const Directivity& d, double turn_rad, double stretch, const Towards& towards) {
  if (d.kind == Directivity::Kind::uniform) return 0;
  if (d.kind == Directivity::Kind::line) return 1.3705 * d.size * (turn_rad + stretch);
  if (d.kind == Directivity::Kind::piston)
    return 0.4 * d.size * 1.01 * turn_rad + d.size * d.size / 4 * 1.01 * stretch;
  // Functions of the angle: d acos w = d asin w = dw / sqrt(1 - w^2), and no change of an angle is larger
  // than that from 0.
  const Ball w = cosines_of(d.axis, towards);
  const double flattest = std::min(std::max(std::abs(w.lo()), std::abs(w.hi())) + stretch, 1.0),
               sine = std::sqrt((1 - flattest) * (1 + flattest)),
               turn =
                   1.01 * turn_rad + std::min(sine > 0 ? stretch / sine : 1.0, 1.2 * std::sqrt(2 * stretch));
  if (d.kind == Directivity::Kind::gaussian) return 1.011 / d.size * turn;
  return std::sqrt(CertifiedGain(d).largest().hi()) *
         std::expm1(d.table->steepest() * std::numbers::ln10 / 20 * turn) * (1 + slack);
}

/// What patterns in slightly other directions make of an energy, which would be `plain` without patterns.
/// With a^2 and b^2 the patterns there and back, integrals of a times others are bounded by Cauchy's and
/// Schwarz's inequality.
struct PatternDoubt {
  double out_change = 0, out_beams = 1, most_out = 1;
  double home_change = 0, most_home = 1;

  double of(double energy, double plain) const {
    const double t = out_change, n = out_beams, r = home_change, out = plain * most_out,
                 home = plain * most_home, root_n = std::sqrt(n);
    return (2 * t * root_n * std::sqrt(energy * home) + n * t * t * home + 2 * r * std::sqrt(energy * out) +
            r * r * out + 4 * t * r * root_n * std::sqrt(energy * plain) +
            2 * t * root_n * r * r * std::sqrt(out * plain) + 2 * r * n * t * t * std::sqrt(home * plain) +
            n * t * t * r * r * plain) *
           (1 + slack);
  }
};

Towards about(std::span<const glm::dvec3> places_m) {
  Towards found;
  for (const glm::dvec3& p : places_m) found.centre_m += p / double(places_m.size());
  for (const glm::dvec3& p : places_m)
    found.radius_m = std::max(found.radius_m, glm::distance(p, found.centre_m) * (1 + slack));
  return found;
}

}  // namespace

PairedPieces::PairedPieces(const EchoLaw& law, std::span<const double> borders_m, double step_m,
                           std::vector<double> target, double tolerance)
    : law_(law),
      borders_(borders_m),
      step_m_(step_m),
      tolerance_(tolerance),
      target_(std::move(target)),
      textures_(certified_textures(law)),
      beta_(Ball(law.absorption_db_per_m) * log(Ball(10)) / Ball(10)) {}

PairedPieces::OnFacet PairedPieces::on(FacetId facet, const PairedFacet& paired,
                                       const PairedEnclosure& proven) const {
  OnFacet on{paired, proven, law_.material[facet],
             ShiftedSamples(borders_, step_m_, proven.shift_m * (1 + slack)), nullptr};
  on.integrator = std::make_unique<CertifiedPathIntegrator>(on.samples.borders());
  return on;
}

void PairedPieces::add(OnFacet& on, std::span<const glm::dvec3> corners_m, glm::dvec3 receiver_m,
                       std::uint32_t receive_tube, std::pair<std::uint32_t, std::uint32_t> beams,
                       BinsBetween& bins) const {
  const auto [first, end] = beams;
  if (first == end) return;
  const PairedFacet& paired = on.paired;
  constexpr double units = 0x1p-49;  // that corners are rounded by (FootprintSharer)
  CertifiedPolygon plane;
  plane.distance = Ball(paired.transmit_distance_m);
  plane.u = {Ball(1), Ball(0), Ball(0)};
  plane.v = {Ball(0), Ball(1), Ball(0)};
  plane.away = {Ball(0), Ball(0), Ball(1)};
  std::vector<CertifiedPolygon::Point> points;
  std::vector<glm::dvec3> seen_home;
  for (const glm::dvec3& corner : corners_m) {
    std::array<Ball, 3> way;
    for (int k = 0; k < 3; ++k) {
      Ball& own = way[std::size_t(k)] = Ball(corner[k]);
      own.add_error(Ball(
          units * (std::abs(corner[k]) + std::abs(corner[k] - receiver_m[k]) + std::abs(receiver_m[k]))));
      own = own - Ball(paired.to_plane.seen_m[k]);
    }
    const auto along = [&](int row) {
      Ball sum(paired.to_plane.lies_m[row]);
      for (int k = 0; k < 3; ++k) sum += Ball(paired.to_plane.linear[k][row]) * way[std::size_t(k)];
      return sum;
    };
    points.push_back({along(0), along(1)});
    seen_home.push_back(paired.receive_seen.at({points.back().x.middle(), points.back().y.middle()}));
  }
  const CertifiedPolygon polygon = part_of(plane, std::move(points));
  if (polygon.edges.size() < 3) return;

  const ApexOverPlane out{Ball(paired.transmit_distance_m), Ball(0), Ball(0)},
      home{Ball(paired.receive_distance_m), Ball(paired.receive_foot_m.x), Ball(paired.receive_foot_m.y)};
  const auto law_of = [&](std::size_t e) { return on.proven.law[e] ? &*on.proven.law[e] : nullptr; };
  const CertifiedPathEnergy energy({out, paired.transmit_seen}, {home, paired.receive_seen}, law_.path,
                                   {law_of(0), law_of(1)}, law_.material_mu[on.material], beta_);
  const CertifiedTexture* texture = textures_[on.material].get();
  Between range{1, 1};
  if (texture != nullptr) range = {std::max(texture->range().lo(), 0.0), texture->range().hi()};
  const FacetMap lies{glm::dvec3(0), paired.lies.foot_m,
                      glm::dmat3(paired.lies.u, paired.lies.v, glm::dvec3(0))};
  const bool cut = range.hi - range.lo > tolerance_ / 8 * range.lo;
  const std::size_t cells = cut ? cut_by_cells(polygon, *texture, lies, most_cells, {}) : 0;
  const Between even = cells > 0 ? Between{1, 1} : range;
  const std::size_t row = borders_.size() - 1;
  // About a border between samples all may be missing anyway.
  const auto allowance = [&](double relative, double parts) {
    return CertifiedPathIntegrator::Allowance{
        relative, [this, row, first = first, parts](std::size_t beam, std::size_t sample) {
          const std::size_t bin = (first + beam) * row + std::min(sample / 2, row - 1);
          return std::max(target_[bin] / (sample % 2 == 1 ? parts : parts / 8), 1e-300);
        }};
  };
  const Interval& factor = on.proven.factor;

  // Of an even bed without patterns, by sample: what changes of patterns and of texture are told by.
  std::map<std::size_t, double> plain;
  double all_plain = 0;
  const bool weighed = law_.patterns != nullptr;
  double texture_change = 0;
  if (cells > 0 && on.proven.place_off_m > 0) {
    double per_m = 0;
    for (const CertifiedTexture::Axis& axis : texture->axes())
      per_m = std::max(per_m,
                       root(squared(axis.per_m[0]) + squared(axis.per_m[1]) + squared(axis.per_m[2])).hi());
    texture_change = std::min(texture->change(per_m * on.proven.place_off_m * (1 + slack)), range.hi);
  }
  if (weighed || texture_change > 0) {
    CertifiedPathIntegrand integrand(energy, {}, nullptr);
    on.integrator->add(polygon, out, {&home, 1}, integrand, allowance(0.05, 20),
                       [&](std::size_t sample, std::span<const Ball> values) {
                         plain[sample] += values[0].hi();
                         all_plain += values[0].hi();
                       });
  }
  const auto plain_of = [&](std::size_t sample) {
    const auto found = plain.find(sample);
    return found != plain.end() ? found->second : all_plain;
  };

  CertifiedPathGains gains;
  std::vector<PatternDoubt> doubts(end - first);
  if (weighed) {
    const TransmitPattern& transmit = law_.patterns->transmit[law_.patterns->fan_of_tube[receive_tube]];
    const std::span receive = std::span(law_.patterns->receive).subspan(first, end - first);
    gains = {energy.out(), energy.home(), transmit, receive};
    const Towards there = about(corners_m), back = about(seen_home);
    PatternDoubt doubt;
    doubt.out_beams = double(transmit.beams.size());
    doubt.most_out = tubefoot::most_of(transmit, there);
    for (const Directivity& beam : transmit.beams)
      doubt.out_change =
          std::max(doubt.out_change, root_change(beam, on.proven.turn_rad[0], on.proven.stretch[0], there));
    for (std::size_t b = 0; b < receive.size(); ++b) {
      doubts[b] = doubt;
      doubts[b].most_home = tubefoot::most_of(receive[b], back);
      doubts[b].home_change = root_change(receive[b], on.proven.turn_rad[1], on.proven.stretch[1], back);
    }
  }
  std::map<std::size_t, std::vector<Between>> found;  // by sample, over all cells
  const auto add_part = [&](const CertifiedPolygon& part, const CertifiedCell* cell) {
    CertifiedPathIntegrand integrand(energy, gains, cell);
    const double parts = 200 * double(std::max<std::size_t>(cells, 1)) * even.hi;
    on.integrator->add(part, out, {&home, 1}, integrand, allowance(tolerance_ / 8, parts),
                       [&](std::size_t sample, std::span<const Ball> values) {
                         std::vector<Between>& sums = found[sample];
                         sums.resize(values.size());
                         for (std::size_t b = 0; b < values.size(); ++b) {
                           sums[b].lo += std::max(values[b].lo(), 0.0) * even.lo;
                           sums[b].hi += std::max(values[b].hi(), 0.0) * even.hi;
                         }
                       });
  };
  if (cells == 0)
    add_part(polygon, nullptr);
  else
    cut_by_cells(polygon, *texture, lies, most_cells,
                 [&](const CertifiedPolygon& part, const CertifiedCell& cell) { add_part(part, &cell); });
  for (const auto& [sample, sums] : found) {
    const double most_plain = (weighed || texture_change > 0) ? plain_of(sample) : 0;
    for (std::size_t b = 0; b < sums.size(); ++b) {
      double off = 0;
      if (weighed) off += doubts[b].of(sums[b].hi, most_plain * range.hi);
      if (texture_change > 0)
        off += texture_change * most_plain * (weighed ? doubts[b].most_out * doubts[b].most_home : 1);
      on.samples.add(std::uint32_t(first + b), std::uint32_t(sample),
                     std::max(sums[b].lo - off, 0.0) * factor.lo * (1 - slack),
                     (sums[b].hi + off) * factor.hi * (1 + slack), bins);
    }
  }
}

double PairedPieces::most_of(std::uint32_t transmit, std::uint32_t beam, const Towards& out,
                             const Towards& home) const {
  const double passes =
      tubefoot::most_of(law_.path.out.loss, out) * tubefoot::most_of(law_.path.back().loss, home);
  if (law_.patterns == nullptr) return passes;
  return passes * tubefoot::most_of(law_.patterns->transmit[transmit], out) *
         tubefoot::most_of(law_.patterns->receive[beam], home);
}

}  // namespace tubefoot
