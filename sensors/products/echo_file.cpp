// SPDX-License-Identifier: GPL-3.0-or-later
// echoes.nc, as docs/echo-file.md describes it.
#include <fmt/format.h>
#include <netcdf.h>
#include <netcdf_mem.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "files/checked_file.hpp"
#include "files/hdf5_chunks.hpp"
#include "files/reserved_space.hpp"
#include "geometry/steps/steps.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/recordings/pose_angles.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// A netCDF-4 file under construction, every call checked. What defines it and small variables are written by
/// netCDF; then values of pings, packed by all threads. In memory, if that is not too much, so that it
/// reaches the disk whole or not at all; else on the disk, in space that is set aside for it before HDF5
/// writes anything (ReservedSpace says why).
class EchoFile {
 public:
  EchoFile(fs::path path, bool in_memory, std::size_t small_bytes)
      : path_(std::move(path)), in_memory_(in_memory) {
    constexpr std::size_t first_guess_bytes = 1 << 20;
    check(in_memory_ ? nc_create_mem(path_.c_str(), NC_NETCDF4 | NC_CLOBBER, first_guess_bytes, &id_)
                     : nc_create(path_.c_str(), NC_NETCDF4 | NC_CLOBBER, &id_),
          "create the file");
    defining_ = true;
    if (in_memory_) return;
    try {
      space_.emplace(path_);
      reserve(small_bytes);
    } catch (...) {
      discard();
      throw;
    }
  }
  ~EchoFile() {
    if (!finished_) discard();
  }
  EchoFile(const EchoFile&) = delete;
  EchoFile& operator=(const EchoFile&) = delete;

  int id() const { return id_; }
  /// All is defined and written but the values of pings, which are of so many bytes.
  Hdf5Chunks& chunks(std::size_t bytes_of_values) {
    defining_ = false;
    if (in_memory_) {
      NC_memio memory{};
      check(nc_close_memio(id_, &memory), "complete the file");
      const std::unique_ptr<void, decltype(&std::free)> owned(memory.memory, &std::free);
      return chunks_.emplace(path_, std::span(static_cast<const unsigned char*>(memory.memory), memory.size));
    }
    check(nc_close(id_), "complete the file");
    reserve(bytes_of_values);  // closing gave back what was not used
    return chunks_.emplace(path_);
  }
  void close() {
    chunks_->close();
    finished_ = true;
  }

  void check(int status, const std::string& task) const {
    if (status != NC_NOERR) throw write_error(path_, fmt::format("cannot {}: {}", task, nc_strerror(status)));
  }

 private:
  void reserve(std::size_t bytes_of_values) {
    // What deflate cannot shrink stays as long as it is; a chunk's entry is some ten bytes.
    constexpr std::size_t margin_bytes = 4 << 20;
    space_->reserve(bytes_of_values + bytes_of_values / 64 + margin_bytes);
  }
  void discard() {
    if (defining_) nc_abort(id_);
    chunks_.reset();
    space_.reset();
    if (!in_memory_) discard_file(path_);
  }

  fs::path path_;
  bool in_memory_;
  std::optional<ReservedSpace> space_;
  std::optional<Hdf5Chunks> chunks_;
  int id_ = 0;
  bool defining_ = false, finished_ = false;
};

/// One group (or the root) under construction: all variables are defined first, then small ones written.
class EchoGroup {
 public:
  EchoGroup(const EchoFile& file, int id) : file_(file), id_(id) {}

  int dimension(const char* name, std::size_t length) {
    int dimension = 0;
    check(nc_def_dim(id_, name, length, &dimension), "define dimension", name);
    return dimension;
  }

  void attribute(const char* name, const std::string& text) { attribute(NC_GLOBAL, name, text); }
  void attribute(const char* name, double value) {
    check(nc_put_att_double(id_, NC_GLOBAL, name, NC_DOUBLE, 1, &value), "write attribute", name);
  }

  /// A float64 variable; its values are written by write().
  int variable(const char* name, const std::vector<int>& dimensions, const char* units, const char* long_name,
               std::vector<double> values) {
    const int variable = define(name, dimensions, units, long_name);
    pending_.push_back({name, variable, std::move(values)});
    return variable;
  }

