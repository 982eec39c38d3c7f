// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/receiver_pair_reference.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/certified/certified_driver.hpp"
#include "engine/certified/receiver_pair_integrand.hpp"

// Computes reference energies and products of a receiver pair in isovelocity water. Pieces that both
// receivers see are intersected in ball arithmetic, and uncertain areas along edges are added as intervals.
// See docs/notes/certified-energies.md, section "Two receivers".
namespace tubefoot {
namespace {

class ReceiverPairEncloser {
 public:
  ReceiverPairEncloser(const FacetMesh& mesh, const ReceiverPairHistory& history, double unit_m,
                       const ReceiverBaseline& receiver_pair, std::array<const EchoModel*, 2> models,
                       const CertifiedRequest& request)
      : mesh_(mesh),
        history_(history),
        unit_m_(unit_m),
        receiver_pair_(receiver_pair),
        models_(models),
        request_(request) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Ball half = Ball(receiver_pair.baseline_m) / Ball(2) * Ball(receiver_pair.axis[int(k)]),
                 middle(history.middle_m[int(k)]);
      at_m_[0][k] = middle + half;
      at_m_[1][k] = middle - half;
    }
  }

  /// Without `energies`, the energies are 0.
  std::vector<Ball> enclose(bool energies) const {
    const auto facets = facets_of_receivers(history_.by_upper, history_.by_lower);
    const auto by_facet = enclose_tasks(
        "facets", facets.size(), 1, Bins<Ball>(),
        [&](std::size_t k, Bins<Ball>& bins) { add(facets[k].upper, facets[k].lower, energies, bins); });
    std::vector<Ball> total(request_.target.size());
    for (const Bins<Ball>& bins : by_facet)
      for (const auto& [bin, part] : bins) total[bin] += part;
    return total;
  }

 private:
  void add(const SharedFacet* upper, const SharedFacet* lower, bool energies, Bins<Ball>& bins) const {
    const FacetId facet = (upper != nullptr ? upper : lower)->facet;
    FacetCone cone;
    FacetCone::make(mesh_, facet, history_.transmit.apex, cone);
    const auto polygon = [&](const ReceivedPiece& piece) {
      return certified_polygon(cone, piece.corners_m, piece.rests_m, piece.receiver_m, unit_m_);
    };
    CertifiedPathIntegrator integrator(request_.borders);
    for (const std::size_t end : {0, 1}) {
      const SharedFacet* seen = end == 0 ? upper : lower;
      const SharedFootprints& shared = end == 0 ? history_.by_upper : history_.by_lower;
      for (std::uint32_t k = 0; energies && seen != nullptr && k < seen->piece_count; ++k)
        add_energy(end, facet, polygon({shared, shared.pieces[seen->first_piece + k]}), integrator, bins);
    }
    if (upper == nullptr || lower == nullptr) return;
    each_common(history_.by_upper, *upper, history_.by_lower, *lower,
                [&](const ReceivedPiece& one, const ReceivedPiece& two) {
                  const CertifiedPolygon seen = polygon(one);
                  const auto [part, ambiguous] = common_part(seen, polygon(two));
                  if (!faces(0, seen) || !faces(1, seen)) return;
                  add_product(facet, part, integrator, bins);
                  add_ambiguous(facet, seen, ambiguous, integrator, bins);
                });
  }

  ReceiverPairPath ends(std::size_t end, FacetId facet, const CertifiedPolygon& polygon) const {
    const EchoModel& model = *models_[end];
    CertifiedPathEnergy energy(polygon, at_m_[end], model, model.seabed(facet), request_.beta_per_m);
    CertifiedPathGains gains(energy.tx(), energy.rx(), model.patterns->transmit.front(),
                             std::span(model.patterns->receive).first(1));
    return {std::move(energy), std::move(gains)};
  }
  /// Returns false if a receiver sees the plane from behind. This happens only by rounding of half a grid
  /// unit. Throws if the receiver lies in the plane.
  bool faces(std::size_t end, const CertifiedPolygon& polygon) const {
    const Ball height = apex_over(polygon, at_m_[end]).height;
    if (height.may_be_zero())
      throw std::invalid_argument(
          "a receiver lies in the plane of a facet, to within 1e-30 m, so there is no certified bound");
    return height.surely_positive();
  }

