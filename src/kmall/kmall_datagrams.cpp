// SPDX-License-Identifier: GPL-3.0-or-later
#include "kmall/kmall_datagrams.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>

#include "kmall/kmall_fields.hpp"

// This file reads the datagrams of a sonar in general: installation, motion, positions and sound speeds.
// Offsets are those of the structs of the format description.

namespace tubefoot {
namespace {

/// Throws for versions after the last one that is known.
void check_version(const KmallFile& file, const KmallRecord& record, unsigned last) {
  if (record.version > last)
    throw file.error(record,
                     fmt::format("has version {}: tubefoot reads versions up to {}", record.version, last));
}

/// Returns the entries "KEY:TEXT" or "KEY=TEXT" of a text that separates them by `separator`.
std::map<std::string, std::string, std::less<>> entries_of(std::string_view text, char separator,
                                                           char assigns) {
  std::map<std::string, std::string, std::less<>> entries;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    const std::string_view entry = text.substr(0, end);
    if (const std::size_t at = entry.find(assigns); at != std::string_view::npos) {
      std::string_view key = entry.substr(0, at);
      key.remove_prefix(std::min(key.find_first_not_of("\r\n "), key.size()));
      entries.emplace(key, entry.substr(at + 1));
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return entries;
}

double number_in(const KmallFields& body, const std::map<std::string, std::string, std::less<>>& entries,
                 std::string_view key) {
  const auto found = entries.find(key);
  if (found == entries.end()) return 0;
  double value = 0;
  const char* const end = found->second.data() + found->second.size();
  const auto [stop, problem] = std::from_chars(found->second.data(), end, value);
  if (problem != std::errc() || !std::isfinite(value) || std::abs(value) > 1e4)
    throw body.error(fmt::format("'{}' of the installation is not a number up to 10000", key));
  return value;
}

KmallMounting mounting_in(const KmallFields& body, std::string_view text) {
  const auto entries = entries_of(text, ';', '=');
  const auto value = [&](std::string_view key) { return number_in(body, entries, key); };
  KmallMounting mounting{{value("X"), value("Y"), value("Z")}, value("R"), value("P"), value("H"), {}};
  for (std::size_t part = 0; part < mounting.phase_centres_m.size(); ++part) {
    const std::string name = entries.contains("IX") ? "I" : std::array{"IP", "IC", "IS"}[part];
    mounting.phase_centres_m[part] = {value(name + "X"), value(name + "Y"), value(name + "Z")};
  }
  return mounting;
}

/// The part of #MRZ and #MWC that names ping, fan and heads.
template <class Ping>
void read_common(const KmallFields& common, Ping& ping) {
  ping.number = common.at<std::uint16_t>(2);
  ping.fans = common.at<std::uint8_t>(4);
  ping.fan = common.at<std::uint8_t>(5);
  ping.transmitter = common.at<std::uint8_t>(8);
  ping.receiver = common.at<std::uint8_t>(9);
}

KmallSector sector_of_sounding(const KmallFields& f) {
  KmallSector sector;
  sector.sub_array = std::min<std::size_t>(f.at<std::uint8_t>(2), 2);
  sector.delay_s = f.at<float>(4);
  sector.tilt_deg = f.at<float>(8);
  sector.source_level_db = f.at<float>(12);
  sector.frequency_hz = f.at<float>(20);
  sector.bandwidth_hz = f.at<float>(24);
  const double total_s = f.at<float>(28);
  const double effective_s = f.at_or<float>(44, 0);
  sector.effective_pulse_s = effective_s > 0 ? effective_s : total_s;
  return sector;
}

KmallSounding sounding_in(const KmallFields& f, const KmallPing& ping) {
  constexpr unsigned normal_detection = 0, by_amplitude = 1, by_phase = 2;
  KmallSounding s;
  const unsigned method = f.at<std::uint8_t>(4);
  s.is_valid = f.at<std::uint8_t>(3) == normal_detection && (method == by_amplitude || method == by_phase);
  s.sector = f.at<std::uint8_t>(2);
  if (s.sector >= ping.sectors.size())
    throw f.error(fmt::format("a sounding belongs to sector {}, but the ping has {} sectors", s.sector,
                              ping.sectors.size()));
  // Rejected soundings of a recording may contain values that are not finite.
  const auto value = [&](std::size_t offset) {
    const double number = f.unchecked<float>(offset);
    s.is_valid = s.is_valid && std::isfinite(number);
    return number;
  };
  s.water_column_angle_deg = value(40);
  s.absorption_db_per_km = value(44);
  constexpr double most_absorption_db_per_km = 1e5;
  s.is_valid =
      s.is_valid && s.absorption_db_per_km >= 0 && s.absorption_db_per_km <= most_absorption_db_per_km;
  s.angle_re_receiver_deg = value(72) + value(76);
  s.two_way_travel_time_s = value(80) + value(84);
  s.latitude_deg = ping.latitude_deg + value(88);
  s.longitude_deg = ping.longitude_deg + value(92);
  s.z_m = value(96);
  s.y_m = value(100);
  s.x_m = value(104);
  return s;
}

}  // namespace

KmallInstallation read_kmall_installation(KmallFile& file, const KmallRecord& record) {
  const std::vector<std::uint8_t> bytes = file.body(record);
  const KmallFields body(file, record, bytes);
  constexpr std::size_t text_at = 6;
  std::string text(bytes.begin() + std::min(text_at, bytes.size()), bytes.end());
  text.erase(std::find(text.begin(), text.end(), '\0'), text.end());
  const auto entries = entries_of(text, ',', ':');
  const auto entry = [&](const std::string& key) {
    const auto found = entries.find(key);
    return found == entries.end() ? std::string() : found->second;
  };
  KmallInstallation installation;
  installation.sonar = entry("SYSTEM");
  installation.revision = entry("KMALL");
  for (std::size_t head = 0; head < installation.transmitters.size(); ++head)
    for (const auto& [name, mounting] : {std::pair("TRAI_TX", &installation.transmitters[head]),
                                         std::pair("TRAI_RX", &installation.receivers[head])})
      if (const std::string described = entry(fmt::format("{}{}", name, head + 1)); !described.empty())
        *mounting = mounting_in(body, described);
  for (const char* name : {"ATTI_1", "ATTI_2"})
    if (const std::string described = entry(name); described.find("U=ACTIVE") != std::string::npos)
      installation.motion_sensor = mounting_in(body, described);
  installation.waterline_m = number_in(body, entries_of(entry("EMXI"), ';', '='), "SWLZ");
  if (!installation.transmitters[0] || !installation.receivers[0])
    throw body.error("names no transmitter and receiver: 'TRAI_TX1' and 'TRAI_RX1' were expected");
  return installation;
}

std::vector<KmallMotion> read_kmall_motion(KmallFile& file, const KmallRecord& record) {
  check_version(file, record, 1);
  const std::vector<std::uint8_t> bytes = file.body(record);
  KmallParts parts(KmallFields(file, record, bytes));
  constexpr std::size_t least_info = 12, least_sample = 64;
  const KmallFields info = parts.sized(least_info);
  const std::size_t samples = info.at<std::uint16_t>(6), size = info.at<std::uint16_t>(8);
  std::vector<KmallMotion> motion;
  for (std::size_t k = 0; k < samples; ++k) {
    const KmallFields f = parts.take(size, least_sample);
    motion.push_back({f.at<std::uint32_t>(8) + 1e-9 * f.at<std::uint32_t>(12), f.at<float>(40),
                      f.at<float>(44), f.at<float>(48), f.at<float>(52)});
  }
  return motion;
}

KmallPosition read_kmall_position(KmallFile& file, const KmallRecord& record) {
  check_version(file, record, 0);
  const std::vector<std::uint8_t> bytes = file.body(record);
  KmallParts parts(KmallFields(file, record, bytes));
  parts.sized(8);
  const KmallFields& f = parts.rest();
  return {f.at<std::uint32_t>(0) + 1e-9 * f.at<std::uint32_t>(4), f.at<double>(12), f.at<double>(20)};
}

std::vector<KmallSoundSpeed> read_kmall_profile(KmallFile& file, const KmallRecord& record) {
  check_version(file, record, 1);
  const std::vector<std::uint8_t> bytes = file.body(record);
  KmallParts parts(KmallFields(file, record, bytes));
  constexpr std::size_t least_info = 28, sample_bytes = 20;
  const KmallFields info = parts.sized(least_info);
  const std::size_t samples = info.at<std::uint16_t>(2);
  std::vector<KmallSoundSpeed> profile;
  for (std::size_t k = 0; k < samples; ++k) {
    const KmallFields f = parts.take(sample_bytes);
    profile.push_back({f.at<float>(0), f.at<float>(4)});
  }
  return profile;
}

KmallPing read_kmall_ping(KmallFile& file, const KmallRecord& record) {
  check_version(file, record, 3);
  const std::vector<std::uint8_t> bytes = file.body(record);
  KmallParts parts(KmallFields(file, record, bytes));
  KmallPing ping;
  ping.time_s = record.time_s;
  read_common(parts.sized(12), ping);
  const KmallFields info = parts.sized(140);
  ping.swath_port_deg = info.at<float>(44);
  ping.swath_starboard_deg = info.at<float>(48);
  ping.transmit_width_deg = info.at<float>(72);
  ping.receive_width_deg = info.at<float>(76);
  const std::size_t sectors = info.at<std::uint16_t>(92), sector_bytes = info.at<std::uint16_t>(94);
  ping.heading_deg = info.at<float>(96);
  ping.sound_speed_m_s = info.at<float>(100);
  ping.waterline_m = info.at<float>(108);
  ping.latitude_deg = info.at<double>(124);
  ping.longitude_deg = info.at<double>(132);
  if (!(ping.sound_speed_m_s > 0)) throw info.error("has a sound speed of 0");
  for (std::size_t k = 0; k < sectors; ++k)
    ping.sectors.push_back(sector_of_sounding(parts.take(sector_bytes, 36)));
  const KmallFields received = parts.sized(32);
  const std::size_t soundings = received.at<std::uint16_t>(2) + received.at<std::uint16_t>(26);
  const std::size_t sounding_bytes = received.at<std::uint16_t>(6);
  ping.water_column_rate_hz = received.at<float>(8);
  const std::size_t classes = received.at<std::uint16_t>(28), class_bytes = received.at<std::uint16_t>(30);
  parts.take(classes * class_bytes);
  ping.soundings.reserve(soundings);
  for (std::size_t k = 0; k < soundings; ++k)
    ping.soundings.push_back(sounding_in(parts.take(sounding_bytes, 112), ping));
  return ping;
}

KmallWaterColumn read_kmall_water_column(KmallFile& file, const KmallRecord& record) {
  check_version(file, record, 2);
  const std::vector<std::uint8_t> bytes = file.body(record);
  KmallParts parts(KmallFields(file, record, bytes));
  KmallWaterColumn column;
  column.time_s = record.time_s;
  read_common(parts.sized(12), column);
  const KmallFields transmitted = parts.sized(12);
  const std::size_t sectors = transmitted.at<std::uint16_t>(2),
                    sector_bytes = transmitted.at<std::uint16_t>(4);
  for (std::size_t k = 0; k < sectors; ++k) {
    const KmallFields f = parts.take(sector_bytes, 14);
    KmallSector& sector = column.sectors.emplace_back();
    sector.tilt_deg = f.at<float>(0);
    sector.frequency_hz = f.at<float>(4);
    sector.beam_width_along_deg = f.at<float>(8);
  }
  const KmallFields received = parts.sized(16);
  const std::size_t beams = received.at<std::uint16_t>(2);
  const std::size_t beam_bytes = received.at<std::uint8_t>(4), phase = received.at<std::uint8_t>(5);
  column.gain_exponent = received.at<std::uint8_t>(6);
  column.gain_offset_db = received.at<std::int8_t>(7);
  column.sample_rate_hz = received.at<float>(8);
  column.sound_speed_m_s = received.at<float>(12);
  if (!(column.sample_rate_hz > 0) || !(column.sound_speed_m_s > 0))
    throw received.error("has a sample rate or a sound speed of 0");
  if (phase > 2) throw received.error(fmt::format("has phases of kind {}: expected 0, 1 or 2", phase));
  for (std::size_t k = 0; k < beams; ++k) {
    const KmallFields f = parts.take(beam_bytes, 12);
    KmallWaterBeam& beam = column.beams.emplace_back();
    beam.angle_deg = f.at<float>(0);
    beam.first_sample = f.at<std::uint16_t>(4);
    beam.sector = f.at<std::uint16_t>(8);
    beam.detected_sample = f.at_or<float>(12, float(f.at<std::uint16_t>(6)));
    if (beam.sector >= sectors)
      throw f.error(
          fmt::format("beam {} belongs to sector {}, but the ping has {} sectors", k, beam.sector, sectors));
    const std::size_t samples = f.at<std::uint16_t>(10);
    const std::span<const std::uint8_t> levels = parts.take(samples).bytes();
    beam.levels.assign(levels.begin(), levels.end());
    parts.take(samples * phase);  // phases of 1 or 2 bytes per sample
  }
  return column;
}

}  // namespace tubefoot
