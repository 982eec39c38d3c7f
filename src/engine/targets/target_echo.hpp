// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "engine/certified/reference.hpp"
#include "engine/echo/echo.hpp"
#include "engine/echo/sample_finder.hpp"
#include "geometry/numbers/interval.hpp"

namespace tubefoot {

/// One leg between an end of a path and a target, in doubles or in intervals.
template <class N>
struct TargetLeg {
  N range_m{};                   ///< length, or travel time multiplied by the reference sound speed
  N intensity_per_m2{};          ///< one-way loss: spreading and absorption
  std::array<N, 3> direction{};  ///< unit vector at the end of the path
};

/// Returns the straight leg along a vector in metres, whose coordinates are exact or enclosed, with the
/// absorption of the model.
template <class N>
TargetLeg<N> straight_leg(const std::array<N, 3>& from_end_m, const EchoModel& model);
extern template TargetLeg<double> straight_leg(const std::array<double, 3>&, const EchoModel&);
extern template TargetLeg<Interval> straight_leg(const std::array<Interval, 3>&, const EchoModel&);

/// Range bins [first, end) of a target. If a bound does not decide between bins, or between a bin and the
/// outside, all possible bins are given and none is certain.
struct TargetBins {
  std::size_t first = 0, end = 0;
  bool certain = true;
  bool operator==(const TargetBins&) const = default;
};

/// Returns the bin of a monostatic echo, by exact comparison of the squared range with the squared borders.
/// A target on a border belongs to the farther bin. Empty outside of the bins. The grid unit is a power of
/// two.
std::optional<TargetBins> bin_of_range(const SampleFinder& samples, GridPoint apex, GridPoint target,
                                       double grid_unit_m);
/// Returns the bin of a half path, or all bins of an interval. Empty if the path is certainly outside of all
/// bins.
std::optional<TargetBins> bin_of_half_path(const SampleFinder& samples, double half_path_m);
std::optional<TargetBins> bin_of_half_path(const SampleFinder& samples, const Interval& half_path_m);

/// Half paths of a target for three positions of a receiver that moves. The first and the last position are
/// those at the times of the borders of an interval of the record. The third is that in its middle.
template <class N>
struct MovingHalfPaths {
  N at_begin_m{}, at_middle_m{}, at_end_m{};
};
/// Returns the bin of a target in one interval of a divided record. The interval contains the target on two
/// conditions. The half path at its begin must not be less than its first border. The half path at its end
/// must be less than `end_m`. The next interval starts at `end_m` and compares the same numbers. Exactly one
/// interval therefore contains the target, unless the receiver is as fast as sound. The half path in the
/// middle selects the bin, which is limited to the interval.
std::optional<TargetBins> bin_of_moving_receiver(const SampleFinder& samples, double end_m,
                                                 const MovingHalfPaths<double>& half_paths);
std::optional<TargetBins> bin_of_moving_receiver(const SampleFinder& samples, double end_m,
                                                 const MovingHalfPaths<Interval>& half_paths);

/// Sum of the echoes of targets per beam and range bin, for sensors with one receiver.
/// N: double, or Interval for a certified sum.
template <class N>
class TargetEchoSum {
 public:
  /// The arguments must outlive this object. `model`: patterns and absorption; surfaces are not used.
  TargetEchoSum(const ReceiveBeams& beams, const SampleFinder& samples, const EchoModel& model);

  /// Adds the echo of a target with this cross-section. `tx_tubes` and `rx_tubes` contain the target. With
  /// one apex (`same_tube`), the echo returns through the tube through which the sound left. Otherwise it
  /// returns through each receive tube of the same fan.
  void add(const N& cross_section_m2, const TargetLeg<N>& tx, const TargetLeg<N>& rx, const TargetBins& bins,
           std::span<const std::uint32_t> tx_tubes, std::span<const std::uint32_t> rx_tubes, bool same_tube);

  /// Returns the sums [beam][sample].
  const std::vector<N>& sums() const { return sums_; }
  /// Returns whether a target was added to any bin.
  bool has_any() const { return has_any_; }

 private:
  void add_to(std::uint32_t beam, const TargetBins& bins, const N& energy);

  const ReceiveBeams& beams_;
  std::size_t samples_;
  const EchoModel& model_;
  std::vector<N> sums_;
  bool has_any_ = false;
};
extern template class TargetEchoSum<double>;
extern template class TargetEchoSum<Interval>;

/// Sum of the echoes of targets for one fan with a receiver pair: the rows of rows_of(ReceiverPairEcho).
template <class N>
class TargetPairSum {
 public:
  /// The arguments must outlive this object. `fan` is the fan and the beam of model.patterns.
  TargetPairSum(const ReceiverBaseline& receiver_pair, std::uint32_t fan, const SampleFinder& samples,
                const EchoModel& model);

  /// Adds a target. The vectors lead from the transmitter and from the middle of the receiver pair to the
  /// target. A receiver that does not see the target receives nothing. The cross product has the phase
  /// exp(i k (r_upper - r_lower)), for a target in the same bin of both receivers.
  void add(const N& cross_section_m2, glm::dvec3 from_transmitter_m, glm::dvec3 from_middle_m,
           bool seen_by_upper, bool seen_by_lower);
  /// Returns the sums [row][sample]: upper and lower energy, real and imaginary part of the product.
  const std::vector<N>& sums() const { return sums_; }
  bool has_any() const { return has_any_; }

 private:
  void add_to(std::size_t row, std::size_t sample, const N& value, bool certain);

  const ReceiverBaseline& receiver_pair_;
  std::uint32_t fan_;
  const SampleFinder& samples_;
  const EchoModel& model_;
  std::vector<N> sums_;
  bool has_any_ = false;
};
extern template class TargetPairSum<double>;
extern template class TargetPairSum<Interval>;

/// Converts enclosures of `rows` rows to energies with bounds.
CertifiedEcho certified_echo_of(std::span<const Interval> sums, std::size_t rows);

}  // namespace tubefoot
