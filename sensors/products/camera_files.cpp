// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the frames of acoustic cameras as DIDSON (.ddf) or ARIS (.aris) files. Amplitudes are codes of
// levels in dB relative to one reference per recording.

#include "sensors/products/camera_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/steps/in_order.hpp"
#include "sensors/formats/aris_file.hpp"
#include "sensors/formats/ddf_file.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/recordings/navigation.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// The DIDSON with this number of beams and the nearest frequency. Three have 48 beams.
DdfHeader didson_nearest(int beams, double frequency_khz) {
  constexpr std::uint32_t standard = 4, long_range = 6;
  const struct {
    int beams;
    double frequency_khz;
    bool high_resolution;
    std::uint32_t config_flags;
  } kinds[] = {{96, 1800, true, standard},
               {48, 1100, false, standard},
               {48, 1200, true, long_range},
               {48, 700, false, long_range}};
  DdfHeader header;
  header.beams = beams;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& kind : kinds) {
    const double off = std::abs(std::log(kind.frequency_khz / frequency_khz));
    if (kind.beams != beams || off >= nearest) continue;
    nearest = off;
    header.high_resolution = kind.high_resolution;
    header.config_flags = kind.config_flags;
  }
  return header;
}

DdfHeader ddf_header(const Recording& recording, const RunContext& run) {
  const Sensor& sensor = *recording.sensor;
  const auto beams = static_cast<int>(sensor.beams().size());
  if (beams != 48 && beams != 96)
    throw std::invalid_argument(fmt::format("a DIDSON has 48 or 96 beams, not {}", beams));
  if (sensor.samples().count != 512)
    throw std::invalid_argument(fmt::format("a DIDSON has 512 samples, not {}", sensor.samples().count));
  // A DIDSON states its window by codes for lengths at a nominal sound speed, which the assumed one does not
  // change.
  const double length_m = sensor.samples().count * sensor.samples().step_m / recording.range_ratio;
  DdfHeader header = didson_nearest(beams, sensor.frequency_khz());
  header.title = run.title;
  header.window = ddf_window(header, sensor.samples().first_m / recording.range_ratio, length_m);
  header.sample_rate_hz = ddf_sample_rate_hz(length_m);
  header.frame_rate_hz = 1 / sensor.description().shortest_interval_s();
  header.sound_speed_m_s = recording.sound_speed_m_s;
  header.water_temperature_c = run.water.temperature_c;
  return header;
}

ArisHeader aris_header(const Recording& recording, const RunContext& run) {
  const Sensor& sensor = *recording.sensor;
  const RangeSamples& samples = sensor.samples();
  ArisHeader header;
  header.title = run.title;
  header.beams = static_cast<int>(sensor.beams().size());
  header.samples = samples.count;
  const ArisModel model = aris_ping_mode(header.beams).model;
  // Each model has two frequencies: 1.1 and 1.8, or 1.8 and 3.0 MHz.
  header.high_frequency = sensor.frequency_khz() > (model == ArisModel::aris_3000 ? 2400 : 1450);
  header.window =
      aris_window(samples.first_m, samples.count * samples.step_m, samples.count, recording.sound_speed_m_s);
  header.sound_speed_m_s = recording.sound_speed_m_s;
  header.frame_rate_hz = 1 / sensor.description().shortest_interval_s();
  header.water_temperature_c = run.water.temperature_c;
  header.salinity = run.water.salinity_psu < 7.5  ? ArisSalinity::fresh
                    : run.water.salinity_psu < 25 ? ArisSalinity::brackish
                                                  : ArisSalinity::salt;
  return header;
}

/// File format for a camera's frames: ARIS for an ARIS; otherwise DIDSON if possible, then ARIS.
struct CameraFormat {
  std::optional<DdfHeader> didson;
  std::optional<ArisHeader> aris;
  std::string why_neither;
};

CameraFormat format_of(const Recording& recording, const RunContext& run) {
  const SensorDescription& sensor = recording.sensor->description();
  CameraFormat format;
  std::string reasons[2] = {"the camera is an ARIS", ""};
  const std::string what = fmt::format("'{}'", sensor.name);
  if (!is_aris(sensor)) try {
      const DdfHeader header = ddf_header(recording, run);
      check(header, what);
      format.didson = header;
      return format;
    } catch (const std::invalid_argument& error) {
      reasons[0] = error.what();
    }
  try {
    const ArisHeader header = aris_header(recording, run);
    check(header, what);
    format.aris = header;
  } catch (const std::invalid_argument& error) {
    reasons[1] = error.what();
    format.why_neither = fmt::format(
        "no DIDSON or ARIS file is written for '{}', because neither format is possible. DIDSON: {}. ARIS: "
        "{}",
        sensor.name, reasons[0], reasons[1]);
  }
  return format;
}

/// Levels as received.
class Levels {
 public:
  Levels(const Recording& recording, const RunContext& run)
      : recording_(recording), received_(recording, run) {}

  std::vector<double> of(std::size_t ping) const {
    std::vector<double> levels = received_.of(ping);
    for (double& level : levels) level = received_.chain().level_db(level);
    return levels;
  }

