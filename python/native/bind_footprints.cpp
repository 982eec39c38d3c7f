// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings of footprints: traces the chosen pings of a sensor and exposes the columns and corners of
// the footprints as arrays.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "footprints/footprint_place.hpp"
#include "footprints/footprint_table.hpp"
#include "run/abilities.hpp"
#include "run/settings.hpp"
#include "run/tiles_in_view.hpp"
#include "run_apart.hpp"
#include "scene.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace {

/// Footprints of the pings of a sensor.
struct NativeFootprints {
  std::shared_ptr<const Survey> survey;
  std::string sensor;
  FootprintTable table;
};

NativeFootprints compute(NativeScene& scene, const std::string& sensor, const std::string& pings,
                         const std::string& beams, RunWatch& watch) {
  NativeFootprints footprints{scene.survey(), sensor, {}};
  const Survey& survey = *footprints.survey;
  const ThreadLimit limit(scene.description().run.threads);
  const std::size_t s = survey.sensor_set->sensor_named(sensor);
  const Transmissions transmissions(survey, request_of(scene.description().run));
  require_able(survey, transmissions.request(), Feature::footprints, s);
  const SensorPings& all = survey.sensors[s];
  const PingRange range = resolved(pings, all.times_s.size());
  const std::vector<std::uint32_t> chosen = resolved_beams(beams, all.sensor->beams().size());
  TransmissionsAround around(transmissions);
  watch.total = std::size_t(range.last - range.first + 1);
  for (auto ping = std::size_t(range.first); ping <= std::size_t(range.last); ++ping, ++watch.pings)
    for (std::size_t transmission = 0; transmission < all.sensor->transmissions(); ++transmission)
      footprints.table.append(footprint_table(
          around.at(survey.sensor_set->transmissions_of(s), ping).received_by(s, ping, transmission), s,
          chosen));
  return footprints;
}

std::shared_ptr<NativeFootprints> footprints(NativeScene& scene, const std::string& sensor,
                                             const std::string& pings, const std::string& beams,
                                             const py::object& progress) {
  std::shared_ptr<NativeFootprints> result;
  RunWatch watch;
  run_apart(watch, progress, [&] {
    result = std::make_shared<NativeFootprints>(compute(scene, sensor, pings, beams, watch));
  });
  return result;
}

/// Returns name, unit, meaning and values of each column.
py::list columns(const py::object& self) {
  const FootprintTable& table = self.cast<const NativeFootprints&>().table;
  py::list all;
  for (const FootprintColumn& column : footprint_columns()) {
    const auto values = [&](auto member) -> py::array {
      using T = typename std::decay_t<decltype(table.*member)>::value_type;
      return view_of<T>(table.*member, self);
    };
    all.append(
        py::make_tuple(column.name, column.units, column.long_name, std::visit(values, column.values)));
  }
  return all;
}

/// Returns the corners in the coordinate reference system of the scene, or unchanged if it has none.
py::array map_corners(const NativeFootprints& self) {
  const FootprintPlace place(self.survey->scene);
  std::vector<double> corners;
  corners.reserve(3 * self.table.corners_m.size());
  for (const glm::dvec3& corner : self.table.corners_m) {
    const glm::dvec3 p = place(corner);
    corners.insert(corners.end(), {p.x, p.y, p.z});
  }
  return array_of(corners, 3);
}

std::vector<std::string> component_names(const NativeFootprints& self) {
  std::vector<std::string> names;
  for (const ComponentReport& c : self.survey->scene.report.components) names.push_back(c.name);
  return names;
}

std::vector<std::string> material_names(const NativeFootprints& self) {
  std::vector<std::string> names;
  for (const MaterialDescription& m : self.survey->scene.description.materials) names.push_back(m.name);
  return names;
}

py::array offsets(const py::object& self, std::vector<std::uint64_t> FootprintTable::*member) {
  return view_of<std::uint64_t>(self.cast<const NativeFootprints&>().table.*member, self);
}

}  // namespace

void bind_footprints(py::module_& module) {
  py::class_<NativeFootprints, std::shared_ptr<NativeFootprints>>(module, "Footprints")
      .def_readonly("sensor", &NativeFootprints::sensor)
      .def("columns", &columns)
      .def_property_readonly(
          "first_piece", [](const py::object& self) { return offsets(self, &FootprintTable::first_piece); })
      .def_property_readonly(
          "first_corner", [](const py::object& self) { return offsets(self, &FootprintTable::first_corner); })
      .def_property_readonly(
          "first_occluder",
          [](const py::object& self) { return offsets(self, &FootprintTable::first_occluder); })
      .def_property_readonly("corners_m",
                             [](const py::object& self) {
                               return view_of<double>(self.cast<const NativeFootprints&>().table.corners_m,
                                                      self, 3);
                             })
      .def_property_readonly("occluders",
                             [](const py::object& self) {
                               return view_of<std::uint32_t>(
                                   self.cast<const NativeFootprints&>().table.occluders, self);
                             })
      .def_property_readonly("map_corners", &map_corners)
      .def_property_readonly("crs_wkt",
                             [](const NativeFootprints& self) {
                               const FootprintPlace place(self.survey->scene);
                               return place.is_map() ? place.crs_wkt() : std::string();
                             })
      .def_property_readonly("component_names", &component_names)
      .def_property_readonly("material_names", &material_names);
  module.def("footprints", &footprints);
}

}  // namespace tubefoot::python
