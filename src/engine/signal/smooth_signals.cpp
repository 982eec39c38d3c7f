// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/smooth_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "engine/signal/chebyshev_pulses.hpp"
#include "engine/signal/smooth_amplitude.hpp"
#include "engine/signal/smooth_pieces.hpp"
#include "geometry/integrals/polygon_transform.hpp"
#include "geometry/steps/in_order.hpp"

namespace tubefoot {
namespace {

constexpr double pi = std::numbers::pi;
/// What a task takes: part of the summation's order.
constexpr std::size_t patches_per_task = 256;
constexpr int most_nodes = 16, fewest_nodes = 4, most_halvings = 40;
/// What tables of pulses may fill; long pulses have fewer nodes for it.
constexpr double most_table_bytes = 256e6;
/// Radians of a pattern's wavenumber over a piece.
constexpr double most_pattern_rad = 0.15;

/// The carrier's wave number and those about it, as far as the pulse's band goes.
struct Band {
  double middle_rad_m = 0, half_rad_m = 0, tolerance = 0;

  /// Chebyshev's nodes that interpolate (1 + share x) e^{i change x}, |x| <= 1, where share is the half
  /// band's of the carrier: the remainder is at most the n-th derivative over 2^(n-1) n!. More than `most`:
  /// that many do not.
  int nodes_for(double change_rad, int most) const {
    const double share = half_rad_m / middle_rad_m;
    double scale = 1;  // change^(n-1) / (2^(n-1) n!)
    for (int n = 1; n <= most; ++n) {
      if (n > 1) scale *= change_rad / (2 * n);
      if (scale * (change_rad * (1 + share) + n * share) <= tolerance) return n;
    }
    return most + 1;
  }
  /// Increasing.
  std::vector<double> nodes(int count) const {
    std::vector<double> rad_m;
    for (int k = 0; k < count; ++k)
      rad_m.push_back(middle_rad_m - half_rad_m * std::cos(pi * (k + 0.5) / count));
    return rad_m;
  }
};

/// Amplitudes at some of Chebyshev's nodes of the band, and what makes coefficients of polynomials of them.
struct BandNodes {
  std::vector<double> rad_m, weight;  // [polynomial][node]
  SmoothAmplitude amplitude;

  BandNodes(const Band& band, int count) : rad_m(band.nodes(count)), amplitude(rad_m, band.tolerance) {
    // T_j(-cos x) = (-1)^j cos(jx)
    for (int j = 0; j < count; ++j)
      for (int k = 0; k < count; ++k)
        weight.push_back((j == 0       ? 1.0
                          : j % 2 == 0 ? 2.0
                                       : -2.0) /
                         count * std::cos(j * pi * (k + 0.5) / count));
  }
};

/// Both halves of a polygon, cut across a direction.
void halve(const PlanarPolygon& polygon, glm::dvec2 along, std::vector<PlanarPolygon>& halves) {
  std::vector<glm::dvec2> turned;
  double low = 0, high = 0;
  for (const glm::dvec2& p : polygon.offsets) {
    turned.emplace_back(glm::dot(p, along), along.x * p.y - along.y * p.x);
    low = std::min(low, turned.back().x);
    high = std::max(high, turned.back().x);
  }
  for (const double side : {-1.0, 1.0}) {
    const std::vector<glm::dvec2> half = cut_at(turned, 0, (low + high) / 2, side);
    if (half.size() < 3) continue;
    PlanarPolygon& part = halves.emplace_back();
    part.distance = polygon.distance;
    for (const glm::dvec2& q : half) {
      const glm::dvec2 p(along.x * q.x - along.y * q.y, along.y * q.x + along.x * q.y);
      if (part.offsets.empty()) part.first = p;
      part.offsets.push_back(p - part.first);
    }
    part.first += polygon.first;
  }
}

/// The polygons of one channel, one after the other.
class ChannelOfSmooth {
 public:
  ChannelOfSmooth(const SignalChannel& channel, const CoherentReceiver& receiver, const Band& band,
                  const ChebyshevPulses& pulses, const EchoLaw& law)
      : channel_(channel),
        receiver_(receiver),
        band_(band),
        pulses_(pulses),
        path_(law.path),
        absorption_per_m_(absorption_per_m(law.absorption_db_per_m)),
        nodes_(std::size_t(pulses.most())),
        sent_(amplitude_wavenumber(channel.transmit) + amplitude_wavenumber(law.path.out.loss)),
        heard_(amplitude_wavenumber(channel.receive) + amplitude_wavenumber(law.path.back().loss)) {
    const double reach = receiver.pulse.end_s - receiver.pulse.begin_s;
    first_m_ = (receiver.times.first_s - receiver.pulse.end_s - reach) * receiver.sound_speed_m_s;
    last_m_ = (receiver.times.time_s(receiver.times.count) - receiver.pulse.begin_s + reach) *
              receiver.sound_speed_m_s;
  }

