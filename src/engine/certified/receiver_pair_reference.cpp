// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/receiver_pair_reference.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "engine/certified/receiver_pair_integrand.hpp"
#include "engine/certified/reference_parts.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

// Computes reference energies and products of a receiver pair in isovelocity water. Pieces that both
// receivers see are intersected in ball arithmetic, and uncertain areas along edges are added as intervals.
// See docs/notes/certified-energies.md, section "Two receivers".
namespace tubefoot {
namespace {

class ReceiverPairEncloser {
 public:
  ReceiverPairEncloser(const FacetMesh& mesh, const ReceiverPairHistory& history, double unit_m,
                       const ReceiverBaseline& receiver_pair, const RangeSamples& samples,
                       std::array<const EchoModel*, 2> models,
                       std::span<const std::shared_ptr<const CertifiedTexture>> textures,
                       std::span<const double> target, double working)
      : mesh_(mesh),
        history_(history),
        unit_m_(unit_m),
        receiver_pair_(receiver_pair),
        models_(models),
        textures_(textures),
        borders_(sample_borders_m(samples)),
        target_(target),
        working_(working),
        beta_(Ball(models[0]->absorption_db_per_m) * log(Ball(10)) / Ball(10)) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Ball half = Ball(receiver_pair.baseline_m) / Ball(2) * Ball(receiver_pair.axis[int(k)]),
                 middle(history.middle_m[int(k)]);
      at_m_[0][k] = middle + half;
      at_m_[1][k] = middle - half;
    }
  }

  /// Without `energies`, the energies are 0.
  std::vector<Ball> enclose(bool energies, bool& coarse) {
    struct Job {
      const SharedFacet *upper, *lower;
    };
    std::vector<Job> jobs;  // by facet
    const auto &up = history_.by_upper.facets, &down = history_.by_lower.facets;
    for (auto u = up.begin(), d = down.begin(); u != up.end() || d != down.end();) {
      const bool has_upper = u != up.end() && (d == down.end() || u->facet <= d->facet),
                 has_lower = d != down.end() && (u == up.end() || d->facet <= u->facet);
      jobs.push_back({has_upper ? &*u++ : nullptr, has_lower ? &*d++ : nullptr});
    }
    std::vector<Bins> by_job(jobs.size());
    tbb::parallel_for(std::size_t{0}, jobs.size(),
                      [&](std::size_t k) { add(jobs[k].upper, jobs[k].lower, energies, by_job[k]); });
    coarse = coarse_;
    std::vector<Ball> total(target_.size());
    for (const Bins& bins : by_job)  // in order, so that the result does not depend on the threads
      for (const auto& [bin, part] : bins) total[bin] += part;
    return total;
  }

 private:
  std::size_t samples() const { return borders_.size() - 1; }
  static std::span<const glm::dvec3> corners_of(const SharedFootprints& shared, const SharedPiece& piece) {
    return std::span(shared.corners_m).subspan(piece.first, piece.count);
  }

  void add(const SharedFacet* upper, const SharedFacet* lower, bool energies, Bins& bins) {
    const FacetId facet = (upper != nullptr ? upper : lower)->facet;
    FacetCone cone;
    FacetCone::make(mesh_, facet, history_.transmit.apex, cone);
    const auto polygon = [&](const SharedFootprints& shared, const SharedPiece& piece) {
      return certified_polygon(cone, corners_of(shared, piece), shared.receiver_m, unit_m_);
    };
    CertifiedPathIntegrator integrator(borders_);
    for (const std::size_t end : {0, 1}) {
      const SharedFacet* seen = end == 0 ? upper : lower;
      const SharedFootprints& shared = end == 0 ? history_.by_upper : history_.by_lower;
      for (std::uint32_t k = 0; energies && seen != nullptr && k < seen->piece_count; ++k)
        add_energy(end, facet, polygon(shared, shared.pieces[seen->first_piece + k]), integrator, bins);
    }
    if (upper == nullptr || lower == nullptr) return;
    for (std::uint32_t k = 0; k < upper->piece_count; ++k) {
      const SharedPiece& one = history_.by_upper.pieces[upper->first_piece + k];
      for (std::uint32_t m = 0; m < lower->piece_count; ++m) {
        const SharedPiece& two = history_.by_lower.pieces[lower->first_piece + m];
        if (two.transmit_tube != one.transmit_tube) continue;
        stop_if_wanted();
        const CertifiedPolygon seen = polygon(history_.by_upper, one);
        const auto [part, ambiguous] = common_part(seen, polygon(history_.by_lower, two));
        if (!faces(0, seen) || !faces(1, seen)) continue;
        add_product(facet, part, integrator, bins);
        add_ambiguous(facet, seen, ambiguous, integrator, bins);
      }
    }
  }