  int define(const char* name, const std::vector<int>& dimensions, const char* units, const char* long_name) {
    int variable = 0;
    check(nc_def_var(id_, name, NC_DOUBLE, static_cast<int>(dimensions.size()), dimensions.data(), &variable),
          "define variable", name);
    attribute(variable, "units", units);
    attribute(variable, "long_name", long_name);
    return variable;
  }

  void attribute(int variable, const char* name, const std::string& text) {
    check(nc_put_att_text(id_, variable, name, text.size(), text.c_str()), "write attribute", name);
  }

  void compress(int variable, const char* name, const std::vector<std::size_t>& chunk) {
    check(nc_def_var_chunking(id_, variable, NC_CHUNKED, chunk.data()), "chunk variable", name);
    constexpr int shuffle = 1, deflate = 1, level = 4;
    check(nc_def_var_deflate(id_, variable, shuffle, deflate, level), "compress variable", name);
  }

  void write(int variable, const char* name, const double* values) {
    check(nc_put_var_double(id_, variable, values), "write variable", name);
  }

  void write() {
    for (const auto& pending : pending_) write(pending.id, pending.name, pending.values.data());
    pending_.clear();
  }

 private:
  struct Pending {
    const char* name;
    int id;
    std::vector<double> values;
  };

  void check(int status, const char* task, const char* name) const {
    if (status != NC_NOERR) file_.check(status, fmt::format("{} '{}'", task, name));
  }

  const EchoFile& file_;
  int id_;
  std::vector<Pending> pending_;
};

template <typename Item, typename Value>
std::vector<double> column(const std::vector<Item>& items, Value value) {
  std::vector<double> values;
  values.reserve(items.size());
  for (const Item& item : items) values.push_back(value(item));
  return values;
}

constexpr struct {
  const char *name, *long_name;
} staff_variables[] = {
    {"energy_lower",
     "echo energy per beam and range sample that the lower receiver hears; energy is the upper's"},
    {"cross_real", "mean product of the upper receiver's signal and the lower one's conjugate, real part"},
    {"cross_imag",
     "mean product of the upper receiver's signal and the lower one's conjugate, imaginary part"},
};

std::string meaning_of(const std::string& name) {
  constexpr std::string_view bound = "_bound";
  if (name == "energy") return "echo energy per beam and range sample, for a source of 1 J/sr at 1 m";
  if (name.ends_with(bound)) {
    const std::string of = name.substr(0, name.size() - bound.size());
    return "certified half-width: the true " + (of == "energy" ? "energy" : "value of " + of) +
           " lies within " + of + " +- " + name;
  }
  for (const auto& staff : staff_variables)
    if (name == staff.name) return staff.long_name;
  throw std::invalid_argument("no variable " + name);
}

/// A variable over ping, beam and sample, whose values are written ping by ping.
struct PingVariable {
  std::string name;
  std::function<std::span<const double>(std::size_t ping)> values;
};

/// Of a recording's variables over ping, beam and sample, their names in its group and what they hold.
std::vector<PingVariable> ping_variables(const Recording& recording) {
  std::vector<PingVariable> variables{
      {"energy", [&recording](std::size_t ping) { return recording.energy_of(ping); }}};
  for (std::size_t c = 1; c < recording.channels(); ++c)
    variables.push_back({staff_variables[c - 1].name,
                         [&recording, c](std::size_t ping) { return recording.channel_of(ping, c); }});
  if (recording.energy_bound.empty()) return variables;
  for (std::size_t c = 0, channels = variables.size(); c < channels; ++c)
    variables.push_back({variables[c].name + "_bound", [&recording, c](std::size_t ping) {
                           return recording.energy_bound.subspan(
                               (ping * recording.channels() + c) * recording.cells(), recording.cells());
                         }});
  return variables;
}

