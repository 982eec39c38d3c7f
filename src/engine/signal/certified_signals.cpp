// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/certified_signals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "geometry/integrals/certified_path_wave.hpp"
#include "geometry/mesh/facet_cone.hpp"
#include "geometry/numbers/ball_vector.hpp"
#include "geometry/steps/in_order.hpp"

// Encloses the signals of smooth_signals() in ball arithmetic: closed-form pulses are integrated along the
// edges of the visible polygons. Source: docs/notes/smooth-surfaces.md, "Certified signals".

namespace tubefoot {
namespace {

/// Polygons per task. The number determines the order of summation.
constexpr std::size_t certified_patches_per_task = 16;

/// Marks a missing bound.
const std::complex<double> open(std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::infinity());
const ComplexBall imaginary_unit(Ball(0.0), Ball(1.0));

ComplexBall turned(const Ball& phase) {
  Ball sine, cosine;
  sin_cos(phase, sine, cosine);
  return {cosine, sine};
}

/// Pulse as waves in the path length, at a given time of reception.
class PulseWaves {
 public:
  PulseWaves(const TaperedChirp& pulse, double baseband_hz, double sound_speed, double absorption_db_per_m)
      : turn_(Ball(2.0) * Ball::pi()),
        speed_(sound_speed),
        duration_(pulse.duration_s),
        taper_(pulse.taper),
        baseband_(Ball(baseband_hz) * turn_),
        fade_(Ball(absorption_db_per_m) * log(Ball(10)) / Ball(20)) {
    const Ball rate = (Ball(pulse.stop_hz) - Ball(pulse.start_hz)) / duration_;
    height_ = Ball(1.0) / root(duration_ * (Ball(1.0) - Ball(0.625) * taper_));
    flank_ = taper_ * duration_ / Ball(2.0);
    // A path that is longer by x was transmitted x / c earlier. Coefficients of the pulse's phase there, in
    // powers of x.
    linear_ = ComplexBall(-fade_, turn_ * Ball(pulse.start_hz) / speed_);
    square_ = ComplexBall(Ball(0.0), -(Ball::pi() * rate / squared(speed_)));
    swing_ = pulse.taper > 0 ? Ball::pi() / flank_ / speed_ : Ball(0.0);
    const double fastest = std::max(pulse.start_hz, pulse.stop_hz);
    steepest_ = (height_ * (turn_ * Ball(fastest) / speed_ + swing_ + fade_)).hi();
    with_flanks_ = pulse.taper > 0;
    with_middle_ = pulse.taper < 1;
  }

  PathWave at(double time_s) const {
    PathWave wave;
    const Ball time(time_s);
    wave.origin = time * speed_;
    wave.largest = height_.hi();
    if (with_flanks_) wave.steepest = steepest_;
    const ComplexBall all = turned(baseband_ * time) * ComplexBall(height_ * exp(-(fade_ * wave.origin)));
    const auto path = [&](const Ball& after_s) { return speed_ * (time - after_s); };
    const ComplexBall half = all / ComplexBall(2.0), quarter = -(all / ComplexBall(4.0));
    const ComplexBall up = linear_ + imaginary_unit * ComplexBall(swing_),
                      down = linear_ - imaginary_unit * ComplexBall(swing_);
    if (with_flanks_) {
      // Flank: (1 - cos(pi from end / flank)) / 2.
      const ComplexBall turn = turned(swing_ * speed_ * duration_),
                        back = turned(-(swing_ * speed_ * duration_));
      wave.stretches.push_back(
          {path(duration_),
           path(duration_ - flank_),
           {{half, linear_, square_}, {quarter * turn, up, square_}, {quarter * back, down, square_}}});
    }
    if (with_middle_)
      wave.stretches.push_back({path(duration_ - (with_flanks_ ? flank_ : Ball(0.0))),
                                path(with_flanks_ ? flank_ : Ball(0.0)),
                                {{all, linear_, square_}}});
    if (with_flanks_)
      wave.stretches.push_back(
          {path(flank_),
           path(Ball(0.0)),
           {{half, linear_, square_}, {quarter, up, square_}, {quarter, down, square_}}});
    return wave;
  }

