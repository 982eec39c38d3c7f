// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/smooth_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <ranges>
#include <stdexcept>
#include <utility>

#include "engine/signal/certified_signals.hpp"
#include "engine/signal/polygon_velocity.hpp"
#include "engine/signal/smooth_amplitude.hpp"
#include "engine/signal/smooth_pieces.hpp"
#include "geometry/integrals/edge_motion.hpp"
#include "geometry/integrals/edge_panels.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/in_order.hpp"

// Computes signals of smooth facets: the pulse is integrated along the edges of visible polygons in the
// Kirchhoff approximation. Source: docs/notes/smooth-surfaces.md, "A pulse along the edges".

namespace tubefoot {
namespace {

/// Polygons per task. The number determines the order of summation.
constexpr std::size_t smooth_patches_per_task = 256;
constexpr int most_nodes = 24, most_piece_halvings = 40;
/// Largest change of a pattern's phase over a piece, in rad.
constexpr double most_pattern_rad = 0.15;
/// Largest product of half the band and half the range of paths in a piece, in rad, if the surface depends
/// on the angle.
constexpr double most_uneven_rad = 8;

/// Share of the tolerance for each of four errors that add up: delays, quadratures, breaks and the far
/// field.
constexpr double each_error = 0.2;

/// Pulse as a function of path length.
struct ReceivedPulse {
  const BasebandPulse& pulse;
  PulseTable table;
  double carrier_rad_m, part_rad_m, band_rad_m, sound_speed_m_s;
  /// Derivative of the pulse by time; for derivatives of signals.
  std::optional<BasebandPulse> rate{};
  std::optional<PulseTable> rate_table{};

  ReceivedPulse(const CoherentReceiver& receiver, double tolerance)
      : pulse(receiver.pulse),
        table(receiver.pulse, receiver.times, each_error * tolerance),
        carrier_rad_m(2 * pi * receiver.carrier_hz / receiver.sound_speed_m_s),
        part_rad_m(pi * receiver.pulse.part_bandwidth_hz.value_or(receiver.pulse.bandwidth_hz) /
                   receiver.sound_speed_m_s),
        band_rad_m(pi * receiver.pulse.bandwidth_hz / receiver.sound_speed_m_s),
        sound_speed_m_s(receiver.sound_speed_m_s) {}

  /// Bound of the envelope's change of phase over half of a stretch of paths without a break.
  double turn_rad(double half_m) const {
    const double flank_m = pulse.flank_s * sound_speed_m_s;
    return part_rad_m * half_m + (flank_m > 0 ? pi / 2 * std::min(1.0, 2 * half_m / flank_m) : 0);
  }
  /// Whether polynomials with this number of nodes, and the table's interpolation, may extend over a break
  /// within stretches of this half length.
  bool may_cross(const PulseBreak& at, int nodes, double half_m, double error) const {
    const double half_s = half_m / sound_speed_m_s, of_table = table.reach_s() / 4,
                 square = 1.5 / (double(nodes) * nodes) * half_s * half_s + of_table * of_table;
    return at.step + at.bend_per_s2 * square <= error * table.peak();
  }
};

/// Number of Chebyshev nodes that interpolate e^{i turn x}, |x| <= 1, within an error. The remainder is at
/// most turn^n / (2^(n-1) n!).
int chebyshev_nodes_for(double turn_rad, double error) {
  double left = 2;
  for (int n = 1; n < most_nodes; ++n) {
    left *= turn_rad / (2 * n);
    if (left <= error) return n;
  }
  return most_nodes;
}

/// Effect of a rough surface on a path: a mean over Gaussian path differences, by the trapezoidal rule.
struct PathShift {
  double longer_m = 0;
  std::complex<double> weight = 1;
};

/// Appends both halves of a polygon, cut across a direction.
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

/// Polygons of one channel, one after the other: their signals, or the derivatives of their signals by
/// parameters. Each column is a sum of delayed copies of a pulse. Signals have one column. Each parameter has
/// two, of the pulse and of its derivative by time.
class ChannelOfSmooth {
 public:
  ChannelOfSmooth(const SignalChannel& channel, const CoherentReceiver& receiver,
                  const ReceivedPulse& received, const EchoModel& model, double tolerance,
                  std::span<const SignalParameter> parameters = {}, std::size_t number = 0)
      : channel_(channel),
        receiver_(receiver),
        received_pulse_(received),
        path_(model.path),
        absorption_per_m_(absorption_per_m(model.absorption_db_per_m)),
        tolerance_(tolerance),
        sent_(amplitude_wavenumber(channel.transmit) + amplitude_wavenumber(model.path.tx.loss)),
        received_(amplitude_wavenumber(channel.receive) + amplitude_wavenumber(model.path.back().loss)),
        parameters_(parameters),
        number_(number) {
    if (parameters.empty()) columns_.push_back({&received.pulse, &received.table, 0});
    for (std::size_t n = 0; n < parameters.size(); ++n) {
      columns_.push_back({&received.pulse, &received.table, n * receiver.times.count});
      columns_.push_back({&*received.rate, &*received.rate_table, n * receiver.times.count});
    }
    strength_.resize(columns_.size());
    const double reach = receiver.pulse.end_s - receiver.pulse.begin_s;
    first_m_ = (receiver.times.first_s - receiver.pulse.end_s - reach) * receiver.sound_speed_m_s;
    last_m_ = (receiver.times.time_s(receiver.times.count) - receiver.pulse.begin_s + reach) *
              receiver.sound_speed_m_s;
  }

