// SPDX-License-Identifier: GPL-3.0-or-later
// Computes reference energies of bistatic echoes in isovelocity water, for the common visibility of two
// apexes. Cells lie between ellipses of equal path length, and integrals use CertifiedPathIntegrator. See
// docs/notes/certified-energies.md, section "Two apexes".
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "engine/certified/certified_path_energy.hpp"
#include "engine/certified/reference_parts.hpp"
#include "geometry/steps/steps.hpp"

namespace tubefoot {
namespace {

/// Facets of a run are usually neighbours, with the same samples.
constexpr std::size_t facets_in_run = 32;

/// One try, like that for one apex (reference.cpp).
class PathEncloser {
 public:
  PathEncloser(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
               const RangeSamples& samples, const EchoModel& model,
               std::span<const std::shared_ptr<const CertifiedTexture>> textures, const Echo& ordinary,
               double working)
      : mesh_(mesh),
        history_(history),
        beams_(beams),
        model_(model),
        textures_(textures),
        borders_(sample_borders_m(samples)),
        working_(working),
        target_(reference_targets(ordinary, working)),
        beta_(Ball(model.absorption_db_per_m) * log(Ball(10)) / Ball(10)) {
    for (std::size_t k = 0; k < 3; ++k) rx_m_[k] = Ball(history.shared.receiver_m[int(k)]);
    count_parts();
  }

  std::vector<Ball> enclose(bool& coarse) {
    const std::vector<SharedFacet>& facets = history_.shared.facets;
    const std::size_t samples = borders_.size() - 1,
                      runs = (facets.size() + facets_in_run - 1) / facets_in_run;
    std::vector<BinSums> by_run(runs, BinSums(target_.size() / samples, samples));
    Steps steps("facets", facets.size());
    tbb::parallel_for(std::size_t{0}, runs, [&](std::size_t run) {
      const std::size_t first = run * facets_in_run;
      for (std::size_t k = first; k < std::min(first + facets_in_run, facets.size()); ++k) {
        steps.done();
        add(facets[k], by_run[run]);
      }
    });
    coarse = coarse_;
    std::vector<Interval> total(target_.size());
    for (const BinSums& sums : by_run) sums.add_to(total);  // in order, whatever the number of threads
    std::vector<Ball> balls;
    for (const Interval& sum : total) balls.push_back(Ball::between(sum.lo, sum.hi));
    return balls;
  }

 private:
  std::pair<std::uint32_t, std::uint32_t> beams_of(const SharedPiece& piece) const {
    if (!beams_.fan_of_transmit_tube.empty() &&
        beams_.fan_of_transmit_tube[piece.transmit_tube] != beams_.fan_of_receive_tube[piece.receive_tube])
      return {0, 0};
    if (model_.patterns != nullptr) return model_.patterns->beams_of_tube[piece.receive_tube];
    const std::uint32_t beam = beams_.of_tube[piece.receive_tube];
    return {beam, beam + 1};
  }
  std::span<const glm::dvec3> corners_of(const SharedPiece& piece) const {
    return std::span(history_.shared.corners_m).subspan(piece.first, piece.count);
  }

  /// Counts the approximate number of pieces that share a bin.
  void count_parts() {
    parts_.assign(target_.size(), 0);
    for (const SharedPiece& piece : history_.shared.pieces) {
      double least = std::numeric_limits<double>::infinity(), most = 0;
      for (const glm::dvec3& corner : corners_of(piece)) {
        const double half = (glm::length(corner) + glm::length(corner - history_.shared.receiver_m)) / 2;
        least = std::min(least, half);
        most = std::max(most, half);
      }
      const auto [first, end] = beams_of(piece);
      for (std::size_t k = 0; k + 1 < borders_.size(); ++k)
        if (borders_[k] < most && borders_[k + 1] > least)
          for (std::uint32_t beam = first; beam < end; ++beam) ++parts_[beam * (borders_.size() - 1) + k];
    }
  }

