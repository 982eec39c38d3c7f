// SPDX-License-Identifier: GPL-3.0-or-later
// Converts pings and soundings of a fan across the track to SONAR-netCDF4, GSF and XTF files. Heights are
// above the scene's height 0, and headings are true.

#include "sensors/products/swath_formats.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sensors/formats/gsf_file.hpp"
#include "sensors/formats/sonar_netcdf.hpp"
#include "sensors/formats/xtf_file.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/products/line_files.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

/// Level of the sample that contains a sounding, within the limits of the files.
double level_db(const Sounding& sounding) {
  constexpr double lowest = -600, highest = 600;
  return std::clamp(20 * std::log10(sounding.amplitude), lowest, highest);
}

bool is_one_of_several(const Sounding& sounding) { return sounding.flags.has(DetectionFlag::several_echoes); }

/// Beam flags of GSF as in its library: bit 0 means ignore, and the others give the reason.
std::uint8_t gsf_flags(const std::optional<Sounding>& sounding) {
  constexpr std::uint8_t accepted = 0, no_detection = 0x01, taken_by_a_filter = 0x09, informational = 0x10;
  if (!sounding) return no_detection;
  return is_cut(*sounding) ? taken_by_a_filter : is_one_of_several(*sounding) ? informational : accepted;
}

class SonarNetcdfFormat : public SwathFormat {
 public:
  SonarNetcdfFormat(const std::filesystem::path& folder, const Recording& recording, const RunContext& run,
                    const SwathSettings& settings, const BottomFinder& finder)
      : recording_(recording),
        finder_(finder),
        name_(recording.sensor->description().name + "-sonar.nc"),
        file_(folder / name_, header(recording, run, settings)) {}

  std::function<void()> adding(const PlacedPing& placed) override {
    const RangeSamples& samples = recording_.sensor->samples();
    const double c = recording_.sound_speed_m_s;
    const NavigationFix& fix = placed.fix;
    const double above_water_m = fix.place.lon_lat_height.z;
    SonarNetcdfPing ping;
    ping.unix_time_ns = std::llround(fix.unix_time_s * 1e9);
    ping.longitude_deg = fix.place.lon_lat_height.x;
    ping.latitude_deg = fix.place.lon_lat_height.y;
    ping.height_m = above_water_m;
    ping.heading_deg = fix.lie.heading_deg;
    ping.pitch_deg = fix.lie.pitch_deg;
    ping.roll_deg = fix.lie.roll_deg;
    ping.waterline_below_reference_m = above_water_m;
    ping.transducer_depth_m = -above_water_m;
    ping.sound_speed_m_s = c;
    ping.steering_sound_speed_m_s = recording_.steering_sound_speed_m_s;
    ping.sample_interval_s = 2 * samples.step_m / c;
    ping.blanking_interval_s = 2 * (samples.first_m + samples.step_m / 2) / c;
    if (recording_.sensor->stabilisation().any()) ping.transmit_steering_deg = transmit_steering(placed.ping);
    for (std::size_t beam = 0; beam < placed.sounded.rays.size(); ++beam) {
      ping.across_angle_deg.push_back(degrees(placed.sounded.rays[beam].across_rad));
      ping.backscatter_db.push_back(levels_db(placed.sounded, beam));
      ping.detections.push_back(detection(placed, beam));
    }
    return [this, ping = std::move(ping)] { file_.add(ping); };
  }
  void finish() override { file_.finish(); }
  std::vector<std::filesystem::path> files() const override { return {name_}; }

 private:
  /// Levels up to a beam's last echo; the zeros after it are not written.
  std::vector<float> levels_db(const SoundedPing& sounded, std::size_t beam) const {
    const std::vector<double>& received = sounded.received_j[beam];
    std::vector<float> levels(received.size(), -std::numeric_limits<float>::infinity());
    for (std::size_t k = 0; k < received.size(); ++k)
      if (received[k] > 0) levels[k] = static_cast<float>(finder_.receiver(beam).level_db(received[k]));
    return levels;
  }

