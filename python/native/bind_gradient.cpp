// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings of derivatives: the names of parameters, and the gradient of weighted sums of energies.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <optional>

#include "arrays.hpp"
#include "bindings.hpp"
#include "run/gradient_parameters.hpp"
#include "run/settings.hpp"
#include "run/weighted_gradient.hpp"
#include "run_apart.hpp"
#include "scene.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace {

using Weights = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::array vectors(const std::vector<glm::dvec3>& all) {
  py::array_t<double> array({py::ssize_t(all.size()), py::ssize_t(3)});
  double* to = array.mutable_data();
  for (const glm::dvec3& v : all)
    for (int k = 0; k < 3; ++k) *to++ = v[k];
  return array;
}

/// `weights`: by sensor; None for a sensor without weights.
py::dict gradient(const std::shared_ptr<NativeScene>& scene,
                  const std::vector<std::optional<Weights>>& weights, const std::optional<int>& threads,
                  const py::object& progress) {
  std::vector<std::span<const double>> values;
  for (const std::optional<Weights>& one : weights)
    values.push_back(one ? std::span<const double>(one->data(), std::size_t(one->size()))
                         : std::span<const double>());
  WeightedGradient sum;
  std::shared_ptr<const Survey> survey;
  RunWatch watch;
  run_apart(watch, progress, [&] {
    const ThreadLimit limit(threads.value_or(scene->description().run.threads));
    survey = scene->survey();
    sum = weighted_gradient(*survey, request_of(scene->description().run), values, &watch);
  });
  py::dict all;
  const Scene& loaded = survey->scene;
  std::vector<glm::dvec3> vertices;
  for (const GridPoint v : loaded.mesh.vertices) vertices.push_back(loaded.grid.to_metres(v));
  all["vertices_m"] = vectors(vertices);
  all["by_vertex"] = vectors(sum.by_vertex);
  std::vector<std::uint32_t> facets;
  for (const auto& facet : loaded.mesh.facets) facets.insert(facets.end(), facet.begin(), facet.end());
  all["facets"] = array_of(facets, 3);
  all["component"] = array_of(loaded.mesh.component);
  all["mu"] = array_of(sum.by_mu);
  all["scattering"] = sum.by_scattering;
  all["sound_speed"] = sum.by_sound_speed;
  all["absorption"] = sum.by_absorption;
  all["profile"] = sum.by_profile;
  py::list sonars, objects;
  for (const WeightedGradient::OfSonar& sonar : sum.sonars)
    sonars.append(py::make_tuple(vectors(sonar.by_position), vectors(sonar.by_rotation),
                                 vectors(sonar.by_mounting), vectors(sonar.by_patterns)));
  for (const WeightedGradient::OfObject& object : sum.objects)
    objects.append(
        py::make_tuple(vectors({object.by_position}), vectors({object.by_rotation}), object.moves_alone));
  all["sonars"] = sonars;
  all["objects"] = objects;
  return all;
}

}  // namespace

void bind_gradient(py::module_& module) {
  module.def("gradient", &gradient);
  module.def("gradient_parameters", [](const NativeScene& scene) {
    std::vector<std::tuple<std::string, std::string, std::string>> all;
    for (const GradientParameter& p : gradient_parameters(scene.description()))
      all.emplace_back(p.name, p.units, p.meaning);
    return all;
  });
}

}  // namespace tubefoot::python
