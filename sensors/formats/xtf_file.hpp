// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/streamed_file.hpp"
#include "sensors/formats/packet_bytes.hpp"
#include "sensors/formats/reson_8101.hpp"

namespace tubefoot {

/// What the positions of an XTF file are. Readers take metres for UTM of a zone that the file does not name.
enum class XtfNavigation { kDegrees, kMetres };

/// A channel as the file header describes it. Zero: unknown.
struct XtfChannel {
  double frequency_khz = 0;                           ///< 0 to 65535
  double along_track_width_deg = 0;                   ///< of the beam, -3 dB
  double across_track_width_deg = 0;                  ///< -3 dB, of the fan (vertical)
  double tilt_deg = 0;                                ///< of the fan's axis below the horizontal
  double starboard_m = 0, forward_m = 0, down_m = 0;  ///< place of the transducer on the carrier
};

struct XtfSidescan {
  XtfChannel port, starboard;
  /// No ping may have more samples a side; some readers rely on the number in the header. At least 1.
  std::uint32_t max_samples = 0;
  bool time_varied_gain = false;  ///< the samples have had one
};

struct XtfHeader {
  std::string program = "tubefoot";  ///< at most 8 bytes: a reader in C may show the version behind them
  std::string sonar_name;            ///< at most 15 bytes
  std::string note;                  ///< at most 63 bytes
  /// X41's code: 0 none, 15 Reson SeaBat 8101, 44 a sidescan and 45 a multibeam of no listed kind.
  std::uint16_t sonar_type = 0;
  XtfNavigation navigation = XtfNavigation::kDegrees;
  double sound_speed_m_s = 1500;
  std::optional<XtfSidescan> sidescan{};   ///< channels 0 (port) and 1 (starboard)
  std::optional<XtfChannel> bathymetry{};  ///< the channel after them
  /// The frequency of a channel in the file header is in kHz in the files seen; MB-System says Hz.
  bool channel_frequency_in_hz = false;
  /// Where the motion sensor sits on the carrier: readers work out what heave a sonar elsewhere has.
  double motion_starboard_m = 0, motion_forward_m = 0, motion_down_m = 0;
};

/// Where the sonar is and how it lies at a ping.
struct XtfPlace {
  double unix_time_s = 0;  ///< UTC, seconds since 1970 without leap seconds
  std::uint32_t ping_number = 0;
  double x = 0;            ///< longitude [deg, east positive] or easting [m]
  double y = 0;            ///< latitude [deg, north positive] or northing [m]
  double heading_deg = 0;  ///< clockwise from north, 0 to 360
  double pitch_deg = 0;    ///< bow up, -90 to 90
  double roll_deg = 0;     ///< starboard down, -180 to 180
  double heave_m = 0;      ///< up, from where the header has the sonar
  double depth_m = 0;      ///< of the sonar below the surface
  double altitude_m = 0;   ///< of the sonar above the bottom; 0 or more
  double speed_m_s = 0;    ///< over the surface; 0 or more
};

struct XtfSidescanPing {
  XtfPlace place;
  double slant_range_m = 0;  ///< to the far edge of the last sample; the first begins at 0
  std::span<const std::uint16_t> port, starboard;  ///< nearest sample first
};

struct XtfAttitude {
  double unix_time_s = 0;
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0, heave_m = 0;  ///< as XtfPlace
};

struct XtfFix {
  double unix_time_s = 0;
  double x = 0, y = 0;    ///< as XtfPlace
  double altitude_m = 0;  ///< of the antenna, up
};

/// A sounding of a generic multibeam (packet type 28).
struct XtfSounding {
  std::int32_t beam = 0;
  double two_way_time_s = 0;
  double across_angle_deg = 0;  ///< from straight down, starboard positive
  double along_angle_deg = 0;   ///< forward positive
  double intensity = 0;
  std::int32_t quality = 0;
};

/// Writes an XTF file (eXtended Triton Format, revision X41) ping by ping; no more than one packet is in
/// memory. docs/files-xtf.md says which fields are filled and what is uncertain.
///
/// Values that their fields do not hold, or that are not numbers, are refused with std::invalid_argument
/// before anything of the packet is written: the file can go on. Errors of the disk are std::runtime_error,
/// naming the file and the reason; the file is then gone. A file that is not finished is taken away.
class XtfFile {
 public:
  XtfFile(const std::filesystem::path& path, const XtfHeader& header);

  /// Needs a header with a sidescan.
  void add_sidescan_ping(const XtfSidescanPing& ping);
  /// A ping of a RESON 8101, beams from port to starboard. Needs a header with bathymetry.
  void add_reson_8101_ping(const XtfPlace& place, const Reson8101Settings& settings,
                           const std::vector<Reson8101Beam>& beams);
  /// A ping of any multibeam. Needs a header with bathymetry.
  void add_soundings(const XtfPlace& place, std::span<const XtfSounding> soundings);
  void add_attitude(const XtfAttitude& attitude);
  void add_navigation(const XtfFix& fix);
  /// At most 199 bytes.
  void add_note(double unix_time_s, const std::string& text);

  /// Completes the file. Nothing can be added afterwards.
  void finish();

 private:
  XtfFile(std::filesystem::path path, XtfHeader header, const PacketBytes& file_header);
  FieldCheck check(std::string_view packet, std::uint32_t number) const;
  FieldCheck check(std::string_view packet, double unix_time_s) const;
  void put_place(PacketBytes& packet, const XtfPlace& place, const FieldCheck& check);
  std::uint32_t tag_ms(std::int64_t since_1970_ms);
  void check_position(double x, double y, const FieldCheck& check) const;
  PacketBytes bathymetry_packet(std::uint8_t type, const XtfPlace& place, const FieldCheck& check);
  void write_padded(PacketBytes packet, const FieldCheck& check);

  XtfHeader header_;
  StreamedFile file_;
  std::optional<std::int64_t> clock_begin_ms_{};  ///< of the time tags, since 1970
};

}  // namespace tubefoot
