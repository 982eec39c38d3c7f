// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recorded_navigation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <string_view>

#include "engine/scattering/counter_random.hpp"
#include "files/csv_file.hpp"
#include "files/memory_at_hand.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/recordings/pose_angles.hpp"

// This file computes the navigation that sonars record. It consists of true poses with latency, errors of
// attitude, position and water level, and the assumed mounting.

namespace tubefoot {
namespace {

constexpr double seconds_per_hour = 3600;
constexpr double time_rounding_s = 1e-9;  // as Trajectory::holds() permits

/// Six independent normal deviates of a transmission. They depend on the seed, the trajectory and the time
/// alone. Any selection of pings and any sensor on the trajectory therefore get the same errors.
std::array<double, 6> normal_deviates(std::uint64_t seed, std::size_t trajectory, double time_s) {
  const auto bits = std::bit_cast<std::uint64_t>(time_s + 0.0);
  const SampleRandom random(seed, static_cast<std::uint32_t>(trajectory),
                            static_cast<std::uint32_t>(bits >> 32), static_cast<std::uint32_t>(bits));
  std::array<double, 6> deviates{};
  for (std::uint32_t pair = 0; pair < 3; ++pair) {
    const std::complex<double> z =
        std::sqrt(2.0) * circular_normal(random.uniform_pair(Purpose::navigation, pair));
    deviates[2 * pair] = z.real();
    deviates[2 * pair + 1] = z.imag();
  }
  return deviates;
}

/// Error of three components of a sensor: bias, drift and noise.
glm::dvec3 error_of(const std::array<double, 3>& bias, const std::array<double, 3>& drift_per_hour,
                    const std::array<double, 3>& noise, double time_s, const double* deviates) {
  glm::dvec3 error;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    error[k] = bias[i] + drift_per_hour[i] * time_s / seconds_per_hour + noise[i] * deviates[k];
  }
  return error;
}

/// Navigation of a trajectory as it is recorded.
class RecordedTrack {
 public:
  RecordedTrack(const ProcessingDescription& processing, const WaterLevelError& water_level,
                const Trajectory& trajectory, std::size_t number)
      : processing_(processing), water_level_(water_level), trajectory_(trajectory), number_(number) {}

  /// Returns the recorded pose of the carrier at a time. Throws InputError.
  Pose at(double time_s) const {
    const ProcessingDescription& p = processing_;
    Pose pose;
    pose.position_m = trajectory_.at(before(time_s, p.latency_s, p.latency_place, "latency_s")).position_m;
    pose.attitude =
        trajectory_.at(before(time_s, p.attitude_latency_s, p.attitude_latency_place, "attitude_latency_s"))
            .attitude;
    const std::array<double, 6> deviates = normal_deviates(p.seed, number_, time_s);
    const glm::dvec3 turn = error_of(p.attitude_bias_deg, p.attitude_drift_deg_per_hour, p.attitude_noise_deg,
                                     time_s, &deviates[0]);
    // Angles are computed only for errors, because the conversion rounds.
    if (turn != glm::dvec3(0)) {
      const PoseAngles angles = angles_of(pose.attitude);
      pose.attitude =
          attitude_from_angles(radians(angles.heading_deg + turn[0]), radians(angles.pitch_deg + turn[1]),
                               radians(angles.roll_deg + turn[2]));
    }
    pose.position_m +=
        error_of(p.position_bias_m, p.position_drift_m_per_hour, p.position_noise_m, time_s, &deviates[3]);
    pose.position_m.z += water_level_.at_m(time_s);
    return pose;
  }

 private:
  /// Returns the time of which the recorded value is true. On a survey it must be on the same line, because
  /// the turns between lines are not simulated.
  double before(double time_s, double latency_s, const SourcePlace& place, const char* key) const {
    const double true_s = time_s - latency_s;
    if (latency_s == 0 || trajectory_.is_fixed()) return true_s;
    double begin_s = trajectory_.begin_s(), end_s = trajectory_.end_s();
    for (const Trajectory::Line& line : trajectory_.lines())
      if (time_s >= line.begin_s - time_rounding_s && time_s <= line.end_s + time_rounding_s) {
        begin_s = line.begin_s;
        end_s = line.end_s;
      }
    if (true_s < begin_s - time_rounding_s || true_s > end_s + time_rounding_s)
      throw InputError(
          place,
          fmt::format("with '{}' = {:.9g}, the value recorded at {:.9g} s is that of {:.9g} s, but the "
                      "{} lasts from {:.9g} s to {:.9g} s: change 'first_ping_s' or 'pings' of the "
                      "sensor, or reduce the latency",
                      key, latency_s, time_s, true_s, trajectory_.lines().empty() ? "trajectory" : "line",
                      begin_s, end_s));
    return true_s;
  }

