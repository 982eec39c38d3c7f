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
  energy_centroid,  ///< the mean range of the samples of one echo that count, weighted by energy
  maximum,          ///< the vertex of the parabola through the largest sample and its neighbours
  split_beam,       ///< zero of the phase between a beam's halves; needs signals (split_beam_zero), not
                    ///< energies
};

/// Name in tables of soundings: "first_return", "energy_centroid", "maximum" or "split_beam".
const char* name_of(DetectionMethod method);
/// The method of that name, as scene files give it: one of the first three. Throws std::invalid_argument for
/// another name.
DetectionMethod detection_method_from_name(std::string_view name);

/// Selects the samples of a beam that count. Their middle lies in the range gate, and their energy is above
/// 0 and reaches both thresholds.
struct DetectionRule {
  DetectionMethod method = DetectionMethod::energy_centroid;
  double relative_db = -20;  ///< energy relative to the beam's largest sample in the gate; at most 0
  double absolute_j = 0;     ///< threshold of received energy density, in J/m^2
  double nearest_m = 0, farthest_m = std::numeric_limits<double>::infinity();  ///< range gate
};

/// Reasons to doubt a detection.
enum class DetectionFlag : std::uint8_t {
  /// The echo begins or ends so close to a border of the gate that a part of the echo may lie outside. The
  /// limit is the widest gap between the samples of the echo, but at least one sample.
  cut_by_window = 1,
  /// Another echo in the gate has at least a tenth of the energy of this echo. The flag is also set if the
  /// centroid fell into a gap of the echo and was moved by more than two samples.
  several_echoes = 2,
};

/// A set of flags. An empty set means that nothing speaks against the detection.
class DetectionFlags {
 public:
  bool has(DetectionFlag flag) const { return (bits_ & static_cast<std::uint8_t>(flag)) != 0; }
  void set(DetectionFlag flag) { bits_ |= static_cast<std::uint8_t>(flag); }
  bool empty() const { return bits_ == 0; }
  bool operator==(const DetectionFlags&) const = default;

 private:
  std::uint8_t bits_ = 0;
};

/// Name in tables of soundings: "good", "cut_by_window", "several_echoes" or "cut_by_window+several_echoes".
const char* name_of(DetectionFlags flags);

/// A detection of the bottom in one beam.
struct Detection {
  double range_m = 0;  ///< slant range
  /// Standard deviation of the range. The position of an echo is uniform in its sample: step / sqrt(12). The
  /// variance of a centroid is the sum of w^2 ((r - range)^2 + step^2 / 12) over its samples with the energy
  /// shares w. This formula treats each energy as one look at fully developed speckle.
  double range_sigma_m = 0;
  int sample = 0;       ///< sample that contains the range; it counts
  double energy_j = 0;  ///< energy of the largest sample on which the detection rests
  DetectionFlags flags;
  /// 1 - rms / (length / sqrt(12)), at least 0. It compares the rms distance of the gate's energy from the
  /// detection with that of uniform noise from the middle of the gate. The value 1 means that all energy is
  /// at the detection.
  double quality = 0;
};

/// Detects the bottom in one beam's energies [J/m^2]. Returns nothing if no sample counts. The nearest of
/// equal largest samples is the maximum.
///
/// The samples that count form one echo or several. Their widest gap separates two echoes if it is longer
/// than the number of counting samples on its smaller side. The same rule applies again to the selected
/// part. A shadow or a null of the speckle within an echo therefore separates nothing, and the water between
/// a target and the seabed does. The selected part contains the first return or the maximum. For a centroid
/// it is the part of more energy, or the nearer of equal parts. A centroid uses only its own echo. If it
/// falls into a gap of that echo, the range is the middle of the nearest sample that counts.
///
/// Throws std::invalid_argument for negative or non-finite energies, for a number of energies other than
/// `samples.count`, for samples without length, or for an invalid rule.
std::optional<Detection> detect_bottom(std::span<const double> energies_j, const RangeSamples& samples,
                                       const DetectionRule& rule = {});

/// Position at a slant range on a beam's axis, along a straight ray, in the frame of the pose. `beam_axis`
/// is a direction in the sensor's frame. Throws std::invalid_argument if its length is not 1 to 1e-6, or for
/// a negative or non-finite range.
glm::dvec3 sounding_position(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m);

}  // namespace tubefoot