  /// `out`: samples, or samples of all parameters.
  void add(const VisiblePolygons& seen, const VisiblePolygon& patch, const SmoothSurface& surface,
           std::complex<double>* out) {
    const glm::dvec3 transmit = channel_.transmit_m - seen.origin_m,
                     receive = channel_.receive_m - seen.origin_m;
    plane_ = {patch.normal, patch.distance_m + glm::dot(patch.normal, transmit)};
    rx_.distance = patch.distance_m + glm::dot(patch.normal, receive);
    if (!(plane_.distance_m > 0) || !(rx_.distance > 0)) return;
    const PlaneFrame frame(plane_);
    frame_ = &frame;
    rx_.foot = frame.project(receive - transmit);
    back_m_ = receive - transmit;
    const auto corners = seen.corners(patch);
    corners_.assign(corners.begin(), corners.end());
    for (glm::dvec3& corner : corners_) corner -= transmit;
    pieces_.resize(1);
    pieces_[0].assign(corners_, plane_, frame);
    halvings_.assign(1, 0);
    velocity_.clear();
    for (const SignalParameter& parameter : parameters_)
      velocity_.push_back(velocity_on_plane(parameter, std::size_t(&patch - seen.patches.data()), number_,
                                            pieces_[0], rx_, frame, plane_.normal, transmit, receive));
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
  struct Column {
    const BasebandPulse* pulse;
    const PulseTable* table;
    std::size_t first;  ///< first sample
  };

  void add(const PlanarPolygon& piece, const SmoothSurface& surface, int halvings,
           std::complex<double>* out) {
    if (piece.offsets.size() < 3) return;
    const auto [half_shortest, half_longest] = PathCutter::half_paths_of(piece, rx_);
    if (2 * half_longest < first_m_ || 2 * half_shortest > last_m_) return;
    const double path = half_shortest + half_longest, half_spread = half_longest - half_shortest;
    const glm::dvec2 place = place_of_shortest_path(piece, rx_);
    const double tx_m = std::hypot(piece.distance, place.x, place.y),
                 back_m = std::hypot(rx_.distance, place.x - rx_.foot.x, place.y - rx_.foot.y);
    const double sine = (piece.distance / tx_m + rx_.distance / back_m) / 2,
                 rough_m = 2 * sine * surface.roughness_m,
                 lowest = std::max(received_pulse_.carrier_rad_m - received_pulse_.band_rad_m, 0.0);
    if (std::pow(lowest * rough_m, 2) > 80) return;  // a factor of 4e-18 remains
    const bool uneven = (surface.fluid || surface.roughness_m > 0) &&
                        received_pulse_.band_rad_m * half_spread > most_uneven_rad;
    if (halvings < most_piece_halvings && (uneven || pattern_changes(piece, tx_m, back_m))) {
      halve(piece, across(piece, uneven), pieces_);
      return;
    }
    // The edges of a polygon that is small relative to the wavelength nearly cancel.
    const double k = received_pulse_.carrier_rad_m, size = std::sqrt(std::abs(area(piece)));
    error_ = std::max(each_error * tolerance_ * std::min(1.0, k * size / 4), 1e-13);
    SmoothSurface mirror = surface;
    mirror.roughness_m = 0;
    factor_ = received_part(piece) * mirror.factor(sine, k);
    take_shifts(rough_m);
    if (parameters_.empty() && is_small(half_spread)) {
      const FarAmplitude far = far_amplitude(piece, rx_, k);
      if (far.error <= each_error * tolerance_ * far.most) {
        const std::complex<double> amplitude =
            factor_ * std::exp(-absorption_per_m_ * path / 2) * far.pressure;
        for (const PathShift& shift : shifts_)
          received_pulse_.table.add(amplitude * shift.weight,
                                    (path + shift.longer_m) / receiver_.sound_speed_m_s, out);
        return;
      }
    }
    // Panels are wide enough that pulses are not added more often than their band requires.
    const double most_spread = 2 * pi / received_pulse_.band_rad_m;
    placed_rx_ = rx_;
    if (!parameters_.empty()) {
      const PlacedReceiver placed = beside_border(piece, rx_, k);
      placed_rx_ = placed.rx;
      // Near the border, derivatives of weights grow with the inverse square of this phase, and cancel.
      error_ *= placed.border_rad * placed.border_rad;
    }
    edges_.assign(piece, placed_rx_, k + absorption_per_m_ / 2, most_spread);
    if (!parameters_.empty()) motion_.emplace(piece, placed_rx_);
    add_image(out);
    for (const EdgePanels::Panel& panel : edges_.panels()) add(panel, out);
  }

  /// Whether one delay suffices for a whole piece.
  bool is_small(double half_spread_m) const {
    const double error = each_error * tolerance_;
    return received_pulse_.turn_rad(half_spread_m) <= error &&
           std::ranges::all_of(receiver_.pulse.breaks, [&](const PulseBreak& at) {
             return received_pulse_.may_cross(at, 1, half_spread_m, error);
           });
  }

  void take_shifts(double rough_m) {
    const double k = received_pulse_.carrier_rad_m, turn = (k + received_pulse_.band_rad_m) * rough_m;
    shifts_.assign(1, {});
    if (!(turn * turn / 2 > 0.1 * error_)) return;
    // The rule's sums of e^{i turn x} contain images of the transform at multiples of 2 pi / step.
    const double reach = std::sqrt(2 * std::log(4 / error_)), step = 2 * pi / (turn + reach);
    const int most = int(std::ceil(reach / step));
    shifts_.clear();
    for (int n = -most; n <= most; ++n) {
      const double x = n * step, longer = x * rough_m;
      shifts_.push_back({longer, std::polar(step / std::sqrt(2 * pi) * std::exp(-x * x / 2), k * longer)});
    }
  }

  /// Phase of a path at the carrier, and its absorption.
  std::complex<double> wave(double path_m) const {
    return std::polar(std::exp(-absorption_per_m_ * path_m / 2), received_pulse_.carrier_rad_m * path_m);
  }
  /// Sets strength_ to the strengths by column of pulses that arrive along a path. `rate_of` returns the
  /// derivatives of path and weight for a velocity.
  template <class RateOf>
  void take_strength(std::complex<double> factor, double path_m, double weight, const RateOf& rate_of) {
    const std::complex<double> arriving = wave(path_m);
    if (parameters_.empty()) {
      strength_[0] = factor * weight * arriving;
      return;
    }
    const double k = received_pulse_.carrier_rad_m;
    for (std::size_t n = 0; n < parameters_.size(); ++n) {
      const SignalParameter& parameter = parameters_[n];
      const EdgeMotion::NodeRate by = rate_of(velocity_[n]);
      // A change of the sound speed changes delays and phases as a change of the path does.
      const double later_m = by.path_m - parameter.by_sound_speed * path_m,
                   fainter =
                       (absorption_per_m_ * by.path_m + absorption_per_m(parameter.by_absorption) * path_m) /
                       2;
      strength_[2 * n] =
          factor * (by.weight + weight * std::complex<double>(-fainter, k * later_m)) * arriving;
      strength_[2 * n + 1] = factor * (-weight * later_m / receiver_.sound_speed_m_s) * arriving;
    }
  }
  void take_strength(std::complex<double> factor, const EdgePanels::Panel& panel,
                     const EdgePanels::Node& node) {
    take_strength(factor, node.path_m, node.weight, [&](const EdgeMotion::Velocity& velocity) {
      return motion_->of_node(edges_.corner_of(panel), node, velocity);
    });
  }

  double sample_of(double time_s) const {
    return (time_s - receiver_.times.first_s) * receiver_.times.rate_hz;
  }
  /// First sample at or after a time.
  std::size_t sample_from(double time_s) const {
    return std::size_t(std::clamp(std::ceil(sample_of(time_s)), 0.0, double(receiver_.times.count)));
  }

  /// Adds the specular contribution, a copy of the pulse at the plane's place of shortest path.
  void add_image(std::complex<double>* out) {
    if (edges_.image() == 0) return;
    take_strength(factor_, edges_.shortest_m(), edges_.image(), [&](const EdgeMotion::Velocity& velocity) {
      const double longer_m = motion_->of_shortest_m(velocity);
      return EdgeMotion::NodeRate{longer_m, -edges_.image() * longer_m / edges_.shortest_m()};
    });
    for (const PathShift& shift : shifts_) {
      const double delay_s = (edges_.shortest_m() + shift.longer_m) / receiver_.sound_speed_m_s;
      const BasebandPulse& pulse = receiver_.pulse;
      for (std::size_t n = sample_from(delay_s + pulse.begin_s), end = sample_from(delay_s + pulse.end_s);
           n <= end && n < receiver_.times.count; ++n)
        for (std::size_t c = 0; c < columns_.size(); ++c)
          out[columns_[c].first + n] +=
              strength_[c] * shift.weight * columns_[c].pulse->at(receiver_.times.time_s(n) - delay_s);
    }
  }

  /// Adds the pulses of a panel: by a polynomial over its delays for samples without a break, and by parts
  /// for the others.
  void add(const EdgePanels::Panel& panel, std::complex<double>* out) {
    const double c = receiver_.sound_speed_m_s, least = panel.least_path_m(), most = panel.most_path_m(),
                 half = (most - least) / 2, turn = received_pulse_.turn_rad(half);
    const int count = chebyshev_nodes_for(turn, error_);
    const double node_error = error_ / 8;
    path_nodes_.clear();
    edges_.nodes(panel, panel.from, panel.to, turn + count, node_error, path_nodes_);
    interpolate(panel, count, (least + most) / 2, half);
    const auto first_of = [&](double time_s, const PathShift& shift) {
      return time_s + (least + shift.longer_m) / c - received_pulse_.table.reach_s();
    };
    for (const PathShift& shift : shifts_) {
      // Samples with a break, in the order of the breaks.
      std::size_t next = 0;
      const double longer_s = 2 * half / c + 2 * received_pulse_.table.reach_s();
      const auto add_until = [&](std::size_t end) {
        for (std::size_t column = 0; column < columns_.size() && next < end; ++column)
          for (std::size_t n = 0; n < delay_m_.size(); ++n)
            columns_[column].table->add(coefficients_[column * delay_m_.size() + n] * shift.weight,
                                        (delay_m_[n] + shift.longer_m) / c, next, end,
                                        out + columns_[column].first);
        next = std::max(next, end);
      };
      for (const PulseBreak& at : receiver_.pulse.breaks) {
        if (received_pulse_.may_cross(at, count, half, error_)) continue;
        const double begin_s = first_of(at.time_s, shift);
        const std::size_t end = sample_from(begin_s + longer_s);
        add_until(sample_from(begin_s));
        for (; next < end; ++next) add_by_parts(panel, next, shift, out);
      }
      add_until(receiver_.times.count);
    }
  }

  /// Coefficients of the pulses at Chebyshev delays, which together represent the panel's nodes.
  void interpolate(const EdgePanels::Panel& panel, int count, double middle_m, double half_m) {
    const auto n = std::size_t(count);
    moments_.assign(columns_.size() * n, 0);
    for (const EdgePanels::Node& node : path_nodes_) {
      take_strength(factor_, panel, node);
      const double x = half_m > 0 ? (node.path_m - middle_m) / half_m : 0;
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        std::complex<double>* moments = &moments_[c * n];
        double before = 1, value = x;
        moments[0] += strength_[c];
        for (std::size_t m = 1; m < n; ++m) {
          moments[m] += value * strength_[c];
          before = std::exchange(value, 2 * x * value - before);
        }
      }
    }
    coefficients_.assign(columns_.size() * n, 0);
    delay_m_.resize(n);
    for (std::size_t a = 0; a < n; ++a) {
      const double angle = pi * (double(a) + 0.5) / count;
      delay_m_[a] = middle_m + half_m * std::cos(angle);
      for (std::size_t m = 0; m < n; ++m) {
        const double share = (m == 0 ? 1.0 : 2.0) / count * std::cos(double(m) * angle);
        for (std::size_t c = 0; c < columns_.size(); ++c)
          coefficients_[c * n + a] += share * moments_[c * n + m];
      }
    }
  }

