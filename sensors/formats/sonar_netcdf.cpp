// SPDX-License-Identifier: GPL-3.0-or-later
// Writes SONAR-netCDF4 files ping by ping, in batches of one chunk. Columns of the layout convert pings to
// rows; backscatter goes into lists of floats.

#include "sensors/formats/sonar_netcdf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sensors/formats/netcdf_stream.hpp"
#include "sensors/formats/sonar_netcdf_layout.hpp"

namespace tubefoot {
namespace {

/// Pings are written in batches of this size, or of a chunk of the file.
constexpr std::size_t batch_bytes = 4 << 20;

/// Until a file is closed, HDF5 keeps some 130 bytes per list for free space. After this number of lists the
/// file is reopened.
constexpr std::size_t lists_per_opening = 1 << 14;

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("SONAR-netCDF4: " + what);
}

void check_header(const SonarNetcdfHeader& h) {
  require(h.beams > 0 && h.beams <= 32767,
          fmt::format("the number of beams is {}, but must be 1 to 32767", h.beams));
  require(std::isfinite(h.frequency_hz) && h.frequency_hz > 0,
          fmt::format("the frequency is {} Hz, but must be positive", h.frequency_hz));
  const std::size_t transmit_beams = std::max<std::size_t>(h.transmit_beams.size(), 1);
  require(
      h.transmit_beam_of.empty() || h.transmit_beam_of.size() == h.beams,
      fmt::format("there are transmit beams of {} beams, but {} beams", h.transmit_beam_of.size(), h.beams));
  for (const std::size_t tx : h.transmit_beam_of)
    require(tx < transmit_beams,
            fmt::format("there is no transmit beam {} (there are {})", tx, transmit_beams));
  require(std::isfinite(h.sound_speed_m_s) && h.sound_speed_m_s > 0,
          fmt::format("the sound speed is {} m/s, but must be positive", h.sound_speed_m_s));
}

template <typename Value>
std::vector<Value> converted(const std::vector<double>& values) {
  std::vector<Value> result;
  result.reserve(values.size());
  for (const double value : values) result.push_back(static_cast<Value>(value));
  return result;
}

}  // namespace

glm::dvec3 forward_starboard_down(glm::dvec3 p, double heading_deg) {
  const double heading = heading_deg * std::numbers::pi / 180;
  const double s = std::sin(heading), c = std::cos(heading);
  return {s * p.x + c * p.y, c * p.x - s * p.y, -p.z};
}

class SonarNetcdfFile::State {
 public:
  State(const std::filesystem::path& file, const SonarNetcdfHeader& header)
      : stream_(file),
        beams_(header.beams),
        of_signals_(header.complex_beams),
        layout_(define_sonar_netcdf(stream_, header)) {
    pending_.resize(layout_.columns.size());
    stream_.flush();
    // A batch starts at most one more chunk of every variable.
    constexpr std::size_t widest_value = 8, list_reference = 16;
    for (const SonarNetcdfColumn& column : layout_.columns)
      chunks_bytes_ += SonarNetcdfLayout::chunk_pings * column.per_ping * widest_value;
    chunks_bytes_ +=
        SonarNetcdfLayout::chunk_pings * (layout_.times.size() * widest_value + 2 * beams_ * list_reference);
  }

  void add(const SonarNetcdfPing& ping) {
    check_ping(ping);
    last_time_ns_ = ping.unix_time_ns;
    for (std::size_t k = 0; k < pending_.size(); ++k) layout_.columns[k].append(ping, pending_[k]);
    times_.push_back(static_cast<unsigned long long>(ping.unix_time_ns));
    for (const std::vector<float>& beam : ping.backscatter_db) keep(beam, samples_);
    for (const std::vector<std::complex<float>>& beam : ping.backscatter) {
      std::vector<float> real, imaginary;
      for (const std::complex<float> value : beam)
        real.push_back(value.real()), imaginary.push_back(value.imag());
      keep(std::move(real), samples_);
      keep(std::move(imaginary), imaginary_);
    }
    ++pings_;
    if (times_.size() >= SonarNetcdfLayout::chunk_pings || samples_bytes_ >= batch_bytes) write();
  }

  void finish() {
    write();
    stream_.finish();
  }