  SonarDetection detection(const PlacedPing& placed, std::size_t beam) const {
    SonarDetection detection;
    detection.beam_angle_deg = degrees(placed.sounded.rays[beam].across_rad);
    const std::optional<Sounding>& sounding = placed.sounded.soundings[beam];
    if (!sounding) return detection;
    detection.found = true;
    detection.rejected = is_cut(*sounding);
    detection.doubtful = is_one_of_several(*sounding);
    detection.two_way_travel_time_s = sounding->two_way_travel_time_s;
    detection.forward_starboard_down_m = placed.forward_starboard_down_m(beam);
    detection.longitude_deg = placed.soundings_lon_lat[beam].x;
    detection.latitude_deg = placed.soundings_lon_lat[beam].y;
    detection.backscatter_db = level_db(*sounding);
    detection.quality = 100 * placed.sounded.range_sigma_m[beam] / sounding->slant_range_m;
    return detection;
  }

  /// By transmit beam, as SonarNetcdfPing has it.
  std::vector<std::array<double, 2>> transmit_steering(std::size_t ping) const {
    std::vector<std::array<double, 2>> steering(recording_.sectors());
    for (std::size_t beam = recording_.sensor->beams().size(); beam-- > 0;) {
      const SteeredPose pose = recording_.beam_pose(ping, beam);
      steering[recording_.sector_of(beam)] = {degrees(pose.across_rad), degrees(pose.along_rad)};
    }
    return steering;
  }

  static SonarNetcdfHeader header(const Recording& recording, const RunContext& run,
                                  const SwathSettings& settings) {
    const Sensor& sensor = *recording.sensor;
    const double c = recording.sound_speed_m_s, step_m = sensor.samples().step_m;
    const auto second = static_cast<std::time_t>(run.start_unix_s);
    SonarNetcdfHeader header;
    header.title = run.title.empty() ? sensor.description().name : run.title;
    header.summary =
        "Simulated. Levels are those of the receiver: they include spreading and absorption, unless the "
        "sensor has a time-varied gain. The reference point is the transducer, which also has the given "
        "attitude.";
    header.keywords = "multibeam, simulation";
    header.date_created = fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", fmt::gmtime(second));
    header.history = header.date_created + " tubefoot: simulated";
    header.sonar_manufacturer = "simulated";
    header.sonar_model = sensor.description().preset == "none" ? kind_of(sensor.description()).name()
                                                               : sensor.description().preset;
    header.platform_name = sensor.description().trajectory;
    header.platform_type = "simulated";
    header.beams = sensor.beams().size();
    header.frequency_hz = 1000 * sensor.frequency_khz();
    header.pulse_length_s = 2 * step_m / c;
    header.bandwidth_hz = 1 / header.pulse_length_s;
    header.absorption_db_per_m = recording.absorption_db_per_km / 1000;
    header.sound_speed_m_s = c;
    header.source_level_db = sensor.description().signal.source_level_db;
    header.receive_width_across_deg = settings.receive_across_deg;
    header.receive_width_along_deg = settings.receive_along_deg;
    header.beams_stabilised = sensor.stabilisation().any();
    header.transmit_width_across_deg = settings.transmit_across_deg;
    header.transmit_width_along_deg = settings.along_track_deg;
    header.equivalent_beam_angle_sr =
        radians(settings.receive_across_deg) * 2 * std::sin(radians(settings.along_track_deg) / 2);
    add_transmit_beams(header, recording);
    return header;
  }

  /// Adds the transmit beams of a sensor with transmit sectors.
  static void add_transmit_beams(SonarNetcdfHeader& header, const Recording& recording) {
    const Sensor& sensor = *recording.sensor;
    for (std::size_t k = 0; k < sensor.transmit_sectors().size(); ++k) {
      const TransmitSector& sector = sensor.transmit_sectors()[k];
      SonarTransmitBeam beam;
      beam.frequency_hz = 1000 * sector.frequency_khz;
      const std::optional<double> pulse_us = sensor.pulse_length_us(k);
      beam.pulse_length_s = pulse_us ? *pulse_us * 1e-6 : header.pulse_length_s;
      beam.bandwidth_hz = 1 / beam.pulse_length_s;
      beam.absorption_db_per_m = recording.absorption_of(k) / 1000;
      beam.width_along_deg = header.transmit_width_along_deg;
      beam.width_across_deg = degrees(sector.last_across_rad - sector.first_across_rad);
      beam.across_deg = degrees((sector.first_across_rad + sector.last_across_rad) / 2);
      beam.tilt_deg = degrees(sector.tilt_rad);
      beam.delay_s = sensor.transmission_delay_s(sensor.first_transmission(k));
      header.transmit_beams.push_back(beam);
    }
    for (std::size_t beam = 0; beam < sensor.beams().size(); ++beam)
      header.transmit_beam_of.push_back(recording.sector_of(beam));
  }

