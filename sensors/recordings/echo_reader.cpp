// SPDX-License-Identifier: GPL-3.0-or-later
// Reads echo files (echoes.nc, docs/output-files.md) of any origin. Names, dimensions, units, sizes and
// values are checked before use, and memory is checked before allocation.
#include "sensors/recordings/echo_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>

#include "files/memory_at_hand.hpp"
#include "sensors/recordings/netcdf_group.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;
using Units = std::span<const std::string_view>;

// The first unit of each list is that of the layout; the others are its synonyms. Files of version 0.1 and
// earlier give the energy density in J, meaning J/m^2.
constexpr std::string_view ones[] = {"1"},
                           joules_per_m2[] = {"J m-2", "J/m2", "J/m^2", "J.m-2", "J", "joule", "joules"},
                           metres[] = {"m", "metre", "metres", "meter", "meters"},
                           degrees_[] = {"degree", "degrees", "deg"}, seconds[] = {"s", "second", "seconds"};

bool finite(double value) { return std::isfinite(value); }

/// Reads a finite variable along one dimension. With `optional` the result is empty if the variable is
/// missing.
std::vector<double> axis(const EchoGroupInput& group, const char* name, const char* dimension, Units units,
                         std::size_t length, bool optional = false) {
  if (optional && !group.has(name)) return {};
  std::vector<std::size_t> shape;
  std::vector<double> values = group.values(name, {dimension}, units, &shape);
  // Groups may redefine a dimension. The dimension of the energy applies.
  if (values.size() != length)
    group.fail(
        name, fmt::format("has {} values, but 'energy' has {} along '{}'", values.size(), length, dimension));
  group.require(name, {dimension}, shape, values, finite, "a finite number");
  return values;
}

/// Numbers of pings or beams; empty if the file does not contain them.
std::vector<double> numbers(const EchoGroupInput& group, const char* name, const char* dimension,
                            std::size_t length) {
  std::vector<double> values = axis(group, name, dimension, ones, length, true);
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!(values[k] >= 0) || values[k] != std::floor(values[k]) || (k > 0 && values[k] <= values[k - 1]))
      group.fail(name, fmt::format("is {} at {} {}; expected increasing whole numbers of at least 0",
                                   values[k], dimension, k));
  return values;
}

SensorEchoes read_sensor(const EchoGroupInput& group, const std::string& default_name) {
  SensorEchoes echoes;
  echoes.name = group.text("sensor_name");
  if (echoes.name.empty()) echoes.name = default_name;
  const std::string source = group.text("source_energy"), expected_source = "1 J/sr at 1 m";
  if (!source.empty() && source != expected_source)
    group.fail(
        "energy",
        fmt::format("assumes a source of '{}' (attribute source_energy), expected '{}': scale the values",
                    source, expected_source));

  const Words dimensions{"ping", "beam", "sample"};
  std::vector<std::size_t> shape, bound_shape;
  echoes.energy = group.values("energy", dimensions, joules_per_m2, &shape);
  echoes.pings = shape[0], echoes.beams = shape[1], echoes.samples = shape[2];
  group.require(
      "energy", dimensions, shape, echoes.energy, [](double e) { return std::isfinite(e) && e >= 0; },
      "finite energies of at least 0");
  if (group.has("energy_bound")) {
    echoes.energy_bound = group.values("energy_bound", dimensions, joules_per_m2, &bound_shape);
    if (bound_shape != shape)
      group.fail("energy_bound", fmt::format("has {} values, expected {} as in 'energy'",
                                             fmt::join(bound_shape, " x "), fmt::join(shape, " x ")));
    group.require(
        "energy_bound", dimensions, shape, echoes.energy_bound, [](double b) { return b >= 0; },
        "half-widths of at least 0");
  }

  echoes.slant_range_m = axis(group, "slant_range", "sample", metres, echoes.samples);
  for (std::size_t k = 1; k < echoes.samples; ++k)
    if (!(echoes.slant_range_m[k] > echoes.slant_range_m[k - 1]))
      group.fail("slant_range", fmt::format("goes from {} to {} at sample {}; expected increasing ranges",
                                            echoes.slant_range_m[k - 1], echoes.slant_range_m[k], k));
  echoes.beam_azimuth_deg = axis(group, "beam_azimuth", "beam", degrees_, echoes.beams);
  echoes.beam_elevation_deg = axis(group, "beam_elevation", "beam", degrees_, echoes.beams, true);
  echoes.ping_time_s = axis(group, "ping_time", "ping", seconds, echoes.pings, true);
  echoes.ping_number = numbers(group, "ping_number", "ping", echoes.pings);
  echoes.beam_number = numbers(group, "beam_number", "beam", echoes.beams);
  if (group.has("slant_range_bounds")) {
    std::vector<std::size_t> edges;
    echoes.slant_range_bounds_m = group.values("slant_range_bounds", {"sample", "bound"}, metres, &edges);
    if (edges != std::vector<std::size_t>{echoes.samples, 2})
      group.fail("slant_range_bounds",
                 fmt::format("has {} values, expected {} x 2", fmt::join(edges, " x "), echoes.samples));
    group.require("slant_range_bounds", {"sample", "bound"}, edges, echoes.slant_range_bounds_m, finite,
                  "a finite number");
  }
  return echoes;
}

