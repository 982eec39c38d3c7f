// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "engine/echo/path_on_facet.hpp"
#include "engine/echo/quadratures.hpp"
#include "engine/echo/texture_cells.hpp"
#include "geometry/steps/steps.hpp"

// Integrates bistatic echoes facet by facet with PathCutter, over cells between ellipses of equal path, with
// patterns, texture and mirror losses in the integrand (quadratures.hpp).

namespace tubefoot {
namespace {

/// Facets per task. The results do not depend on this number.
constexpr std::size_t bistatic_facets_per_task = 32;

/// Quadrature of single facets. One object per thread.
class FacetEcho {
 public:
  FacetEcho(const CommonVisibility& visibility, const ReceiveBeams& beams, std::span<const double> borders,
            const EchoModel& model, double tolerance)
      : visibility_(visibility),
        beams_(beams),
        model_(model),
        borders_(borders),
        cutter_(borders),
        mirrors_angle_rad_(smooth_angle_rad(model.path)),
        tolerance_(tolerance) {}

  /// `number`: index of the facet in the common visibility.
  void add(std::size_t number, std::vector<Part<double>>& parts) {
    const SeenFacet facet = visibility_[number];
    const PlaneFrame frame(facet.plane);
    path_ = path_on(visibility_, number, frame, model_);
    if (is_silent(path_.seabed)) return;
    smooth_ = {mirrors_angle_rad_};
    smooth_.take(path_.seabed);
    for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
      const SeenPart seen = visibility_.part(number, facet.first_piece + k);
      if (!beams_.in_one_fan(seen.tx_tube, seen.rx_tube)) continue;
      assign(polygon_, seen.corners_m, facet.plane, frame, visibility_.bistatic(number));
      cells_.cut(polygon_, path_.lies, path_.seabed.texture, [&](const PlanarPolygon& part) {
        const Part<double> owned{0, 0, 0, std::uint32_t(number), seen.tx_tube};
        add(part, seen, owned, parts);
      });
    }
  }

 private:
  void integrate(const PlanarPolygon& polygon, const PathCutter::Integrand& integrand,
                 const PathCutter::Work& work, std::uint32_t first_beam, Part<double> part,
                 std::vector<Part<double>>& parts) {
    const auto [first, end] = cutter_.samples_of(polygon, path_.rx.over);
    if (first == end) return;
    sum_.resize(work.values * (borders_.size() - 1), 0);
    cutter_.add(polygon, path_.rx.over, integrand, work, sum_);
    const std::size_t skipped = work.values > 1 ? 1 : 0;  // skips the integral without patterns
    for (std::size_t k = first; k < end; ++k)
      for (std::size_t v = 0; v < work.values; ++v) {
        part.value = std::exchange(sum_[k * work.values + v], 0);
        if (part.value == 0 || v < skipped) continue;
        part.beam = first_beam + std::uint32_t(v - skipped);
        part.sample = std::uint32_t(k);
        parts.push_back(part);
      }
  }

  /// With patterns, the first value is the energy without them, and the others are those of the beams.
  void add(const PlanarPolygon& polygon, const SeenPart& seen, const Part<double>& owned,
           std::vector<Part<double>>& parts) {
    const BeamPatterns* patterns = model_.patterns;
    std::uint32_t first = beams_.of_tube[seen.rx_tube], end = first;
    const TransmitPattern* transmit = nullptr;
    Smoothness smooth = smooth_;
    if (patterns != nullptr) {
      std::tie(first, end) = patterns->beams_of_tube[seen.rx_tube];
      if (first == end) return;
      transmit = &patterns->transmit[patterns->fan_of_tube[seen.rx_tube]];
      for (const Directivity& sent : transmit->beams)
        for (std::uint32_t beam = first; beam < end; ++beam) smooth.take(sent, patterns->receive[beam]);
      smooth.limited = !patterns->least.empty();
    }
    PathCutter::Work work = smooth.work(tolerance_);
    work.values = 1 + end - first;
    integrate(
        polygon,
        [&](glm::dvec2 p, double tx, double rx, std::span<double> values) {
          PathOnFacet::Directions towards;
          if (patterns != nullptr || path_.over_mirrors()) towards = path_.directions(p, tx, rx);
          values[0] = path_.energy(tx, rx, towards, path_.texture_at(p));
          if (patterns == nullptr) return;
          const double sent = transmit->gain(towards.tx), energy_sent = values[0] * sent;
          for (std::uint32_t beam = first; beam < end; ++beam) {
            const double received = patterns->receive[beam].gain(towards.rx);
            values[1 + beam - first] = patterns->receives(beam, sent * received) ? energy_sent * received : 0;
          }
        },
        work, first, owned, parts);
  }

  const CommonVisibility& visibility_;
  const ReceiveBeams& beams_;
  const EchoModel& model_;
  std::span<const double> borders_;
  PathCutter cutter_;
  double mirrors_angle_rad_, tolerance_;
  PathOnFacet path_;
  Smoothness smooth_;
  PlanarPolygon polygon_;
  TextureCells cells_;
  std::vector<double> sum_;  // all 0 between polygons
};

}  // namespace

void integrate_two_apexes(const CommonVisibility& visibility, const ReceiveBeams& beams,
                          const RangeSamples& samples, const EchoModel& model, const Quadrature& how,
                          const Sink<double>& sink) {
  if (!visibility.shared_hits().empty()) integrate_hits(visibility, beams, samples, model, sink);
  if (how.binning != Binning::exact)
    return integrate_whole(visibility, beams, samples, model, how.binning, sink);
  const std::vector<double> borders = sample_borders_m(samples);
  const std::size_t facets = visibility.end() - visibility.first();
  std::vector<std::vector<Part<double>>> parts((facets + bistatic_facets_per_task - 1) /
                                               bistatic_facets_per_task);
  tbb::enumerable_thread_specific<FacetEcho> threads(
      [&] { return FacetEcho(visibility, beams, borders, model, how.path_tolerance); });
  Steps steps("facets", facets);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t task) {
    FacetEcho& facet_echo = threads.local();
    const std::size_t begin = visibility.first() + task * bistatic_facets_per_task,
                      end = std::min(begin + bistatic_facets_per_task, visibility.end());
    for (std::size_t number = begin; number < end; ++number) {
      facet_echo.add(number, parts[task]);
      steps.done();
    }
  });
  for (const auto& task : parts)
    for (const Part<double>& part : task) sink(part);
}

}  // namespace tubefoot
