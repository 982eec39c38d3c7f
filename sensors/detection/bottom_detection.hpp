// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "engine/scattering/range_samples.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

enum class DetectionMethod {
  first_return,     ///< the middle of the first sample that counts
  energy_centroid,  ///< the mean range of the samples of one echo that count, weighed by energy
  maximum,          ///< the top of the parabola through the largest sample and its neighbours
  split_beam,       ///< where the phase between a beam's halves is zero: of signals (split_beam_zero), not of
                    ///< energies
};

/// Name as in scene files and in tables of soundings: "first_return", "energy_centroid", "maximum".
const char* name_of(DetectionMethod method);
/// The method of that name; throws std::invalid_argument.
DetectionMethod detection_method_from_name(std::string_view name);

/// Which of a beam's samples count: those whose middle lies in the range gate and whose energy is above 0 and
/// reaches both thresholds.
struct DetectionRule {
  DetectionMethod method = DetectionMethod::energy_centroid;
  double relative_db = -20;  ///< energy over that of the beam's largest sample in the gate; at most 0
  double absolute_j = 0;     ///< energy
  double nearest_m = 0, farthest_m = std::numeric_limits<double>::infinity();  ///< range gate
};

/// What makes a detection doubtful.
enum class DetectionFlag : std::uint8_t {
  cut_by_window = 1,   ///< its echo reaches the first or the last sample of the gate: more of it lies outside
  several_echoes = 2,  ///< another echo, apart from this one, has a tenth of its energy or more
};

/// A set of flags; none: nothing speaks against the detection.
class DetectionFlags {
 public:
  bool has(DetectionFlag flag) const { return (bits_ & static_cast<std::uint8_t>(flag)) != 0; }
  void set(DetectionFlag flag) { bits_ |= static_cast<std::uint8_t>(flag); }
  bool empty() const { return bits_ == 0; }
  bool operator==(const DetectionFlags&) const = default;

 private:
  std::uint8_t bits_ = 0;
};

/// As in tables of soundings: "good", "cut_by_window", "several_echoes" or "cut_by_window+several_echoes".
const char* name_of(DetectionFlags flags);

/// Where a beam found the bottom.
struct Detection {
  double range_m = 0;  ///< slant range
  /// Standard deviation of the range. An echo lies anywhere in its sample: step / sqrt(12). A centroid has
  /// the sum of w^2 ((r - range)^2 + step^2 / 12) over its samples as variance, w their shares of the energy:
  /// each energy is taken for one look at fully developed speckle.
  double range_sigma_m = 0;
  int sample = 0;       ///< that holds the range; it counts
  double energy_j = 0;  ///< of the largest sample that the detection rests upon
  DetectionFlags flags;
  /// 1 - rms / (length / sqrt(12)), at least 0: rms distance of the energy in the gate from the detection,
  /// over that of noise spread evenly over the gate. 1: all energy is there.
  double quality = 0;
};

/// The bottom in one beam's energies [J], or none if no sample counts. Of equal largest samples the nearest
/// is the maximum.
///
/// The samples that count are one echo or several: their widest gap parts them if it is longer than what
/// counts on the lesser side of it, in samples, and so on in the part that is kept. So a shadow or a null of
/// the speckle within an echo parts nothing, and the water between a target and the seabed does. Kept is what
/// holds the first return or the maximum; for a centroid the part of more energy, the nearer of equal ones. A
/// centroid rests on its echo alone; where it falls into a gap of that, the range is the nearest border of a
/// sample that counts.
///
/// Throws std::invalid_argument for energies that are negative or not finite, a number of
/// them other than `samples.count`, samples without length, or a rule that is none.
std::optional<Detection> detect_bottom(std::span<const double> energies_j, const RangeSamples& samples,
                                       const DetectionRule& rule = {});

/// The place at a slant range on a beam's axis, along a straight ray, in the frame of the pose. `beam_axis`
/// is a direction in the sensor's frame. Throws std::invalid_argument if its length is not 1 to 1e-6, or for
/// a range that is negative or not finite.
glm::dvec3 sounding_position(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m);

}  // namespace tubefoot