  TexturedPolygon textured(FacetId facet, const CertifiedPolygon& polygon) const {
    return request_.textured(polygon, models_[0]->material[facet], models_[0]->path.tx.map_of(facet));
  }
  /// Permitted error of a part. The number of parts is a guess, and repeated tries correct it.
  double allowed(std::size_t channel, std::size_t sample, double parts) const {
    return std::max(request_.target[channel * request_.row() + sample] / (30 * parts), least_allowed);
  }

  void add_energy(std::size_t end, FacetId facet, const CertifiedPolygon& polygon,
                  CertifiedPathIntegrator& integrator, Bins<Ball>& bins) const {
    if (!faces(end, polygon)) return;
    const TexturedPolygon textured = this->textured(facet, polygon);
    textured.each_part([&](const CertifiedPolygon& part, const CertifiedCell* cell) {
      ReceiverPairPath own = ends(end, facet, part);
      const ApexOverPlane tx = own.energy.tx().over(), rx = own.energy.rx().over();
      CertifiedPathIntegrand integrand(std::move(own.energy), std::move(own.gains), cell);
      integrator.add(part, tx, {&rx, 1}, integrand,
                     {request_.tolerance / 3,
                      [&](std::size_t, std::size_t k) { return allowed(end, k, textured.parts()); }},
                     [&](std::size_t k, std::span<const Ball> values) {
                       bins[end * request_.row() + k] += textured.factor() * values[0];
                     });
    });
  }

  ReceiverPairIntegrand product(const ReceiverPairPath& upper, const ReceiverPairPath& lower,
                                const CertifiedCell* cell) const {
    return {upper, lower, ReceiverPairPhase(upper.energy.tx(), receiver_pair_, history_.middle_m), cell};
  }

  void add_product(FacetId facet, const CertifiedPolygon& polygon, CertifiedPathIntegrator& integrator,
                   Bins<Ball>& bins) const {
    if (polygon.points.empty()) return;
    const TexturedPolygon textured = this->textured(facet, polygon);
    textured.each_part([&](const CertifiedPolygon& part, const CertifiedCell* cell) {
      const ReceiverPairPath upper = ends(0, facet, part), lower = ends(1, facet, part);
      ReceiverPairIntegrand integrand = product(upper, lower, cell);
      const ApexOverPlane homes[2] = {upper.energy.rx().over(), lower.energy.rx().over()};
      integrator.add(part, upper.energy.tx().over(),
                     std::span(homes).first(receiver_pair_.baseline_m > 0 ? 2 : 1), integrand,
                     {request_.tolerance / 3,
                      [&](std::size_t v, std::size_t k) {
                        return allowed(1 + std::max<std::size_t>(v, 1), k, textured.parts());
                      }},
                     taker(textured.factor(), bins));
    });
  }

  /// Adds the uncertain part of the intersection, relative to the piece that the upper receiver sees.
  void add_ambiguous(FacetId facet, const CertifiedPolygon& polygon, const Ball& ambiguous,
                     CertifiedPathIntegrator& integrator, Bins<Ball>& bins) const {
    const CertifiedTexture* texture = request_.textures[models_[0]->material[facet]].get();
    const ReceiverPairPath upper = ends(0, facet, polygon), lower = ends(1, facet, polygon);
    ReceiverPairIntegrand integrand = product(upper, lower, nullptr);
    const ApexOverPlane rx = upper.energy.rx().over();
    integrator.add(polygon, upper.energy.tx().over(), {&rx, 1}, integrand,
                   {0, [](std::size_t, std::size_t) { return least_allowed; }},
                   taker(texture == nullptr ? Ball(1) : texture->range(), bins), ambiguous);
  }

  CertifiedPathIntegrator::Taker taker(const Ball& factor, Bins<Ball>& bins) const {
    return [this, factor, &bins](std::size_t k, std::span<const Ball> values) {
      bins[2 * request_.row() + k] += factor * values[1];
      bins[3 * request_.row() + k] += factor * values[2];
    };
  }

