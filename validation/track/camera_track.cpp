// SPDX-License-Identifier: GPL-3.0-or-later
// Estimates the track of a camera from its frames: projects each frame onto a flat seabed and correlates
// consecutive pictures. The shift of the contents is the negative step of the camera.
#include "track/camera_track.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace tubefoot {
namespace {

constexpr double unseen = std::numeric_limits<double>::quiet_NaN();

/// Horizontal unit vectors of the heading of a pose.
struct Heading {
  explicit Heading(const Pose& pose) {
    const glm::dvec3 forward = pose.attitude * glm::dvec3(0, 1, 0);
    ahead = glm::normalize(glm::dvec3(forward.x, forward.y, 0));
    starboard = glm::dvec3(ahead.y, -ahead.x, 0);
  }
  glm::dvec3 ahead, starboard;
};

/// Returns the elevation, in the axes of the camera, at which a beam meets the seabed at a slant range.
/// Returns nothing if the beam does not meet it there.
std::optional<double> elevation_at(const Pose& pose, double height_m, double azimuth_rad, double range_m) {
  const double level = (pose.attitude * glm::dvec3(std::sin(azimuth_rad), std::cos(azimuth_rad), 0)).z,
               up = (pose.attitude * glm::dvec3(0, 0, 1)).z, most = std::hypot(level, up);
  const double cosine = -height_m / (range_m * most);
  if (std::abs(cosine) > 1) return {};
  // level cos e + up sin e = most cos(e - middle)
  const double middle = std::atan2(up, level), turn = std::acos(cosine);
  const double one = std::remainder(middle + turn, 2 * std::numbers::pi),
               other = std::remainder(middle - turn, 2 * std::numbers::pi);
  return std::abs(one) < std::abs(other) ? one : other;
}

/// Returns energies divided by the mean of their range, minus 1, where the seabed fills the beam.
std::vector<double> flattened(const Sensor& sensor, const Pose& pose, double height_m,
                              std::span<const double> energies) {
  constexpr double inner = 0.95;  // share of the height of the beam
  const auto samples = static_cast<std::size_t>(sensor.samples().count);
  std::vector<double> flat(energies.size(), unseen);
  for (std::size_t k = 0; k < samples; ++k) {
    const double range_m =
        sensor.samples().first_m + (static_cast<double>(k) + 0.5) * sensor.samples().step_m;
    std::vector<std::size_t> filled;
    double sum = 0;
    for (std::size_t b = 0; b < sensor.beams().size(); ++b) {
      const BeamAxis& beam = sensor.beams()[b];
      const auto elevation = elevation_at(pose, height_m, beam.azimuth_rad, range_m);
      if (!elevation || std::abs(*elevation - beam.elevation_rad) > inner * beam.elevation_width_rad / 2)
        continue;
      filled.push_back(b * samples + k);
      sum += energies[b * samples + k];
    }
    if (!(sum > 0)) continue;
    for (const std::size_t bin : filled)
      flat[bin] = energies[bin] * static_cast<double>(filled.size()) / sum - 1;
  }
  return flat;
}

/// Finds the energy of a frame at a position in the axes of the camera, by its beam and sample.
class FrameLookup {
 public:
  FrameLookup(const Sensor& sensor, std::vector<double> flat)
      : sensor_(sensor), flat_(std::move(flat)), samples_(static_cast<std::size_t>(sensor.samples().count)) {}

  double at(glm::dvec3 place_m) const {
    const std::vector<BeamAxis>& beams = sensor_.beams();
    const double azimuth = std::atan2(place_m.x, place_m.y);
    const double sample = (glm::length(place_m) - sensor_.samples().first_m) / sensor_.samples().step_m - 0.5;
    const auto after = std::upper_bound(beams.begin(), beams.end(), azimuth,
                                        [](double a, const BeamAxis& beam) { return a < beam.azimuth_rad; });
    if (after == beams.begin() || after == beams.end() || !(sample >= 0)) return unseen;
    const auto b = static_cast<std::size_t>(after - beams.begin()) - 1, k = static_cast<std::size_t>(sample);
    if (k + 1 >= samples_) return unseen;
    const double v = (azimuth - beams[b].azimuth_rad) / (beams[b + 1].azimuth_rad - beams[b].azimuth_rad),
                 u = sample - static_cast<double>(k);
    const auto value = [&](std::size_t beam, std::size_t s) { return flat_[beam * samples_ + s]; };
    return (1 - v) * ((1 - u) * value(b, k) + u * value(b, k + 1)) +
           v * ((1 - u) * value(b + 1, k) + u * value(b + 1, k + 1));
  }

