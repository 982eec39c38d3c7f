// SPDX-License-Identifier: GPL-3.0-or-later
// Writes GSF files (Generic Sensor Format of Leidos, version 3, docs/exchange-formats.md): records of pings
// with scaled arrays, attitude, sound-speed profiles and processing parameters, all big-endian.

#include "sensors/formats/gsf_file.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tubefoot {
namespace {

enum Record : std::uint32_t {
  kHeader = 1,
  kSwathPing = 2,
  kSoundSpeedProfile = 3,
  kProcessingParameters = 4,
  kAttitude = 12
};
constexpr std::uint32_t has_checksum = 0x80000000;
constexpr std::size_t largest_record = 524288;  // limit of the Leidos library
constexpr std::size_t header_size = 12;
constexpr double knots = 3600.0 / 1852.0;  // per m/s

enum Subrecord : std::uint8_t {
  kDepth = 1,
  kAcross = 2,
  kAlong = 3,
  kTwoWayTime = 4,
  kBeamAngle = 5,
  kMeanAmplitude = 6,
  kBeamFlags = 16,
  kBeamAngleForward = 18,
  kSectorNumber = 22,
  kScaleFactors = 100,
  kReson8101 = 122,
};

const GsfOptions& checked(const std::filesystem::path& path, const GsfOptions& options) {
  const FieldCheck check(fmt::format("{}: options", path.string()));
  check.text("version", options.version, header_size);
  const auto scale = [&](const char* name, const GsfScale& array, int small, int large) {
    if (array.multiplier < 1)
      check.fail(fmt::format("the multiplier of {} is {}, but must be at least 1", name, array.multiplier));
    if (array.bytes != small && array.bytes != large)
      check.fail(fmt::format("{} is stored in {} bytes, but must be stored in {}", name, array.bytes,
                             small == large ? fmt::to_string(small) : fmt::format("{} or {}", small, large)));
  };
  scale("depth", options.depth, 2, 4);
  scale("across", options.across, 2, 4);
  scale("along", options.along, 2, 4);
  scale("two-way time", options.two_way_time, 2, 4);
  scale("beam angle", options.beam_angle, 2, 2);
  scale("mean amplitude", options.mean_amplitude, 1, 2);
  return options;
}

/// Seconds and nanoseconds from whole microseconds. A double has no finer resolution in this century.
std::pair<std::int32_t, std::int32_t> gsf_moment(double unix_time_s, const FieldCheck& check) {
  check.within("time [s since 1970]", unix_time_s, 0, 2147483646);
  const auto microseconds = std::llround(unix_time_s * 1e6);
  return {static_cast<std::int32_t>(microseconds / 1000000),
          static_cast<std::int32_t>(microseconds % 1000000 * 1000)};
}

std::uint16_t direction(const char* name, double degrees, const FieldCheck& check) {
  return static_cast<std::uint16_t>(std::lround(check.within(name, degrees, 0, 360) * 100) % 36000);
}

struct Attitude {
  std::uint16_t heading;
  std::int16_t pitch, roll, heave;
};

Attitude attitude(double heading_deg, double pitch_deg, double roll_deg, double heave_m,
                  const FieldCheck& check) {
  return {direction("heading [deg]", heading_deg, check),
          check.integer<std::int16_t>("pitch [deg]", check.within("pitch [deg]", pitch_deg, -90, 90), 100),
          check.integer<std::int16_t>("roll [deg]", check.within("roll [deg]", roll_deg, -180, 180), 100),
          check.integer<std::int16_t>("heave [m]", heave_m, 100)};
}

PacketBytes ping_header(const GsfPing& ping, std::int16_t beams, const FieldCheck& check) {
  const auto [seconds, nanoseconds] = gsf_moment(ping.unix_time_s, check);
  const Attitude lie = attitude(ping.heading_deg, ping.pitch_deg, ping.roll_deg, ping.heave_m, check);
  PacketBytes data(std::endian::big, 56);
  data.put<std::int32_t>(0, seconds);
  data.put<std::int32_t>(4, nanoseconds);
  data.put<std::int32_t>(8, check.integer<std::int32_t>(
                                "longitude", check.within("longitude", ping.longitude_deg, -180, 180), 1e7));
  data.put<std::int32_t>(
      12, check.integer<std::int32_t>("latitude", check.within("latitude", ping.latitude_deg, -90, 90), 1e7));
  data.put<std::int16_t>(16, beams);
  data.put<std::int16_t>(18, static_cast<std::int16_t>((beams + 1) / 2));  // beams count from 1
  data.put<std::int16_t>(24, check.integer<std::int16_t>("tide [m]", ping.tide_m, 100));
  data.put<std::int32_t>(26, check.integer<std::int32_t>("depth corrector [m]", ping.depth_corrector_m, 100));
  data.put<std::uint16_t>(30, lie.heading);
  data.put<std::int16_t>(32, lie.pitch);
  data.put<std::int16_t>(34, lie.roll);
  data.put<std::int16_t>(36, lie.heave);
  data.put<std::uint16_t>(38, direction("course [deg]", ping.course_deg, check));
  data.put<std::uint16_t>(40, check.integer<std::uint16_t>("speed [m/s]", ping.speed_m_s, 100 * knots));
  data.put<std::int32_t>(42, check.integer<std::int32_t>("height [m]", ping.height_m, 1000));
  data.put<std::int32_t>(46, check.integer<std::int32_t>("separation [m]", ping.separation_m, 1000));
  data.put<std::int32_t>(50, check.integer<std::int32_t>("GPS tide [m]", ping.gps_tide_m, 1000));
  return data;
}

/// The library's structure for the whole 8100 series.
void append_reson_8101(PacketBytes& data, const Reson8101Settings& settings, std::uint32_t ping_number,
                       const FieldCheck& check) {
  PacketBytes own(std::endian::big, 52);
  own.put<std::uint32_t>(2, ping_number);
  own.put<std::uint32_t>(6, settings.sonar_id);
  own.put<std::uint16_t>(10, settings.sonar_model);
  own.put<std::uint16_t>(12, check.integer<std::uint16_t>("frequency [kHz]", settings.frequency_khz));
  own.put<std::uint16_t>(14, check.integer<std::uint16_t>("sound speed [m/s]", settings.sound_speed_m_s, 10));
  own.put<std::uint16_t>(16, check.integer<std::uint16_t>("sample rate [Hz]", sample_rate_hz(settings)));
  own.put<std::uint16_t>(18, check.integer<std::uint16_t>("ping rate [Hz]", settings.ping_rate_hz, 1e3));
  constexpr std::uint16_t has_amplitudes = 8;
  own.put<std::uint16_t>(20, has_amplitudes);
  own.put<std::uint16_t>(22, check.integer<std::uint16_t>("range setting [m]", settings.range_m));
  own.put<std::uint16_t>(24, static_cast<std::uint16_t>(check.within("power", settings.power, 0, 8)));
  own.put<std::uint16_t>(26, gain_word(settings, check));
  own.put<std::uint16_t>(28, check.integer<std::uint16_t>("pulse [s]", settings.pulse_s, 1e6));
  own.put<std::uint8_t>(30, check.integer<std::uint8_t>("spreading of the gain", settings.spreading, 4));
  own.put<std::uint8_t>(31, check.integer<std::uint8_t>("absorption [dB/km]", settings.absorption_db_per_km));
  own.put<std::uint8_t>(
      32, check.integer<std::uint8_t>("along-track width [deg]", settings.along_track_width_deg, 10));
  own.put<std::uint8_t>(
      33, check.integer<std::uint8_t>("across-track width [deg]", settings.across_track_width_deg, 10));
  own.put<std::int16_t>(
      35, check.integer<std::int16_t>("projector angle [deg]", settings.projector_angle_deg, 100));
  own.put<std::int16_t>(46,
                        check.integer<std::int16_t>("head temperature [C]", settings.head_temperature_c, 10));
  own.put<std::uint16_t>(48,
                         check.integer<std::uint16_t>("beam spacing [deg]", settings.beam_spacing_deg, 1e4));
  data.append<std::uint32_t>(kReson8101 << 24 | static_cast<std::uint32_t>(own.size()));
  data.append(own.bytes());
}

}  // namespace

