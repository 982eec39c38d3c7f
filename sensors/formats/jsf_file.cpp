// SPDX-License-Identifier: GPL-3.0-or-later
// Writes EdgeTech JSF files of complex sidescan samples. Offsets are those of EdgeTech's "JSF data file
// description" 0023492, revision M, message type 80.
#include "sensors/formats/jsf_file.hpp"

#include <algorithm>
#include <cmath>

#include "sensors/formats/packet_moment.hpp"

namespace tubefoot {
namespace {

constexpr std::uint16_t start_of_message = 0x1601, sonar_data = 80;
constexpr std::uint8_t protocol_version = 0x0D, normal_data_source = 2;
constexpr std::size_t message_header = 16, sonar_header = 240, bytes_a_sample = 4;
constexpr std::int16_t analytic_signal = 1;
constexpr double most_20_bits = (1 << 20) - 1, most_16_bits = 32767;

/// Bits of the validity flag.
enum Valid : unsigned {
  position = 1u << 0,
  heading = 1u << 3,
  pitch_and_roll = 1u << 5,
  altitude = 1u << 6,
  depth = 1u << 9,
  annotation = 1u << 10,
  sound_speed = 1u << 14,
};

/// N of value = integer x 2^-N: the largest N for which all parts fit 16 bits.
int weighting_of(std::span<const std::complex<double>> samples, const FieldCheck& check) {
  double largest = 0;
  for (const std::complex<double>& sample : samples) {
    if (!std::isfinite(sample.real()) || !std::isfinite(sample.imag()))
      check.fail("a sample is not finite: omit the ping");
    largest = std::max({largest, std::abs(sample.real()), std::abs(sample.imag())});
  }
  if (largest == 0) return 0;
  int exponent = 0;
  std::frexp(most_16_bits / largest, &exponent);  // in [2^(e-1), 2^e)
  return exponent - 1;
}

class Message {
 public:
  Message(const JsfPing& ping, std::size_t samples, const FieldCheck& check)
      : ping_(ping), check_(check), bytes_(std::endian::little, message_header + sonar_header) {
    header(samples);
    clock();
    place();
    pulse(samples);
  }

  PacketBytes& bytes() { return bytes_; }
  template <typename Field>
  void put(std::size_t offset, std::type_identity_t<Field> value) {
    bytes_.put<Field>(message_header + offset, value);
  }

 private:
  void header(std::size_t samples) {
    bytes_.put<std::uint16_t>(0, start_of_message);
    bytes_.put<std::uint8_t>(2, protocol_version);
    bytes_.put<std::uint16_t>(4, sonar_data);
    bytes_.put<std::uint8_t>(6, normal_data_source);
    bytes_.put<std::uint8_t>(7, static_cast<std::uint8_t>(ping_.subsystem));
    bytes_.put<std::uint8_t>(8, ping_.starboard ? 1 : 0);
    bytes_.put<std::uint32_t>(12, static_cast<std::uint32_t>(sonar_header + bytes_a_sample * samples));
    put<std::uint32_t>(4, ping_.first_sample);
    put<std::uint32_t>(8, ping_.number);
    put<std::int16_t>(28, 1);  // the only code
    put<std::int16_t>(34, analytic_signal);
    put<std::int16_t>(170, 1);   // pulses in the water
    put<std::uint16_t>(220, 1);  // the ping's only packet
    if (!ping_.annotation.empty()) {
      bytes_.put_text(message_header + 90, 24, check_.text("annotation", ping_.annotation, 24));
      valid(annotation);
    }
  }

  void clock() {
    const PacketMoment time = moment(ping_.unix_time_s, check_);
    constexpr double signed_end_s = 2147483647;
    check_.within("time [s since 1970]", ping_.unix_time_s, 0, signed_end_s);
    put<std::int32_t>(0, static_cast<std::int32_t>(time.epoch_s));
    put<std::int16_t>(156, static_cast<std::int16_t>(time.year));
    put<std::int16_t>(158, static_cast<std::int16_t>(time.day_of_year));
    put<std::int16_t>(160, time.hour);
    put<std::int16_t>(162, time.minute);
    put<std::int16_t>(164, time.second);
    put<std::int16_t>(166, 3);  // the other codes are obsolete
    constexpr std::int64_t day_ms = 86'400'000;
    put<std::uint32_t>(200, static_cast<std::uint32_t>(time.since_1970_ms % day_ms));
  }