 private:
  const Sensor& sensor_;
  std::vector<double> flat_;
  std::size_t samples_;
};

}  // namespace

PixelMap ground_picture(const Recording& recording, std::size_t ping, std::span<const double> energies,
                        const SurfaceLayout& layout) {
  const Sensor& sensor = *recording.sensor;
  const Pose& pose = recording.ping_pose[ping];
  const RangeSamples& samples = sensor.samples();
  const double height_m = pose.position_m.z - layout.seabed_m,
               reach_m = samples.first_m + samples.count * samples.step_m;
  if (!(height_m > 0 && reach_m > height_m))
    throw std::invalid_argument("the camera does not see the seabed");
  const double ground_m = std::sqrt(reach_m * reach_m - height_m * height_m);
  const double half_width_m =
      ground_m * std::sin(std::min(std::abs(sensor.beams().front().azimuth_rad), 1.5));
  const FrameLookup lookup(sensor, flattened(sensor, pose, height_m, energies));
  const Heading heading(pose);
  const glm::dquat into_camera = glm::conjugate(pose.attitude);

  PixelMap map;
  map.columns = static_cast<std::size_t>(2 * half_width_m / layout.pixel_m) + 1;
  map.rows = static_cast<std::size_t>(ground_m / layout.pixel_m) + 1;
  for (std::size_t r = 0; r < map.rows; ++r)
    for (std::size_t c = 0; c < map.columns; ++c) {
      const double starboard = static_cast<double>(c) * layout.pixel_m - half_width_m,
                   ahead = static_cast<double>(r) * layout.pixel_m;
      const glm::dvec3 place =
          starboard * heading.starboard + ahead * heading.ahead - glm::dvec3(0, 0, height_m);
      map.values.push_back(lookup.at(into_camera * place));
    }
  return map;
}

TrackStep seen_from(const Pose& pose, glm::dvec3 place_m) {
  const Heading heading(pose);
  const glm::dvec3 way = place_m - pose.position_m;
  return {glm::dot(way, heading.starboard), glm::dot(way, heading.ahead)};
}

glm::dvec3 place_seen(const Pose& pose, TrackStep there, double seabed_m) {
  const Heading heading(pose);
  const glm::dvec3 place =
      pose.position_m + there.starboard_m * heading.starboard + there.ahead_m * heading.ahead;
  return {place.x, place.y, seabed_m};
}

TrackEstimate estimate_track(const Recording& recording, const std::vector<std::vector<double>>& frames,
                             const SurfaceLayout& layout, int most_shift) {
  TrackEstimate estimate;
  estimate.least_correlation = 1;
  estimate.largest_correlation = -1;
  PixelMap before;
  for (std::size_t ping = 0; ping < frames.size(); ++ping) {
    PixelMap now = ground_picture(recording, ping, frames[ping], layout);
    if (ping > 0) {
      const FrameShift shift = find_shift(before, now, most_shift);
      // The contents of the frames move opposite to the camera.
      const TrackStep measured{-shift.columns * layout.pixel_m, -shift.rows * layout.pixel_m};
      const TrackStep truth = seen_from(recording.ping_pose[ping - 1], recording.ping_pose[ping].position_m);
      estimate.worst_pixels =
          std::max(estimate.worst_pixels,
                   std::hypot(measured.starboard_m - truth.starboard_m, measured.ahead_m - truth.ahead_m) /
                       layout.pixel_m);
      estimate.least_correlation = std::min(estimate.least_correlation, shift.correlation);
      estimate.largest_correlation = std::max(estimate.largest_correlation, shift.correlation);
      estimate.measured.push_back(measured);
      estimate.true_steps.push_back(truth);
      estimate.shifts.push_back(shift);
    }
    before = std::move(now);
  }
  return estimate;
}

}  // namespace tubefoot