  const ProcessingDescription& processing_;
  const WaterLevelError& water_level_;
  const Trajectory& trajectory_;
  std::size_t number_;
};

bool changes_navigation(const ProcessingDescription& p) {
  const std::array<double, 3> none{};
  return p.latency_s != 0 || p.attitude_latency_s != 0 || p.tide_m != 0 || p.tide_file ||
         p.attitude_bias_deg != none || p.attitude_drift_deg_per_hour != none ||
         p.attitude_noise_deg != none || p.position_bias_m != none || p.position_drift_m_per_hour != none ||
         p.position_noise_m != none;
}

bool changes_mounting(const SensorDescription& sensor) {
  const AssumedMountingDescription& assumed = sensor.assumed;
  return assumed.yaw_deg.value_or(sensor.yaw_deg) != sensor.yaw_deg ||
         assumed.tilt_deg.value_or(sensor.tilt_deg) != sensor.tilt_deg ||
         assumed.roll_deg.value_or(sensor.roll_deg) != sensor.roll_deg ||
         assumed.lever_arm_m.value_or(sensor.lever_arm_m) != sensor.lever_arm_m;
}

/// Returns the recorded pose of a sensor. For a sensor that is turned towards a target, the software knows
/// the attitude relative to the carrier.
Pose recorded_pose(const Sensor& sensor, const Sensor& assumed, const Pose& carrier, const Pose& recorded,
                   bool at_receiver = false) {
  Pose pose = at_receiver ? assumed.receiver_pose_on(recorded) : assumed.pose_on(recorded);
  if (!sensor.description().look_at_m) return pose;
  pose.attitude = sensor.pose_on(carrier).attitude;
  if (recorded.attitude != carrier.attitude)
    pose.attitude = glm::normalize(recorded.attitude * glm::inverse(carrier.attitude) * pose.attitude);
  return pose;
}

void record_poses(SensorPings& pings, const Sensor& assumed, const Trajectory& trajectory,
                  const RecordedTrack& track, const WaterLevelError& water_level) {
  const Sensor& sensor = *pings.sensor;
  require_memory(static_cast<double>(pings.transmission_poses.size()) * sizeof(Pose),
                 sensor.description().place, "the recorded poses", "reduce the number of pings per scene");
  pings.recorded_poses.reserve(pings.transmission_poses.size());
  for (const double time_s : pings.times_s) {
    for (std::size_t transmission = 0; transmission < sensor.transmissions(); ++transmission) {
      const double at_s = time_s + sensor.transmission_delay_s(transmission);
      pings.recorded_poses.push_back(recorded_pose(sensor, assumed, trajectory.at(at_s), track.at(at_s)));
      if (!sensor.receiver_moves()) continue;
      const double received_s = time_s + sensor.reception_delay_s(transmission);
      pings.recorded_receiver_poses.push_back(
          recorded_pose(sensor, assumed, trajectory.at(received_s), track.at(received_s), true));
    }
    pings.water_level_errors_m.push_back(water_level.at_m(time_s));
  }
  const auto same = [](const Pose& a, const Pose& b) {
    return a.position_m == b.position_m && a.attitude == b.attitude;
  };
  if (std::ranges::equal(pings.recorded_poses, pings.transmission_poses, same) &&
      (pings.recorded_receiver_poses.empty() ||
       std::ranges::equal(pings.recorded_receiver_poses, pings.receiver_poses, same))) {
    pings.recorded_poses.clear();
    pings.recorded_receiver_poses.clear();
  }
  if (std::ranges::all_of(pings.water_level_errors_m, [](double error) { return error == 0; }))
    pings.water_level_errors_m.clear();
}

/// Sound speed of the assumed water at the first recorded position.
double assumed_speed_at(const Scene& scene, const SensorPings& pings) {
  const SceneWater& water = *scene.assumed_water;
  const Pose& first = pings.recorded_poses.empty() ? pings.poses.front() : pings.recorded_poses.front();
  const double level_m = pings.water_level_errors_m.empty() ? 0 : pings.water_level_errors_m.front();
  return water.profile().at(water.surface_height_m() + level_m - first.position_m.z);
}

/// Warns about beams across the track whose recorded angle asin(ratio sin(angle)) does not exist.
void warn_of_angles(const SensorPings& pings, const ProcessingDescription& processing,
                    std::vector<std::string>& warnings) {
  const Sensor& sensor = *pings.sensor;
  if (!sensor.is_across_track() || !processing.sound_speed_at_transducer_m_s) return;
  const double steering_m_s = *processing.sound_speed_at_transducer_m_s;
  const auto without = std::ranges::count_if(sensor.beams(), [&](const BeamAxis& axis) {
    const double sine = beam_direction(axis).x / std::cos(axis.tilt_rad);
    return std::abs(sine) * steering_m_s / pings.sound_speed_m_s > 1;
  });
  if (without == 0) return;
  warnings.push_back(fmt::format(
      "{}: with an assumed sound speed of {:g} m/s at the transducer instead of {:.2f} m/s, {} beams of "
      "sensor '{}' have no recorded angle, because its sine exceeds 1: they have no soundings",
      to_string(processing.place), steering_m_s, pings.sound_speed_m_s, without, sensor.description().name));
}

}  // namespace

