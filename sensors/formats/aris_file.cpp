// SPDX-License-Identifier: GPL-3.0-or-later
// Writes ARIS files (.aris, "DDF_05", docs/exchange-formats.md): headers of file and frames, range gates in
// whole microseconds, and the frame rates that a range gate permits.

#include "sensors/formats/aris_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace tubefoot {

namespace {

constexpr std::size_t aris_header_size = 1024, aris_frame_size = 1024;
constexpr std::uint32_t aris_signature = 0x05464444;  // "DDF" 5
constexpr double shortest_delay_us = 930, longest_delay_us = 65535;
constexpr double shortest_period_us = 4, longest_period_us = 100;
constexpr double shortest_cycle_us = 1802, longest_cycle_us = 65535;

/// Range [m] of a two-way travel time.
double range_m(double time_us, double sound_speed_m_s) { return time_us * 1e-6 * sound_speed_m_s / 2; }
double time_us(double range_m, double sound_speed_m_s) { return 2 * range_m / sound_speed_m_s * 1e6; }

/// Duration of one transmission with its echoes: the end of the range gate, and the 420 us that the vendor's
/// frame rates include per transmission.
double cycle_us(const ArisWindow& window, int samples) {
  return std::max(shortest_cycle_us,
                  window.start_delay_us + static_cast<double>(samples) * window.sample_period_us + 420);
}

}  // namespace

void check(const ArisHeader& header, const std::string& what) {
  ArisModel natural{};
  try {
    natural = aris_ping_mode(header.beams).model;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: {}", what, error.what()));
  }
  if (header.model && *header.model != natural &&
      !(header.beams == 48 && *header.model == ArisModel::aris_1200))
    throw std::invalid_argument(
        fmt::format("{}: {} beams do not fit the model: an ARIS 1200 has 48 beams, an ARIS 1800 has 48 or "
                    "96, and an ARIS 3000 has 64 or 128",
                    what, header.beams));
  require_field(header.samples >= 1 && header.samples <= longest_cycle_us, what, "the number of samples",
                header.samples, "1 to 65535");
  require_field(
      header.window.start_delay_us >= shortest_delay_us && header.window.start_delay_us <= longest_delay_us,
      what, "the start delay", header.window.start_delay_us, "930 to 65535 us");
  require_field(header.window.sample_period_us >= shortest_period_us &&
                    header.window.sample_period_us <= longest_period_us,
                what, "the sample period", header.window.sample_period_us, "4 to 100 us");
  const double cycle = cycle_us(header.window, header.samples);
  require_field(cycle <= longest_cycle_us, what, "the time of one transmission and its echoes", cycle,
                "at most 65535 us: end the window at a shorter range");
  require_field(header.sound_speed_m_s > 0 && header.sound_speed_m_s <= 1e5, what, "the speed of sound",
                header.sound_speed_m_s, "above 0, at most 1e5 m/s");
  require_field(header.frame_rate_hz > 0 && header.frame_rate_hz <= 1e6, what, "the frame rate",
                header.frame_rate_hz, "above 0, at most 1e6 Hz");
  require_field(header.pulse_width_us == 0 || (header.pulse_width_us >= 4 && header.pulse_width_us <= 100),
                what, "the pulse width", header.pulse_width_us, "4 to 100 us, or 0 if unknown");
  require_field(std::abs(header.water_temperature_c) <= 1000, what, "the water's temperature",
                header.water_temperature_c, "between -1000 and 1000 degrees");
}

ArisPingMode aris_ping_mode(int beams) {
  switch (beams) {
    case 48:
      return {1, 3, ArisModel::aris_1800};
    case 96:
      return {3, 6, ArisModel::aris_1800};
    case 64:
      return {6, 4, ArisModel::aris_3000};
    case 128:
      return {9, 8, ArisModel::aris_3000};
    default:
      throw std::invalid_argument(
          fmt::format("invalid number of beams {}: an ARIS has 48, 64, 96 or 128", beams));
  }
}