  const Recording& recording_;
  const BottomFinder& finder_;
  std::filesystem::path name_;
  SonarNetcdfFile file_;
};

/// Whole metres to add to depths below height 0 so that none is negative.
int depth_offset_m(const Recording& recording, const RunContext& run, const SoundingPlacer& placer) {
  const Sensor& sensor = *recording.sensor;
  const RangeSamples& samples = sensor.samples();
  const double far_m = samples.first_m + samples.count * samples.step_m;
  double highest_m = 0;
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
    const Pose& pose = recording.ping_pose[ping];
    double up_m = pose.position_m.z;
    for (std::size_t beam = 0; beam < sensor.beams().size(); ++beam) {
      const BeamRay ray = ray_of_beam(recording, ping, beam, static_cast<std::size_t>(samples.count) - 1);
      up_m = std::max(up_m, placer.highest_m(ray.pose, ray.axis, far_m, recording.water_level_error_m(ping)));
    }
    // The Earth's surface falls away from a tangent plane.
    constexpr double least_radius_m = 6.3e6;
    const double away_m = std::hypot(pose.position_m.x, pose.position_m.y) + placer.longest_m(far_m);
    const double below_plane_m = run.frame.is_tangent() ? away_m * away_m / (2 * least_radius_m) : 0;
    highest_m = std::max(highest_m, up_m + run.frame.origin_height_m() + below_plane_m);
  }
  return static_cast<int>(std::ceil(highest_m));
}

GsfOptions gsf_options(const Recording& recording, const RunContext& run, const SoundingPlacer& placer) {
  GsfOptions options;
  options.depth.offset = depth_offset_m(recording, run, placer);
  options.mean_amplitude = {50, 0, 2};
  return options;
}

Reson8101Settings settings_8101(const Recording& recording, const SwathSettings& swath) {
  const SignalDescription& signal = recording.sensor->description().signal;
  constexpr double fastest_hz = 65, largest_absorption = 255;  // limits of the fields
  Reson8101Settings settings;
  settings.sound_speed_m_s = recording.sound_speed_m_s;
  settings.range_m = std::ceil(swath.range_max_m);
  settings.ping_rate_hz = std::min(fastest_hz, 1 / recording.sensor->description().shortest_interval_s());
  settings.time_varied_gain = signal.tvg_spreading.has_value();
  settings.spreading = signal.tvg_spreading.value_or(settings.spreading);
  settings.absorption_db_per_km =
      std::min(largest_absorption, signal.tvg_absorption_db_per_km.value_or(recording.absorption_db_per_km));
  return settings;
}

/// Sound-speed profile by which the soundings were placed, with depths from height 0 down as in the file.
/// Above the profile's first point the water is isovelocity.
std::vector<GsfSoundSpeedProfile::Point> points_below_0(const Recording& recording, const RunContext& run) {
  if (!run.layered_water) return {{0, recording.sound_speed_m_s}};
  const auto& profile = run.layered_water->profile();
  const double depth_of_0_m = run.layered_water->surface_height_m() + run.frame.origin_height_m();
  std::vector<GsfSoundSpeedProfile::Point> points{{0, profile.at(depth_of_0_m)}};
  constexpr double codes_per_m = 100;  // no reader takes two points at one depth of the file for a step
  for (const auto& point : profile.points())
    if (const double depth_m = point.depth_m - depth_of_0_m;
        std::round(codes_per_m * depth_m) > std::round(codes_per_m * points.back().depth_m))
      points.push_back({depth_m, point.sound_speed_m_s});
  return points;
}

