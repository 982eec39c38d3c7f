// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes echo files of any origin. The input is raw bytes in netCDF's classic formats, or a description of
// a whole classic or netCDF-4 file. The description has dimensions, types, units and values. The libraries
// netCDF and HDF5 are not under test: validation/fuzzing.md.
#include <netcdf.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "compare/comparison.hpp"
#include "files/json_text.hpp"
#include "fuzz.hpp"

namespace tubefoot::fuzz {
namespace {

std::string word(Bytes& bytes, std::initializer_list<const char*> usual) {
  const std::uint32_t which = bytes.below(static_cast<std::uint32_t>(usual.size() + 2));
  if (which < usual.size()) return usual.begin()[which];
  return std::string(bytes.text(bytes.below(40)));
}

double number(Bytes& bytes) {
  const std::array<double, 16> usual{0.0,        1e-9,  2.5,   -1.0,     1e-300,    1e300, NC_FILL_DOUBLE,
                                     9.96921e36, -0.0,  1e-12, HUGE_VAL, -HUGE_VAL, NAN,   360.0,
                                     1e9,        5e-324};
  const std::uint32_t which = bytes.below(64);
  return which < usual.size() ? usual[which] : double(which) * 0.25;
}

void put_attribute(int id, int variable, const char* name, const std::string& text, std::uint32_t kind) {
  const char* string = text.c_str();
  const double value = double(text.size()) - 3;
  if (kind < 5)
    nc_put_att_text(id, variable, name, text.size(), text.data());
  else if (kind == 5)
    nc_put_att_string(id, variable, name, 1, &string);
  else if (kind == 6)
    nc_put_att_double(id, variable, name, NC_DOUBLE, 1, &value);
  else
    nc_put_att_string(id, variable, name, 0, nullptr);
}

/// Defines dimensions, attributes and variables of one group, except for those that netCDF rejects.
void define(int id, Bytes& bytes, std::vector<std::vector<double>>& written) {
  constexpr std::array lengths{std::size_t{0},       std::size_t{1},       std::size_t{100000},
                               std::size_t{1} << 31, std::size_t{1} << 40, std::size_t{65536}};
  std::vector<int> dimensions;
  for (const char* const usual : {"ping", "beam", "sample", "edge"}) {
    const std::uint32_t how = bytes.below(16);
    if (how == 15) continue;
    int dimension = 0;
    const std::size_t length = how < lengths.size() ? lengths[how] : how - lengths.size();  // 0: unlimited
    const std::string name = how == 14 ? word(bytes, {"ping", "beam", "sample"}) : usual;
    if (nc_def_dim(id, name.c_str(), length, &dimension) == NC_NOERR) dimensions.push_back(dimension);
  }
  for (const char* const name : {"sensor_name", "source_energy", "scene_hash", "engine", "tubefoot_version"})
    if (const std::uint32_t kind = bytes.below(12); kind < 8)
      put_attribute(id, NC_GLOBAL, name, word(bytes, {"1 J/sr at 1 m", "camera", ""}), kind);
  constexpr std::array types{NC_DOUBLE, NC_DOUBLE, NC_DOUBLE, NC_DOUBLE,
                             NC_FLOAT,  NC_INT,    NC_CHAR,   NC_UINT64};
  struct Usual {
    const char* name;
    const char* unit;
    std::vector<std::size_t> dimensions;
  };
  static const std::array<Usual, 7> variables{{{"energy", "J", {0, 1, 2}},
                                               {"energy_bound", "J", {0, 1, 2}},
                                               {"slant_range", "m", {2}},
                                               {"slant_range_bounds", "m", {2, 3}},
                                               {"beam_azimuth", "degree", {1}},
                                               {"beam_elevation", "degree", {1}},
                                               {"ping_time", "s", {0}}}};
  for (const Usual& usual : variables) {
    const std::uint32_t how = bytes.below(16);
    if (how == 15) continue;
    std::vector<int> ids;
    if (how == 14) {
      for (std::uint32_t n = bytes.below(5); n > 0 && !dimensions.empty(); --n)
        ids.push_back(dimensions[bytes.below(static_cast<std::uint32_t>(dimensions.size()))]);
    } else {
      for (const std::size_t d : usual.dimensions)
        if (d < dimensions.size()) ids.push_back(dimensions[d]);
    }
    int variable = 0;
    const nc_type type = how == 13 ? types[bytes.below(types.size())] : NC_DOUBLE;
    if (nc_def_var(id, usual.name, type, int(ids.size()), ids.data(), &variable) != NC_NOERR) continue;
    const std::uint32_t kind = bytes.below(32);
    if (kind < 30)
      put_attribute(id, variable, "units", kind < 24 ? usual.unit : word(bytes, {"dB", "metre"}),
                    kind < 24 ? 0 : kind - 22);
    if (how == 12) {
      const double fill = number(bytes);
      nc_put_att_double(id, variable, "_FillValue", type, 1, &fill);
    }
    std::size_t count = 1;
    for (const int dimension : ids) {
      std::size_t length = 0;
      nc_inq_dimlen(id, dimension, &length);
      if (__builtin_mul_overflow(count, length, &count)) count = 0;
    }
    written.emplace_back();
    if (count > 0 && count <= 4096) {
      const std::uint32_t pattern = bytes.below(4);
      for (std::size_t k = 0; k < count; ++k)
        written.back().push_back(pattern == 0 ? number(bytes) : double(k) * (pattern == 1 ? 0.5 : 1e-9));
    } else if (!ids.empty()) {  // variables that are never written must not take space
      const std::vector<std::size_t> chunk(ids.size(), 1);
      nc_def_var_chunking(id, variable, NC_CHUNKED, chunk.data());
    }
  }
}

void fill(int id, const std::vector<std::vector<double>>& written) {
  for (std::size_t v = 0; v < written.size(); ++v)
    if (!written[v].empty()) nc_put_var_double(id, static_cast<int>(v), written[v].data());
}

/// Writes a netCDF file. Returns false if netCDF rejects it.
bool write_echoes(const std::filesystem::path& file, Bytes& bytes) {
  constexpr std::array formats{NC_NETCDF4, 0, NC_64BIT_OFFSET, NC_64BIT_DATA};
  const int format = formats[bytes.below(formats.size())];
  std::filesystem::remove(file);
  int id = 0;
  if (nc_create(file.c_str(), NC_CLOBBER | format, &id) != NC_NOERR) return false;
  std::vector<std::pair<int, std::vector<std::vector<double>>>> groups(1);
  groups[0].first = id;
  if (format == NC_NETCDF4 && bytes.below(3) != 0)
    for (std::uint32_t n = 1 + bytes.below(2); n > 0; --n) {
      int group = 0;
      if (nc_def_grp(id, word(bytes, {"camera", "side"}).c_str(), &group) == NC_NOERR)
        groups.push_back({group, {}});
    }
  for (auto& [group, written] : groups) define(group, bytes, written);
  // Classic files reserve space for unwritten data, which must stay small.
  std::size_t room = 0;
  if (format != NC_NETCDF4) {
    int count = 0;
    nc_inq_nvars(id, &count);
    for (int v = 0; v < count; ++v) {
      int rank = 0, ids[NC_MAX_VAR_DIMS];
      nc_inq_var(id, v, nullptr, nullptr, &rank, ids, nullptr);
      double values = 1;
      for (int d = 0; d < rank; ++d) {
        std::size_t length = 0;
        nc_inq_dimlen(id, ids[d], &length);
        values *= double(length);
      }
      room = std::max(room, values > 1e5 ? std::size_t{1} << 40 : std::size_t(values));
    }
  }
  int old = 0;
  if (room > 100000) nc_set_fill(id, NC_NOFILL, &old);
  bool good = nc_enddef(id) == NC_NOERR;
  for (const auto& [group, written] : groups)
    if (good) fill(group, written);
  good = (good && nc_close(id) == NC_NOERR);
  if (!good) nc_abort(id);
  return good && std::filesystem::exists(file);
}

void read(const std::filesystem::path& file) {
  const EchoContents contents = read_echo_file(file);
  for (const SensorEchoes& s : contents.sensors) {
    if (s.energy.size() != s.pings * s.beams * s.samples || s.energy.empty()) finding("energies of no size");
    for (const double e : s.energy)
      if (!(e >= 0 && std::isfinite(e))) finding("an energy that is none");
    for (std::size_t k = 1; k < s.samples; ++k)
      if (!(s.slant_range_m.at(k) > s.slant_range_m[k - 1])) finding("slant ranges that do not increase");
    for (const auto& [values, size] :
         {std::pair(&s.energy_bound, s.energy.size()), std::pair(&s.slant_range_bounds_m, 2 * s.samples),
          std::pair(&s.beam_elevation_deg, s.beams), std::pair(&s.ping_time_s, s.pings)})
      if (!values->empty() && values->size() != size) finding("values of another size");
  }
  const EchoPairs pairs = pair_echoes(contents, contents, std::nullopt, false);
  if (pairs.sensors.size() != contents.sensors.size()) finding("a sensor without its like");
  text_of(comparison_json(contents, contents, pairs, errors_of(pairs, 3)));
}

}  // namespace
}  // namespace tubefoot::fuzz

/// First byte: for 0 to 1 the file follows, else a description of the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  fuzz::Bytes bytes(data, size);
  std::filesystem::path file = fuzz::scratch_folder() / "echoes.nc";
  if (bytes.below(8) < 2)
    fuzz::scratch_file("echoes.nc", bytes.rest());
  else if (!fuzz::write_echoes(file, bytes))
    return 0;
  fuzz::may_refuse([&] { fuzz::read(file); });
  return 0;
}