 private:
  Ball turn_, speed_, duration_, taper_, baseband_, fade_, height_, flank_, swing_;
  ComplexBall linear_, square_;
  double steepest_ = 0;
  bool with_flanks_ = false, with_middle_ = true;
};

/// Range of samples that may receive paths of these lengths.
std::pair<std::size_t, std::size_t> samples_of(double shortest_m, double longest_m, const TaperedChirp& pulse,
                                               const SignalTimes& times, double sound_speed) {
  const double first = (shortest_m / sound_speed - times.first_s) * times.rate_hz,
               end = (longest_m / sound_speed + pulse.duration_s - times.first_s) * times.rate_hz,
               margin = 1 + 1e-9 * (std::abs(first) + std::abs(end)), count = double(times.count);
  if (!std::isfinite(first) || !std::isfinite(end)) return {0, times.count};
  return {std::size_t(std::clamp(std::floor(first - margin), 0.0, count)),
          std::size_t(std::clamp(std::ceil(end + margin) + 1, 0.0, count))};
}

/// Polygon as the ends of a channel see it.
struct ReceivedPolygon {
  CertifiedPathEdges edges;
  bool surely = true;  ///< both ends certainly lie on the visible side
};
/// None if one of the ends certainly lies on the other side.
std::optional<ReceivedPolygon> received_polygon(const CertifiedSmoothSignals::Seen& seen,
                                                const VisiblePolygons& patches, const VisiblePolygon& patch,
                                                const SignalChannel& channel) {
  FacetCone cone;
  FacetCone::make(seen.mesh, patch.facet, seen.apex, cone);
  const CertifiedPolygon polygon =
      certified_polygon(cone, patches.corners(patch), {}, seen.other_apex_m, seen.grid_unit_m);
  const ApexOverPlane tx = apex_over(polygon, vector_between(patches.origin_m, channel.transmit_m)),
                      back = apex_over(polygon, vector_between(patches.origin_m, channel.receive_m));
  if (!(tx.height.hi() > 0 && back.height.hi() > 0)) return std::nullopt;
  std::vector<CertifiedPolygon::Point> points;
  for (const CertifiedPolygon::Point& p : polygon.points) points.push_back({p.x - tx.x, p.y - tx.y});
  return ReceivedPolygon{CertifiedPathEdges(points, tx.height, {back.height, back.x - tx.x, back.y - tx.y}),
                         tx.height.surely_positive() && back.height.surely_positive()};
}

/// Bounds of the path lengths over a polygon, in doubles with a margin for rounding.
std::pair<double, double> paths_of(const VisiblePolygons& patches, const VisiblePolygon& patch,
                                   const SignalChannel& channel) {
  const auto corners = patches.corners(patch);
  const glm::dvec3 tx = channel.transmit_m - patches.origin_m, rx = channel.receive_m - patches.origin_m;
  double longest = 0, reach = 0;
  for (const glm::dvec3& corner : corners) {
    longest = std::max(longest, glm::distance(corner, tx) + glm::distance(corner, rx));
    reach = std::max(reach, glm::distance(corner, corners[0]));
  }
  // The length of a path changes by at most twice the distance along the plane. No path is shorter than the
  // specular path.
  const double heights = 2 * patch.distance_m + glm::dot(patch.normal, tx + rx);
  const glm::dvec3 apart = rx - tx;
  const double across2 = std::max(glm::dot(apart, apart) - std::pow(glm::dot(apart, patch.normal), 2), 0.0);
  return {std::max(longest - 4 * reach, heights > 0 ? std::hypot(heights, std::sqrt(across2)) : 0), longest};
}

}  // namespace

bool CertifiedSmoothSignals::can_bound(const SmoothSurface& surface, const SignalChannel& channel,
                                       const Path& path) {
  return !surface.fluid && surface.roughness_m == 0 && !channel.has_path() && !path.over_mirrors() &&
         channel.transmit.kind == Directivity::Kind::uniform &&
         channel.receive.kind == Directivity::Kind::uniform;
}

CertifiedSignals CertifiedSmoothSignals::of(const VisiblePolygons& patches,
                                            const std::vector<SignalChannel>& channels,
                                            double absorption_db_per_m,
                                            const std::function<const SmoothSurface*(FacetId)>& surface_of,
                                            std::span<const double> allowed) const {
  CertifiedSignals all{{channels.size(), times_.count, {}}, {}};
  all.signals.value.assign(channels.size() * times_.count, 0);
  all.bound.assign(all.signals.value.size(), 0);
  const PulseWaves waves(pulse_, baseband_hz_, sound_speed_, absorption_db_per_m);
  std::size_t edges = 0;
  for (const VisiblePolygon& patch : patches.patches) edges += patch.corner_count;
  struct Part {
    std::vector<ComplexBall> sum;
    std::vector<std::uint8_t> open;  ///< per sample: some contribution has no bound and is not in the sum
  };
  const auto add_patch = [&](const VisiblePolygon& patch, std::size_t c, Part& part) {
    stop_if_wanted();
    const SmoothSurface* surface = surface_of(patch.facet);
    if (surface == nullptr || surface->reflection == 0.0) return;
    std::optional<ReceivedPolygon> received = received_polygon(seen_, patches, patch, channels[c]);
    if (!received) return;
    const auto [first, end] = samples_of(received->edges.shortest_path(), received->edges.longest_path(),
                                         pulse_, times_, sound_speed_);
    if (!received->surely) {
      for (std::size_t k = first; k < end; ++k) part.open[k] = 1;
      return;
    }
    const ComplexBall reflection(Ball(surface->reflection.real()), Ball(surface->reflection.imag()));
    for (std::size_t k = first; k < end; ++k) {
      const PathWave wave = waves.at(times_.time_s(k));
      // Relative to the pulse. Fainter contributions are negligible, and the quadrature does not reach
      // arbitrarily small errors.
      const double faintest = std::max(1e-22 * wave.largest, 1e-300);
      const ComplexBall echo =
          reflection * received->edges.integral(
                           wave, std::max(allowed[c] / double(std::max<std::size_t>(edges, 1)), faintest));
      if (echo.is_finite())
        part.sum[k] += echo;
      else
        part.open[k] = 1;
    }
  };
  const std::size_t tasks =
      (patches.patches.size() + certified_patches_per_task - 1) / certified_patches_per_task;
  Part sum{std::vector<ComplexBall>(times_.count), std::vector<std::uint8_t>(times_.count)};
  in_order(
      0, channels.size() * tasks, 256 * times_.count,
      [&](std::size_t task) {
        Part part{std::vector<ComplexBall>(times_.count), std::vector<std::uint8_t>(times_.count)};
        const std::size_t begin = task % tasks * certified_patches_per_task,
                          end = std::min(begin + certified_patches_per_task, patches.patches.size());
        for (std::size_t n = begin; n < end; ++n) add_patch(patches.patches[n], task / tasks, part);
        return part;
      },
      [&](std::size_t task, const Part& part) {
        for (std::size_t k = 0; k < times_.count; ++k) {
          sum.sum[k] += part.sum[k];
          sum.open[k] |= part.open[k];
        }
        if (task % tasks + 1 < tasks) return;
        for (std::size_t k = 0; k < times_.count; ++k) {
          const std::size_t at = task / tasks * times_.count + k;
          const Ball real = sum.sum[k].real(), imaginary = sum.sum[k].imaginary();
          const std::complex<double> middle(real.middle(), imaginary.middle());
          all.signals.value[at] = middle;
          all.bound[at] = sum.open[k] ? open
                                      : std::complex(radius_about(real, middle.real()),
                                                     radius_about(imaginary, middle.imag()));
          sum.sum[k] = ComplexBall(0.0);
          sum.open[k] = 0;
        }
      });
  return all;
}

void CertifiedSmoothSignals::leave_open(const VisiblePolygons& patches,
                                        const std::vector<SignalChannel>& channels,
                                        std::span<std::complex<double>> bound) const {
  for (std::size_t c = 0; c < channels.size(); ++c)
    for (const VisiblePolygon& patch : patches.patches) {
      const auto [shortest, longest] = paths_of(patches, patch, channels[c]);
      const auto [first, end] = channels[c].has_path()
                                    ? std::pair(std::size_t(0), times_.count)
                                    : samples_of(shortest, longest, pulse_, times_, sound_speed_);
      for (std::size_t k = first; k < end; ++k) bound[c * times_.count + k] = open;
    }
}

}  // namespace tubefoot
