// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/receiver_pair_echo.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <stdexcept>

#include "engine/echo/pair_on_facet.hpp"
#include "engine/echo/quadratures.hpp"
#include "engine/echo/texture_cells.hpp"
#include "engine/surface/facet_flattening.hpp"
#include "engine/water/apparent_map.hpp"
#include "geometry/integrals/convex_clip.hpp"
#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/stop.hpp"

// Integrates energies and mean products of a receiver pair over common visible polygons with PathCutter. The
// product has the phase exp(i k (r_a - r_b)) (receiver_pair_echo.hpp).

namespace tubefoot {
namespace {

/// Relative to the energy without interference.
constexpr double tolerance = 1e-8;
/// Facets per task. The number determines the order of summation.
constexpr std::size_t facets_per_pair_task = 64;

/// Whether the transmitter is at the middle of the receiver pair. If apparent positions differ between
/// chains of mirrors, the ends differ too.
bool in_the_middle(const ReceiverPairHistory& history) {
  return history.middle_m == glm::dvec3(0) && history.bistatic_upper.empty() &&
         history.bistatic_lower.empty();
}

/// Sums the echo of one fan. One object per task.
class ReceiverPairIntegral {
 public:
  ReceiverPairIntegral(const ReceiverPairHistory& history, const ReceiverBaseline& receiver_pair,
                       std::uint32_t fan, std::uint32_t beam, std::span<const double> borders,
                       std::array<const EchoModel*, 2> models)
      : history_(history),
        receiver_pair_(receiver_pair),
        patterns_{models[0]->patterns->transmit[fan].beams, &models[0]->patterns->receive[beam],
                  models[0]->patterns->least.empty() ? 0 : models[0]->patterns->least[beam]},
        models_(models),
        cutter_(borders) {
    const glm::dvec3 half = receiver_pair.baseline_m / 2 * receiver_pair.axis;
    at_m_ = {history.middle_m + half, history.middle_m - half};
    for (const EchoModel* model : models_)
      smooth_everywhere_.angle_rad = std::min(smooth_everywhere_.angle_rad, smooth_angle_rad(model->path));
    for (const Directivity& sent : patterns_.transmit) smooth_everywhere_.take(sent, *patterns_.receive);
    smooth_everywhere_.limited = patterns_.least > 0;
    phase_rad_ = resolution_of(
        [&](double y) { return receiver_pair.wavenumber_rad_m * receiver_pair.baseline_m * y; });
    const std::size_t samples = borders.size() - 1;
    for (auto& sum : energy_) sum.assign(samples, 0);
    cross_.assign(3 * samples, 0);
  }

  /// Adds the energies of one receiver.
  void add_energy(std::size_t end, const SharedFacet& facet) {
    place(end, facet);
    const std::optional<ChannelOnFacet> channel = channel_of(end, facet.facet);
    if (!channel) return;
    const PairIntegrand integrand{*channel};
    const SharedFootprints& shared = seen_by(end);
    for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
      assign(polygon_, shared, shared.pieces[facet.first_piece + k]);
      integrate(integrand, energy_[end]);
    }
  }

  /// Adds the products on the surface that both receivers see. `upper` and `lower` are the same facet.
  void add_product(const SharedFacet& upper, const SharedFacet& lower) {
    place(0, upper);
    const std::optional<ChannelOnFacet> a = channel_of(0, upper.facet), b = channel_of(1, upper.facet);
    if (!a || !b) return;
    const PairIntegrand integrand{*a, b, receiver_pair_.wavenumber_rad_m, range_difference()};
    const SharedFootprints &by_upper = history_.by_upper, &by_lower = history_.by_lower;
    PlanarPolygon other;
    for (std::uint32_t k = 0; k < upper.piece_count; ++k) {
      const SharedPiece& one = by_upper.pieces[upper.first_piece + k];
      for (std::uint32_t m = 0; m < lower.piece_count; ++m) {
        const SharedPiece& two = by_lower.pieces[lower.first_piece + m];
        if (two.transmit_tube != one.transmit_tube) continue;
        stop_if_wanted();
        assign(polygon_, by_upper, one);
        assign(other, by_lower, two);
        if (clip_convex(polygon_, other)) integrate(integrand, cross_);
      }
    }
  }

  const std::vector<double>& energy(std::size_t end) const { return energy_[end]; }
  const std::vector<double>& cross() const { return cross_; }

 private:
  const SharedFootprints& seen_by(std::size_t end) const {
    return end == 0 ? history_.by_upper : history_.by_lower;
  }

  void assign(PlanarPolygon& polygon, const SharedFootprints& shared, const SharedPiece& piece) const {
    tubefoot::assign(polygon, std::span(shared.corners_m).subspan(piece.first, piece.count), plane_, frame_,
                     bistatic_);
  }

  /// Selects a facet that receiver `of` shares.
  void place(std::size_t of, const SharedFacet& facet) {
    const std::vector<BistaticFacet>& bistatic = of == 0 ? history_.bistatic_upper : history_.bistatic_lower;
    bistatic_ = bistatic.empty() ? nullptr : &bistatic[std::size_t(&facet - seen_by(of).facets.data())];
    plane_ = {facet.plane_normal, facet.transmit_distance_m};
    frame_ = PlaneFrame(plane_);
    smooth_ = smooth_everywhere_;
    smooth_.take(models_[of]->seabed(facet.facet));
  }

