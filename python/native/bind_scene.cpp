// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings of scenes: reads scene files and scene texts with meshes from arrays, loads them, and
// exposes facets, materials, pings and warnings.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>

#include "bindings.hpp"
#include "files/file_hash.hpp"
#include "run/no_return.hpp"
#include "run/placement.hpp"
#include "run/run_steps.hpp"
#include "scene.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace {

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Corners = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;

/// Returns the mesh of a component from arrays of shape (n, 3) and (m, 3); the Python package checks the
/// shapes.
std::shared_ptr<const ComponentMesh> component(const Points& vertices, const Corners& facets,
                                               const SourcePlace& place) {
  auto mesh = std::make_shared<ComponentMesh>();
  const auto v = vertices.unchecked<2>();
  mesh->points_m.reserve(std::size_t(v.shape(0)));
  for (py::ssize_t i = 0; i < v.shape(0); ++i) {
    mesh->points_m.emplace_back(v(i, 0), v(i, 1), v(i, 2));
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(v(i, k)))
        throw InputError(place, fmt::format("vertex {} has a coordinate that is not finite", i));
  }
  const auto f = facets.unchecked<2>();
  mesh->triangles.reserve(std::size_t(f.shape(0)));
  for (py::ssize_t i = 0; i < f.shape(0); ++i) {
    mesh->triangles.push_back({f(i, 0), f(i, 1), f(i, 2)});
    for (int k = 0; k < 3; ++k)
      if (f(i, k) >= v.shape(0))
        throw InputError(place, fmt::format("facet {} refers to vertex {}, but there are {} vertices", i,
                                            f(i, k), v.shape(0)));
  }
  drop_unused_points(*mesh);
  return mesh;
}

template <class T>
std::string_view bytes_of(const T& array) {
  return {reinterpret_cast<const char*>(array.data()), std::size_t(array.nbytes())};
}

std::shared_ptr<NativeScene> parse_scene(
    const std::string& text, const std::string& file,
    const std::vector<std::tuple<bool, std::size_t, Points, Corners>>& given) {
  SceneDescription description = read_scene_text(text, file);
  Sha256 hash;
  hash.update(description.sha256);
  for (const auto& [terrain, index, vertices, facets] : given) {
    const auto put = [&, &v = vertices, &f = facets](auto& described) {
      described.facets = component(v, f, described.place);
    };
    if (terrain)
      put(description.terrains.at(index));
    else
      put(description.objects.at(index));
    hash.update(bytes_of(vertices));
    hash.update(bytes_of(facets));
  }
  if (!given.empty()) description.sha256 = hash.hex_digest();
  return std::make_shared<NativeScene>(std::move(description));
}

template <class T>
std::vector<std::string> names_of(const std::vector<T>& described) {
  std::vector<std::string> names;
  for (const T& d : described) names.push_back(d.name);
  return names;
}

/// Returns the warnings of `tubefoot check`. The flag marks warnings about sensors without returns.
std::vector<std::pair<std::string, bool>> warnings_of(const Survey& survey) {
  std::vector<std::pair<std::string, bool>> all;
  const auto add = [&](const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) all.emplace_back(warning, false);
  };
  add(survey.scene.report.warnings);
  add(files_left_out(survey));
  for (const SeabedPlacement& placement : placements(survey))
    if (!placement.warning.empty()) add({placement.warning});
  add(vast_windows(survey));
  for (const NoReturn& no_return : expected_no_returns(survey, request_of(survey.scene.description.run)))
    all.emplace_back(no_return.warning, true);
  return all;
}

}  // namespace

std::shared_ptr<const Survey> NativeScene::survey() {
  const std::scoped_lock lock(mutex_);
  if (!survey_) survey_ = open_survey(description_);
  return survey_;
}

void bind_scene(py::module_& module) {
  py::class_<NativeScene, std::shared_ptr<NativeScene>>(module, "Scene")
      .def_property_readonly("title", [](const NativeScene& s) { return s.description().title; })
      .def_property_readonly("file", [](const NativeScene& s) { return s.description().file.string(); })
      .def_property_readonly("hash", [](const NativeScene& s) { return s.description().sha256; })
      .def_property_readonly("sensors",
                             [](const NativeScene& s) { return names_of(s.description().sensors); })
      .def_property_readonly("materials",
                             [](const NativeScene& s) { return names_of(s.description().materials); })
      .def_property_readonly("components",
                             [](const NativeScene& s) {
                               std::vector<std::string> names = names_of(s.description().terrains);
                               for (std::string& n : names_of(s.description().objects))
                                 names.push_back(std::move(n));
                               return names;
                             })
      .def("warnings",
           [](NativeScene& s) {
             const py::gil_scoped_release released;
             return warnings_of(*s.survey());
           })
      .def("pings",
           [](NativeScene& s, const std::string& sensor) {
             const py::gil_scoped_release released;
             const auto survey = s.survey();
             return survey->sensors[survey->sensor_set->sensor_named(sensor)].times_s.size();
           })
      .def("transmissions",
           [](NativeScene& s, const std::string& sensor) {
             const py::gil_scoped_release released;
             const auto survey = s.survey();
             return survey->sensors[survey->sensor_set->sensor_named(sensor)].sensor->transmissions();
           })
      .def("transmission",
           [](NativeScene& s, const std::string& sensor, std::size_t ping, std::size_t transmission) {
             const py::gil_scoped_release released;
             const auto survey = s.survey();
             return std::make_shared<NativeTransmission>(
                 *survey, request_of(s.description().run),
                 ReceivedTransmission{survey->sensor_set->sensor_named(sensor), ping, transmission});
           });
  module.def(
      "read_scene",
      [](const std::string& file, bool confined) {
        return std::make_shared<NativeScene>(read_scene_file(file, confined));
      },
      py::call_guard<py::gil_scoped_release>());
  module.def("parse_scene", &parse_scene);
}

}  // namespace tubefoot::python