WaterLevelError::WaterLevelError(const ProcessingDescription& processing) : processing_(processing) {
  if (!processing.tide_file) return;
  constexpr std::array<std::string_view, 2> columns = {"time_s", "tide_m"};
  constexpr double largest_m = 1000;
  try {
    read_csv(*processing.tide_file, columns, [&](const CsvRow& row) {
      const double time_s = row.values[0], tide_m = row.values[1];
      if (!levels_.empty() && !(time_s > levels_.back().time_s))
        throw InputError(row.places[0],
                         fmt::format("time_s must increase: {} follows {}", time_s, levels_.back().time_s));
      if (!(std::abs(tide_m) <= largest_m))
        throw InputError(row.places[1],
                         fmt::format("tide_m is {}, expected {} to {}", tide_m, -largest_m, largest_m));
      levels_.push_back({time_s, tide_m});
    });
  } catch (const InputError& error) {
    throw InputError(processing.tide_file_place, error.what());
  }
  if (levels_.empty())
    throw InputError(processing.tide_file_place,
                     fmt::format("'{}' has a header but no rows, expected at least one time",
                                 processing.tide_file->string()));
}

double WaterLevelError::at_m(double time_s) const {
  if (levels_.empty()) return processing_.tide_m;
  if (time_s < levels_.front().time_s - time_rounding_s || time_s > levels_.back().time_s + time_rounding_s)
    throw InputError(
        processing_.tide_file_place,
        fmt::format("a transmission is at {:.9g} s, but '{}' lasts from {:.9g} s to {:.9g} s: add "
                    "rows, or change the times of the pings",
                    time_s, processing_.tide_file->string(), levels_.front().time_s, levels_.back().time_s));
  const auto after = std::ranges::upper_bound(levels_, time_s, {}, &Level::time_s);
  if (after == levels_.begin() || after == levels_.end())
    return processing_.tide_m + (after == levels_.end() ? levels_.back() : levels_.front()).tide_m;
  const Level &a = *(after - 1), &b = *after;
  return processing_.tide_m + std::lerp(a.tide_m, b.tide_m, (time_s - a.time_s) / (b.time_s - a.time_s));
}

void assume_configuration(Scene& scene, SensorSet& sensor_set) {
  const ProcessingDescription& processing = scene.description.processing;
  const WaterLevelError water_level(processing);
  for (std::size_t s = 0; s < sensor_set.sensors.size(); ++s) {
    SensorPings& pings = sensor_set.sensors[s];
    const Sensor& sensor = *pings.sensor;
    const double true_m_s = pings.sound_speed_m_s;
    const bool other_mounting = changes_mounting(sensor.description());
    if (other_mounting || changes_navigation(processing)) {
      const std::size_t number = scene.sensor_trajectory[s];
      const Trajectory& trajectory = scene.trajectories[number];
      record_poses(pings, *assumed_sensor(sensor, 1), trajectory,
                   {processing, water_level, trajectory, number}, water_level);
    }
    const bool other_water = scene.assumed_water != scene.water;
    const double steering_m_s = processing.sound_speed_at_transducer_m_s.value_or(true_m_s);
    double range_m_s = true_m_s;
    if (other_water) pings.assumed_sound_speed_m_s = range_m_s = assumed_speed_at(scene, pings);
    // The water of the placer is the assumed one, so the true speed for steering needs a value of its own.
    if (other_water || steering_m_s != true_m_s) pings.steering_sound_speed_m_s = steering_m_s;
    if (other_mounting || range_m_s != true_m_s)
      pings.assumed_sensor = assumed_sensor(sensor, range_m_s / true_m_s);
    warn_of_angles(pings, processing, scene.report.warnings);
  }
}

std::optional<std::string> assumed_configuration_text(const Scene& scene, const SensorPings& pings) {
  std::vector<std::string> parts;
  if (scene.assumed_water != scene.water)
    parts.push_back(fmt::format("sound speed {:.2f} m/s", pings.assumed_sound_speed_m_s));
  if (const auto steering = scene.description.processing.sound_speed_at_transducer_m_s;
      steering && *steering != pings.sound_speed_m_s)
    parts.push_back(fmt::format("{:.2f} m/s for steering", *steering));
  double move_m = 0, turn_rad = 0;
  for (std::size_t k = 0; k < pings.recorded_poses.size(); ++k) {
    const Pose &recorded = pings.recorded_poses[k], &truth = pings.transmission_poses[k];
    move_m = std::max(move_m, glm::distance(recorded.position_m, truth.position_m));
    const glm::dquat turn = recorded.attitude * glm::inverse(truth.attitude);
    turn_rad =
        std::max(turn_rad, 2 * std::atan2(glm::length(glm::dvec3(turn.x, turn.y, turn.z)), std::abs(turn.w)));
  }
  if (move_m > 0) parts.push_back(fmt::format("positions off by up to {:.3g} m", move_m));
  if (turn_rad > 0) parts.push_back(fmt::format("attitudes off by up to {:.3g} degrees", degrees(turn_rad)));
  if (parts.empty()) return std::nullopt;
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace tubefoot