  /// Path over the facet to a receiver. None if the facet returns nothing, or if the receiver sees it edge-on
  /// or from behind. The latter happens only by the half units of the grid.
  std::optional<ChannelOnFacet> channel_of(std::size_t end, FacetId facet) const {
    ChannelOnFacet channel{{}, patterns_};
    if (bistatic_ != nullptr) {
      BistaticFacet moved = *bistatic_;
      if (!moved.move_receiver(at_m_[end] - history_.middle_m)) return {};
      channel.path = PathOnFacet(moved, facet, *models_[end]);
    } else {
      const PathCutter::Receiver rx = over_plane(plane_, frame_, at_m_[end]);
      if (!(rx.distance > 0)) return {};
      channel.path =
          PathOnFacet(plane_, frame_, {plane_.distance_m, glm::dvec2(0)}, rx, facet, *models_[end]);
    }
    if (is_silent(channel.path.seabed)) return {};
    return channel;
  }

  RangeDifference range_difference() const {
    const glm::dvec3 axis = receiver_pair_.axis;
    if (bistatic_ == nullptr)
      return RangeDifference::of(plane_, frame_, history_.middle_m, axis, receiver_pair_.baseline_m);
    const LyingPlane& seen = bistatic_->receive_seen;
    return {{glm::dot(seen.u, axis), glm::dot(seen.v, axis), glm::dot(seen.foot_m, axis)},
            receiver_pair_.baseline_m};
  }

  void integrate(const PairIntegrand& integrand, std::vector<double>& out) {
    const PathOnFacet& path = integrand.a.path;
    std::vector<PathCutter::Receiver> receivers{path.rx.over};
    PathCutter::Work work = smooth_.work(tolerance);
    work.values = integrand.values();
    if (integrand.b) {
      receivers.push_back(integrand.b->path.rx.over);
      work.resolution_rad = std::min(work.resolution_rad, phase_rad_);
      // If the transmitter is in the middle of the receivers, neither is much nearer than the other.
      work.from_second = !in_the_middle(history_);
    }
    cells_.cut(polygon_, path.lies, path.seabed.texture, [&](const PlanarPolygon& part) {
      cutter_.add(part, receivers, std::cref(integrand), work, out);
    });
  }

  const ReceiverPairHistory& history_;
  const ReceiverBaseline& receiver_pair_;
  ChannelPatterns patterns_;
  std::array<const EchoModel*, 2> models_;  // per receiver
  PathCutter cutter_;
  Smoothness smooth_everywhere_;  // of patterns and mirror losses
  double phase_rad_ = 1;
  std::array<glm::dvec3, 2> at_m_;  // receivers, relative to the transmitter
  // Values of the current facet.
  const BistaticFacet* bistatic_ = nullptr;
  FacetPlane plane_;
  PlaneFrame frame_{FacetPlane{}};
  Smoothness smooth_;
  PlanarPolygon polygon_;
  TextureCells cells_;
  std::array<std::vector<double>, 2> energy_;
  std::vector<double> cross_;  // 3 values per sample
};

}  // namespace

std::vector<FacetOfReceivers> facets_of_receivers(const SharedFootprints& by_upper,
                                                  const SharedFootprints& by_lower) {
  std::vector<FacetOfReceivers> all;
  const auto &up = by_upper.facets, &down = by_lower.facets;
  for (auto u = up.begin(), d = down.begin(); u != up.end() || d != down.end();) {
    const bool has_upper = u != up.end() && (d == down.end() || u->facet <= d->facet),
               has_lower = d != down.end() && (u == up.end() || d->facet <= u->facet);
    all.push_back({has_upper ? &*u++ : nullptr, has_lower ? &*d++ : nullptr});
  }
  return all;
}

TubeSet tubes_of_fan(const TubeSet& tubes, std::span<const std::uint32_t> fan_of_tube, std::uint32_t fan) {
  TubeSet part = tubes;
  part.tubes.clear();
  for (std::size_t t = 0; t < tubes.tubes.size(); ++t)
    if (fan_of_tube[t] == fan) part.tubes.push_back(tubes.tubes[t]);
  return part;
}

TubeSet moved_along(const TubeSet& tubes, const ReceiverBaseline& receiver_pair, double end,
                    double grid_unit_m) {
  TubeSet moved = tubes;
  const glm::dvec3 way = glm::round(end * receiver_pair.baseline_m / (2 * grid_unit_m) * receiver_pair.axis);
  moved.apex.x += std::int32_t(way.x);
  moved.apex.y += std::int32_t(way.y);
  moved.apex.z += std::int32_t(way.z);
  return moved;
}

