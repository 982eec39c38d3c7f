// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings of coverage: computes the coverage of the facets by the chosen pings. Exposes it as
// columns, one row per facet, and as a picture.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "files/usage_error.hpp"
#include "footprints/coverage_output.hpp"
#include "footprints/survey_coverage.hpp"
#include "picture.hpp"
#include "run/abilities.hpp"
#include "run/facet_numbering.hpp"
#include "run/settings.hpp"
#include "run_apart.hpp"
#include "scene.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace {

/// Coverage of the facets of a scene by some pings.
struct NativeCoverage {
  std::shared_ptr<const Survey> survey;
  std::string title;
  std::vector<CountedPing> pings;
  CoverageTotals totals;
  std::optional<CoveragePicture> picture;
  // One row per facet that a ping sees.
  std::vector<std::uint32_t> facet, most_pings;
  std::vector<std::uint16_t> component, material;
  std::array<std::vector<double>, facet_reals.size()> reals;
  // One row per facet and number of pings.
  std::vector<std::uint32_t> depth_facet, depth_pings;
  std::vector<double> depth_share;

  void add(const CoveredFacet& f) {
    const FacetCoverage& c = f.coverage;
    const auto row = reals_of(f);
    totals.add(f);
    picture->add(f);
    facet.push_back(c.facet);
    component.push_back(f.component);
    material.push_back(f.material);
    most_pings.push_back(std::uint32_t(c.seen.pings));
    for (std::size_t k = 0; k < reals.size(); ++k) reals[k].push_back(row[k]);
    for (const AreaShare& part : c.by_pings) {
      depth_facet.push_back(c.facet);
      depth_pings.push_back(std::uint32_t(part.pings));
      depth_share.push_back(part.share);
    }
  }
};

struct Requested {
  std::optional<std::string> sensor;
  std::string pings, output;
};

std::shared_ptr<NativeCoverage> compute(NativeScene& scene, const Requested& requested) {
  auto coverage = std::make_shared<NativeCoverage>();
  std::optional<CoverageOutput> output;
  if (!requested.output.empty())
    output.emplace(requested.output, std::nullopt, inputs_of(scene.description()));
  coverage->survey = scene.survey();
  const Survey& survey = *coverage->survey;
  const ThreadLimit limit(scene.description().run.threads);
  const RunRequest request = request_of(scene.description().run);
  require_able(
      survey, request, Feature::coverage,
      requested.sensor ? std::optional(survey.sensor_set->sensor_named(*requested.sensor)) : std::nullopt);
  const std::vector<ReceivedPing> pings = counted_pings(survey, requested.sensor, requested.pings);
  coverage->pings = names_of(survey, pings);
  coverage->title = coverage_title(survey, requested.sensor, pings.size());
  coverage->picture.emplace(survey);
  if (output) output->begin(survey, coverage->pings);
  cover(survey, request, pings, true, [&](const CoveredFacet& facet) {
    coverage->add(facet);
    if (output) output->add(facet);
  });
  if (output) output->finish(coverage->title);
  return coverage;
}

std::shared_ptr<NativeCoverage> coverage_of(NativeScene& scene, const std::optional<std::string>& sensor,
                                            const std::string& pings, const std::string& output) {
  std::shared_ptr<NativeCoverage> coverage;
  RunWatch watch;
  run_apart(watch, py::none(), [&] { coverage = compute(scene, {sensor, pings, output}); });
  return coverage;
}

template <class T>
py::object column(const py::object& self, std::vector<T> NativeCoverage::*member) {
  return view_of<T>(self.cast<const NativeCoverage&>().*member, self);
}

py::dict columns(const py::object& self) {
  py::dict all;
  all["facet"] = column(self, &NativeCoverage::facet);
  all["component_index"] = column(self, &NativeCoverage::component);
  all["material_index"] = column(self, &NativeCoverage::material);
  all["most_pings"] = column(self, &NativeCoverage::most_pings);
  for (std::size_t k = 0; k < facet_reals.size(); ++k)
    all[facet_reals[k]] = view_of<double>(self.cast<const NativeCoverage&>().reals[k], self);
  return all;
}

py::dict depths(const py::object& self) {
  py::dict all;
  all["facet"] = column(self, &NativeCoverage::depth_facet);
  all["pings"] = column(self, &NativeCoverage::depth_pings);
  all["share"] = column(self, &NativeCoverage::depth_share);
  return all;
}

std::vector<std::string> components(const NativeCoverage& self) {
  std::vector<std::string> names;
  for (const ComponentReport& c : self.survey->scene.report.components) names.push_back(c.name);
  return names;
}

std::vector<std::string> materials(const NativeCoverage& self) {
  std::vector<std::string> names;
  for (const MaterialDescription& m : self.survey->scene.description.materials) names.push_back(m.name);
  return names;
}

std::shared_ptr<NativePicture> picture(const NativeCoverage& self) {
  if (self.picture->empty())
    throw UsageError("no facet lies in the sector of a ping, so there is nothing to draw");
  std::shared_ptr<NativePicture> made;
  RunWatch watch;
  run_apart(watch, py::none(), [&] {
    made = std::make_shared<NativePicture>(
        NativePicture{self.picture->draw(self.title), "tubefoot: " + self.title});
  });
  return made;
}

}  // namespace

void bind_coverage(py::module_& module) {
  py::class_<NativeCoverage, std::shared_ptr<NativeCoverage>>(module, "Coverage")
      .def_readonly("title", &NativeCoverage::title)
      .def_property_readonly("pings",
                             [](const NativeCoverage& self) {
                               std::vector<std::pair<std::string, std::size_t>> pings;
                               for (const CountedPing& p : self.pings) pings.emplace_back(p.sensor, p.ping);
                               return pings;
                             })
      .def_property_readonly("facets_of_scene",
                             [](const NativeCoverage& self) {
                               const LoadedScene& loaded_scene = *self.survey->loaded_scene;
                               return loaded_scene.is_tiled() ? loaded_scene.numbering().facets()
                                                              : loaded_scene.scene.mesh.facets.size();
                             })
      .def_property_readonly("by_pings", [](const NativeCoverage& self) { return self.totals.by_pings; })
      .def_property_readonly("component_names", &components)
      .def_property_readonly("material_names", &materials)
      .def("columns", &columns)
      .def("depths", &depths)
      .def("picture", &picture);
  module.def("coverage", &coverage_of);
}

}  // namespace tubefoot::python