  /// Adds one sample of a panel, which is cut at its breaks.
  void add_by_parts(const EdgePanels::Panel& panel, std::size_t sample, const PathShift& shift,
                    std::complex<double>* out) {
    const double c = receiver_.sound_speed_m_s, least = panel.least_path_m(), most = panel.most_path_m(),
                 time_s = receiver_.times.time_s(sample) - shift.longer_m / c;
    cuts_.assign(1, {panel.from, panel.from_path_m});
    for (const PulseBreak& at : receiver_.pulse.breaks) {
      const double path = c * (time_s - at.time_s);
      if (path > least && path < most) cuts_.push_back({edges_.place_of(panel, path), path});
    }
    cuts_.push_back({panel.to, panel.to_path_m});
    std::ranges::sort(cuts_);
    path_nodes_.clear();
    for (std::size_t n = 1; n < cuts_.size(); ++n) {
      const double half_m = std::abs(cuts_[n].second - cuts_[n - 1].second) / 2;
      edges_.nodes(panel, cuts_[n - 1].first, cuts_[n].first, received_pulse_.turn_rad(half_m), error_ / 8,
                   path_nodes_);
    }
    sums_.assign(columns_.size(), 0);
    for (const EdgePanels::Node& node : path_nodes_) {
      const double after_s = time_s - node.path_m / c;
      if (receiver_.pulse.at(after_s) == 0.0) continue;
      take_strength(1, panel, node);
      for (std::size_t column = 0; column < columns_.size(); ++column)
        sums_[column] += strength_[column] * columns_[column].pulse->at(after_s);
    }
    for (std::size_t column = 0; column < columns_.size(); ++column)
      out[columns_[column].first + sample] += shift.weight * (factor_ * sums_[column]);
  }

