// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/receiver_pair_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/flattened_facet.hpp"
#include "engine/certified/receiver_pair_integrand.hpp"
#include "geometry/numbers/enclosure_slack.hpp"

// Encloses products of a receiver pair over intersections of visible pieces on flattened facets. The result
// is widened by the enclosures of factors, ranges, patterns and texture. See
// docs/notes/certified-energies.md, section "Of two receivers".
namespace tubefoot {
namespace {

constexpr double slack = enclosure_slack;
constexpr double whatever = 1e100;  // allowance for values that are not needed

/// Sums of a sample over pieces, without factors: both parts of the product as intervals, and upper bounds
/// of its size and of either energy.
struct Sums {
  BinInterval real, imag;
  double size = 0, energy = 0;

  void add(std::span<const Ball> values, const BinInterval& texture) {
    size += std::max(values[0].hi(), 0.0) * texture.hi;
    if (values.size() > 3) energy += std::max({values[3].hi(), values[4].hi(), 0.0}) * texture.hi;
    take(real, values[1], values[0], texture);
    take(imag, values[2], values[0], texture);
  }

 private:
  static void take(BinInterval& sum, const Ball& part, const Ball& size, const BinInterval& texture) {
    const double middle = texture.lo + (texture.hi - texture.lo) / 2,
                 off = (texture.hi - texture.lo) / 2 * std::max(size.hi(), 0.0) * (1 + slack);
    sum.lo += part.lo() * middle - off;
    sum.hi += part.hi() * middle + off;
  }
};

}  // namespace

ReceiverPairPieces::ReceiverPairPieces(const EchoModel& model, double wavenumber_rad_m,
                                       std::span<const double> borders_m, double step_m,
                                       std::vector<double> target, double tolerance)
    : model_(model),
      wavenumber_(wavenumber_rad_m),
      borders_(borders_m),
      step_m_(step_m),
      tolerance_(tolerance),
      target_(std::move(target)),
      textures_(certified_textures(model)),
      beta_(Ball(model.absorption_db_per_m) * log(Ball(10)) / Ball(10)) {}

ReceiverPairPieces::OnFacet ReceiverPairPieces::on(FacetId facet, const By& upper, const By& lower) const {
  // The shift is at least a small part of a sample, so that ellipses about a border are easily resolved.
  const double shift = std::max({upper.proven.shift_m, lower.proven.shift_m, 1e-7 * step_m_}) * (1 + slack);
  OnFacet on{upper, lower, model_.material[facet], ShiftedSamples(borders_, step_m_, shift), nullptr};
  on.integrator = std::make_unique<CertifiedPathIntegrator>(on.samples.borders());
  return on;
}

void ReceiverPairPieces::add(OnFacet& on, const Seen& upper, const Seen& lower, Products& found) const {
  const CertifiedPolygon seen = flattened(upper.corners_m, upper.receiver_m, on.upper.bistatic),
                         other = flattened(lower.corners_m, lower.receiver_m, on.lower.bistatic);
  if (seen.edges.size() < 3 || other.edges.size() < 3) return;
  const auto [part, uncertain] = common_part(seen, other);
  const bool is_any = part.edges.size() >= 3;
  if (!is_any && !(uncertain.hi() > 0)) return;
  const bool weighed = model_.patterns != nullptr;
  ReceiverPairPath by_upper{energy_of(on.upper.bistatic, on.upper.proven, model_, on.material, beta_), {}},
      by_lower{energy_of(on.lower.bistatic, on.lower.proven, model_, on.material, beta_), {}};
  const ApexOverPlane tx = by_upper.energy.tx().over(),
                      homes[2]{by_upper.energy.rx().over(), by_lower.energy.rx().over()};
  const ReceiverPairPhase phase(homes[0], homes[1], wavenumber_);
  const std::span both = std::span(homes).first(phase.growth > 0 ? 2 : 1);
  // Either energy of an untextured seabed without patterns. Their mean bounds the square root of their
  // product.
  CertifiedPathIntegrand plain[2]{{by_upper.energy, {}, nullptr}, {by_lower.energy, {}, nullptr}};
  PatternAmbiguity ambiguity;
  if (weighed) {
    const std::span receive = std::span(model_.patterns->receive).first(1);
    const TransmitPattern& transmit = model_.patterns->transmit.front();
    ambiguity = PatternAmbiguity(transmit, Towards::places(upper.corners_m), on.upper.proven);
    for (const auto& [two_way, by, polygon] :
         {std::tuple(&by_upper, &on.upper, &seen), {&by_lower, &on.lower, &other}}) {
      two_way->gains = {two_way->energy.tx(), two_way->energy.rx(), transmit, receive};
      ambiguity.take_rx(receive.front(), seen_rx(*polygon, by->bistatic), by->proven);
    }
  }
  const CertifiedTexture* texture = textures_[on.material].get();
  BinInterval range{1, 1};
  if (texture != nullptr) range = {std::max(texture->range().lo(), 0.0), texture->range().hi()};
  const Interval factor(std::sqrt(on.upper.proven.factor.lo * on.lower.proven.factor.lo) * (1 - slack),
                        std::sqrt(on.upper.proven.factor.hi * on.lower.proven.factor.hi) * (1 + slack));
  const double largest = factor.hi * range.hi * ambiguity.most_tx * ambiguity.most_rx * (1 + slack);
  const auto allowance = [&](double relative, double parts, int which) {
    return CertifiedPathIntegrator::Allowance{
        relative, [this, parts, which](std::size_t value, std::size_t sample) {
          if (value > 2 || (which >= 0 && int(sample % 2) != which)) return whatever;
          return std::max(target_[std::min(sample / 2, target_.size() - 1)] / parts, 1e-300);
        }};
  };

  // Adds points that one receiver receives next to a border, and points that may or may not be common to
  // both.
  const auto add_ambiguous = [&](std::size_t sample, std::span<const Ball> values) {
    on.samples.add(0, std::uint32_t(sample), 0, std::max(values[0].hi(), 0.0) / 2 * largest, found.ambiguous);
  };
  if (uncertain.hi() > 0)
    for (CertifiedPathIntegrand& energy : plain)
      on.integrator->add(seen, tx, both.first(1), energy, allowance(1, 1, 2), add_ambiguous, uncertain);
  if (!is_any) return;
  const bool wide = on.samples.too_wide();
  for (const ApexOverPlane& rx : both.first(wide ? 1 : both.size()))
    for (CertifiedPathIntegrand& energy : plain)
      on.integrator->add(part, tx, {&rx, 1}, energy, allowance(0.1, 8, wide ? -1 : 0),
                         [&](std::size_t sample, std::span<const Ball> values) {
                           if (wide || sample % 2 == 0) add_ambiguous(sample, values);
                         });
  if (wide) return;

  const FacetMap lies = map_of(on.upper.bistatic.lies);
  const bool cut = range.hi - range.lo > tolerance_ / 8 * range.lo;
  const std::size_t cells = cut ? cut_by_cells(part, *texture, lies, most_cells, {}) : 0;
  const BinInterval even = cells > 0 ? BinInterval{1, 1} : range;
  const double change = cells > 0 ? change_of(*texture, on.upper.proven.place_off_m) : 0;
  // Energies that scale the errors due to patterns and texture.
  std::map<std::size_t, double> alone[2];
  std::map<std::size_t, Sums> sums;
  if (weighed || change > 0)
    for (std::size_t r = 0; r < 2; ++r)
      on.integrator->add(
          part, tx, both, plain[r], allowance(0.05, 20, 1),
          [&](std::size_t sample, std::span<const Ball> values) { alone[r][sample] += values[0].hi(); });
  const auto add_part = [&](const CertifiedPolygon& polygon, const CertifiedCell* cell) {
    ReceiverPairIntegrand integrand(by_upper, by_lower, phase, cell, weighed);
    const double parts = 200 * double(std::max<std::size_t>(cells, 1)) * even.hi;
    on.integrator->add(
        polygon, tx, both, integrand, allowance(tolerance_ / 8, parts, 1),
        [&](std::size_t sample, std::span<const Ball> values) { sums[sample].add(values, even); });
  };
  if (cells == 0)
    add_part(part, nullptr);
  else
    cut_by_cells(
        part, *texture, lies, most_cells,
        [&](const CertifiedPolygon& polygon, const CertifiedCell& cell) { add_part(polygon, &cell); });
  const double turn = std::min(
      2.0, wavenumber_ * ReceiveRanges::largest_difference_m(on.upper.proven.rx, on.lower.proven.rx));
  const std::uint32_t row = std::uint32_t(borders_.size() - 1);
  for (const auto& [sample, own] : sums) {
    if (sample % 2 == 0) continue;  // counted with the points next to a border
    double off = 0;
    if (weighed || change > 0) {
      const double most = std::max(alone[0][sample], alone[1][sample]);
      if (weighed) off += ambiguity.of(std::max(own.energy, own.size), most * range.hi);
      off += change * most * ambiguity.most_tx * ambiguity.most_rx;
    }
    const double middle = factor.middle(),
                 apart = ((factor.hi - factor.lo) / 2 + factor.hi * turn) * own.size + factor.hi * off;
    for (const auto& [beam, sum] : {std::pair(0u, own.real), {1u, own.imag}}) {
      BinInterval& bin = found.sure[beam * row + sample / 2];
      bin.lo += sum.lo * middle - apart * (1 + slack);
      bin.hi += sum.hi * middle + apart * (1 + slack);
    }
  }
}

}  // namespace tubefoot
