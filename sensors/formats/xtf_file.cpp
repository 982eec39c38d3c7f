// SPDX-License-Identifier: GPL-3.0-or-later
// Writes XTF files (docs/exchange-formats.md). Offsets are those of X41's structures: the number before each
// name is its offset.
#include "sensors/formats/xtf_file.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "sensors/formats/packet_moment.hpp"

namespace tubefoot {
namespace {

constexpr std::uint16_t magic_number = 0xFACE;
enum PacketType : std::uint8_t {
  kSonar = 0,
  kNotes = 1,
  kBathymetry = 2,
  kAttitude = 3,
  kSoundings = 28,
  kNavigation = 42,
};
constexpr std::size_t xtf_header_size = 1024, channel_size = 128, first_channel = 256;
constexpr std::size_t ping_header_size = 256, ping_channel_size = 64, block = 64, notes_size = 256;
constexpr double knots = 3600.0 / 1852.0;  // per m/s
constexpr double full_scale_volts = 5;

/// Year to second, in the order that all packets share.
void put_date(PacketBytes& packet, std::size_t offset, const PacketMoment& time) {
  packet.put<std::uint16_t>(offset, time.year);
  packet.put<std::uint8_t>(offset + 2, time.month);
  packet.put<std::uint8_t>(offset + 3, time.day);
  packet.put<std::uint8_t>(offset + 4, time.hour);
  packet.put<std::uint8_t>(offset + 5, time.minute);
  packet.put<std::uint8_t>(offset + 6, time.second);
}

/// Hour to hundredth of a second.
void put_clock(PacketBytes& packet, std::size_t offset, const PacketMoment& time) {
  packet.put<std::uint8_t>(offset, time.hour);
  packet.put<std::uint8_t>(offset + 1, time.minute);
  packet.put<std::uint8_t>(offset + 2, time.second);
  packet.put<std::uint8_t>(offset + 3, static_cast<std::uint8_t>(time.microseconds / 10000));
}

/// The header of each packet. Its size is filled in when the packet is complete.
PacketBytes started(PacketType type, std::size_t size, std::size_t channels = 0) {
  PacketBytes packet(std::endian::little, size);
  packet.put<std::uint16_t>(0, magic_number);
  packet.put<std::uint8_t>(2, type);
  packet.put<std::uint16_t>(4, static_cast<std::uint16_t>(channels));
  return packet;
}

void check_attitude(double heading_deg, double pitch_deg, double roll_deg, const FieldCheck& check) {
  check.within("heading [deg]", heading_deg, 0, 360);
  check.within("pitch [deg]", pitch_deg, -90, 90);
  check.within("roll [deg]", roll_deg, -180, 180);
}

enum ChannelType : std::uint8_t { kPort = 1, kStarboard = 2, kBathymetryChannel = 3 };

void put_channel(PacketBytes& packet, std::size_t index, ChannelType type, const std::string& name,
                 const XtfChannel& channel, const XtfHeader& header, const FieldCheck& check) {
  const std::size_t begin = first_channel + index * channel_size;
  const bool sidescan = type != kBathymetryChannel;
  const auto real = [&](std::size_t offset, const char* what, double value) {
    packet.put<float>(begin + offset, check.real(name + " " + what, value));
  };
  packet.put<std::uint8_t>(begin, type);
  packet.put<std::uint8_t>(begin + 1, static_cast<std::uint8_t>(index));
  packet.put<std::uint16_t>(begin + 2, sidescan ? 1 : 0);  // slant range
  packet.put<std::uint16_t>(begin + 4, 1);                 // samples are not signed
  packet.put<std::uint16_t>(begin + 6, 2);                 // bytes per sample
  packet.put<std::uint32_t>(begin + 8, sidescan ? header.sidescan->max_samples : 0);
  packet.put_text(begin + 12, name);
  real(28, "volt scale", full_scale_volts);
  check.within(name + " frequency [kHz]", channel.frequency_khz, 0, 65535);
  real(32, "frequency", channel.frequency_khz * (header.channel_frequency_in_hz ? 1e3 : 1));
  real(36, "along-track width [deg]", channel.along_track_width_deg);
  real(40, "tilt [deg]", channel.tilt_deg);
  real(44, "across-track width [deg]", channel.across_track_width_deg);
  real(48, "position to starboard [m]", channel.starboard_m);
  real(52, "position forward [m]", channel.forward_m);
  real(56, "position down [m]", channel.down_m);
  packet.put<std::uint8_t>(begin + 74, 3);  // samples are 2-byte integers
}

PacketBytes file_header(const std::filesystem::path& path, const XtfHeader& header) {
  const FieldCheck check(fmt::format("{}: file header", path.string()));
  check.positive("sound speed [m/s]", header.sound_speed_m_s);
  check.real("sound speed [m/s]", header.sound_speed_m_s);
  if (!header.sidescan && !header.bathymetry)
    check.fail("the header describes neither a sidescan nor bathymetry");

  PacketBytes packet(std::endian::little, xtf_header_size);
  packet.put<std::uint8_t>(0, 0x7B);
  packet.put<std::uint8_t>(1, 1);
  packet.put_text(2, check.text("program", header.program, 8 + 1));
  packet.put_text(10, "223");  // with 303 to 312 readers would expect a padding bug
  packet.put_text(18, check.text("sonar name", header.sonar_name, 16));
  packet.put<std::uint16_t>(34, header.sonar_type);
  packet.put_text(36, check.text("note", header.note, 64));
  packet.put_text(100, path.filename().string().substr(0, 63));
  packet.put<std::uint16_t>(164, header.navigation == XtfNavigation::kDegrees ? 3 : 0);
  packet.put<std::uint16_t>(166, header.sidescan ? 2 : 0);
  packet.put<std::uint16_t>(168, header.bathymetry ? 1 : 0);
  packet.put<float>(232, check.real("motion sensor forward [m]", header.motion_forward_m));
  packet.put<float>(236, check.real("motion sensor to starboard [m]", header.motion_starboard_m));
  packet.put<float>(240, check.real("motion sensor down [m]", header.motion_down_m));
  if (header.sidescan) {
    check.within("largest number of samples", header.sidescan->max_samples, 1, 1 << 28);
    put_channel(packet, 0, kPort, "PORT", header.sidescan->port, header, check);
    put_channel(packet, 1, kStarboard, "STBD", header.sidescan->starboard, header, check);
  }
  if (header.bathymetry)
    put_channel(packet, header.sidescan ? 2 : 0, kBathymetryChannel, "BATHY", *header.bathymetry, header,
                check);
  return packet;
}

}  // namespace

XtfFile::XtfFile(const std::filesystem::path& path, const XtfHeader& header)
    : XtfFile(path, header, file_header(path, header)) {}

XtfFile::XtfFile(std::filesystem::path path, XtfHeader header, const PacketBytes& file_header)
    : header_(std::move(header)), file_(std::move(path)) {
  file_.append(file_header.bytes());
}

void XtfFile::add_sidescan_ping(const XtfSidescanPing& ping) {
  const FieldCheck check = this->check("sidescan ping", ping.place.ping_number);
  if (!header_.sidescan) check.fail("the file header has no sidescan");
  check.positive("slant range [m]", ping.slant_range_m);
  const double seconds = ping.slant_range_m / (header_.sound_speed_m_s / 2);

  PacketBytes packet = started(kSonar, ping_header_size, 2);
  put_place(packet, ping.place, check);
  const auto add_channel = [&](std::uint16_t index, const XtfChannel& channel, const char* name,
                               std::span<const std::uint16_t> samples) {
    check.within(fmt::format("number of samples on the {} side", name), static_cast<double>(samples.size()),
                 1, header_.sidescan->max_samples);
    PacketBytes chunk(std::endian::little, ping_channel_size);
    chunk.put<std::uint16_t>(0, index);
    chunk.put<float>(4, check.real("slant range [m]", ping.slant_range_m));
    chunk.put<float>(16, check.real("recording time [s]", seconds));
    chunk.put<float>(20, check.real("recording time [s]", seconds));
    chunk.put<std::uint16_t>(24, header_.sidescan->time_varied_gain ? 4 : 0);
    chunk.put<std::uint16_t>(26, check.integer<std::uint16_t>("frequency [kHz]", channel.frequency_khz));
    chunk.put<std::uint32_t>(42, static_cast<std::uint32_t>(samples.size()));
    chunk.put<std::uint16_t>(46, static_cast<std::uint16_t>(1000 * full_scale_volts));
    // The order follows paper records: port is drawn from its far end inwards.
    if (index == 0)
      for (auto sample = samples.rbegin(); sample != samples.rend(); ++sample)
        chunk.append<std::uint16_t>(*sample);
    else
      for (const std::uint16_t sample : samples) chunk.append<std::uint16_t>(sample);
    packet.append(chunk.bytes());
  };
  add_channel(0, header_.sidescan->port, "port", ping.port);
  add_channel(1, header_.sidescan->starboard, "starboard", ping.starboard);
  write_padded(std::move(packet), check);
}

void XtfFile::add_reson_8101_ping(const XtfPlace& place, const Reson8101Settings& settings,
                                  const std::vector<Reson8101Beam>& beams) {
  const FieldCheck check = this->check("8101 ping", place.ping_number);
  PacketBytes packet = bathymetry_packet(kBathymetry, place, check);
  packet.append(reson_8101_packet(settings, place.unix_time_s, place.ping_number, beams,
                                  fmt::format("{}: 8101 ping {}", file_.path().string(), place.ping_number)));
  write_padded(std::move(packet), check);
}

void XtfFile::add_soundings(const XtfPlace& place, std::span<const XtfSounding> soundings) {
  const FieldCheck check = this->check("multibeam ping", place.ping_number);
  PacketBytes packet = bathymetry_packet(kSoundings, place, check);
  packet.put<std::uint16_t>(
      4, check.integer<std::uint16_t>("number of soundings", static_cast<double>(soundings.size())));
  constexpr double huge = std::numeric_limits<double>::max();
  for (const XtfSounding& sounding : soundings) {
    packet.append<std::int32_t>(sounding.beam);
    packet.append<double>(check.within("intensity", sounding.intensity, -huge, huge));
    packet.append<std::int32_t>(sounding.quality);
    packet.append<double>(check.within("two-way time [s]", sounding.two_way_time_s, 0, huge));
    packet.append<double>(check.within("delay [s]", sounding.delay_s, 0, huge));
    packet.append<double>(check.within("angle across [deg]", sounding.across_angle_deg, -180, 180));
    packet.append<double>(check.within("angle along [deg]", sounding.along_angle_deg, -180, 180));
    packet.append_zeros(4 * sizeof(float));
  }
  write_padded(std::move(packet), check);
}

void XtfFile::add_attitude(const XtfAttitude& attitude) {
  const FieldCheck check = this->check("attitude", attitude.unix_time_s);
  const PacketMoment time = moment(attitude.unix_time_s, check);
  check_attitude(attitude.heading_deg, attitude.pitch_deg, attitude.roll_deg, check);
  PacketBytes packet = started(kAttitude, block);
  packet.put<std::uint32_t>(22, time.microseconds);
  packet.put<std::uint32_t>(26, time.epoch_s);
  packet.put<float>(30, check.real("pitch [deg]", attitude.pitch_deg));
  packet.put<float>(34, check.real("roll [deg]", attitude.roll_deg));
  packet.put<float>(38, check.real("heave [m]", attitude.heave_m));
  packet.put<std::uint32_t>(46, tag_ms(time.since_1970_ms));
  packet.put<float>(50, check.real("heading [deg]", attitude.heading_deg));
  put_date(packet, 54, time);
  packet.put<std::uint16_t>(61, static_cast<std::uint16_t>(time.microseconds / 1000));
  write_padded(std::move(packet), check);
}

void XtfFile::add_navigation(const XtfFix& fix) {
  const FieldCheck check = this->check("navigation", fix.unix_time_s);
  const PacketMoment time = moment(fix.unix_time_s, check);
  check_position(fix.x, fix.y, check);
  PacketBytes packet = started(kNavigation, block);
  put_date(packet, 14, time);
  packet.put<std::uint32_t>(21, time.microseconds);
  packet.put<std::uint32_t>(25, time.epoch_s);
  packet.put<std::uint32_t>(29, tag_ms(time.since_1970_ms));
  packet.put<double>(33, fix.y);
  packet.put<double>(41, fix.x);
  packet.put<double>(49, check.real("altitude [m]", fix.altitude_m));
  packet.put<std::uint8_t>(57, 3);  // the times of source and receiver are the same
  write_padded(std::move(packet), check);
}

void XtfFile::add_note(double unix_time_s, const std::string& text) {
  const FieldCheck check = this->check("note", unix_time_s);
  PacketBytes packet = started(kNotes, notes_size);
  put_date(packet, 14, moment(unix_time_s, check));
  packet.put_text(56, check.text("note", text, 200));
  write_padded(std::move(packet), check);
}

void XtfFile::finish() { file_.close(); }

FieldCheck XtfFile::check(std::string_view packet, std::uint32_t number) const {
  return FieldCheck(fmt::format("{}: {} {}", file_.path().string(), packet, number));
}

FieldCheck XtfFile::check(std::string_view packet, double unix_time_s) const {
  return FieldCheck(fmt::format("{}: {} at {} s", file_.path().string(), packet, unix_time_s));
}

void XtfFile::check_position(double x, double y, const FieldCheck& check) const {
  constexpr double huge = std::numeric_limits<double>::max();
  const bool degrees = header_.navigation == XtfNavigation::kDegrees;
  check.within(degrees ? "longitude [deg]" : "easting [m]", x, degrees ? -180 : -huge, degrees ? 180 : huge);
  check.within(degrees ? "latitude [deg]" : "northing [m]", y, degrees ? -90 : -huge, degrees ? 90 : huge);
}

/// Time tag in milliseconds on one clock for all packets, from midnight of the day before the first packet.
/// MB-System reads some tags as signed, and a tag of 0 may mean none. Tags therefore lie above 0 and below
/// 2^31, for lines of up to 22 days. After that the clock starts again.
std::uint32_t XtfFile::tag_ms(std::int64_t since_1970_ms) {
  constexpr std::int64_t day_ms = 86'400'000, wraps_ms = std::int64_t{1} << 31;
  if (!clock_begin_ms_) clock_begin_ms_ = since_1970_ms / day_ms * day_ms - day_ms;
  const std::int64_t tag = (since_1970_ms - *clock_begin_ms_) % wraps_ms;
  return static_cast<std::uint32_t>(tag < 0 ? tag + wraps_ms : tag);
}

void XtfFile::put_place(PacketBytes& packet, const XtfPlace& place, const FieldCheck& check) {
  const PacketMoment time = moment(place.unix_time_s, check);
  check_position(place.x, place.y, check);
  check_attitude(place.heading_deg, place.pitch_deg, place.roll_deg, check);
  check.within("speed [m/s]", place.speed_m_s, 0, 1e4);
  check.within("altitude [m]", place.altitude_m, 0, 1e5);
  const float speed_knots = check.real("speed [m/s]", place.speed_m_s * knots);
  const float heading_deg = check.real("heading [deg]", place.heading_deg);

  put_date(packet, 14, time);
  packet.put<std::uint8_t>(21, static_cast<std::uint8_t>(time.microseconds / 10000));
  packet.put<std::uint16_t>(22, time.day_of_year);
  packet.put<std::uint32_t>(28, place.ping_number);
  packet.put<float>(32, check.real("sound speed [m/s]", header_.sound_speed_m_s / 2));  // half the sound
                                                                                        // speed, as readers
                                                                                        // expect
  packet.put<float>(72, check.real("sound speed [m/s]", header_.sound_speed_m_s));
  packet.put<float>(120, speed_knots);
  packet.put<float>(124, heading_deg);
  packet.put<double>(128, place.y);
  packet.put<double>(136, place.x);
  put_clock(packet, 148, time);
  packet.put<float>(152, speed_knots);
  packet.put<double>(160, place.y);
  packet.put<double>(168, place.x);
  packet.put<float>(192, check.real("depth [m]", place.depth_m));
  packet.put<float>(196, check.real("altitude [m]", place.altitude_m));
  packet.put<float>(204, check.real("pitch [deg]", place.pitch_deg));
  packet.put<float>(208, check.real("roll [deg]", place.roll_deg));
  packet.put<float>(212, heading_deg);
  packet.put<float>(216, check.real("heave [m]", place.heave_m));
  packet.put<std::uint32_t>(224, tag_ms(time.since_1970_ms));
  packet.put<std::uint32_t>(232, tag_ms(time.since_1970_ms));
  put_clock(packet, 236, time);
}

PacketBytes XtfFile::bathymetry_packet(std::uint8_t type, const XtfPlace& place, const FieldCheck& check) {
  if (!header_.bathymetry) check.fail("the file header has no bathymetry");
  PacketBytes packet = started(static_cast<PacketType>(type), ping_header_size);
  put_place(packet, place, check);
  return packet;
}

void XtfFile::write_padded(PacketBytes packet, const FieldCheck& check) {
  packet.pad_to_multiple_of(block);
  packet.put<std::uint32_t>(
      10, check.integer<std::uint32_t>("size of the packet", static_cast<double>(packet.size())));
  file_.append(packet.bytes());
}

}  // namespace tubefoot
