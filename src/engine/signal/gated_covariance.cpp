// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/gated_covariance.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

/// Sums over the polygons of a task.
class GatedIntegral {
 public:
  GatedIntegral(const VisiblePolygons& seen, const SignalChannel& a, const SignalChannel& b,
                std::span<const double> borders, double step_m, int reach, double wavenumber,
                const EchoModel& model, double tolerance)
      : seen_(seen),
        a_(a),
        b_(b),
        samples_(int(borders.size()) - 1),
        reach_(reach),
        step_m_(step_m),
        wavenumber_(wavenumber),
        model_(model),
        tolerance_(tolerance),
        one_(same(a, b)),
        cutter_(borders),
        sums_(std::size_t(2 * reach + 1)) {
    patterns_.take(a.transmit, a.receive);
    if (!one_) patterns_.take(b.transmit, b.receive);
    const double apart = glm::distance(a.transmit_m, b.transmit_m) + glm::distance(a.receive_m, b.receive_m);
    if (!one_) phase_rad_ = resolution_of([&](double y) { return wavenumber_ * apart * y; });
    for (auto& sum : sums_) sum.assign(std::size_t(samples_) * values(), 0);
  }

  void add(const VisiblePolygon& patch) {
    const ChannelOnPolygon a(a_, seen_, patch, model_), b(b_, seen_, patch, model_);
    if (!a.faces() || !b.faces() || is_silent(a.path().seabed)) return;
    corners_.clear();
    for (const glm::dvec3& corner : seen_.corners(patch)) corners_.push_back(corner - a.transmit_m());
    polygon_.assign(corners_, a.plane(), a.frame());
    const ReflectivityField* texture = a.path().seabed.texture;
    if (texture == nullptr) return add(polygon_, a, b);
    cells_.cut(polygon_, LyingPlane(a.plane(), a.frame(), a_.transmit_m), texture->cells(),
               [&](const PlanarPolygon& part) { add(part, a, b); });
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

  void add(const PlanarPolygon& polygon, const ChannelOnPolygon& a, const ChannelOnPolygon& b) {
    stop_if_wanted();
    Smoothness smooth = patterns_;
    smooth.take(a.path().seabed);
    PathCutter::Work work = smooth.work(tolerance_);
    work.values = values();
    work.resolution_rad = std::min(work.resolution_rad, phase_rad_);
    work.from_second = !one_;
    const glm::dvec3 foot = -a.plane().distance_m * a.plane().normal;
    const auto pattern = [](const ChannelOnPolygon& on, glm::dvec3 there, glm::dvec3 back) {
      return amplitude_pattern(on.channel().transmit, there) * amplitude_pattern(on.channel().receive, back);
    };
    const PathCutter::Receiver& rx = a.path().rx.over;
    if (one_)
      return cutter_.add(
          polygon, rx,
          [&](glm::dvec2 p, double tx, double back, std::span<double> values) {
            values[0] = a.path().density_at(tx, back) * texture(a, p);
            if (!a.weighed()) return;
            values[0] *= a_.transmit.gain(a.path().tx.direction(p, tx)) *
                         a_.receive.gain(a.path().rx.direction(p, back));
          },
          work, sums_[std::size_t(reach_)]);
    // Both ends of channel b above the plane, in the coordinates of channel a.
    const auto over = [&](glm::dvec3 place_m) {
      const glm::dvec3 from_a = place_m - a.transmit_m();
      return PathCutter::Receiver{a.plane().distance_m + glm::dot(a.plane().normal, from_a),
                                  a.frame().project(from_a)};
    };
    PathCutter::SecondRange second{over(b.transmit_m()), over(b.receive_m())};
    const bool weighed = a.weighed() || b.weighed();
    const PathCutter::Integrand integrand = [&](glm::dvec2 p, double tx, double back,
                                                std::span<double> values) {
      const auto range = [p](const PathCutter::Receiver& end) {
        return std::hypot(end.distance, p.x - end.foot.x, p.y - end.foot.y);
      };
      const double b_out = range(second.transmit), b_back = range(second.receive);
      double size =
          std::sqrt(a.path().density_at(tx, back) * b.path().density_at(b_out, b_back)) * texture(a, p);
      if (weighed) {
        const glm::dvec3 place = foot + p.x * a.frame().u + p.y * a.frame().v + a.transmit_m();
        const glm::dvec3 b_there = (place - b.transmit_m()) / b_out,
                         b_from = (place - b.receive_m()) / b_back;
        size *= pattern(a, a.path().tx.direction(p, tx), a.path().rx.direction(p, back)) *
                pattern(b, b_there, b_from);
      }
      values[0] = std::abs(size);
      const std::complex<double> product =
          std::polar(1.0, wavenumber_ * ((tx - b_out) + (back - b_back))) * size;
      values[1] = product.real();
      values[2] = product.imag();
    };
    for (int band = -reach_; band <= reach_; ++band) {
      second.later_m = band * step_m_;
      cutter_.add(polygon, rx, second, integrand, work, sums_[std::size_t(band + reach_)]);
    }
  }

  double texture(const ChannelOnPolygon& a, glm::dvec2 p) const {
    if (a.path().seabed.texture == nullptr) return 1;
    return a.path().seabed.texture->factor(a_.transmit_m - a.plane().distance_m * a.plane().normal +
                                           p.x * a.frame().u + p.y * a.frame().v);
  }

  const VisiblePolygons& seen_;
  const SignalChannel &a_, &b_;
  int samples_, reach_;
  double step_m_, wavenumber_;
  const EchoModel& model_;
  double tolerance_;
  bool one_;
  PathCutter cutter_;
  Smoothness patterns_;
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
  const double apart = glm::distance(a.transmit_m, b.transmit_m) + glm::distance(a.receive_m, b.receive_m);
  all.reach =
      same(a, b) ? 0 : int(std::min(std::ceil(apart / 2 / samples.step_m), double(samples.count - 1)));
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