  void add(const SharedFacet& facet, BinSums& bins) {
    FacetCone cone;
    FacetCone::make(mesh_, facet.facet, history_.transmit.apex, cone);
    CertifiedPathIntegrator integrator(borders_);
    for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
      const SharedPiece& piece = history_.shared.pieces[facet.first_piece + k];
      const auto [first, end] = beams_of(piece);
      if (first == end) continue;
      const CertifiedPolygon polygon =
          certified_polygon(cone, corners_of(piece), history_.shared.receiver_m, history_.grid_unit_m);
      add(polygon, facet.facet, piece, first, end, integrator, bins);
    }
  }

  void add(const CertifiedPolygon& polygon, FacetId facet, const SharedPiece& piece, std::uint32_t first,
           std::uint32_t end, CertifiedPathIntegrator& integrator, BinSums& bins) {
    const CertifiedPathEnergy energy(polygon, rx_m_, model_, model_.seabed(facet), beta_);
    CertifiedPathGains gains;
    if (model_.patterns != nullptr)
      gains = {energy.tx(), energy.rx(),
               model_.patterns->transmit[model_.patterns->fan_of_tube[piece.receive_tube]],
               std::span(model_.patterns->receive).subspan(first, end - first)};
    const CertifiedTexture* texture = textures_[model_.material[facet]].get();
    const Ball range = texture == nullptr ? Ball(1) : texture->range();
    const bool worth_it = polygon.edges.size() >= 3 && range.hi() - range.lo() > working_ / 8 * range.lo();
    const std::size_t row = borders_.size() - 1,
                      cells = worth_it ? cut_by_cells(polygon, *texture, model_.path.tx.map_of(facet),
                                                      most_cells, {})
                                       : 0;
    if (worth_it && cells == 0) coarse_ = true;
    const Interval even = cells > 0 ? Interval(1) : interval_of(range);
    const auto add_part = [&](const CertifiedPolygon& part, const CertifiedCell* cell) {
      CertifiedPathIntegrand integrand(energy, gains, cell);
      // The relative and the shared error each receive a third of the tolerance. The rest is for gaps and
      // rounding.
      const CertifiedPathIntegrator::Allowance allowance{
          working_ / 3, [&](std::size_t beam, std::size_t sample) {
            const std::size_t bin = (first + beam) * row + sample;
            const double sharers = std::max(parts_[bin], 1.0) * double(std::max<std::size_t>(cells, 1));
            return std::max(target_[bin] / 3 / sharers / even.hi, least_allowed);
          }};
      const ApexOverPlane rx = energy.rx().over();
      integrator.add(part, energy.tx().over(), {&rx, 1}, integrand, allowance,
                     [&](std::size_t sample, std::span<const Interval> values) {
                       for (std::size_t beam = 0; beam < values.size(); ++beam)
                         bins.at(first + beam, sample) += even * values[beam];
                     });
    };
    if (cells == 0) return add_part(polygon, nullptr);
    cut_by_cells(polygon, *texture, model_.path.tx.map_of(facet), most_cells,
                 [&](const CertifiedPolygon& part, const CertifiedCell& cell) { add_part(part, &cell); });
  }

  const FacetMesh& mesh_;
  const BistaticHistory& history_;
  const ReceiveBeams& beams_;
  const EchoModel& model_;
  std::span<const std::shared_ptr<const CertifiedTexture>> textures_;
  std::vector<double> borders_;
  double working_;
  std::vector<double> target_, parts_;
  Ball beta_;
  std::array<Ball, 3> rx_m_;
  std::atomic<bool> coarse_ = false;
};

}  // namespace

CertifiedEcho certify_echo(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model, const Echo& ordinary,
                           double tolerance) {
  if (!history.bistatic.empty())
    throw std::invalid_argument(
        "there is no certified bound for facets whose apparent positions differ between two apexes");
  const auto textures = certified_textures(model);
  EchoModel own = model;
  BeamPatterns patterns;
  if (model.patterns != nullptr) {
    patterns = as_images_have(*model.patterns, model.path);
    own.patterns = &patterns;
  }
  return refined_until_tolerance(tolerance, [&](double working, bool& coarse) {
    PathEncloser encloser(mesh, history, beams, samples, own, textures, ordinary, working);
    const std::vector<Ball> total = encloser.enclose(coarse);
    return enclosed_echo(ordinary, total, tolerance);
  });
}

}  // namespace tubefoot