/// An array of a ping and its storage.
struct GsfFile::Array {
  std::uint8_t id;
  const char* name;
  std::vector<double> values;
  GsfScale scale;
  bool is_signed;

  void append_to(PacketBytes& data, const FieldCheck& check) const {
    data.append<std::uint32_t>(
        static_cast<std::uint32_t>(id) << 24 |
        static_cast<std::uint32_t>(values.size() * static_cast<std::size_t>(scale.bytes)));
    for (std::size_t beam = 0; beam < values.size(); ++beam) {
      const std::string what = fmt::format("{} of beam {} (offset {})", name, beam, scale.offset);
      const auto put = [&]<typename Field>(Field) {
        data.append<Field>(check.integer<Field>(what, values[beam] + scale.offset, scale.multiplier));
      };
      switch (scale.bytes) {
        case 1:
          is_signed ? put(std::int8_t{}) : put(std::uint8_t{});
          break;
        case 2:
          is_signed ? put(std::int16_t{}) : put(std::uint16_t{});
          break;
        default:
          is_signed ? put(std::int32_t{}) : put(std::uint32_t{});
      }
    }
  }
};

GsfFile::GsfFile(const std::filesystem::path& path, const GsfOptions& options)
    : options_(checked(path, options)), file_(path) {
  PacketBytes data(std::endian::big, header_size);
  data.put_text(0, options_.version);
  write(kHeader, std::move(data));
}