double ArisWindow::start_m(double sound_speed_m_s) const { return range_m(start_delay_us, sound_speed_m_s); }

double ArisWindow::length_m(double sound_speed_m_s, int samples) const {
  return range_m(static_cast<double>(samples) * sample_period_us, sound_speed_m_s);
}

ArisWindow aris_window(double start_m, double length_m, int samples, double sound_speed_m_s) {
  if (!(samples >= 1 && sound_speed_m_s > 0 && std::isfinite(sound_speed_m_s)))
    throw std::invalid_argument(
        fmt::format("no ARIS window has {} samples at a sound speed of {} m/s", samples, sound_speed_m_s));
  const double wanted_us = time_us(length_m, sound_speed_m_s) / samples;
  const double period_us = std::clamp(std::round(wanted_us), shortest_period_us, longest_period_us);
  if (!(std::abs(period_us - wanted_us) * samples <= period_us / 2)) {
    const double below = std::isnan(wanted_us)
                             ? shortest_period_us
                             : std::clamp(std::floor(wanted_us), shortest_period_us, longest_period_us - 1);
    const auto length_of = [&](double period) { return range_m(period * samples, sound_speed_m_s); };
    throw std::invalid_argument(fmt::format(
        "an ARIS has no window of {} m in {} samples: its sample period is a whole number of microseconds "
        "from 4 to 100; choose a window_length_m of {:.6f} ({} us) or {:.6f} ({} us)",
        length_m, samples, length_of(below), below, length_of(below + 1), below + 1));
  }
  const double delay_us = std::round(time_us(start_m, sound_speed_m_s));
  if (!(delay_us >= shortest_delay_us && delay_us <= longest_delay_us))
    throw std::invalid_argument(fmt::format(
        "an ARIS has no window that starts at {} m: choose a window_start_m of {:.4f} to {:.4f}", start_m,
        range_m(shortest_delay_us, sound_speed_m_s), range_m(longest_delay_us, sound_speed_m_s)));
  return {static_cast<std::uint32_t>(delay_us), static_cast<std::uint32_t>(period_us)};
}

std::optional<ArisWindow> nearest_aris_window(double start_m, double length_m, int samples,
                                              double sound_speed_m_s) {
  const double period_us = std::round(time_us(length_m, sound_speed_m_s) / samples),
               requested_us = std::round(time_us(start_m, sound_speed_m_s)),
               delay_us = std::max(shortest_delay_us, requested_us);
  if (!(delay_us - requested_us <= period_us * samples / 50 && period_us >= shortest_period_us &&
        period_us <= longest_period_us && delay_us <= longest_delay_us))
    return std::nullopt;
  return ArisWindow{static_cast<std::uint32_t>(delay_us), static_cast<std::uint32_t>(period_us)};
}

bool is_aris(const SensorDescription& sensor) { return sensor.preset.starts_with("aris-"); }

std::uint8_t aris_amplitude(double level_db) { return amplitude(level_db, aris_full_scale_db); }

ArisFile::ArisFile(const std::filesystem::path& file, ArisHeader header)
    : CameraFile(file, {(check(header, file.string()), header.beams), header.samples, header.most_frames}),
      header_(std::move(header)) {
  begin();
}

