// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs the sensors of two echo files and checks that their pings, beams, samples, axes and scene hashes
// agree.
#include "compare/echo_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "files/input_error.hpp"
#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

constexpr double axis_tolerance_deg = 1e-3, sample_share = 0.01, time_tolerance_s = 1e-6;

const SensorEchoes* find(const EchoContents& contents, const std::string& name) {
  for (const SensorEchoes& sensor : contents.sensors)
    if (sensor.name == name) return &sensor;
  return nullptr;
}

std::string names(const EchoContents& contents) {
  std::string result;
  for (const SensorEchoes& sensor : contents.sensors)
    result += fmt::format("{}'{}'", result.empty() ? "" : ", ", sensor.name);
  return result;
}

/// The checks of one pair of sensors.
class Match {
 public:
  Match(const EchoContents& reference, const EchoContents& candidate, const EchoPairs::Sensor& pair)
      : reference_file_(reference.file.string()),
        candidate_file_(candidate.file.string()),
        reference_(*pair.reference),
        candidate_(*pair.candidate) {}

  void check() const {
    if (reference_.pings != candidate_.pings || reference_.beams != candidate_.beams ||
        reference_.samples != candidate_.samples)
      fail("energy", fmt::format("has {} pings x {} beams x {} range bins, but {} has {} x {} x {}: compute "
                                 "the same pings, beams and range bins as the reference",
                                 candidate_.pings, candidate_.beams, candidate_.samples, reference_file_,
                                 reference_.pings, reference_.beams, reference_.samples));
    const double step_m = sample_step_m();
    const char *samples = "use the range bins of the reference",
               *beams = "use the beams of the reference in the same order";
    check_axis({"slant_range", "sample", "m", sample_share * step_m, samples}, &SensorEchoes::slant_range_m);
    check_axis({"slant_range_bounds", "edge", "m", sample_share * step_m, samples},
               &SensorEchoes::slant_range_bounds_m);
    check_axis({"beam_azimuth", "beam", "degrees", axis_tolerance_deg, beams, 360},
               &SensorEchoes::beam_azimuth_deg);
    check_axis({"beam_elevation", "beam", "degrees", axis_tolerance_deg, beams},
               &SensorEchoes::beam_elevation_deg);
  }

  bool ping_times_differ() const {
    if (reference_.ping_time_s.empty() || candidate_.ping_time_s.empty()) return false;
    for (std::size_t k = 0; k < reference_.pings; ++k)
      if (std::abs(reference_.ping_time_s[k] - candidate_.ping_time_s[k]) > time_tolerance_s) return true;
    return false;
  }

 private:
  [[noreturn]] void fail(const char* variable, const std::string& message) const {
    throw InputError({candidate_file_},
                     fmt::format("variable '{}' of sensor '{}' {}", variable, candidate_.name, message));
  }

  double sample_step_m() const {
    const auto& edges = reference_.slant_range_bounds_m;
    const auto& centres = reference_.slant_range_m;
    if (!edges.empty()) return std::abs(edges[1] - edges[0]);
    return centres.size() > 1 ? centres[1] - centres[0] : centres[0];
  }

  /// Names and tolerance of an axis.
  struct Axis {
    const char *variable, *index, *unit;
    double tolerance;
    const char* advice;
    double period = 0;  ///< values that differ by this period are equal
  };

  /// Skips values that only one file has.
  void check_axis(const Axis& axis, std::vector<double> SensorEchoes::*values) const {
    const std::vector<double>&reference = reference_.*values, &candidate = candidate_.*values;
    if (reference.empty() || candidate.empty()) return;
    for (std::size_t k = 0; k < reference.size(); ++k) {
      double difference = candidate[k] - reference[k];
      if (axis.period > 0) difference = std::remainder(difference, axis.period);
      if (std::abs(difference) <= axis.tolerance) continue;
      fail(axis.variable,
           fmt::format("is {} {} at {} {}, but {} has {} (the permitted difference is {:.2g} {}): {}",
                       candidate[k], axis.unit, axis.index, k, reference_file_, reference[k], axis.tolerance,
                       axis.unit, axis.advice));
    }
  }

  std::string reference_file_, candidate_file_;
  const SensorEchoes &reference_, &candidate_;
};

void check_scenes(const EchoContents& reference, const EchoContents& candidate, bool any_scene,
                  std::vector<std::string>& notes) {
  const std::string &expected = reference.provenance.scene_hash, &found = candidate.provenance.scene_hash;
  if (expected.empty())
    notes.push_back("the reference has no scene_hash, so it is unknown whether the scenes are equal");
  else if (found.empty())
    notes.push_back(
        "the candidate has no scene_hash, so it is unknown whether it shows the scene of the reference");
  else if (found != expected && any_scene)
    notes.push_back(fmt::format("the scenes differ: scene_hash {} and {}", expected, found));
  else if (found != expected)
    throw InputError({candidate.file.string()},
                     fmt::format("scene_hash is {}, but {} has {}: compute both from the same scene files, "
                                 "or compare different scenes with --any-scene",
                                 found, reference.file.string(), expected));
}

}  // namespace

EchoPairs pair_echoes(const EchoContents& reference, const EchoContents& candidate,
                      const std::optional<std::string>& sensor, bool any_scene) {
  EchoPairs pairs;
  check_scenes(reference, candidate, any_scene, pairs.notes);
  if (sensor && !find(reference, *sensor))
    throw UsageError(
        fmt::format("{} has no sensor '{}'; it has {}", reference.file.string(), *sensor, names(reference)));
  const bool one_with_one = reference.sensors.size() == 1 && candidate.sensors.size() == 1;
  for (const SensorEchoes& expected : reference.sensors) {
    if (sensor && expected.name != *sensor) continue;
    const SensorEchoes* found = one_with_one ? &candidate.sensors.front() : find(candidate, expected.name);
    if (!found)
      throw InputError(
          {candidate.file.string()},
          fmt::format(
              "has no sensor '{}' of {}; it has {}: rename a group, or compare one sensor with --sensor",
              expected.name, reference.file.string(), names(candidate)));
    if (found->name != expected.name)
      pairs.notes.push_back(
          fmt::format("the sensor of the candidate has the name '{}', not '{}'", found->name, expected.name));
    const EchoPairs::Sensor pair{&expected, found};
    const Match match(reference, candidate, pair);
    match.check();
    if (match.ping_times_differ())
      pairs.notes.push_back(fmt::format(
          "the ping times of '{}' differ; the comparison matches pings by their number", expected.name));
    pairs.sensors.push_back(pair);
  }
  if (!sensor)
    for (const SensorEchoes& other : candidate.sensors)
      if (!one_with_one && !find(reference, other.name))
        pairs.notes.push_back(
            fmt::format("the sensor '{}' of the candidate is not in the reference", other.name));
  return pairs;
}

}  // namespace tubefoot
