// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Writes XTF files (eXtended Triton Format, revision X41) ping by ping: sidescan, multibeam, attitude,
// navigation and notes. The page docs/exchange-formats.md lists the fields that are filled, and the uncertain
// ones.

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

/// Unit of the positions in an XTF file. Readers take metres for UTM of a zone that the file does not name.
enum class XtfNavigation { kDegrees, kMetres };

/// A channel in the file header. Zero: unknown.
struct XtfChannel {
  double frequency_khz = 0;                           ///< 0 to 65535
  double along_track_width_deg = 0;                   ///< of the beam, -3 dB
  double across_track_width_deg = 0;                  ///< -3 dB, of the fan (vertical)
  double tilt_deg = 0;                                ///< of the fan's axis below the horizontal
  double starboard_m = 0, forward_m = 0, down_m = 0;  ///< position of the transducer on the carrier
};

struct XtfSidescan {
  XtfChannel port, starboard;
  /// Largest number of samples per side in any ping, at least 1. Some readers rely on the number in the
  /// header.
  std::uint32_t max_samples = 0;
  bool time_varied_gain = false;  ///< true if a gain was applied to the samples
};

struct XtfHeader {
  std::string program = "tubefoot";  ///< at most 8 bytes: a reader in C may show the version behind them
  std::string sonar_name;            ///< at most 15 bytes
  std::string note;                  ///< at most 63 bytes
  /// X41's code: 0 none, 15 Reson SeaBat 8101, 44 an unlisted sidescan and 45 an unlisted multibeam.
  std::uint16_t sonar_type = 0;
  XtfNavigation navigation = XtfNavigation::kDegrees;
  double sound_speed_m_s = 1500;
  std::optional<XtfSidescan> sidescan{};   ///< channels 0 (port) and 1 (starboard)
  std::optional<XtfChannel> bathymetry{};  ///< the channel after them
  /// Unit of a channel's frequency in the file header. It is kHz in known files; MB-System documents Hz.
  bool channel_frequency_in_hz = false;
  /// Position of the motion sensor on the carrier. Readers compute the heave of a sonar at another position
  /// from it.
  double motion_starboard_m = 0, motion_forward_m = 0, motion_down_m = 0;
};

/// Position and attitude of the sonar at a ping.
struct XtfPlace {
  double unix_time_s = 0;  ///< UTC, seconds since 1970 without leap seconds
  std::uint32_t ping_number = 0;
  double x = 0;            ///< longitude [deg, east positive] or easting [m]
  double y = 0;            ///< latitude [deg, north positive] or northing [m]
  double heading_deg = 0;  ///< clockwise from north, 0 to 360
  double pitch_deg = 0;    ///< bow up, -90 to 90
  double roll_deg = 0;     ///< starboard down, -180 to 180
  double heave_m = 0;      ///< up, from the sonar's position in the header
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
  double delay_s = 0;  ///< of the beam's transmission after the time of the ping
};

/// Writes an XTF file (eXtended Triton Format, revision X41) ping by ping; at most one packet is in memory.
/// The page docs/exchange-formats.md lists the fields that are filled, and the uncertain ones.
///
/// Throws std::invalid_argument for NaN and for values out of range of their fields, before any byte of the
/// packet is written; further packets can follow. Throws std::runtime_error for disk errors, with the file's
/// name and the reason; the file is then removed. The destructor removes an unfinished file.
class XtfFile {
 public:
  XtfFile(const std::filesystem::path& path, const XtfHeader& header);

  /// Requires a header with a sidescan.
  void add_sidescan_ping(const XtfSidescanPing& ping);
  /// A ping of a RESON 8101, beams from port to starboard. Requires a header with bathymetry.
  void add_reson_8101_ping(const XtfPlace& place, const Reson8101Settings& settings,
                           const std::vector<Reson8101Beam>& beams);
  /// A ping of any multibeam. Requires a header with bathymetry.
  void add_soundings(const XtfPlace& place, std::span<const XtfSounding> soundings);
  void add_attitude(const XtfAttitude& attitude);
  void add_navigation(const XtfFix& fix);
  /// At most 199 bytes.
  void add_note(double unix_time_s, const std::string& text);

  /// Completes the file. No packets can follow.
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
  std::optional<std::int64_t> clock_begin_ms_{};  ///< origin of the time tags, since 1970
};

}  // namespace tubefoot