  bool pattern_changes(const PlanarPolygon& piece, double tx_m, double back_m) const {
    if (sent_ == 0 && received_ == 0) return false;
    const glm::dvec2 middle = centroid_offset(piece);
    double reach = 0;
    for (const glm::dvec2& offset : piece.offsets) reach = std::max(reach, glm::length(offset - middle));
    return reach * (sent_ / tx_m + received_ / back_m) > most_pattern_rad;
  }

  /// Direction across which a piece is cut. It is the direction in which paths differ most, along their
  /// slope or their curvature across the slope, or the longest direction of the piece.
  glm::dvec2 across(const PlanarPolygon& piece, bool for_paths) const {
    const glm::dvec2 offset = centroid_offset(piece), middle = piece.first + offset;
    glm::dvec2 longest(0);
    for (const glm::dvec2& corner : piece.offsets)
      if (glm::dot(corner - offset, corner - offset) > glm::dot(longest, longest)) longest = corner - offset;
    if (!for_paths) return glm::normalize(longest);
    const glm::dvec2 from_foot = middle - rx_.foot;
    const double tx_m = std::hypot(piece.distance, middle.x, middle.y),
                 back_m = std::hypot(rx_.distance, from_foot.x, from_foot.y);
    const glm::dvec2 slope = middle / tx_m + from_foot / back_m;
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
    const double bend = (1 / tx_m + 1 / back_m) / 8, length = extent(along), width = extent(aside);
    return (steep + bend * length) * length >= bend * width * width ? along : aside;
  }