ReceiverPairHistory trace_receiver_pair(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                                        const VisibilityOptions& options, TubeSet transmit,
                                        const TubeSet& receive, const ReceiverBaseline& receiver_pair,
                                        bool corner_rests) {
  ReceiverPairHistory history;
  history.upper = moved_along(receive, receiver_pair, 1, grid_unit_m);
  history.lower = moved_along(receive, receiver_pair, -1, grid_unit_m);
  history.middle_m = displacement_m(transmit.apex, receive.apex, grid_unit_m);
  history.transmit = std::move(transmit);
  const auto sent = look(mesh, tree, history.transmit, options);
  const auto share = [&](const TubeSet& tubes, SharedFootprints& shared) {
    const auto received = look(mesh, tree, tubes, options);
    shared = FootprintSharer(mesh, {history.transmit, sent}, {tubes, received}, grid_unit_m,
                             {.corner_rests = corner_rests})
                 .all();
  };
  share(history.upper, history.by_upper);
  share(history.lower, history.by_lower);
  return history;
}

ReceiverPairHistory trace_receiver_pair(const ApparentPair& pair, const WorldGrid& grid,
                                        const VisibilityOptions& options, TubeSet transmit,
                                        const TubeSet& receive, const ReceiverBaseline& receiver_pair,
                                        const ApparentMap& transmit_water, const ApparentMap& receive_water,
                                        double reference_absorption_db_per_m) {
  ReceiverPairHistory history;
  history.middle_m = displacement_m(transmit.apex, receive.apex, grid.unit_m());
  history.transmit = std::move(transmit);
  const auto end = [&](double which, TubeSet& tubes, SharedFootprints& shared,
                       std::vector<BistaticFacet>& bistatic) {
    tubes = moved_along(receive, receiver_pair, which, grid.unit_m());
    BistaticHistory both = trace_bistatic(pair, grid, options, history.transmit, tubes, transmit_water,
                                          receive_water, reference_absorption_db_per_m);
    shared = std::move(both.shared);
    bistatic = std::move(both.bistatic);
  };
  end(1, history.upper, history.by_upper, history.bistatic_upper);
  end(-1, history.lower, history.by_lower, history.bistatic_lower);
  return history;
}

namespace {

/// `models`: per receiver.
ReceiverPairEcho integrated(const ReceiverPairHistory& history, const ReceiverBaseline& receiver_pair,
                            std::uint32_t fan, std::uint32_t beam, const RangeSamples& samples,
                            std::array<const EchoModel*, 2> models, bool energies) {
  const std::vector<double> borders = sample_borders_m(samples);
  if (!(receiver_pair.baseline_m >= 0 &&
        (receiver_pair.baseline_m <= samples.first_m || !in_the_middle(history))))
    throw std::invalid_argument("the baseline of a receiver pair must be at most the nearest range");
  const std::vector<FacetOfReceivers> jobs = facets_of_receivers(history.by_upper, history.by_lower);
  std::vector<std::optional<ReceiverPairIntegral>> parts((jobs.size() + facets_per_pair_task - 1) /
                                                         facets_per_pair_task);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t task) {
    ReceiverPairIntegral& part = parts[task].emplace(history, receiver_pair, fan, beam, borders, models);
    const std::size_t end = std::min((task + 1) * facets_per_pair_task, jobs.size());
    for (std::size_t k = task * facets_per_pair_task; k < end; ++k) {
      stop_if_wanted();
      if (energies && jobs[k].upper != nullptr) part.add_energy(0, *jobs[k].upper);
      if (energies && jobs[k].lower != nullptr) part.add_energy(1, *jobs[k].lower);
      if (jobs[k].upper != nullptr && jobs[k].lower != nullptr)
        part.add_product(*jobs[k].upper, *jobs[k].lower);
    }
  });
  const auto count = std::size_t(samples.count);
  ReceiverPairEcho echo{std::vector<double>(count), std::vector<double>(count), std::vector<double>(count),
                        std::vector<double>(count)};
  for (const auto& part : parts)
    for (std::size_t k = 0; k < count; ++k) {
      echo.upper_j[k] += part->energy(0)[k];
      echo.lower_j[k] += part->energy(1)[k];
      echo.cross_real_j[k] += part->cross()[3 * k + 1];
      echo.cross_imag_j[k] += part->cross()[3 * k + 2];
    }
  return echo;
}

}  // namespace

ReceiverPairEcho integrate_receiver_pair_echo(const ReceiverPairHistory& history,
                                              const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                              std::uint32_t beam, const RangeSamples& samples,
                                              const EchoModel& model) {
  return integrate_receiver_pair_echo(history, receiver_pair, fan, beam, samples, model, model);
}

ReceiverPairEcho integrate_receiver_pair_echo(const ReceiverPairHistory& history,
                                              const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                              std::uint32_t beam, const RangeSamples& samples,
                                              const EchoModel& by_upper, const EchoModel& by_lower) {
  return integrated(history, receiver_pair, fan, beam, samples, {&by_upper, &by_lower}, true);
}

ReceiverPairEcho integrate_receiver_pair_products(const ReceiverPairHistory& history,
                                                  const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                                  std::uint32_t beam, const RangeSamples& samples,
                                                  const EchoModel& by_upper, const EchoModel& by_lower) {
  return integrated(history, receiver_pair, fan, beam, samples, {&by_upper, &by_lower}, false);
}

}  // namespace tubefoot
