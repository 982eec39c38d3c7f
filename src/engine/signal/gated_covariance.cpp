// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/gated_covariance.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "engine/echo/pair_on_facet.hpp"
#include "engine/echo/quadratures.hpp"
#include "engine/echo/texture_cells.hpp"
#include "geometry/steps/stop.hpp"

// Integrates products of two channels over the parts of polygons that lie in given range samples of both.
// The parts are cut along the range ellipses of both channels. Source: docs/notes/signals.md, "Range bins".

namespace tubefoot {
namespace {

/// Polygons per task. The number determines the order of summation.
constexpr std::size_t gated_patches_per_task = 32;

bool same(const Directivity& a, const Directivity& b) {
  return a.kind == b.kind && a.axis == b.axis && a.from_axis == b.from_axis && a.centre == b.centre &&
         a.size == b.size && a.table == b.table;
}
bool same(const SignalChannel& a, const SignalChannel& b) {
  return a.transmit_m == b.transmit_m && a.receive_m == b.receive_m && same(a.transmit, b.transmit) &&
         same(a.receive, b.receive);
}

/// Largest difference of the path lengths of two channels.
double apart_m(const SignalChannel& a, const SignalChannel& b) {
  return glm::distance(a.transmit_m, b.transmit_m) + glm::distance(a.receive_m, b.receive_m);
}

/// Sums over the polygons of a task.
class GatedIntegral {
 public:
  GatedIntegral(const VisiblePolygons& seen, const SignalChannel& a, const SignalChannel& b,
                std::span<const double> borders, double step_m, int reach, double wavenumber,
                const EchoModel& model, double tolerance)
      : seen_(seen),
        channels_{&a, &b},
        samples_(int(borders.size()) - 1),
        reach_(reach),
        step_m_(step_m),
        wavenumber_(wavenumber),
        model_(model),
        tolerance_(tolerance),
        one_(same(a, b)),
        cutter_(borders),
        sums_(std::size_t(2 * reach + 1)) {
    for (const SignalChannel* channel : channels_)
      smooth_everywhere_.take(channel->transmit, channel->receive);
    if (!one_) phase_rad_ = resolution_of([&](double y) { return wavenumber_ * apart_m(a, b) * y; });
    for (auto& sum : sums_) sum.assign(std::size_t(samples_) * values(), 0);
  }

  void add(const VisiblePolygon& patch) {
    // Places are relative to the transmitter of channel a.
    const auto& [a, b] = channels_;
    const glm::dvec3 from_seen = a->transmit_m - seen_.origin_m;
    const FacetPlane plane{patch.normal, patch.distance_m + glm::dot(patch.normal, from_seen)};
    const PlaneFrame frame(plane);
    std::array<ChannelOnFacet, 2> on;
    for (std::size_t c = 0; c < 2; ++c) {
      const PathCutter::Receiver tx = over_plane(plane, frame, channels_[c]->transmit_m - a->transmit_m),
                                 rx = over_plane(plane, frame, channels_[c]->receive_m - a->transmit_m);
      if (!(tx.distance > 0 && rx.distance > 0)) return;
      on[c] = {PathOnFacet(plane, frame, tx, rx, patch.facet, model_),
               {std::span(&channels_[c]->transmit, 1), &channels_[c]->receive, 0, true}};
      on[c].path.lies = LyingPlane(plane, frame, a->transmit_m);
    }
    if (is_silent(on[0].path.seabed)) return;
    corners_.clear();
    for (const glm::dvec3& corner : seen_.corners(patch)) corners_.push_back(corner - from_seen);
    polygon_.assign(corners_, plane, frame);
    if (one_) return add(PairIntegrand{on[0]});
    const auto difference = [&](glm::dvec3 one_m, glm::dvec3 other_m) {
      return RangeDifference::of(plane, frame, (one_m + other_m) / 2.0 - a->transmit_m, one_m - other_m, 1);
    };
    add(PairIntegrand{on[0], on[1], wavenumber_, difference(a->receive_m, b->receive_m),
                      difference(a->transmit_m, b->transmit_m)});
  }

  /// Adds the sums to covariances.
  void tell(std::vector<std::complex<double>>& all) const {
    const std::size_t width = sums_.size();
    for (std::size_t band = 0; band < width; ++band)
      for (std::size_t k = 0; k < std::size_t(samples_); ++k) {
        const double* sum = &sums_[band][k * values()];
        all[width * k + band] += one_ ? std::complex<double>(sum[0]) : std::complex<double>(sum[1], sum[2]);
      }
  }