/// Processing of the soundings, in the format's own terms.
std::vector<std::string> gsf_parameters(bool traces_rays, bool corrects_water_level) {
  return {"REFERENCE TIME=1970/001 00:00:00",
          "ROLL_COMPENSATED=YES",
          "PITCH_COMPENSATED=YES",
          "HEAVE_COMPENSATED=YES",  // heave is in the depth corrector, which the depths include
          corrects_water_level ? "TIDE_COMPENSATED=YES" : "TIDE_COMPENSATED=NO",
          "DEPTH_CALCULATION=CORRECTED",
          traces_rays ? "RAY_TRACING=YES" : "RAY_TRACING=NO",  // NO: rays are straight in isovelocity water
          "ROLL_REFERENCE=ROTATED_PITCH_AXIS",
          "NUMBER_OF_TRANSMITTERS=1",
          "NUMBER_OF_RECEIVERS=1",
          "APPLIED_DRAFT=+00.00",
          "APPLIED_PITCH_BIAS=+00.00",
          "APPLIED_ROLL_BIAS=+00.00",
          "APPLIED_GYRO_BIAS=+00.00",
          "APPLIED_POSITION_OFFSET=+00.00,+00.00,+00.00",  // of the transducer, which is the reference point
          "APPLIED_TRANSDUCER_OFFSET=+00.00,+00.00,+00.00",
          "GEOID=WGS-84",
          "TIDAL_DATUM=UNKNOWN",
          "UTC_OFFSET=0"};
}

/// Azimuth of a direction (forward, starboard, down), counterclockwise from starboard, 0 to 360 degrees.
double counterclockwise_deg(const glm::dvec3& direction) {
  const double angle_deg = degrees(std::atan2(direction.x, direction.y));
  return angle_deg < 0 ? angle_deg + 360 : angle_deg;
}

class GsfFormat : public SwathFormat {
 public:
  GsfFormat(const std::filesystem::path& folder, const Recording& recording, const RunContext& run,
            const SwathSettings& settings, const SoundingPlacer& placer)
      : recording_(recording),
        settings_(settings),
        parameters_(gsf_parameters(placer.traces_rays(), !recording.water_level_errors_m.empty())),
        profile_{0, 0, 0, 0, points_below_0(recording, run)},
        lines_(folder, ".gsf", recording,
               std::vector<GsfOptions>(recording.lines().size(), gsf_options(recording, run, placer))) {}

  std::function<void()> adding(const PlacedPing& placed) override {
    const NavigationFix& fix = placed.fix;
    GsfPing ping;
    ping.unix_time_s = fix.unix_time_s;
    ping.longitude_deg = fix.place.lon_lat_height.x;
    ping.latitude_deg = fix.place.lon_lat_height.y;
    ping.heading_deg = fix.lie.heading_deg;
    ping.pitch_deg = fix.lie.pitch_deg;
    ping.roll_deg = fix.lie.roll_deg;
    ping.course_deg = fix.course_deg;
    ping.speed_m_s = fix.speed_m_s;
    ping.height_m = fix.place.lon_lat_height.z;
    ping.depth_corrector_m = -fix.place.lon_lat_height.z;
    if (settings_.is_like_8101) {
      ping.reson_8101 = settings_8101(recording_, settings_);
      ping.ping_number = recording_.number_of(placed.ping);
    }
    const Sensor& sensor = *recording_.sensor;
    const bool has_sectors = !sensor.transmit_sectors().empty(),
               is_tilted = has_sectors || sensor.stabilisation().any() || sensor.receiver_moves();
    for (std::size_t beam = 0; beam < placed.sounded.soundings.size(); ++beam) {
      const BeamRay& ray = placed.sounded.rays[beam];
      const glm::dvec3 axis =
          forward_starboard_down(fix.place.direction(ray.pose.attitude * ray.axis), fix.lie.heading_deg);
      if (is_tilted) {
        ping.beam_angle_deg.push_back(
            degrees(std::copysign(std::acos(std::clamp(axis.z, -1.0, 1.0)), axis.y)));
        ping.beam_azimuth_deg.push_back(counterclockwise_deg(axis));
        if (has_sectors) ping.sector.push_back(static_cast<std::uint8_t>(recording_.sector_of(beam)));
      } else {
        ping.beam_angle_deg.push_back(degrees(std::atan2(axis.y, axis.z)));
      }
      const std::optional<Sounding>& sounding = placed.sounded.soundings[beam];
      ping.flags.push_back(gsf_flags(sounding));
      const glm::dvec3 place = sounding ? placed.forward_starboard_down_m(beam) : glm::dvec3(0);
      ping.along_m.push_back(place.x);
      ping.across_m.push_back(place.y);
      ping.depth_m.push_back(sounding ? -placed.soundings_lon_lat[beam].z : 0);
      ping.two_way_time_s.push_back(sounding ? sounding->two_way_travel_time_s : 0);
      ping.mean_amplitude_db.push_back(sounding ? level_db(*sounding) : 0);
    }
    return [this, number = placed.ping, ping = std::move(ping)] {
      GsfFile& file = lines_.of(number);
      if (lines_.is_first_of_its_line(number)) describe_processing(file, ping);
      file.add_ping(ping);
    };
  }
  void finish() override { lines_.finish(); }
  std::vector<std::filesystem::path> files() const override { return lines_.names(); }