/// The variables of SensorEchoes. Other variables are read only for a whole file.
constexpr const char* compared[] = {"energy",       "energy_bound",   "slant_range", "slant_range_bounds",
                                    "beam_azimuth", "beam_elevation", "ping_time"};

/// Checks before reading that memory suffices for all variables.
void require_memory_for(const NetcdfInput& file, const std::vector<EchoGroupInput>& groups, bool whole) {
  double bytes = 0;
  for (const EchoGroupInput& group : groups) {
    if (whole)
      for (const std::string& name : group.tables()) bytes += group.bytes_of(name.c_str());
    else
      for (const char* name : compared) bytes += group.bytes_of(name);
  }
  require_memory(bytes, {file.path().string()}, "its values", "write fewer pings or sensors per file");
}

std::vector<int> groups_of(const NetcdfInput& file) {
  int count = 0;
  file.check(nc_inq_grps(file.id(), &count, nullptr), "count groups");
  std::vector<int> ids(static_cast<std::size_t>(count));
  file.check(nc_inq_grps(file.id(), &count, ids.data()), "list groups");
  return ids;
}

/// The groups with energies, and default names of their sensors.
struct EchoGroups {
  std::vector<EchoGroupInput> groups;
  std::vector<std::string> names;
};

EchoGroups with_energies(const NetcdfInput& file, const EchoGroupInput& root) {
  if (root.has("energy")) return {{root}, {"sensor"}};
  EchoGroups found;
  for (const int id : groups_of(file)) {
    char name[NC_MAX_NAME + 1] = {};
    file.check(nc_inq_grpname(id, name), "read a group's name");
    const EchoGroupInput group(file, id, std::string(name) + "/");
    if (!group.has("energy")) continue;  // other programs may store other groups
    found.groups.push_back(group);
    found.names.emplace_back(name);
  }
  return found;
}

EchoContents read_contents(const NetcdfInput& file, const EchoGroupInput& root, const EchoGroups& found,
                           bool whole) {
  EchoContents contents;
  contents.file = file.path();
  contents.provenance = {root.text("title"), root.text("scene_hash"), root.text("engine"),
                         root.text("arithmetic"), root.text("version")};
  require_memory_for(file, found.groups, whole);
  for (std::size_t g = 0; g < found.groups.size(); ++g) {
    contents.sensors.push_back(read_sensor(found.groups[g], found.names[g]));
    for (std::size_t k = 0; k < g; ++k)
      if (contents.sensors[k].name == contents.sensors.back().name)
        file.fail(fmt::format("two groups have the sensor_name '{}': give each group its own name",
                              contents.sensors[k].name));
  }
  if (contents.sensors.empty() && root.has("pressure"))
    file.fail(
        "holds signals of elements ('pressure', docs/output-files.md), not energies: name the echoes.nc of "
        "the same run, or read signals in Python with tubefoot.signals()");
  if (contents.sensors.empty())
    file.fail(fmt::format(
        "has no variable 'energy', neither in its root nor in a group (see {} for the layout)", file.page()));
  return contents;
}

/// True for an attribute of a sensor. In a file whose only sensor is the root group, these stand among the
/// file's attributes.
bool is_of_sensor(const std::string& attribute) {
  constexpr std::string_view names[] = {"sensor_name",   "sensor_kind",     "frequency_khz",
                                        "source_energy", "sound_speed_m_s", "absorption_db_per_km"};
  return std::ranges::find(names, attribute) != std::end(names);
}

template <class Item>
const Item* named(const std::vector<Item>& items, const std::string& name) {
  const auto found = std::ranges::find(items, name, &Item::name);
  return found == items.end() ? nullptr : &*found;
}

}  // namespace

const EchoVariable* WholeEchoFile::More::variable(const std::string& name) const {
  return named(variables, name);
}
const EchoAttribute* WholeEchoFile::More::attribute(const std::string& name) const {
  return named(attributes, name);
}

EchoContents read_echo_file(const fs::path& path) {
  const NetcdfInput file(path);
  const EchoGroupInput root(file, file.id(), "");
  return read_contents(file, root, with_energies(file, root), false);
}

WholeEchoFile read_whole_echo_file(const fs::path& path) {
  const NetcdfInput file(path);
  const EchoGroupInput root(file, file.id(), "");
  const EchoGroups found = with_energies(file, root);
  WholeEchoFile whole{read_contents(file, root, found, true), root.attributes(), {}};
  for (const EchoGroupInput& group : found.groups) {
    WholeEchoFile::More& more = whole.more.emplace_back();
    more.attributes = group.attributes();
    for (const std::string& name : group.tables())
      if (std::ranges::find(compared, name) == std::end(compared))
        more.variables.push_back(group.table(name));
  }
  if (root.has("energy"))  // there is one group of attributes, from which those of the file are removed
    std::erase_if(whole.more.front().attributes,
                  [](const EchoAttribute& a) { return !is_of_sensor(a.name); });
  if (root.has("energy"))
    std::erase_if(whole.attributes, [](const EchoAttribute& a) { return is_of_sensor(a.name); });
  return whole;
}

}  // namespace tubefoot