PacketBytes ArisFile::file_header() const {
  PacketBytes record(std::endian::little, aris_header_size);
  record.put<std::uint32_t>(0, aris_signature);
  record.put<std::uint32_t>(4, frames());
  record.put<std::uint32_t>(8, static_cast<std::uint32_t>(std::max(1.0, std::round(header_.frame_rate_hz))));
  record.put<std::uint32_t>(12, header_.high_frequency ? 1 : 0);
  record.put<std::uint32_t>(16, static_cast<std::uint32_t>(header_.beams));
  record.put_single(20, 1e6 / header_.window.sample_period_us);
  record.put<std::uint32_t>(24, static_cast<std::uint32_t>(header_.samples));
  record.put_single(32, header_.window.start_m(header_.sound_speed_m_s));
  record.put_single(36, header_.window.length_m(header_.sound_speed_m_s, header_.samples));
  record.put<std::uint32_t>(44, header_.serial_number);
  record.put_text(48, 32, date());
  record.put_text(80, 256, header_.title);
  // Bytes 352 and 356, StartFrame and EndFrame, stay 0. Readers would take other values for a part of the
  // file to read.
  record.put<std::uint32_t>(372, 1);  // FrameInterval
  record.put<std::uint32_t>(384, static_cast<std::uint32_t>(std::round(header_.sound_speed_m_s)));
  // Codes for 5 to 15, 15 to 25 and 25 to 35 degrees, and for fresh, brackish and salt water.
  record.put<std::uint32_t>(396, header_.water_temperature_c < 15   ? 0
                                 : header_.water_temperature_c < 25 ? 1
                                                                    : 2);
  record.put<std::uint32_t>(400, header_.salinity == ArisSalinity::fresh      ? 0
                                 : header_.salinity == ArisSalinity::brackish ? 1
                                                                              : 2);
  record.put<std::uint64_t>(424, bytes());
  record.put<std::uint32_t>(452, header_.telephoto_lens ? 1 : 0);
  return record;
}

PacketBytes ArisFile::frame_header(const CameraFrame& frame) const {
  PacketBytes record(std::endian::little, aris_frame_size);
  const CalendarTime time = calendar_time(frame.unix_time_s);
  const auto microseconds = static_cast<std::uint64_t>(std::llround(frame.unix_time_s * 1e6));
  const ArisPingMode mode = aris_ping_mode(header_.beams);
  record.put<std::uint32_t>(0, frames());
  record.put<std::uint64_t>(4, microseconds);
  record.put<std::uint32_t>(12, aris_signature);
  record.put<std::uint64_t>(20, microseconds);
  record.put<std::uint32_t>(28, time.day);
  record.put<std::uint32_t>(32, time.hour);
  record.put<std::uint32_t>(36, time.minute);
  record.put<std::uint32_t>(40, time.second);
  record.put<std::uint32_t>(44, time.hundredth);
  record.put_single(52, header_.window.start_m(header_.sound_speed_m_s));
  record.put_single(56, header_.window.length_m(header_.sound_speed_m_s, header_.samples));
  put_platform(record, frame);
  record.put_single(224, header_.water_temperature_c);
  record.put_single(420, 1e6 / header_.window.sample_period_us);
  record.put<std::uint32_t>(436, mode.code);
  record.put<std::uint32_t>(440, header_.high_frequency ? 1 : 0);
  record.put<std::uint32_t>(444, header_.pulse_width_us);
  record.put<std::uint32_t>(448, static_cast<std::uint32_t>(cycle_us(header_.window, header_.samples)));
  record.put<std::uint32_t>(452, header_.window.sample_period_us);
  record.put<std::uint32_t>(456, 1);  // TransmitEnable
  record.put_single(460, header_.frame_rate_hz);
  record.put_single(464, header_.sound_speed_m_s);
  record.put<std::uint32_t>(468, static_cast<std::uint32_t>(header_.samples));
  record.put<std::uint32_t>(472, 1);  // Enable150V: full power
  record.put<std::uint32_t>(476, header_.window.start_delay_us);
  record.put<std::uint32_t>(480, header_.telephoto_lens ? 1 : 0);
  record.put<std::uint32_t>(484, static_cast<std::uint32_t>(header_.model.value_or(mode.model)));
  record.put<std::uint32_t>(488, header_.serial_number);
  record.put<std::uint32_t>(516, 1);  // ReorderedSamples: the order is already [sample][beam]
  record.put<std::uint32_t>(520, static_cast<std::uint32_t>(header_.salinity));
  return record;
}

}  // namespace tubefoot