  const FacetMesh& mesh_;
  const ReceiverPairHistory& history_;
  double unit_m_;
  const ReceiverBaseline& receiver_pair_;
  std::array<const EchoModel*, 2> models_;  // by receiver
  const CertifiedRequest& request_;
  std::array<std::array<Ball, 3>, 2> at_m_;
};

CertifiedEcho enclosed(const FacetMesh& mesh, const ReceiverPairHistory& history, double grid_unit_m,
                       const ReceiverBaseline& receiver_pair, const RangeSamples& samples,
                       std::array<const EchoModel*, 2> models, const ReceiverPairEcho& ordinary,
                       double tolerance, bool energies) {
  require_one_position(history.bistatic_upper);
  require_one_position(history.bistatic_lower);
  CertifiedRequest request(*models[0], samples);
  const ReceiverPairEncloser encloser(mesh, history, grid_unit_m, receiver_pair, models, request);
  const Echo rows = rows_of(ordinary);
  return refined_until_tolerance(request, rows, tolerance, receiver_pair_row_targets, [&] {
    const std::vector<Ball> total = encloser.enclose(energies);
    CertifiedEcho certified{rows, std::vector<double>(total.size())};
    const std::size_t sizes = total.size() / 2;
    for (std::size_t bin = energies ? 0 : sizes; bin < total.size(); ++bin) {
      certified.echo.energy[bin] = 0;
      take_enclosure(certified, bin, total[bin], bin < sizes);
    }
    return certified;
  });
}

}  // namespace

std::vector<double> receiver_pair_targets(std::span<const double> upper, std::span<const double> lower,
                                          double tolerance) {
  Echo rows{3, int(upper.size()), {}};
  for (const auto& row : {upper, lower}) rows.energy.insert(rows.energy.end(), row.begin(), row.end());
  for (std::size_t k = 0; k < upper.size(); ++k) rows.energy.push_back(std::sqrt(upper[k] * lower[k]));
  std::vector<double> target = reference_targets(rows, tolerance);
  const std::vector<double> cross(target.end() - std::ptrdiff_t(upper.size()), target.end());
  target.insert(target.end(), cross.begin(), cross.end());
  return target;
}

std::vector<double> receiver_pair_row_targets(const Echo& rows, double tolerance) {
  const std::span energies(rows.energy);
  const auto row = std::size_t(rows.samples);
  return receiver_pair_targets(energies.first(row), energies.subspan(row, row), tolerance);
}

Echo rows_of(const ReceiverPairEcho& echo) {
  Echo rows{4, int(echo.upper_j.size()), {}};
  for (const auto* row : {&echo.upper_j, &echo.lower_j, &echo.cross_real_j, &echo.cross_imag_j})
    rows.energy.insert(rows.energy.end(), row->begin(), row->end());
  return rows;
}

void compare_receiver_pair_with(CertifiedEcho& certified, double tolerance) {
  compare_with(certified, tolerance, receiver_pair_row_targets);
}

CertifiedEcho certify_receiver_pair_echo(const FacetMesh& mesh, const ReceiverPairHistory& history,
                                         double grid_unit_m, const ReceiverBaseline& receiver_pair,
                                         const RangeSamples& samples, const EchoModel& model,
                                         const ReceiverPairEcho& ordinary, double tolerance) {
  return enclosed(mesh, history, grid_unit_m, receiver_pair, samples, {&model, &model}, ordinary, tolerance,
                  true);
}

CertifiedEcho certify_receiver_pair_products(const FacetMesh& mesh, const ReceiverPairHistory& history,
                                             double grid_unit_m, const ReceiverBaseline& receiver_pair,
                                             const RangeSamples& samples, const EchoModel& by_upper,
                                             const EchoModel& by_lower, const ReceiverPairEcho& ordinary,
                                             double tolerance) {
  return enclosed(mesh, history, grid_unit_m, receiver_pair, samples, {&by_upper, &by_lower}, ordinary,
                  tolerance, false);
}

}  // namespace tubefoot