void GsfFile::add_ping(const GsfPing& ping) {
  const FieldCheck check(fmt::format("{}: ping at {} s", file_.path().string(), ping.unix_time_s));
  if (ping.depth_m.empty()) check.fail("there are no depths");
  const auto beams = check.integer<std::int16_t>("number of beams", static_cast<double>(ping.depth_m.size()));
  const std::vector<Array> arrays = this->arrays(ping);
  std::vector<std::uint8_t> ids;
  for (const Array& array : arrays) {
    ids.push_back(array.id);
    if (array.values.size() != ping.depth_m.size())
      check.fail(
          fmt::format("there are {} values of {} for {} beams", array.values.size(), array.name, beams));
  }
  if (!arrays_of_file_.empty() && arrays_of_file_ != ids)
    check.fail("the arrays differ from those of the first ping");

  PacketBytes data = ping_header(ping, beams, check);
  if (arrays_of_file_.empty()) {
    data.append<std::uint32_t>(kScaleFactors << 24 | static_cast<std::uint32_t>(4 + 12 * arrays.size()));
    data.append<std::uint32_t>(static_cast<std::uint32_t>(arrays.size()));
    for (const Array& array : arrays) {
      data.append<std::uint8_t>(array.id);
      data.append<std::uint8_t>(static_cast<std::uint8_t>(array.scale.bytes << 4));
      data.append<std::uint16_t>(0);
      data.append<std::int32_t>(array.scale.multiplier);
      data.append<std::int32_t>(array.scale.offset);
    }
  }
  for (const Array& array : arrays) array.append_to(data, check);
  if (ping.reson_8101) append_reson_8101(data, *ping.reson_8101, ping.ping_number, check);
  if (data.size() > largest_record)
    check.fail(fmt::format("{} beams make a record of {} bytes, but readers accept at most {}", beams,
                           data.size(), largest_record));
  write(kSwathPing, std::move(data));
  arrays_of_file_ = std::move(ids);
}

std::vector<GsfFile::Array> GsfFile::arrays(const GsfPing& ping) const {
  std::vector<Array> arrays{{kDepth, "depth [m]", ping.depth_m, options_.depth, false}};
  const auto add = [&](std::uint8_t id, const char* name, const std::vector<double>& values,
                       const GsfScale& scale, bool is_signed) {
    if (!values.empty()) arrays.push_back({id, name, values, scale, is_signed});
  };
  add(kAcross, "distance across [m]", ping.across_m, options_.across, true);
  add(kAlong, "distance along [m]", ping.along_m, options_.along, true);
  add(kTwoWayTime, "two-way time [s]", ping.two_way_time_s, options_.two_way_time, false);
  add(kBeamAngle, "beam angle [deg]", ping.beam_angle_deg, options_.beam_angle, true);
  add(kMeanAmplitude, "mean amplitude [dB]", ping.mean_amplitude_db, options_.mean_amplitude, true);
  // Flags need no scale. pygsf assumes 2-byte values for an array without one.
  add(kBeamFlags, "flags", {ping.flags.begin(), ping.flags.end()}, {1, 0, 1}, false);
  // The array "beam angle forward" has the azimuths of the beams, counterclockwise from starboard (gsf.h).
  add(kBeamAngleForward, "beam azimuth [deg]", ping.beam_azimuth_deg, options_.beam_angle, false);
  add(kSectorNumber, "transmit sector", {ping.sector.begin(), ping.sector.end()}, {1, 0, 1}, false);
  return arrays;
}

void GsfFile::add_processing_parameters(double unix_time_s, std::span<const std::string> parameters) {
  const FieldCheck check(fmt::format("{}: processing parameters", file_.path().string()));
  const auto [seconds, nanoseconds] = gsf_moment(unix_time_s, check);
  PacketBytes data(std::endian::big);
  data.append<std::int32_t>(seconds);
  data.append<std::int32_t>(nanoseconds);
  data.append<std::uint16_t>(
      check.integer<std::uint16_t>("number of parameters", static_cast<double>(parameters.size())));
  for (const std::string& parameter : parameters) {
    if (parameter.find('=') == std::string::npos || parameter.find('\0') != std::string::npos)
      check.fail(fmt::format("'{}' is not of the form KEYWORD=VALUE", parameter));
    // The Leidos library counts the terminating zero of a text as one of its bytes.
    data.append<std::uint16_t>(
        check.integer<std::uint16_t>("length of a parameter", static_cast<double>(parameter.size() + 1)));
    data.append_zeros(parameter.size() + 1);
    data.put_text(data.size() - parameter.size() - 1, parameter);
  }
  if (data.size() > largest_record)
    check.fail(fmt::format("{} parameters make a record of {} bytes, but readers accept at most {}",
                           parameters.size(), data.size(), largest_record));
  write(kProcessingParameters, std::move(data));
}