 private:
  void describe_processing(GsfFile& file, const GsfPing& first) {
    file.add_processing_parameters(first.unix_time_s, parameters_);
    profile_.observed_unix_time_s = profile_.applied_unix_time_s = first.unix_time_s;
    profile_.longitude_deg = first.longitude_deg;
    profile_.latitude_deg = first.latitude_deg;
    file.add_sound_speed_profile(profile_);
  }

  const Recording& recording_;
  const SwathSettings settings_;
  const std::vector<std::string> parameters_;
  GsfSoundSpeedProfile profile_;
  LineFiles<GsfFile, GsfOptions> lines_;
};

class XtfFormat : public SwathFormat {
 public:
  XtfFormat(const std::filesystem::path& folder, const Recording& recording, const RunContext& run,
            const SwathSettings& settings)
      : recording_(recording),
        settings_(settings),
        depths_m_(middle_depths_m(recording, run)),
        lines_(folder, ".xtf", recording, headers(recording, settings, depths_m_)) {}

  std::function<void()> adding(const PlacedPing& placed) override {
    const NavigationFix& fix = placed.fix;
    XtfPlace place;
    place.unix_time_s = fix.unix_time_s;
    place.ping_number = recording_.number_of(placed.ping);
    place.x = fix.place.lon_lat_height.x;
    place.y = fix.place.lon_lat_height.y;
    place.heading_deg = fix.lie.heading_deg;
    place.pitch_deg = fix.lie.pitch_deg;
    place.roll_deg = fix.lie.roll_deg;
    place.depth_m = -fix.place.lon_lat_height.z;
    place.heave_m = depths_m_[lines_.line_of(placed.ping)] - place.depth_m;
    if (placed.ping < recording_.altitude_m.size() && recording_.altitude_m[placed.ping] > 0)
      place.altitude_m = recording_.altitude_m[placed.ping];
    place.speed_m_s = fix.speed_m_s;
    if (settings_.is_like_8101)
      return [this, number = placed.ping, place, height_m = fix.place.lon_lat_height.z,
              beams = beams_of_8101(placed.sounded)] {
        XtfFile& file = lines_.of(number);
        add_motion(file, place, height_m);
        file.add_reson_8101_ping(place, settings_8101(recording_, settings_), beams);
      };
    return [this, number = placed.ping, place, height_m = fix.place.lon_lat_height.z,
            soundings = generic_of(placed.sounded, recording_.ping_time_s[placed.ping])] {
      XtfFile& file = lines_.of(number);
      add_motion(file, place, height_m);
      file.add_soundings(place, soundings);
    };
  }
  void finish() override { lines_.finish(); }
  std::vector<std::filesystem::path> files() const override { return lines_.names(); }

 private:
  /// Readers add the sonar's depth from the header, which has one value, to soundings, and subtract heave.
  /// The header therefore has the middle between the least and the greatest depth, and heave is the rest.
  static std::vector<double> middle_depths_m(const Recording& recording, const RunContext& run) {
    std::vector<double> depths_m;
    for (const PingSpan& line : recording.lines()) depths_m.push_back(middle_depth_m(recording, run, line));
    return depths_m;
  }
  static double middle_depth_m(const Recording& recording, const RunContext& run, const PingSpan& line) {
    constexpr std::size_t block = 4096;
    double lowest_m = std::numeric_limits<double>::infinity(), highest_m = -lowest_m;
    for (std::size_t first = line.first; first < line.end; first += block) {
      std::vector<glm::dvec3> places;
      for (std::size_t ping = first; ping < std::min(first + block, line.end); ++ping)
        places.push_back(recording.ping_pose[ping].position_m);
      run.frame.to_lon_lat(places, recording.sensor->description().place);
      for (const glm::dvec3& place : places) {
        lowest_m = std::min(lowest_m, place.z);
        highest_m = std::max(highest_m, place.z);
      }
    }
    return -(lowest_m + highest_m) / 2;
  }