  void place() {
    if (!std::isnan(ping_.x) || !std::isnan(ping_.y)) {
      // Minutes of arc times 10000, or millimetres, or centimetres if millimetres do not fit.
      constexpr double minutes = 60 * 10000, most_mm = 2147483.0;
      const bool millimetres = std::abs(ping_.x) <= most_mm && std::abs(ping_.y) <= most_mm;
      const double per_unit = ping_.degrees ? minutes : millimetres ? 1000 : 100;
      if (ping_.degrees) {
        check_.within("longitude [deg]", ping_.x, -180, 180);
        check_.within("latitude [deg]", ping_.y, -90, 90);
      }
      put<std::int32_t>(80, check_.integer<std::int32_t>("x", ping_.x, per_unit));
      put<std::int32_t>(84, check_.integer<std::int32_t>("y", ping_.y, per_unit));
      put<std::int16_t>(88, ping_.degrees ? 2 : millimetres ? 1 : 4);
      valid(position);
    }
    constexpr double binary_angle = 32768.0 / 180;
    if (!std::isnan(ping_.heading_deg)) {
      check_.within("heading [deg]", ping_.heading_deg, 0, 360);
      const int hundredths = check_.integer<std::uint16_t>("heading [deg]", ping_.heading_deg, 100);
      put<std::uint16_t>(172, static_cast<std::uint16_t>(hundredths % 36000));
      valid(heading);
    }
    if (!std::isnan(ping_.pitch_deg) && !std::isnan(ping_.roll_deg)) {
      check_.within("pitch [deg]", ping_.pitch_deg, -90, 90);
      check_.within("roll [deg]", ping_.roll_deg, -180, 180);
      put<std::int16_t>(174, check_.integer<std::int16_t>("pitch [deg]", ping_.pitch_deg, binary_angle));
      // The field cannot represent +180 degrees; the nearest smaller code replaces it.
      const double roll = std::min(std::round(ping_.roll_deg * binary_angle), most_16_bits);
      put<std::int16_t>(176, static_cast<std::int16_t>(roll));
      valid(pitch_and_roll);
    }
    length(136, "depth [m]", ping_.depth_m, depth);
    length(144, "altitude [m]", ping_.altitude_m, altitude);
  }

  void length(std::size_t offset, const char* name, double metres, Valid bit) {
    if (std::isnan(metres)) return;
    check_.within(name, metres, 0, 2e6);
    put<std::int32_t>(offset, check_.integer<std::int32_t>(name, metres, 1000));
    valid(bit);
  }

  void pulse(std::size_t samples) {
    check_.within("number of samples", static_cast<double>(samples), 1, most_20_bits);
    const auto decahertz = [&](const char* name, double hz) {
      return static_cast<std::uint32_t>(check_.within(name, std::round(hz / 10), 0, most_20_bits));
    };
    const std::uint32_t start = decahertz("first frequency [10 Hz]", ping_.start_hz),
                        stop = decahertz("last frequency [10 Hz]", ping_.stop_hz),
                        count = static_cast<std::uint32_t>(samples);
    // The upper four bits of numbers with more than 16 bits.
    put<std::uint16_t>(16, static_cast<std::uint16_t>(start >> 16 | stop >> 16 << 4 | count >> 16 << 8));
    put<std::uint16_t>(114, static_cast<std::uint16_t>(count));
    put<std::uint16_t>(126, static_cast<std::uint16_t>(start));
    put<std::uint16_t>(128, static_cast<std::uint16_t>(stop));

    check_.positive("sample interval [s]", ping_.sample_interval_s);
    const double parts = std::round(ping_.sample_interval_s * 1e9 * 256);  // of a nanosecond
    check_.within("sample interval [ns]", parts / 256, 1, 4294967295.0);
    const auto interval = static_cast<std::uint64_t>(parts);
    put<std::uint32_t>(116, static_cast<std::uint32_t>(interval >> 8));
    put<std::uint16_t>(18, static_cast<std::uint16_t>(interval & 0xFF));
    put<std::uint16_t>(140, static_cast<std::uint16_t>(std::llround(1 / ping_.sample_interval_s) & 0xFFFF));

    const double microseconds = std::round(check_.within("pulse length [s]", ping_.sweep_s, 0, 65.535) * 1e6);
    const auto whole = static_cast<std::uint32_t>(microseconds);
    put<std::uint16_t>(130, static_cast<std::uint16_t>(whole / 1000));
    put<std::uint16_t>(20, static_cast<std::uint16_t>(whole % 1000 << 4));
    put<float>(152, check_.real("mixer frequency [Hz]", ping_.mixer_hz));
    if (!std::isnan(ping_.sound_speed_m_s)) {
      put<float>(148, check_.real("sound speed [m/s]", ping_.sound_speed_m_s));
      valid(sound_speed);
    }
  }

  void valid(Valid bit) {
    valid_ |= bit;
    put<std::uint16_t>(30, static_cast<std::uint16_t>(valid_));
  }

  const JsfPing& ping_;
  const FieldCheck& check_;
  PacketBytes bytes_;
  unsigned valid_ = 0;
};

}  // namespace

void JsfFile::add(const JsfPing& ping, std::span<const std::complex<double>> samples) {
  const FieldCheck check(fmt::format("{}: ping {}, {}", file_.path().string(), ping.number,
                                     ping.starboard ? "starboard" : "port"));
  const int weighting = weighting_of(samples, check);
  Message message(ping, samples.size(), check);
  message.put<std::int16_t>(168, check.integer<std::int16_t>("weighting factor", weighting));
  int largest = 0;
  for (const std::complex<double>& sample : samples)
    for (const double part : {sample.real(), sample.imag()}) {
      const auto integer = static_cast<std::int16_t>(std::round(std::ldexp(part, weighting)));
      largest = std::max(largest, std::abs(int{integer}));
      message.bytes().append<std::int16_t>(integer);
    }
  message.put<std::uint16_t>(204, static_cast<std::uint16_t>(largest));
  file_.append(message.bytes().bytes());
}

}  // namespace tubefoot