void define_recording(EchoGroup& group, const Recording& recording, const Provenance& provenance) {
  const Sensor& sensor = *recording.sensor;
  const std::vector<BeamAxis>& beams = sensor.beams();
  const RangeSamples& samples = sensor.samples();

  group.attribute("sensor_name", sensor.description().name);
  group.attribute("sensor_kind", kind_of(sensor.description()).name());
  group.attribute("frequency_khz", sensor.frequency_khz());
  group.attribute("source_energy", "1 J/sr at 1 m");
  group.attribute("sound_speed_m_s", recording.sound_speed_m_s);
  group.attribute("absorption_db_per_km", recording.absorption_db_per_km);

  const int ping = group.dimension("ping", recording.ping_time_s.size());
  const int beam = group.dimension("beam", beams.size());
  const int sample = group.dimension("sample", static_cast<std::size_t>(samples.count));
  const int bound = group.dimension("bound", 2);
  const int xyz = group.dimension("xyz", 3);
  const int wxyz = group.dimension("wxyz", 4);

  for (const PingVariable& of_pings : ping_variables(recording)) {
    const std::string& name = of_pings.name;
    const int variable = group.define(name.c_str(), {ping, beam, sample}, "J", meaning_of(name).c_str());
    if (name == "energy")
      group.attribute(variable, "coordinates", "ping_time beam_azimuth beam_elevation slant_range");
    group.compress(variable, name.c_str(), {1, beams.size(), static_cast<std::size_t>(samples.count)});
  }

  group.variable("ping_time", {ping}, "s", "time of the transmission on the scene's clock",
                 recording.ping_time_s);
  if (!provenance.start_utc.empty()) {
    const int time = group.variable("ping_utc", {ping}, ("seconds since " + provenance.start_utc).c_str(),
                                    "date and time of the transmission", recording.ping_time_s);
    group.attribute(time, "standard_name", "time");
    group.attribute(time, "calendar", "standard");
  }

  std::vector<double> centres, bounds, travel_times;
  for (int k = 0; k < samples.count; ++k) {
    const double centre = samples.first_m + (k + 0.5) * samples.step_m;
    centres.push_back(centre);
    bounds.push_back(samples.first_m + k * samples.step_m);
    bounds.push_back(samples.first_m + (k + 1) * samples.step_m);
    travel_times.push_back(2 * centre / recording.sound_speed_m_s);
  }
  const int range =
      group.variable("slant_range", {sample}, "m", "slant range of the sample's centre", centres);
  group.attribute(range, "bounds", "slant_range_bounds");
  group.variable("slant_range_bounds", {sample, bound}, "m",
                 "slant ranges between which the sample gathers energy, the nearer included", bounds);
  group.variable("two_way_travel_time", {sample}, "s", "two-way travel time of the sample's centre",
                 travel_times);

  group.variable(
      "beam_azimuth", {beam}, "degree",
      "azimuth of the beam's axis in the sensor's frame, clockwise from forward, starboard positive",
      column(beams, [](const BeamAxis& axis) { return degrees(axis.azimuth_rad); }));
  group.variable("beam_elevation", {beam}, "degree",
                 "elevation of the beam's axis above the sensor's horizontal plane",
                 column(beams, [](const BeamAxis& axis) { return degrees(axis.elevation_rad); }));
  group.variable("beam_azimuth_width", {beam}, "degree",
                 "full one-way width of the ideal rectangular beam in azimuth",
                 column(beams, [](const BeamAxis& axis) { return degrees(axis.azimuth_width_rad); }));
  group.variable("beam_elevation_width", {beam}, "degree",
                 "full one-way width of the ideal rectangular beam in elevation",
                 column(beams, [](const BeamAxis& axis) { return degrees(axis.elevation_width_rad); }));
  if (!recording.beam_numbers.empty())
    group.variable("beam_number", {beam}, "1", "beam of the sonar, counted from 0",
                   {recording.beam_numbers.begin(), recording.beam_numbers.end()});

  std::vector<double> positions, attitudes;
  std::vector<PoseAngles> angles;
  for (const Pose& pose : recording.ping_pose) {
    const auto& p = pose.position_m;
    const glm::dquat q = glm::normalize(pose.attitude);
    positions.insert(positions.end(), {p.x, p.y, p.z});
    attitudes.insert(attitudes.end(), {q.w, q.x, q.y, q.z});
    angles.push_back(angles_of(q));
  }
  group.variable("sensor_position", {ping, xyz}, "m",
                 "position of the sensor in the local frame: east, north, up", positions);
  group.variable("sensor_attitude", {ping, wxyz}, "1",
                 "quaternion w, x, y, z that turns the sensor's axes (x starboard, y forward, z up) into the "
                 "local frame",
                 attitudes);
  group.variable("sensor_heading", {ping}, "degree",
                 "heading of the sensor's forward axis, clockwise from the local frame's north",
                 column(angles, [](const PoseAngles& a) { return a.heading_deg; }));
  group.variable("sensor_pitch", {ping}, "degree", "pitch of the sensor, forward axis up positive",
                 column(angles, [](const PoseAngles& a) { return a.pitch_deg; }));
  group.variable("sensor_roll", {ping}, "degree", "roll of the sensor, starboard down positive",
                 column(angles, [](const PoseAngles& a) { return a.roll_deg; }));

  for (const PingColumn& column : ping_columns(recording, provenance))
    group.variable(column.name, {ping}, column.units, column.long_name, column.values);

  group.write();
}

