// SPDX-License-Identifier: GPL-3.0-or-later
// Writes DIDSON files, version 3 (.ddf, "DDF_03", docs/exchange-formats.md): headers of file and frames, and
// the codes of range gates.

#include "sensors/formats/ddf_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace tubefoot {

namespace {

constexpr std::size_t ddf_header_size = 512, ddf_frame_size = 256;
constexpr std::uint32_t ddf_signature = 0x03464444;  // "DDF" 3
constexpr int samples_per_beam = 512;
constexpr std::uint32_t largest_start_code = 31, largest_length_code = 3;

bool classic(const DdfHeader& camera) { return (camera.config_flags & 1) != 0; }
bool long_range(const DdfHeader& camera) { return (camera.config_flags & 2) != 0; }
const char* resolution(const DdfHeader& camera) {
  return camera.high_resolution ? "high resolution" : "low resolution";
}

double half_sample_m(double length_m) { return length_m / samples_per_beam / 2; }

/// Readers disagree on these lengths: 0.83 or 1.25 m for one, 70 or 80 m for the other.
bool disputed(const DdfHeader& camera, std::uint32_t length_code) {
  if (classic(camera)) return false;
  return camera.high_resolution ? !long_range(camera) && length_code == 0
                                : long_range(camera) && length_code == 3;
}

}  // namespace

void check(const DdfHeader& header, const std::string& what) {
  const int beams = header.high_resolution && !long_range(header) ? 96 : 48;
  if (header.beams != beams)
    throw std::invalid_argument(
        fmt::format("{}: invalid number of beams {}: a {}DIDSON in {} has {}; write ARIS (DDF_05) for 48, "
                    "64, 96 or 128 beams",
                    what, header.beams, long_range(header) ? "long-range " : "", resolution(header), beams));
  if (header.samples != samples_per_beam)
    throw std::invalid_argument(
        fmt::format("{}: {} samples per beam, but a DIDSON has 512; write ARIS (DDF_05) for other numbers",
                    what, header.samples));
  require_field(header.window.start_code >= 1 && header.window.start_code <= largest_start_code, what,
                "the window's start code", header.window.start_code, "1 to 31");
  require_field(header.window.length_code <= largest_length_code, what, "the window's length code",
                header.window.length_code, "0 to 3");
  require_field(header.frame_rate_hz > 0 && header.frame_rate_hz <= 1e6, what, "the frame rate",
                header.frame_rate_hz, "above 0, at most 1e6 Hz");
  require_field(header.sample_rate_hz > 0 && header.sample_rate_hz <= 1e9, what, "the sample rate",
                header.sample_rate_hz, "above 0, at most 1e9 Hz");
  require_field(header.sound_speed_m_s > 0 && header.sound_speed_m_s <= 1e5, what, "the speed of sound",
                header.sound_speed_m_s, "above 0, at most 1e5 m/s");
  require_field(std::abs(header.water_temperature_c) <= 1000, what, "the water's temperature",
                header.water_temperature_c, "between -1000 and 1000 degrees");
}

double ddf_window_length_m(const DdfHeader& camera, std::uint32_t length_code) {
  static constexpr std::array shortest_m{1.25, 1.125, 2.5, 2.25};  // by the two low flags, high resolution
  return std::ldexp(shortest_m[camera.config_flags & 3],
                    static_cast<int>(length_code) + (camera.high_resolution ? 0 : 2));
}

double ddf_start_step_m(const DdfHeader& camera, DdfStartStep step) {
  const double coarser = camera.high_resolution ? 1 : 2;
  if (classic(camera)) return 0.375 * coarser;
  switch (step) {
    case DdfStartStep::matlab:
      return 0.419 * coarser;
    case DdfStartStep::delay_time:
      return (camera.serial_number <= 18 ? 0.512e-3 : 0.572e-3) * coarser * camera.sound_speed_m_s / 2;
    case DdfStartStep::vendor:
      break;
  }
  return 0.42 * coarser;
}