  /// Amplitude factor of patterns and mirrors towards the centroid.
  double received_part(const PlanarPolygon& piece) const {
    if (channel_.transmit.kind == Directivity::Kind::uniform &&
        channel_.receive.kind == Directivity::Kind::uniform && !path_.over_mirrors())
      return 1;
    const glm::dvec2 place = piece.first + centroid_offset(piece);
    const glm::dvec3 there = -plane_.distance_m * plane_.normal + place.x * frame_->u + place.y * frame_->v;
    const glm::dvec3 tx = glm::normalize(there), rx = glm::normalize(there - back_m_);
    return std::sqrt(path_.tx.loss.at(tx) * path_.back().loss.at(rx)) *
           amplitude_pattern(channel_.transmit, tx) * amplitude_pattern(channel_.receive, rx);
  }

  const SignalChannel& channel_;
  const CoherentReceiver& receiver_;
  const ReceivedPulse& received_pulse_;
  const Path& path_;
  double absorption_per_m_, tolerance_;
  double sent_, received_;  // wave numbers of patterns
  std::span<const SignalParameter> parameters_;
  std::size_t number_;  // of the channel
  std::vector<Column> columns_;
  double first_m_ = 0, last_m_ = 0;  // range of received paths
  // Values of the current polygon; the transmitter is the origin.
  FacetPlane plane_;
  const PlaneFrame* frame_ = nullptr;
  PathCutter::Receiver rx_;
  glm::dvec3 back_m_{0};
  std::vector<glm::dvec3> corners_;
  std::vector<PlanarPolygon> pieces_;
  std::vector<int> halvings_;
  std::vector<EdgeMotion::Velocity> velocity_;  // by parameter
  // Values of the current piece.
  std::complex<double> factor_;
  double error_ = 0;
  EdgePanels edges_;
  PathCutter::Receiver placed_rx_;
  std::optional<EdgeMotion> motion_;
  std::vector<PathShift> shifts_;
  std::vector<EdgePanels::Node> path_nodes_;
  std::vector<std::pair<double, double>> cuts_;  // places and their path lengths
  std::vector<double> delay_m_;
  std::vector<std::complex<double>> moments_, coefficients_;  // [column][order]
  std::vector<std::complex<double>> strength_, sums_;         // by column
};

/// Computes the columns of all channels: [channel][column sample].
std::vector<std::complex<double>> sum_channels(const VisiblePolygons& patches,
                                               const CoherentReceiver& receiver, const EchoModel& model,
                                               const std::function<const SmoothSurface*(FacetId)>& surface_of,
                                               double tolerance,
                                               std::span<const SignalParameter> parameters = {}) {
  check(receiver, model);
  if (!(tolerance >= 1e-9 && tolerance <= 0.1))
    throw std::invalid_argument(fmt::format("the tolerance must be from 1e-9 to 0.1, not {}", tolerance));
  if (!(receiver.pulse.bandwidth_hz < 2 * receiver.carrier_hz))
    throw std::invalid_argument(
        fmt::format("a band of {} Hz around {} Hz reaches down to frequency 0: use a pulse with a bandwidth "
                    "below twice the carrier frequency",
                    receiver.pulse.bandwidth_hz, receiver.carrier_hz));
  std::vector<std::pair<const VisiblePolygon*, const SmoothSurface*>> smooth;
  for (const VisiblePolygon& patch : patches.patches)
    if (const SmoothSurface* surface = surface_of(patch.facet)) smooth.emplace_back(&patch, surface);
  const std::size_t per_channel = receiver.times.count * std::max<std::size_t>(parameters.size(), 1);
  std::vector<std::complex<double>> sums(receiver.channels.size() * per_channel);
  if (smooth.empty()) return sums;
  ReceivedPulse received(receiver, tolerance);
  if (!parameters.empty()) {
    received.rate = receiver.pulse.rate();
    received.rate_table.emplace(*received.rate, receiver.times, each_error * tolerance);
  }
  const std::size_t tasks = (smooth.size() + smooth_patches_per_task - 1) / smooth_patches_per_task;
  in_order(
      0, receiver.channels.size() * tasks, 16 * per_channel,
      [&](std::size_t task) {
        std::vector<std::complex<double>> part(per_channel);
        ChannelOfSmooth channel(receiver.channels[task / tasks], receiver, received, model, tolerance,
                                parameters, task / tasks);
        const std::size_t begin = task % tasks * smooth_patches_per_task,
                          end = std::min(begin + smooth_patches_per_task, smooth.size());
        for (std::size_t n = begin; n < end; ++n)
          channel.add(patches, *smooth[n].first, *smooth[n].second, part.data());
        return part;
      },
      [&](std::size_t task, const std::vector<std::complex<double>>& part) {
        std::complex<double>* row = &sums[task / tasks * per_channel];
        for (std::size_t k = 0; k < part.size(); ++k) row[k] += part[k];
      });
  return sums;
}

}  // namespace

ChannelSignals smooth_signals(const VisiblePolygons& patches, const CoherentReceiver& receiver,
                              const EchoModel& model,
                              const std::function<const SmoothSurface*(FacetId)>& surface_of,
                              double tolerance) {
  return {receiver.channels.size(), receiver.times.count,
          sum_channels(patches, receiver, model, surface_of, tolerance)};
}

std::vector<ChannelSignals> smooth_signal_derivatives(
    const VisiblePolygons& patches, const CoherentReceiver& receiver, const EchoModel& model,
    const std::function<const SmoothSurface*(FacetId)>& surface_of,
    std::span<const SignalParameter> parameters, double tolerance) {
  if (!receiver.pulse.slope ||
      std::ranges::any_of(receiver.pulse.breaks, [](const PulseBreak& at) { return at.step > 0; }))
    throw std::invalid_argument("derivatives of signals need a pulse with flanks and with a slope");
  for (const VisiblePolygon& patch : patches.patches)
    if (const SmoothSurface* surface = surface_of(patch.facet);
        surface != nullptr && !std::ranges::all_of(receiver.channels, [&](const SignalChannel& channel) {
          return CertifiedSmoothSignals::can_bound(*surface, channel, model.path);
        }))
      throw std::invalid_argument(
          "derivatives of signals need reflection without roughness and without a fluid, ends at rest, and "
          "no patterns and mirrors");
  std::vector<ChannelSignals> all;
  if (parameters.empty()) return all;
  const std::vector<std::complex<double>> sums =
      sum_channels(patches, receiver, model, surface_of, tolerance, parameters);
  const std::size_t count = receiver.times.count;
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    ChannelSignals& signals = all.emplace_back(ChannelSignals{receiver.channels.size(), count, {}});
    for (std::size_t channel = 0; channel < signals.channels; ++channel) {
      const auto row = sums.begin() + std::ptrdiff_t((channel * parameters.size() + n) * count);
      signals.value.insert(signals.value.end(), row, row + std::ptrdiff_t(count));
    }
  }
  return all;
}

}  // namespace tubefoot