  void add(const SeenPatches& seen, const SeenPatch& patch, const SmoothSurface& surface,
           std::complex<double>* out) {
    const glm::dvec3 transmit = channel_.transmit_m - seen.origin_m,
                     receive = channel_.receive_m - seen.origin_m;
    plane_ = {patch.normal, patch.distance_m + glm::dot(patch.normal, transmit)};
    home_.distance = patch.distance_m + glm::dot(patch.normal, receive);
    if (!(plane_.distance_m > 0) || !(home_.distance > 0)) return;
    const PlaneFrame frame(plane_);
    frame_ = &frame;
    home_.foot = frame.project(receive - transmit);
    back_m_ = receive - transmit;
    const auto corners = seen.corners(patch);
    corners_.assign(corners.begin(), corners.end());
    for (glm::dvec3& corner : corners_) corner -= transmit;
    pieces_.resize(1);
    pieces_[0].assign(corners_, plane_, frame);
    halvings_.assign(1, 0);
    while (!pieces_.empty()) {
      const PlanarPolygon piece = std::move(pieces_.back());
      const int halvings = halvings_.back();
      pieces_.pop_back();
      halvings_.pop_back();
      add(piece, surface, halvings, out);
      halvings_.resize(pieces_.size(), halvings + 1);
    }
  }

 private:
  void add(const PlanarPolygon& piece, const SmoothSurface& surface, int halvings,
           std::complex<double>* out) {
    if (piece.offsets.size() < 3) return;
    const auto [half_shortest, half_longest] = PathCutter::half_paths_of(piece, home_);
    if (2 * half_longest < first_m_ || 2 * half_shortest > last_m_) return;
    const double path = half_shortest + half_longest,
                 change = band_.half_rad_m * (half_longest - half_shortest);
    const glm::dvec2 place = place_of_shortest_path(piece, home_);
    const double out_m = std::hypot(piece.distance, place.x, place.y),
                 back_m = std::hypot(home_.distance, place.x - home_.foot.x, place.y - home_.foot.y);
    // A rough surface loses more of its amplitude the higher the frequency.
    const double sine = (piece.distance / out_m + home_.distance / back_m) / 2,
                 lost = 2 * std::pow(band_.middle_rad_m * sine * surface.roughness_m, 2),
                 share = band_.half_rad_m / band_.middle_rad_m;
    if (lost * (1 - share) * (1 - share) > 40) return;  // 4e-18 is left of it
    const int needed = band_.nodes_for(change + lost * share * (2 + share), pulses_.most());
    if (halvings < most_halvings && (needed > pulses_.most() || pattern_changes(piece, out_m, back_m))) {
      halve(piece, across(piece, needed > pulses_.most()), pieces_);
      return;
    }
    const auto count = std::size_t(std::min(needed, pulses_.most()));
    std::optional<BandNodes>& nodes = nodes_[count - 1];
    if (!nodes) nodes.emplace(band_, int(count));
    values_.assign(count, 0);
    nodes->amplitude.add(piece, home_, surface, values_);
    const double factor = received_part(piece, path);
    for (std::size_t k = 0; k < count; ++k)
      values_[k] *= factor * phasor(-(nodes->rad_m[k] - band_.middle_rad_m) * path);
    tell(nodes->weight, path / receiver_.sound_speed_m_s, out);
  }

  /// Adds the pulses of the polynomial through an amplitude's values.
  void tell(std::span<const double> weight, double delay_s, std::complex<double>* out) {
    const std::size_t count = values_.size();
    coefficients_.assign(count, 0);
    double largest = 0;
    for (std::size_t j = 0; j < count; ++j) {
      for (std::size_t k = 0; k < count; ++k) coefficients_[j] += weight[j * count + k] * values_[k];
      largest = std::max(largest, std::abs(coefficients_[j]));
    }
    for (std::size_t j = 0; j < count; ++j)
      if (std::abs(coefficients_[j]) > 0.01 * band_.tolerance * largest)
        pulses_.table(int(j)).add(coefficients_[j], delay_s, out);
  }

  bool pattern_changes(const PlanarPolygon& piece, double out_m, double back_m) const {
    if (sent_ == 0 && heard_ == 0) return false;
    const glm::dvec2 middle = centroid_offset(piece);
    double reach = 0;
    for (const glm::dvec2& offset : piece.offsets) reach = std::max(reach, glm::length(offset - middle));
    return reach * (sent_ / out_m + heard_ / back_m) > most_pattern_rad;
  }

  /// The direction that a piece is cut across: that in which paths differ most, which grow along their slope
  /// and bend across it, or the one in which the piece is longest.
  glm::dvec2 across(const PlanarPolygon& piece, bool for_paths) const {
    const glm::dvec2 offset = centroid_offset(piece), middle = piece.first + offset;
    glm::dvec2 longest(0);
    for (const glm::dvec2& corner : piece.offsets)
      if (glm::dot(corner - offset, corner - offset) > glm::dot(longest, longest)) longest = corner - offset;
    if (!for_paths) return glm::normalize(longest);
    const glm::dvec2 from_foot = middle - home_.foot;
    const double out_m = std::hypot(piece.distance, middle.x, middle.y),
                 back_m = std::hypot(home_.distance, from_foot.x, from_foot.y);
    const glm::dvec2 slope = middle / out_m + from_foot / back_m;
    const double steep = glm::length(slope);
    if (!(steep > 1e-3)) return glm::normalize(longest);
    const glm::dvec2 along = slope / steep, aside(-along.y, along.x);
    const auto extent = [&](glm::dvec2 direction) {
      double low = 0, high = 0;
      for (const glm::dvec2& corner : piece.offsets) {
        low = std::min(low, glm::dot(corner, direction));
        high = std::max(high, glm::dot(corner, direction));
      }
      return high - low;
    };
    const double bend = (1 / out_m + 1 / back_m) / 8, length = extent(along), width = extent(aside);
    return (steep + bend * length) * length >= bend * width * width ? along : aside;
  }

