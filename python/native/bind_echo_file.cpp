// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings of echo files and result folders: opens them and exposes their variables, attributes and
// labels as arrays.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "files/input_registry.hpp"
#include "result.hpp"
#include "run_apart.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace fs = std::filesystem;
namespace {

py::array table(const std::vector<double>& values, const std::vector<std::size_t>& lengths,
                const py::object& owner) {
  std::vector<py::ssize_t> shape(lengths.begin(), lengths.end()), strides(lengths.size(), sizeof(double));
  for (std::size_t k = lengths.size(); k-- > 1;) strides[k - 1] = strides[k] * shape[k];
  return view(values.data(), std::move(shape), std::move(strides), owner);
}

/// Files of the folder of a run: the required echo file and the optional statistics.
struct ResultFiles {
  fs::path echoes;
  std::optional<fs::path> statistics;
};

ResultFiles files_of(const fs::path& place) {
  if (!fs::is_directory(place)) return {place, std::nullopt};
  if (!fs::exists(place / "echoes.nc"))
    throw InputError({place.string()},
                     "the folder has no echoes.nc: name a result folder of a run, or an echo file");
  ResultFiles files{place / "echoes.nc", place / "stats.json"};
  if (!fs::exists(*files.statistics)) files.statistics.reset();
  return files;
}

std::shared_ptr<NativeResult> open(const std::string& place) {
  const ResultFiles files = files_of(place);
  auto result = std::make_shared<NativeResult>();
  result->read = std::make_shared<const WholeEchoFile>(read_whole_echo_file(files.echoes));
  constexpr std::uintmax_t most_bytes = std::uintmax_t{64} << 20;
  if (files.statistics)
    result->statistics =
        read_whole(*files.statistics, {files.statistics->string()}, most_bytes, "the stats.json of a run");
  return result;
}

std::shared_ptr<NativeResult> open_from_python(const std::string& place) {
  std::shared_ptr<NativeResult> result;
  RunWatch watch;
  run_apart(watch, py::none(), [&] { result = open(place); });
  return result;
}

}  // namespace

py::dict read_arrays(const py::object& self, std::size_t sensor) {
  const WholeEchoFile& file = *self.cast<const NativeResult&>().read;
  const SensorEchoes& e = file.contents.sensors.at(sensor);
  py::dict arrays;
  const std::vector<std::size_t> cells{e.pings, e.beams, e.samples};
  const auto put = [&](const char* name, const std::vector<double>& values, std::vector<std::size_t> shape) {
    if (!values.empty()) arrays[name] = table(values, shape, self);
  };
  put("energy", e.energy, cells);
  put("energy_bound", e.energy_bound, cells);
  put("ping_time", e.ping_time_s, {e.pings});
  put("slant_range", e.slant_range_m, {e.samples});
  put("slant_range_bounds", e.slant_range_bounds_m, {e.samples, 2});
  put("beam_azimuth", e.beam_azimuth_deg, {e.beams});
  put("beam_elevation", e.beam_elevation_deg, {e.beams});
  for (const EchoVariable& variable : file.more.at(sensor).variables)
    arrays[variable.name.c_str()] = table(variable.values, variable.shape, self);
  return arrays;
}

py::dict read_attributes(const NativeResult& self, std::size_t sensor) {
  py::dict attributes;
  attributes["sensor_name"] = self.read->contents.sensors.at(sensor).name;
  for (const auto& [name, value] : self.read->more.at(sensor).attributes) attributes[name.c_str()] = value;
  return attributes;
}

py::object read_labels(const py::object& self, std::size_t sensor) {
  const WholeEchoFile::More& more = self.cast<const NativeResult&>().read->more.at(sensor);
  py::dict arrays;
  for (const char* of : {"object", "material"}) {
    const std::string label = fmt::format("{}_label", of), share = fmt::format("{}_share", of);
    const EchoVariable *labels = more.variable(label), *shares = more.variable(share);
    if (!labels || !shares) return py::none();
    arrays[fmt::format("{}s", of).c_str()] = py::str(labels->flag_meanings).attr("split")();
    arrays[share.c_str()] = table(shares->values, shares->shape, self);
    arrays[label.c_str()] = table(labels->values, labels->shape, self).attr("astype")("int16");
  }
  for (const char* name : {"mean_height", "mean_range", "unscattered_share"})
    if (const EchoVariable* values = more.variable(name))
      arrays[name] = table(values->values, values->shape, self);
  return arrays;
}

py::dict dimensions_of(const NativeResult& self, std::size_t sensor) {
  py::dict all;
  if (self.read)
    for (const EchoVariable& v : self.read->more.at(sensor).variables)
      all[v.name.c_str()] = py::make_tuple(py::tuple(py::cast(v.dimensions)), v.units, v.long_name);
  else
    for (const RecordedVariable& v : self.recordings.at(sensor).variables())
      all[v.meaning.name.c_str()] = py::make_tuple(
          v.meaning.is_by_beam ? py::make_tuple("ping", "beam") : py::make_tuple("ping", "beam", "sample"),
          v.meaning.units, v.meaning.long_name);
  return all;
}

void bind_echo_file(py::module_& module) { module.def("open", &open_from_python); }

}  // namespace tubefoot::python
