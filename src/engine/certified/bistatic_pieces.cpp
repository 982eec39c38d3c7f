// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/bistatic_pieces.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/flattened_facet.hpp"
#include "geometry/numbers/enclosure_slack.hpp"

// Integrates pieces of flattened facets in ball arithmetic. The bounds of BistaticEnclosure then widen the
// result. They cover the factor, the half-path error at sample borders, patterns and the position of texture.
// See docs/notes/certified-energies.md, section "Of two ends".
namespace tubefoot {
namespace {

constexpr double slack = enclosure_slack;

}  // namespace

BistaticPieces::BistaticPieces(const EchoModel& model, std::span<const double> borders_m, double step_m,
                               std::vector<double> target, double tolerance)
    : model_(model),
      borders_(borders_m),
      step_m_(step_m),
      tolerance_(tolerance),
      target_(std::move(target)),
      textures_(certified_textures(model)),
      beta_(Ball(model.absorption_db_per_m) * log(Ball(10)) / Ball(10)) {}

BistaticPieces::OnFacet BistaticPieces::on(FacetId facet, const BistaticFacet& bistatic,
                                           const BistaticEnclosure& proven) const {
  OnFacet on{bistatic, proven, model_.material[facet],
             ShiftedSamples(borders_, step_m_, proven.shift_m * (1 + slack)), nullptr};
  on.integrator = std::make_unique<CertifiedPathIntegrator>(on.samples.borders());
  return on;
}

void BistaticPieces::add(OnFacet& on, std::span<const glm::dvec3> corners_m, glm::dvec3 receiver_m,
                         std::uint32_t receive_tube, std::pair<std::uint32_t, std::uint32_t> beams,
                         BinIntervals& bins) const {
  const std::uint32_t first = beams.first, end = beams.second;
  if (first == end) return;
  const BistaticFacet& bistatic = on.bistatic;
  const CertifiedPolygon polygon = flattened(corners_m, receiver_m, bistatic);
  if (polygon.edges.size() < 3) return;

  const CertifiedPathEnergy energy = energy_of(bistatic, on.proven, model_, on.material, beta_);
  const ApexOverPlane tx = energy.tx().over(), rx = energy.rx().over();
  const CertifiedTexture* texture = textures_[on.material].get();
  BinInterval range{1, 1};
  if (texture != nullptr) range = {std::max(texture->range().lo(), 0.0), texture->range().hi()};
  const FacetMap lies = map_of(bistatic.lies);
  const bool cut = range.hi - range.lo > tolerance_ / 8 * range.lo;
  const std::size_t cells = cut ? cut_by_cells(polygon, *texture, lies, most_cells, {}) : 0;
  const BinInterval even = cells > 0 ? BinInterval{1, 1} : range;
  const std::size_t row = borders_.size() - 1;
  // Within the shift of a border between samples, the whole energy is uncertain in any case.
  const auto allowance = [&](double relative, double parts) {
    return CertifiedPathIntegrator::Allowance{
        relative, [this, row, first, parts](std::size_t beam, std::size_t sample) {
          const std::size_t bin = (first + beam) * row + std::min(sample / 2, row - 1);
          return std::max(target_[bin] / (sample % 2 == 1 ? parts : parts / 8), 1e-300);
        }};
  };
  const Interval& factor = on.proven.factor;

  // Energies of the untextured seabed without patterns, by sample. They scale the errors due to patterns and
  // texture.
  std::map<std::size_t, double> plain;
  double all_plain = 0;
  const bool weighed = model_.patterns != nullptr;
  double texture_change = 0;
  if (cells > 0) texture_change = change_of(*texture, on.proven.place_off_m);
  if (weighed || texture_change > 0) {
    CertifiedPathIntegrand integrand(energy, {}, nullptr);
    on.integrator->add(polygon, tx, {&rx, 1}, integrand, allowance(0.05, 20),
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
    const TransmitPattern& transmit = model_.patterns->transmit[model_.patterns->fan_of_tube[receive_tube]];
    const std::span receive = std::span(model_.patterns->receive).subspan(first, end - first);
    gains = {energy.tx(), energy.rx(), transmit, receive};
    const PatternAmbiguity tx_ambiguity(transmit, Towards::places(corners_m), on.proven);
    const Towards back = seen_rx(polygon, bistatic);
    for (std::size_t b = 0; b < receive.size(); ++b) {
      ambiguities[b] = tx_ambiguity;
      ambiguities[b].take_rx(receive[b], back, on.proven);
    }
  }
  std::map<std::size_t, std::vector<BinInterval>> found;  // by sample, summed over all cells
  const auto add_part = [&](const CertifiedPolygon& part, const CertifiedCell* cell) {
    CertifiedPathIntegrand integrand(energy, gains, cell);
    const double parts = 200 * double(std::max<std::size_t>(cells, 1)) * even.hi;
    on.integrator->add(part, tx, {&rx, 1}, integrand, allowance(tolerance_ / 8, parts),
                       [&](std::size_t sample, std::span<const Interval> values) {
                         std::vector<BinInterval>& sums = found[sample];
                         sums.resize(values.size());
                         for (std::size_t b = 0; b < values.size(); ++b) {
                           sums[b].lo += std::max(values[b].lo, 0.0) * even.lo;
                           sums[b].hi += std::max(values[b].hi, 0.0) * even.hi;
                         }
                       });
  };
  if (cells == 0)
    add_part(polygon, nullptr);
  else
    cut_by_cells(polygon, *texture, lies, most_cells,
                 [&](const CertifiedPolygon& part, const CertifiedCell& cell) { add_part(part, &cell); });
  for (auto& [sample, sums] : found) {
    const double most_plain = (weighed || texture_change > 0) ? plain_of(sample) : 0;
    for (std::size_t b = 0; b < sums.size(); ++b) {
      double off = 0;
      // Cutting a sliver may lose its part of a cell. The energy with the largest texture value bounds that
      // of the part.
      const double most = most_plain * range.hi * ambiguities[b].most_tx * ambiguities[b].most_rx;
      if (weighed && !(sums[b].hi <= std::numeric_limits<double>::max())) sums[b].hi = most;
      if (weighed) off += ambiguities[b].of(sums[b].hi, most_plain * range.hi);
      if (texture_change > 0)
        off += texture_change * most_plain * (weighed ? ambiguities[b].most_tx * ambiguities[b].most_rx : 1);
      on.samples.add(std::uint32_t(first + b), std::uint32_t(sample),
                     std::max(sums[b].lo - off, 0.0) * factor.lo * (1 - slack),
                     (sums[b].hi + off) * factor.hi * (1 + slack), bins);
    }
  }
}

double BistaticPieces::most_of(std::uint32_t transmit, std::uint32_t beam, const Towards& tx,
                               const Towards& rx) const {
  const double passes =
      tubefoot::most_of(model_.path.tx.loss, tx) * tubefoot::most_of(model_.path.back().loss, rx);
  if (model_.patterns == nullptr) return passes;
  return passes * tubefoot::most_of(model_.patterns->transmit[transmit], tx) *
         tubefoot::most_of(model_.patterns->receive[beam], rx);
}

}  // namespace tubefoot