  /// What absorption over the middle path, and patterns and mirrors towards the centroid leave of the
  /// amplitude.
  double received_part(const PlanarPolygon& piece, double path_m) const {
    const double left = std::exp(-absorption_per_m_ * path_m / 2);
    if (channel_.transmit.kind == Directivity::Kind::uniform &&
        channel_.receive.kind == Directivity::Kind::uniform && !path_.over_mirrors())
      return left;
    const glm::dvec2 place = piece.first + centroid_offset(piece);
    const glm::dvec3 there = -plane_.distance_m * plane_.normal + place.x * frame_->u + place.y * frame_->v;
    const glm::dvec3 out = glm::normalize(there), home = glm::normalize(there - back_m_);
    return left * std::sqrt(path_.out.loss.at(out) * path_.back().loss.at(home)) *
           amplitude_pattern(channel_.transmit, out) * amplitude_pattern(channel_.receive, home);
  }

  const SignalChannel& channel_;
  const CoherentReceiver& receiver_;
  const Band& band_;
  const ChebyshevPulses& pulses_;
  const Path& path_;
  double absorption_per_m_;
  std::vector<std::optional<BandNodes>> nodes_;  // by their number, less one
  std::vector<std::complex<double>> values_, coefficients_;
  double sent_, heard_;              // wave numbers of patterns
  double first_m_ = 0, last_m_ = 0;  // paths that are heard
  // Of the patch at hand; the transmitter is the origin.
  FacetPlane plane_;
  const PlaneFrame* frame_ = nullptr;
  PathCutter::Receiver home_;
  glm::dvec3 back_m_{0};
  std::vector<glm::dvec3> corners_;
  std::vector<PlanarPolygon> pieces_;
  std::vector<int> halvings_;
};

}  // namespace

ChannelSignals smooth_signals(const SeenPatches& patches, const CoherentReceiver& receiver,
                              const EchoLaw& law,
                              const std::function<const SmoothSurface*(FacetId)>& surface_of,
                              double tolerance) {
  check(receiver, law);
  if (!(tolerance >= 1e-9 && tolerance <= 0.1))
    throw std::invalid_argument(fmt::format("a tolerance must be from 1e-9 to 0.1, not {}", tolerance));
  const Band band{2 * pi * receiver.carrier_hz / receiver.sound_speed_m_s,
                  pi * receiver.pulse.bandwidth_hz / receiver.sound_speed_m_s, tolerance};
  if (!(band.half_rad_m < band.middle_rad_m))
    throw std::invalid_argument(fmt::format(
        "a band of {} Hz about {} Hz reaches down to frequency 0: take a pulse of less than twice the "
        "carrier",
        receiver.pulse.bandwidth_hz, receiver.carrier_hz));
  std::vector<std::pair<const SeenPatch*, const SmoothSurface*>> smooth;
  for (const SeenPatch& patch : patches.patches)
    if (const SmoothSurface* surface = surface_of(patch.facet)) smooth.emplace_back(&patch, surface);
  ChannelSignals signals{receiver.channels.size(), receiver.times.count, {}};
  signals.value.assign(signals.channels * signals.samples, 0);
  if (smooth.empty()) return signals;
  const double table_bytes = 16e3 * (receiver.pulse.end_s - receiver.pulse.begin_s) * receiver.times.rate_hz;
  const ChebyshevPulses pulses(
      receiver.pulse, receiver.times,
      std::clamp(int(most_table_bytes / std::max(table_bytes, 1.0)), fewest_nodes, most_nodes),
      tolerance * 1e-3);
  const std::size_t tasks = (smooth.size() + patches_per_task - 1) / patches_per_task;
  in_order(
      0, signals.channels * tasks, 16 * signals.samples,
      [&](std::size_t task) {
        std::vector<std::complex<double>> part(signals.samples);
        ChannelOfSmooth channel(receiver.channels[task / tasks], receiver, band, pulses, law);
        const std::size_t begin = task % tasks * patches_per_task,
                          end = std::min(begin + patches_per_task, smooth.size());
        for (std::size_t n = begin; n < end; ++n)
          channel.add(patches, *smooth[n].first, *smooth[n].second, part.data());
        return part;
      },
      [&](std::size_t task, const std::vector<std::complex<double>>& part) {
        std::complex<double>* row = &signals.value[task / tasks * signals.samples];
        for (std::size_t k = 0; k < part.size(); ++k) row[k] += part[k];
      });
  return signals;
}

}  // namespace tubefoot