  ReceiverPairPath ends(std::size_t end, FacetId facet, const CertifiedPolygon& polygon) const {
    const EchoModel& model = *models_[end];
    CertifiedPathEnergy energy(polygon, at_m_[end], model, model.seabed(facet), beta_);
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

  /// Calls `add(part, cell, even, cells)` for the parts of a polygon by cells of its texture.
  template <class Add>
  void by_cells(FacetId facet, const CertifiedPolygon& polygon, const Add& add) {
    const CertifiedTexture* texture = textures_[models_[0]->material[facet]].get();
    const Ball range = texture == nullptr ? Ball(1) : texture->range();
    const bool worth_it = polygon.edges.size() >= 3 && range.hi() - range.lo() > working_ / 8 * range.lo();
    const std::size_t cells =
        worth_it ? cut_by_cells(polygon, *texture, models_[0]->path.tx.map_of(facet), most_cells, {}) : 0;
    if (worth_it && cells == 0) coarse_ = true;
    if (cells == 0) return add(polygon, nullptr, range, 1.0);
    cut_by_cells(polygon, *texture, models_[0]->path.tx.map_of(facet), most_cells,
                 [&](const CertifiedPolygon& part, const CertifiedCell& cell) {
                   add(part, &cell, Ball(1), double(cells));
                 });
  }
  /// Permitted error of a part. The number of parts is a guess, and repeated tries correct it.
  double allowed(std::size_t channel, std::size_t sample, double cells) const {
    return std::max(target_[channel * samples() + sample] / (30 * cells), least_allowed);
  }

  void add_energy(std::size_t end, FacetId facet, const CertifiedPolygon& polygon,
                  CertifiedPathIntegrator& integrator, Bins& bins) {
    if (!faces(end, polygon)) return;
    by_cells(facet, polygon,
             [&](const CertifiedPolygon& part, const CertifiedCell* cell, const Ball& even, double cells) {
               ReceiverPairPath own = ends(end, facet, part);
               const ApexOverPlane tx = own.energy.tx().over(), rx = own.energy.rx().over();
               CertifiedPathIntegrand integrand(std::move(own.energy), std::move(own.gains), cell);
               integrator.add(
                   part, tx, {&rx, 1}, integrand,
                   {working_ / 3, [&](std::size_t, std::size_t k) { return allowed(end, k, cells); }},
                   [&](std::size_t k, std::span<const Ball> values) {
                     bins[end * samples() + k] += even * values[0];
                   });
             });
  }

  void add_product(FacetId facet, const CertifiedPolygon& polygon, CertifiedPathIntegrator& integrator,
                   Bins& bins) {
    if (polygon.points.empty()) return;
    by_cells(facet, polygon,
             [&](const CertifiedPolygon& part, const CertifiedCell* cell, const Ball& even, double cells) {
               const ReceiverPairPath upper = ends(0, facet, part), lower = ends(1, facet, part);
               ReceiverPairIntegrand integrand(
                   {upper.energy, upper.gains}, {lower.energy, lower.gains},
                   ReceiverPairPhase(upper.energy.tx(), receiver_pair_, history_.middle_m), cell);
               const ApexOverPlane homes[2] = {upper.energy.rx().over(), lower.energy.rx().over()};
               integrator.add(part, upper.energy.tx().over(),
                              std::span(homes).first(receiver_pair_.baseline_m > 0 ? 2 : 1), integrand,
                              {working_ / 3,
                               [&](std::size_t v, std::size_t k) {
                                 return allowed(1 + std::max<std::size_t>(v, 1), k, cells);
                               }},
                              taker(even, bins));
             });
  }

  /// Adds the uncertain part of the intersection, relative to the piece that the upper receiver sees.
  void add_ambiguous(FacetId facet, const CertifiedPolygon& polygon, const Ball& ambiguous,
                     CertifiedPathIntegrator& integrator, Bins& bins) {
    const CertifiedTexture* texture = textures_[models_[0]->material[facet]].get();
    const ReceiverPairPath upper = ends(0, facet, polygon), lower = ends(1, facet, polygon);
    ReceiverPairIntegrand integrand({upper.energy, upper.gains}, {lower.energy, lower.gains},
                                    ReceiverPairPhase(upper.energy.tx(), receiver_pair_, history_.middle_m),
                                    nullptr);
    const ApexOverPlane rx = upper.energy.rx().over();
    integrator.add(polygon, upper.energy.tx().over(), {&rx, 1}, integrand,
                   {0, [](std::size_t, std::size_t) { return least_allowed; }},
                   taker(texture == nullptr ? Ball(1) : texture->range(), bins), ambiguous);
  }

  CertifiedPathIntegrator::Taker taker(const Ball& even, Bins& bins) const {
    return [this, even, &bins](std::size_t k, std::span<const Ball> values) {
      bins[2 * samples() + k] += even * values[1];
      bins[3 * samples() + k] += even * values[2];
    };
  }

  const FacetMesh& mesh_;
  const ReceiverPairHistory& history_;
  double unit_m_;
  const ReceiverBaseline& receiver_pair_;
  std::array<const EchoModel*, 2> models_;  // by receiver
  std::span<const std::shared_ptr<const CertifiedTexture>> textures_;
  std::vector<double> borders_;
  std::span<const double> target_;
  double working_;
  Ball beta_;
  std::array<std::array<Ball, 3>, 2> at_m_;
  std::atomic<bool> coarse_ = false;
};

CertifiedEcho enclosed(const FacetMesh& mesh, const ReceiverPairHistory& history, double grid_unit_m,
                       const ReceiverBaseline& receiver_pair, const RangeSamples& samples,
                       std::array<const EchoModel*, 2> models, const ReceiverPairEcho& ordinary,
                       double tolerance, bool energies) {
  if (!history.bistatic_upper.empty() || !history.bistatic_lower.empty())
    throw std::invalid_argument(
        "there is no certified bound for facets whose apparent positions differ between two apexes");
  const auto textures = certified_textures(*models[0]);
  return refined_until_tolerance(tolerance, [&](double working, bool& coarse) {
    const std::vector<double> target = receiver_pair_targets(ordinary.upper_j, ordinary.lower_j, working);
    ReceiverPairEncloser encloser(mesh, history, grid_unit_m, receiver_pair, samples, models, textures,
                                  target, working);
    const std::vector<Ball> total = encloser.enclose(energies, coarse);
    CertifiedEcho certified{rows_of(ordinary), std::vector<double>(total.size())};
    const std::size_t sizes = total.size() / 2;
    for (std::size_t bin = energies ? 0 : sizes; bin < total.size(); ++bin) {
      if (!total[bin].is_finite()) {
        certified.echo.energy[bin] = 0;
        certified.bound[bin] = infinite;
        continue;
      }
      const double middle = bin < sizes ? std::max(total[bin].middle(), 0.0) : total[bin].middle();
      const Ball off = total[bin] - Ball(middle);
      certified.echo.energy[bin] = middle;
      certified.bound[bin] = std::max({off.hi(), -off.lo(), 0.0});
    }
    compare_receiver_pair_with(certified, tolerance);
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

Echo rows_of(const ReceiverPairEcho& echo) {
  Echo rows{4, int(echo.upper_j.size()), {}};
  for (const auto* row : {&echo.upper_j, &echo.lower_j, &echo.cross_real_j, &echo.cross_imag_j})
    rows.energy.insert(rows.energy.end(), row->begin(), row->end());
  return rows;
}

void compare_receiver_pair_with(CertifiedEcho& certified, double tolerance) {
  const auto row = std::size_t(certified.echo.samples);
  std::vector<double> sure(2 * row);
  for (std::size_t bin = 0; bin < sure.size(); ++bin) {
    const double least = certified.echo.energy[bin] - certified.bound[bin];
    sure[bin] = least > 0 ? least : 0;
  }
  const std::vector<double> requested =
      receiver_pair_targets(std::span(sure).first(row), std::span(sure).last(row), tolerance * (1 + 1e-6));
  certified.bins_over = 0;
  certified.worst_ratio = 0;
  for (std::size_t bin = 0; bin < requested.size(); ++bin) {
    const double ratio = certified.bound[bin] / requested[bin];
    certified.bins_over += !(ratio <= 1);
    if (!(ratio > certified.worst_ratio && std::isfinite(ratio))) continue;
    certified.worst_ratio = ratio;
    certified.worst_beam = int(bin / row);
    certified.worst_sample = int(bin % row);
  }
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
