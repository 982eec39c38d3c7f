// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes files of element signals (signals.nc) of any origin. The input is raw bytes in netCDF's classic
// formats, or a set of changes to a valid classic or netCDF-4 file. The changes concern dimensions, types,
// units and values. The libraries netCDF and HDF5 are not under test: validation/fuzzing.md.
#include <netcdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "fuzz.hpp"
#include "sensors/formats/signals_netcdf.hpp"

namespace tubefoot::fuzz {
namespace {

double number(Bytes& bytes) {
  constexpr std::array<double, 16> usual{0.0,  1.0,   2.0,      -1.0,      0.5, 1e-300, 1e300, NC_FILL_DOUBLE,
                                         -0.0, 1e-12, HUGE_VAL, -HUGE_VAL, NAN, 1e308,  1e9,   5e-324};
  const std::uint32_t which = bytes.below(64);
  return which < usual.size() ? usual[which] : double(which) * 0.25;
}

/// 0 for most inputs, so that most of a file is valid.
std::uint32_t seldom(Bytes& bytes, std::uint32_t others) {
  const std::uint32_t how = bytes.below(64);
  return how <= others ? how : 0;
}

struct Dimension {
  const char* name;
  std::size_t length;
};
constexpr std::array<Dimension, 7> dimensions{
    {{"ping", 3}, {"receiver", 2}, {"sample", 9}, {"complex", 2}, {"xyz", 3}, {"wxyz", 4}, {"track", 3}}};

struct Number {
  const char* name;
  double value;
};
constexpr std::array<Number, 9> numbers{{{"baseband_frequency", 1e5},
                                         {"sample_rate", 4e4},
                                         {"sound_speed_m_s", 1500},
                                         {"matched_filtered", 0},
                                         {"stop_and_hop", 1},
                                         {"waveform_start_frequency", 95e3},
                                         {"waveform_stop_frequency", 105e3},
                                         {"waveform_duration", 2e-4},
                                         {"waveform_taper", 0.5}}};

struct Variable {
  const char* name;
  const char* unit;
  std::vector<std::size_t> along;  ///< of `dimensions`
  double (*usual)(std::size_t);    ///< value by index
};
const std::array<Variable, 10>& variables() {
  constexpr auto counted = [](std::size_t k) { return double(k); };
  constexpr auto turned = [](std::size_t k) { return k % 4 == 0 ? 1.0 : 0.0; };
  static const std::array<Variable, 10> all{
      {{"pressure", "W^(1/2)", {0, 1, 2, 3}, [](std::size_t k) { return double(k % 7) - 3; }},
       {"sample_time", "s", {2}, [](std::size_t k) { return 0.01 + double(k) / 4e4; }},
       {"ping_start_time", "s", {0}, counted},
       {"transmitter_position", "m", {4}, counted},
       {"receiver_position", "m", {1, 4}, counted},
       {"ping_position", "m", {0, 4}, counted},
       {"ping_attitude", "1", {0, 5}, turned},
       {"track_time", "s", {6}, counted},
       {"track_position", "m", {6, 4}, counted},
       {"track_attitude", "1", {6, 5}, turned}}};
  return all;
}

void define_attributes(int id, Bytes& bytes) {
  for (const auto& [name, usual] : numbers) {
    const double other = number(bytes);
    switch (const std::uint32_t how = seldom(bytes, 5)) {
      case 1:
        break;  // omitted
      case 2:
        nc_put_att_text(id, NC_GLOBAL, name, 1, "1");
        break;
      case 3: {
        const std::array two{usual, usual};
        nc_put_att_double(id, NC_GLOBAL, name, NC_DOUBLE, two.size(), two.data());
        break;
      }
      default: {
        const double value = how == 0 ? usual : other;
        nc_put_att_double(id, NC_GLOBAL, name, how == 4 ? NC_INT : NC_DOUBLE, 1, &value);
      }
    }
  }
  constexpr std::array<std::string_view, 3> factors{"exp(-i omega t)", "exp(+i omega t)", ""};
  const std::uint32_t factor = bytes.below(16);
  const std::string_view said = factor < 14    ? factors[factor % 2]
                                : factor == 14 ? factors[2]
                                               : bytes.text(bytes.below(40));
  nc_put_att_text(id, NC_GLOBAL, "time_factor", said.size(), said.data());
}

/// Defines variables, except for those that netCDF rejects. Returns the values of variables that are small
/// enough to be written.
std::vector<std::pair<int, std::vector<double>>> define_variables(int id, Bytes& bytes) {
  constexpr std::array lengths{std::size_t{0},       std::size_t{1},       std::size_t{100000},
                               std::size_t{1} << 31, std::size_t{1} << 40, std::size_t{65536}};
  std::vector<int> ids;
  for (const auto& [name, usual] : dimensions) {
    const std::uint32_t how = seldom(bytes, 20);
    const std::size_t length = how == 0                ? usual
                               : how <= lengths.size() ? lengths[how - 1]
                                                       : how - lengths.size();
    ids.push_back(-1);
    nc_def_dim(id, name, length, &ids.back());  // length 0: unlimited
  }
  constexpr std::array types{NC_FLOAT, NC_INT, NC_CHAR, NC_UINT64};
  std::vector<std::pair<int, std::vector<double>>> written;
  for (const Variable& usual : variables()) {
    const std::uint32_t how = seldom(bytes, 16);
    if (how == 1) continue;  // omitted
    std::vector<int> along;
    for (const std::size_t d : usual.along) along.push_back(ids[d]);
    if (how == 2) std::ranges::reverse(along);
    if (how == 3) along.pop_back();
    if (how == 4) along.push_back(ids[bytes.below(dimensions.size())]);
    int variable = 0;
    const nc_type type = how >= 5 && how < 5 + types.size() ? types[how - 5] : NC_DOUBLE;
    if (nc_def_var(id, usual.name, type, int(along.size()), along.data(), &variable) != NC_NOERR) continue;
    const std::string_view unit = how == 9 ? bytes.text(bytes.below(40)) : usual.unit;
    if (how != 10) nc_put_att_text(id, variable, "units", unit.size(), unit.data());
    if (how == 11) {
      const double fill = number(bytes);
      nc_put_att_double(id, variable, "_FillValue", type, 1, &fill);
    }
    double count = 1;
    std::vector<std::size_t> chunk;
    for (const int dimension : along) {
      std::size_t length = 0;
      nc_inq_dimlen(id, dimension, &length);
      // An unlimited dimension has length one after its first value.
      count *= std::max(1.0, double(length)), chunk.push_back(1);
    }
    if (how == 12) nc_def_var_deflate(id, variable, 1, 1, 9);
    if (count > 4096) {  // variables that are never written must not take space
      if (!along.empty()) nc_def_var_chunking(id, variable, NC_CHUNKED, chunk.data());
      continue;
    }
    std::vector<double> values(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = usual.usual(k);
    if (how >= 13)
      for (std::uint32_t n = 1 + bytes.below(3); n > 0; --n)
        values[bytes.below_many(static_cast<std::uint32_t>(values.size()))] = number(bytes);
    written.emplace_back(variable, std::move(values));
  }
  return written;
}

/// Writes a netCDF file. Returns false if netCDF rejects it.
bool write_any(const std::filesystem::path& file, Bytes& bytes) {
  constexpr std::array formats{NC_NETCDF4, 0, NC_64BIT_OFFSET, NC_64BIT_DATA};
  const int format = formats[bytes.below(formats.size())];
  std::filesystem::remove(file);
  int id = 0, old = 0;
  if (nc_create(file.c_str(), NC_CLOBBER | format, &id) != NC_NOERR) return false;
  define_attributes(id, bytes);
  const auto written = define_variables(id, bytes);
  // Classic files reserve space for unwritten data, which must stay small.
  if (format != NC_NETCDF4) nc_set_fill(id, NC_NOFILL, &old);
  bool good = nc_enddef(id) == NC_NOERR;
  for (const auto& [variable, values] : written) {
    if (!good) break;
    std::array<std::size_t, 5> start{}, count{};
    int rank = 0;
    std::array<int, NC_MAX_VAR_DIMS> along{};
    nc_inq_var(id, variable, nullptr, nullptr, &rank, along.data(), nullptr);
    for (int d = 0; d < rank; ++d) {
      nc_inq_dimlen(id, along[d], &count[d]);
      count[d] = std::max<std::size_t>(1, count[d]);
    }
    nc_put_vara_double(id, variable, start.data(), count.data(), values.data());
  }
  if (good) good = nc_close(id) == NC_NOERR;
  if (!good) nc_abort(id);
  return good && std::filesystem::exists(file);
}

void read(const std::filesystem::path& file) {
  const ElementSignals signals = read_signals(file);
  if (signals.pressure.empty() ||
      signals.pressure.size() != signals.pings() * signals.receivers() * signals.samples())
    finding("pressures of no size");
  for (const std::complex<double>& value : signals.pressure)
    if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) finding("a pressure that is none");
  for (std::size_t ping = 0; ping < signals.pings(); ++ping) {
    const Pose pose = signals.motion.ping_pose(ping);
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(pose.position_m[axis])) finding("a pose that is nowhere");
    if (!(std::abs(glm::dot(pose.attitude, pose.attitude) - 1) < 1e-5)) finding("an attitude that is none");
  }
  // The program can write the signals again, and the copy is equal.
  const std::filesystem::path again = scratch_folder() / "again.nc";
  std::filesystem::remove(again);
  write_signals(again, signals);
  const ElementSignals kept = read_signals(again);
  if (kept.pressure != signals.pressure || kept.array.receivers_m != signals.array.receivers_m ||
      kept.motion.ping_start_s() != signals.motion.ping_start_s())
    finding("signals that do not come back");
}

}  // namespace
}  // namespace tubefoot::fuzz

/// First byte: for 0 to 1 the file follows, else a description of the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  fuzz::Bytes bytes(data, size);
  const std::filesystem::path file = fuzz::scratch_folder() / "signals.nc";
  if (bytes.below(8) < 2)
    fuzz::scratch_file("signals.nc", bytes.rest());
  else if (!fuzz::write_any(file, bytes))
    return 0;
  fuzz::may_refuse([&] { fuzz::read(file); });
  return 0;
}