/// Packed by all threads, written in order: `group` is the full name of the recording's group, with its "/".
void write_pings(Hdf5Chunks& file, const std::string& group, const Recording& recording) {
  const std::vector<PingVariable> variables = ping_variables(recording);
  const std::size_t chunks = recording.pings() * variables.size();
  constexpr std::size_t most_bytes_at_once = 64 << 20;
  const std::size_t block =
      std::clamp<std::size_t>(most_bytes_at_once / (recording.cells() * sizeof(double)), 1, 4096);
  Steps steps("pings of echoes.nc", recording.pings());
  for (std::size_t first = 0; first < chunks; first += block) {
    std::vector<std::vector<unsigned char>> packed(std::min(block, chunks - first));
    tbb::parallel_for(std::size_t{0}, packed.size(), [&](std::size_t k) {
      packed[k] =
          packed_chunk(variables[(first + k) % variables.size()].values((first + k) / variables.size()));
    });
    for (std::size_t k = 0; k < packed.size(); ++k) {
      const std::size_t ping = (first + k) / variables.size(), variable = (first + k) % variables.size();
      file.write(group + variables[variable].name, ping, packed[k]);
      if (variable + 1 < variables.size()) continue;
      recording.let_go(ping);
      steps.done();
    }
  }
}

}  // namespace

void write_echoes(const fs::path& path, const std::vector<Recording>& recordings,
                  const Provenance& provenance, std::size_t most_bytes_in_memory) {
  if (recordings.empty()) throw std::invalid_argument("no recording to write into " + path.string());
  for (const Recording& recording : recordings) check(recording);

  std::size_t bytes = 0, small_bytes = 0;
  for (const Recording& r : recordings) {
    constexpr std::size_t variables = 32;  // more than there are over pings, over beams, over samples
    bytes += r.energy.size_bytes() + r.energy_bound.size_bytes();
    small_bytes += variables * sizeof(double) *
                   (r.pings() + r.sensor->beams().size() + std::size_t(r.sensor->samples().count));
  }
  EchoFile file(path, bytes <= most_bytes_in_memory, small_bytes);
  EchoGroup root(file, file.id());
  for (const auto& [name, value] : attributes_of(provenance))
    std::visit([&](const auto& v) { root.attribute(name, v); }, value);
  const bool grouped = recordings.size() > 1;
  for (const Recording& recording : recordings) {
    int id = file.id();
    if (grouped) {
      const std::string& name = recording.sensor->description().name;
      file.check(nc_def_grp(file.id(), name.c_str(), &id), fmt::format("define group '{}'", name));
    }
    EchoGroup group(file, id);
    define_recording(group, recording, provenance);
  }
  Hdf5Chunks& chunks = file.chunks(bytes);
  for (const Recording& recording : recordings)
    write_pings(chunks, grouped ? "/" + recording.sensor->description().name + "/" : "/", recording);
  file.close();
}

}  // namespace tubefoot