 private:
  void check_ping(const SonarNetcdfPing& ping) const {
    const auto fits = [&](bool holds, const std::string& what) {
      require(holds, fmt::format("ping {}: {}", pings_, what));
    };
    const auto as_many = [&](std::size_t count, const char* what) {
      fits(count == beams_, fmt::format("there are {} {} for {} beams", count, what, beams_));
    };
    as_many(ping.across_angle_deg.size(), "beam angles");
    as_many(of_signals_ ? ping.backscatter.size() : ping.backscatter_db.size(), "time series");
    fits((of_signals_ ? ping.backscatter_db.size() : ping.backscatter.size()) == 0,
         of_signals_ ? "it has levels, but the file stores complex beams"
                     : "it has complex beams, but the file stores levels");
    as_many(ping.detections.size(), "detections");
    fits(ping.unix_time_ns >= 0, "its time is before 1970");
    fits(pings_ == 0 || ping.unix_time_ns > last_time_ns_,
         "its time is not later than that of the previous ping");
    fits(ping.sample_interval_s > 0 && std::isfinite(ping.sample_interval_s),
         fmt::format("its sample interval is {} s, but must be positive", ping.sample_interval_s));
    fits(ping.blanking_interval_s >= 0 && std::isfinite(ping.blanking_interval_s),
         fmt::format("its blanking interval is {} s, but must be at least 0", ping.blanking_interval_s));
  }

  void write() {
    if (times_.empty()) return;
    // A separate list takes a header and is rounded up. Short lists share blocks, which may be half full.
    constexpr std::size_t list_head = 64;
    stream_.reserve(2 * (samples_bytes_ + (samples_.size() + imaginary_.size()) * list_head) +
                    2 * chunks_bytes_);
    const std::size_t count = times_.size(), first = written_;
    for (const SonarNetcdfLayout::Place& place : layout_.times)
      stream_.check(nc_put_vara_ulonglong(place.group, place.variable, &first, &count, times_.data()),
                    "write the times");
    for (std::size_t k = 0; k < pending_.size(); ++k) write(layout_.columns[k], pending_[k]);
    write_lists(layout_.backscatter, "backscatter_r", samples_);
    if (layout_.imaginary) write_lists(*layout_.imaginary, "backscatter_i", imaginary_);
    lists_ += samples_.size() + imaginary_.size();
    if (lists_ >= lists_per_opening) {
      stream_.reopen();
      layout_.find_groups(stream_);
      lists_ = 0;
    } else {
      stream_.flush();
    }
    written_ += count;
    times_.clear();
    samples_.clear();
    imaginary_.clear();
    samples_bytes_ = 0;
    for (auto& values : pending_) values.clear();
  }

  void write(const SonarNetcdfColumn& column, const std::vector<double>& values) const {
    const std::array<std::size_t, 3> start{written_, 0, 0}, count{times_.size(), column.per_ping, 1};
    int status = NC_NOERR;
    if (column.type == NC_FLOAT)
      status = nc_put_vara_float(column.group, column.variable, start.data(), count.data(),
                                 converted<float>(values).data());
    else if (column.type >= NC_FIRSTUSERTYPEID)  // an enumeration
      status = nc_put_vara(column.group, column.variable, start.data(), count.data(),
                           converted<signed char>(values).data());
    else
      status = nc_put_vara_double(column.group, column.variable, start.data(), count.data(), values.data());
    stream_.check(status, fmt::format("write variable '{}'", column.name));
  }

  void keep(std::vector<float> beam, std::vector<std::vector<float>>& with) {
    samples_bytes_ += beam.size() * sizeof(float);
    with.push_back(std::move(beam));
  }

  void write_lists(const SonarNetcdfLayout::Place& place, const char* name,
                   std::vector<std::vector<float>>& values) const {
    std::vector<nc_vlen_t> lists;
    lists.reserve(values.size());
    for (std::vector<float>& samples : values) lists.push_back({samples.size(), samples.data()});
    const std::array<std::size_t, 3> start{written_, 0, 0}, count{times_.size(), beams_, 1};
    stream_.check(nc_put_vara(place.group, place.variable, start.data(), count.data(), lists.data()),
                  fmt::format("write variable '{}'", name));
  }

  NetcdfStream stream_;
  std::size_t beams_;
  bool of_signals_;
  SonarNetcdfLayout layout_;
  std::size_t lists_ = 0, chunks_bytes_ = 0, written_ = 0, pings_ = 0, samples_bytes_ = 0;
  std::int64_t last_time_ns_ = 0;
  std::vector<std::vector<double>> pending_;  ///< by column
  std::vector<unsigned long long> times_;
  std::vector<std::vector<float>> samples_, imaginary_;  ///< of all beams of those pings, one after another
};

SonarNetcdfFile::SonarNetcdfFile(const std::filesystem::path& file, const SonarNetcdfHeader& header) {
  check_header(header);
  state_ = std::make_unique<State>(file, header);
}

SonarNetcdfFile::~SonarNetcdfFile() = default;

void SonarNetcdfFile::add(const SonarNetcdfPing& ping) { state_->add(ping); }

void SonarNetcdfFile::finish() { state_->finish(); }

}  // namespace tubefoot