void GsfFile::add_sound_speed_profile(const GsfSoundSpeedProfile& profile) {
  const FieldCheck check(fmt::format("{}: sound speed profile", file_.path().string()));
  if (profile.points.empty()) check.fail("there are no points");
  PacketBytes data(std::endian::big);
  for (const double time_s : {profile.observed_unix_time_s, profile.applied_unix_time_s}) {
    const auto [seconds, nanoseconds] = gsf_moment(time_s, check);
    data.append<std::int32_t>(seconds);
    data.append<std::int32_t>(nanoseconds);
  }
  data.append<std::int32_t>(check.integer<std::int32_t>(
      "longitude", check.within("longitude", profile.longitude_deg, -180, 180), 1e7));
  data.append<std::int32_t>(
      check.integer<std::int32_t>("latitude", check.within("latitude", profile.latitude_deg, -90, 90), 1e7));
  constexpr std::size_t point_bytes = 8;
  const std::size_t most = (largest_record - data.size() - sizeof(std::uint32_t)) / point_bytes;
  const std::size_t count = profile.points.size(), kept = std::min(count, most);
  data.append<std::uint32_t>(static_cast<std::uint32_t>(kept));
  double above_m = 0;
  for (std::size_t k = 0; k < kept; ++k) {
    const auto& [depth_m, speed_m_s] = profile.points[kept > 1 ? k * (count - 1) / (kept - 1) : 0];
    if (!(depth_m >= above_m))
      check.fail(fmt::format("depth {} m follows {} m: depths must not decrease", depth_m, above_m));
    above_m = depth_m;
    data.append<std::uint32_t>(check.integer<std::uint32_t>("depth [m]", depth_m, 100));
    data.append<std::uint32_t>(check.integer<std::uint32_t>("sound speed [m/s]", speed_m_s, 100));
  }
  write(kSoundSpeedProfile, std::move(data));
}

void GsfFile::add_attitude(std::span<const GsfAttitude> attitudes) {
  if (attitudes.empty())
    throw std::invalid_argument(fmt::format("{}: there are no attitudes", file_.path().string()));
  const double begin_s = attitudes.front().unix_time_s;
  const FieldCheck check(fmt::format("{}: attitudes from {} s", file_.path().string(), begin_s));
  const auto [seconds, nanoseconds] = gsf_moment(begin_s, check);
  PacketBytes data(std::endian::big);
  data.append<std::int32_t>(seconds);
  data.append<std::int32_t>(nanoseconds);
  data.append<std::uint16_t>(
      check.integer<std::uint16_t>("number of attitudes", static_cast<double>(attitudes.size())));
  double earlier_s = begin_s;
  for (const GsfAttitude& one : attitudes) {
    if (!(one.unix_time_s >= earlier_s))
      check.fail(fmt::format("time {} s follows {} s: times must not decrease", one.unix_time_s, earlier_s));
    earlier_s = one.unix_time_s;
    const Attitude lie = attitude(one.heading_deg, one.pitch_deg, one.roll_deg, one.heave_m, check);
    data.append<std::uint16_t>(
        check.integer<std::uint16_t>("time after the first attitude [s]", one.unix_time_s - begin_s, 1000));
    data.append<std::int16_t>(lie.pitch);
    data.append<std::int16_t>(lie.roll);
    data.append<std::int16_t>(lie.heave);
    data.append<std::uint16_t>(lie.heading);
  }
  if (data.size() > largest_record)
    check.fail(fmt::format("{} attitudes make a record of {} bytes, but readers accept at most {}",
                           attitudes.size(), data.size(), largest_record));
  write(kAttitude, std::move(data));
}

void GsfFile::finish() { file_.close(); }

void GsfFile::write(std::uint32_t record, PacketBytes data) {
  data.pad_to_multiple_of(4);
  PacketBytes head(std::endian::big);
  head.append<std::uint32_t>(static_cast<std::uint32_t>(data.size()));
  head.append<std::uint32_t>(record | (options_.checksums ? has_checksum : 0));
  if (options_.checksums)
    head.append<std::uint32_t>(std::accumulate(data.bytes().begin(), data.bytes().end(), std::uint32_t{0}));
  head.append(data.bytes());
  file_.append(head.bytes());
}

}  // namespace tubefoot