  static std::vector<XtfHeader> headers(const Recording& recording, const SwathSettings& settings,
                                        const std::vector<double>& depths_m) {
    std::vector<XtfHeader> headers;
    for (const double depth_m : depths_m) headers.push_back(header(recording, settings, depth_m));
    return headers;
  }
  static XtfHeader header(const Recording& recording, const SwathSettings& settings, double depth_m) {
    XtfHeader header;
    header.sonar_name = recording.sensor->description().name.substr(0, 15);
    header.sonar_type = settings.is_like_8101 ? 15 : 45;
    header.sound_speed_m_s = recording.sound_speed_m_s;
    XtfChannel channel;
    channel.frequency_khz = recording.sensor->frequency_khz();
    channel.along_track_width_deg = settings.along_track_deg;
    channel.across_track_width_deg = settings.fan_deg;
    channel.tilt_deg = 90;
    channel.down_m = header.motion_down_m = depth_m;  // both at the transducer, without a lever arm between
                                                      // them
    header.bathymetry = channel;
    return header;
  }

  static void add_motion(XtfFile& file, const XtfPlace& place, double height_m) {
    file.add_attitude({place.unix_time_s, place.heading_deg, place.pitch_deg, place.roll_deg, place.heave_m});
    file.add_navigation({place.unix_time_s, place.x, place.y, height_m});
  }

  static std::vector<Reson8101Beam> beams_of_8101(const SoundedPing& sounded) {
    std::vector<Reson8101Beam> beams;
    for (const std::optional<Sounding>& sounding : sounded.soundings) {
      beams.emplace_back();
      if (!sounding) continue;
      constexpr double codes_per_db = 10, largest = 65535;
      beams.back().two_way_time_s = sounding->two_way_travel_time_s;
      beams.back().quality = kBrightness | kAmplitudeDetection;
      if (!is_cut(*sounding)) beams.back().quality |= kColinearity;
      beams.back().intensity = static_cast<std::uint16_t>(
          std::clamp(std::round(codes_per_db * level_db(*sounding)), 0.0, largest));
    }
    return beams;
  }

  std::vector<XtfSounding> generic_of(const SoundedPing& sounded, double ping_time_s) const {
    std::vector<XtfSounding> soundings;
    for (std::size_t beam = 0; beam < sounded.soundings.size(); ++beam) {
      const std::optional<Sounding>& sounding = sounded.soundings[beam];
      if (!sounding) continue;
      constexpr std::int32_t cut = 0, good = 1, of_several = 2;
      soundings.push_back({static_cast<std::int32_t>(beam), sounding->two_way_travel_time_s,
                           degrees(sounded.rays[beam].across_rad), degrees(sounded.rays[beam].tilt_rad),
                           level_db(*sounding),
                           is_cut(*sounding)              ? cut
                           : is_one_of_several(*sounding) ? of_several
                                                          : good,
                           sounding->time_s - ping_time_s});
    }
    return soundings;
  }

  const Recording& recording_;
  const SwathSettings settings_;
  std::vector<double> depths_m_;  ///< by line
  LineFiles<XtfFile, XtfHeader> lines_;
};

}  // namespace

std::unique_ptr<SwathFormat> make_sonar_netcdf(const std::filesystem::path& folder,
                                               const Recording& recording, const RunContext& run,
                                               const SwathSettings& settings, const BottomFinder& finder) {
  return std::make_unique<SonarNetcdfFormat>(folder, recording, run, settings, finder);
}

std::unique_ptr<SwathFormat> make_gsf(const std::filesystem::path& folder, const Recording& recording,
                                      const RunContext& run, const SwathSettings& settings,
                                      const SoundingPlacer& placer) {
  return std::make_unique<GsfFormat>(folder, recording, run, settings, placer);
}

std::unique_ptr<SwathFormat> make_xtf(const std::filesystem::path& folder, const Recording& recording,
                                      const RunContext& run, const SwathSettings& settings) {
  return std::make_unique<XtfFormat>(folder, recording, run, settings);
}

glm::dvec3 PlacedPing::forward_starboard_down_m(std::size_t beam) const {
  return forward_starboard_down(east_north_up_between(fix.place.lon_lat_height, soundings_lon_lat[beam]),
                                fix.lie.heading_deg);
}

}  // namespace tubefoot