  /// The level that one in a thousand of all echoes exceed, to a hundredth of a decibel; 0 without echoes.
  double brightest_db() const {
    constexpr double range_db = 1000, per_db = 100, exceeding = 1e-3;
    std::vector<std::uint64_t> counts(static_cast<std::size_t>(2 * range_db * per_db) + 1);
    std::uint64_t echoes = 0;
    const auto places_of = [&](std::size_t ping) {
      std::vector<std::uint32_t> places;
      for (const double level : of(ping)) {
        if (!std::isfinite(level)) continue;  // no echo
        const double place = (std::clamp(level, -range_db, range_db) + range_db) * per_db;
        places.push_back(static_cast<std::uint32_t>(std::lround(place)));
      }
      return places;
    };
    Steps steps("pings read to find the scale of the camera files", recording_.pings());
    in_order(steps, 0, recording_.pings(), (sizeof(double) + sizeof(std::uint32_t)) * recording_.cells(),
             places_of, [&](std::size_t, const std::vector<std::uint32_t>& places) {
               for (const std::uint32_t place : places) ++counts[place];
               echoes += places.size();
             });
    if (echoes == 0) return 0;
    auto above = static_cast<std::uint64_t>(std::floor(exceeding * static_cast<double>(echoes)));
    std::size_t place = counts.size() - 1;
    for (; counts[place] <= above; --place) above -= counts[place];
    return static_cast<double>(place) / per_db - range_db;
  }

 private:
  const Recording& recording_;
  ReceivedPings received_;
};

CameraAttitude attitude_of(const PoseAngles& angles) {
  return {angles.heading_deg, angles.pitch_deg, angles.roll_deg};
}

/// All data of a frame except its amplitudes.
class Frames {
 public:
  Frames(const Recording& recording, const RunContext& run) : recording_(recording), track_(recording, run) {}

  CameraFrame of(std::size_t ping) {
    const Pose& pose = recording_.ping_pose[ping];
    const NavigationFix& fix = track_.of(ping);
    // Attitude of the camera on its platform.
    const glm::dquat platform = pose.attitude * glm::inverse(recording_.sensor->mounting());
    CameraFrame frame;
    frame.unix_time_s = fix.unix_time_s;
    frame.longitude_deg = fix.place.lon_lat_height.x;
    frame.latitude_deg = fix.place.lon_lat_height.y;
    frame.platform = attitude_of(true_angles_of(platform, fix.place.to_east_north_up));
    frame.camera = attitude_of(fix.lie);
    frame.velocity_m_s = glm::dot(velocity_m_s(recording_, ping), platform * forward_axis);
    frame.depth_m = std::max(0.0, -fix.place.lon_lat_height.z);
    if (ping < recording_.altitude_m.size() && std::isfinite(recording_.altitude_m[ping]))
      frame.altitude_m = recording_.altitude_m[ping];
    return frame;
  }

 private:
  const Recording& recording_;
  NavigationTrack track_;
};

void write_frames(CameraFile&& file, const Recording& recording, const RunContext& run,
                  double full_scale_db) {
  const Levels levels(recording, run);
  Frames frames(recording, run);
  const double top_db = levels.brightest_db();
  const auto codes_of = [&](std::size_t ping) {
    const std::vector<double> received = levels.of(ping);
    std::vector<std::uint8_t> codes(received.size());
    std::ranges::transform(received, codes.begin(), [&](double level) {
      return amplitude(level - top_db + full_scale_db, full_scale_db);
    });
    return codes;
  };
  Steps steps("frames written to camera files", recording.pings());
  in_order(steps, 0, recording.pings(), (sizeof(double) + 1) * recording.cells(), codes_of,
           [&](std::size_t ping, const std::vector<std::uint8_t>& codes) {
             CameraFrame frame = frames.of(ping);
             frame.amplitudes = codes;
             file.add(frame);
           });
  file.finish();
}

bool writes_camera_files(const RunContext& run) { return run.writes("ddf") || run.writes("aris"); }

}  // namespace

std::vector<std::string> camera_file_products() { return {"ddf", "aris"}; }

bool has_camera_file(const Recording& recording, const RunContext& run) {
  if (!writes_camera_files(run)) return false;
  const CameraFormat format = format_of(recording, run);
  return (format.didson && run.writes("ddf")) || (format.aris && run.writes("aris"));
}

std::vector<std::string> camera_files_left_out(const Recording& recording, const RunContext& run) {
  if (!writes_camera_files(run)) return {};
  const CameraFormat format = format_of(recording, run);
  if (format.didson || format.aris) return {};
  return {format.why_neither};
}

std::vector<fs::path> write_camera_files(const fs::path& folder, const Recording& recording,
                                         const RunContext& run, std::vector<std::string>& warnings) {
  check(recording);
  if (!writes_camera_files(run)) return {};
  const std::string& name = recording.sensor->description().name;
  const CameraFormat format = format_of(recording, run);
  if (format.didson ? !run.writes("ddf") : format.aris && !run.writes("aris")) return {};
  // A writer throws std::invalid_argument for data that its format cannot represent, and leaves no file.
  try {
    if (format.didson) {
      const fs::path file = name + ".ddf";
      write_frames(DdfFile(folder / file, *format.didson), recording, run, ddf_full_scale_db);
      return {file};
    }
    if (format.aris) {
      const fs::path file = name + ".aris";
      write_frames(ArisFile(folder / file, *format.aris), recording, run, aris_full_scale_db);
      return {file};
    }
    warnings.push_back(format.why_neither);
  } catch (const std::invalid_argument& error) {
    warnings.push_back(fmt::format("no DIDSON or ARIS file is written for '{}': {}", name, error.what()));
  }
  return {};
}

}  // namespace tubefoot