DdfWindow ddf_window(const DdfHeader& camera, double start_m, double length_m, DdfStartStep step) {
  DdfWindow window;
  std::vector<double> lengths_m;
  bool found = false;
  for (std::uint32_t code = 0; code <= largest_length_code; ++code) {
    if (disputed(camera, code)) continue;
    lengths_m.push_back(ddf_window_length_m(camera, code));
    if (!(std::abs(lengths_m.back() - length_m) <= half_sample_m(lengths_m.back()))) continue;
    window.length_code = code;
    found = true;
  }
  if (!found)
    throw std::invalid_argument(
        fmt::format("a DIDSON in {} has no window of {} m that all programs read in the same way: choose a "
                    "window_length_m of {}, or write ARIS (DDF_05)",
                    resolution(camera), length_m, fmt::join(lengths_m, ", ")));
  const double step_m = ddf_start_step_m(camera, step);
  const double code = std::clamp(std::round(start_m / step_m), 1.0, double{largest_start_code});
  if (!(std::abs(code * step_m - start_m) <= half_sample_m(ddf_window_length_m(camera, window.length_code))))
    throw std::invalid_argument(
        fmt::format("a DIDSON in {} has no window that starts at {} m: windows start after 1 to 31 steps of "
                    "{:.6g} m; choose a window_start_m of {:.6g}, or write ARIS (DDF_05)",
                    resolution(camera), start_m, step_m, std::isnan(code) ? step_m : code * step_m));
  window.start_code = static_cast<std::uint32_t>(code);
  return window;
}

double ddf_sample_rate_hz(double length_m, double sound_speed_m_s) {
  return samples_per_beam * sound_speed_m_s / (2 * length_m);
}

std::uint8_t ddf_amplitude(double level_db) { return amplitude(level_db, ddf_full_scale_db); }

DdfFile::DdfFile(const std::filesystem::path& file, DdfHeader header)
    : CameraFile(file, {(check(header, file.string()), header.beams), header.samples, header.most_frames}),
      header_(std::move(header)) {
  begin();
}

PacketBytes DdfFile::file_header() const {
  PacketBytes record(std::endian::little, ddf_header_size);
  record.put<std::uint32_t>(0, ddf_signature);
  record.put<std::uint32_t>(4, frames());
  record.put<std::uint32_t>(8, static_cast<std::uint32_t>(std::max(1.0, std::round(header_.frame_rate_hz))));
  record.put<std::uint32_t>(12, header_.high_resolution ? 1 : 0);
  record.put<std::uint32_t>(16, static_cast<std::uint32_t>(header_.beams));
  record.put_single(20, header_.sample_rate_hz);
  record.put<std::uint32_t>(24, samples_per_beam);
  record.put<std::uint32_t>(32, header_.window.start_code);
  record.put<std::uint32_t>(36, header_.window.length_code);
  record.put<std::uint32_t>(44, header_.serial_number);
  record.put_text(48, 32, date());
  record.put_text(80, 256, header_.title);
  // Bytes 352 and 356, StartFrame and EndFrame, stay 0. Readers would take other values for a part of the
  // file to read.
  record.put<std::uint32_t>(372, 1);  // FrameInterval
  record.put<std::uint32_t>(384, static_cast<std::uint32_t>(std::round(header_.sound_speed_m_s)));
  return record;
}

PacketBytes DdfFile::frame_header(const CameraFrame& frame) const {
  PacketBytes record(std::endian::little, ddf_frame_size);
  const CalendarTime time = calendar_time(frame.unix_time_s);
  record.put<std::uint32_t>(0, frames());
  record.put<std::uint64_t>(4, time.unix_s);
  record.put<std::uint32_t>(12, ddf_signature);
  record.put<std::uint32_t>(20, time.year);
  record.put<std::uint32_t>(24, time.month);
  record.put<std::uint32_t>(28, time.day);
  record.put<std::uint32_t>(32, time.hour);
  record.put<std::uint32_t>(36, time.minute);
  record.put<std::uint32_t>(40, time.second);
  record.put<std::uint32_t>(44, time.hundredth);
  record.put<std::uint32_t>(
      48,
      header_.high_resolution ? 3 : 2);  // TransmitMode: bit 0 high resolution, bit 1 transmits
  record.put<std::uint32_t>(52, header_.window.start_code);
  record.put<std::uint32_t>(56, header_.window.length_code);
  record.put<std::uint32_t>(
      64, static_cast<std::uint32_t>(ddf_full_scale_db));  // Intensity: displays the whole scale
  put_platform(record, frame);
  record.put<std::uint32_t>(192, header_.config_flags);
  record.put_single(224, header_.water_temperature_c);
  return record;
}

}  // namespace tubefoot