 private:
  std::size_t values() const { return one_ ? 1 : 3; }

  void add(const PairIntegrand& integrand) {
    const PathOnFacet& a = integrand.a.path;
    Smoothness smooth = smooth_everywhere_;
    smooth.take(a.seabed);
    PathCutter::Work work = smooth.work(tolerance_);
    work.values = values();
    work.resolution_rad = std::min(work.resolution_rad, phase_rad_);
    work.from_second = !one_;
    cells_.cut(polygon_, a.lies, a.seabed.texture, [&](const PlanarPolygon& part) {
      stop_if_wanted();
      if (one_) return cutter_.add(part, a.rx.over, std::cref(integrand), work, sums_[std::size_t(reach_)]);
      PathCutter::SecondRange second{integrand.b->path.tx.over, integrand.b->path.rx.over};
      for (int band = -reach_; band <= reach_; ++band) {
        second.later_m = band * step_m_;
        cutter_.add(part, a.rx.over, second, std::cref(integrand), work, sums_[std::size_t(band + reach_)]);
      }
    });
  }

  const VisiblePolygons& seen_;
  std::array<const SignalChannel*, 2> channels_;
  int samples_, reach_;
  double step_m_, wavenumber_;
  const EchoModel& model_;
  double tolerance_;
  bool one_;
  PathCutter cutter_;
  Smoothness smooth_everywhere_;  // of patterns
  double phase_rad_ = 1;
  std::vector<glm::dvec3> corners_;
  PlanarPolygon polygon_;
  TextureCells cells_;
  std::vector<std::vector<double>> sums_;  // by band; `values()` per sample
};

}  // namespace

SampleCovariances gated_covariances(const VisiblePolygons& patches, const SignalChannel& a,
                                    const SignalChannel& b, const RangeSamples& samples,
                                    double wavenumber_rad_m, const EchoModel& model, double tolerance) {
  check(model);
  if (a.has_path() || b.has_path())
    throw std::invalid_argument(
        "gated covariances need transmitters and receivers at rest: leave out the motions of the channels, "
        "or use signals from element_signals(), which supports motion");
  if (model.path.over_mirrors())
    throw std::invalid_argument(
        "gated covariances need straight paths without mirrors: use signal_covariances(), which includes the "
        "losses of mirrors");
  const std::vector<double> borders = sample_borders_m(samples);
  if (samples.count < 1 || !(samples.step_m > 0) || !(samples.first_m >= 0) || !std::isfinite(borders.back()))
    throw std::invalid_argument(
        fmt::format("range samples need a first range of 0 or more, a step above 0 and a count of 1 or more, "
                    "all finite, not {} m, {} m and {}",
                    samples.first_m, samples.step_m, samples.count));
  if (!(wavenumber_rad_m >= 0 && std::isfinite(wavenumber_rad_m)))
    throw std::invalid_argument(
        fmt::format("the wavenumber must be finite and 0 or more, not {} rad/m", wavenumber_rad_m));
  if (!(tolerance > 0))
    throw std::invalid_argument(fmt::format("the tolerance must be above 0, not {}", tolerance));
  SampleCovariances all;
  all.samples = samples.count;
  // Half paths of the two channels differ by at most half of the distances between their ends.
  all.reach = same(a, b)
                  ? 0
                  : int(std::min(std::ceil(apart_m(a, b) / 2 / samples.step_m), double(samples.count - 1)));
  all.value.assign(std::size_t(2 * all.reach + 1) * std::size_t(samples.count), 0);
  const std::size_t count = patches.patches.size(),
                    tasks = (count + gated_patches_per_task - 1) / gated_patches_per_task;
  std::vector<std::vector<std::complex<double>>> parts(tasks);
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
    GatedIntegral integral(patches, a, b, borders, samples.step_m, all.reach, wavenumber_rad_m, model,
                           tolerance);
    const std::size_t end = std::min((task + 1) * gated_patches_per_task, count);
    for (std::size_t k = task * gated_patches_per_task; k < end; ++k) integral.add(patches.patches[k]);
    parts[task].assign(all.value.size(), 0);
    integral.tell(parts[task]);
  });
  for (const auto& part : parts)
    for (std::size_t k = 0; k < part.size(); ++k) all.value[k] += part[k];
  return all;
}

}  // namespace tubefoot
