// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/abilities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/certified/reference.hpp"
#include "files/usage_error.hpp"
#include "run/paths.hpp"
#include "run/run_request.hpp"
#include "run/survey.hpp"

// This file contains the table of features that cannot be combined, and finds the first refusal that applies
// to a scene and a request (docs/abilities.md).

namespace tubefoot {
namespace {

using enum Feature;

constexpr std::array<std::string_view, features> names{"refraction",
                                                       "mirrors, further paths",
                                                       "receiver apart",
                                                       "two receivers",
                                                       "signals",
                                                       "tiles",
                                                       "relief",
                                                       "relief of each transmission",
                                                       "scattering law",
                                                       "micro-texture",
                                                       "unbounded texture",
                                                       "inclined mirrors",
                                                       "several scatterings",
                                                       "--reference",
                                                       "double arithmetic",
                                                       "fast binning",
                                                       "rays",
                                                       "an engine of one's own",
                                                       "--labels",
                                                       "--coarsen",
                                                       "audit",
                                                       "coverage",
                                                       "view",
                                                       "footprints",
                                                       "exact corners",
                                                       "refine",
                                                       "chart, advise, --tolerance",
                                                       "a transmission in Python"};

constexpr auto table = std::to_array<Refusal>({
    {inclined_mirrors,
     refraction,
     {},
     "an inclined mirror's image of layered water is not layered, and rays through it have no closed form: "
     "lay the facets level, leave out 'specular_loss_db', or give profile = \"constant\""},
    {refraction,
     mirrors,
     {two_receivers, reference},
     "a certified phase over mirrors needs straight rays: leave out --reference, or give profile = "
     "\"constant\""},
    {scatterings,
     reference,
     {},
     "patches that scatter on to others are taken for points, which no bound encloses: leave out "
     "--reference, or give scatterings = 1"},
    {unbounded_texture, reference, {}, "no reference encloses that"},
    {reference,
     double_arithmetic,
     {},
     "that takes an exact arithmetic: fixed, filtered or rational, not double"},
    {reference, fast_binning, {}, "that integrates footprints: it needs --binning exact"},
    {reference, rays, {}, "that measures footprints: it needs --engine tube"},
    {reference, own_engine, {}, "that measures footprints: it needs --engine tube"},
    {refraction,
     signals,
     {},
     "phases over rays that bend are not known: leave the array out, or give profile = \"constant\""},
    {scatterings,
     signals,
     {},
     "patches that scatter on to others keep no phase: leave the array out, or give scatterings = 1"},
    {signals,
     tiles,
     {},
     "signals are made of the whole ground at once, and tiles come by and by: leave the array out, or give "
     "load = \"whole\""},
    {signals, rays, {}, "signals come from visible polygons: leave the array out, or give --engine tube"},
    {signals,
     own_engine,
     {},
     "signals come from visible polygons, which such an engine does not tell: leave the "
     "array out, or ask a built-in engine"},
    {signals,
     coarsening,
     {},
     "phases tell apart far less than a sample of range or a beam, which facets are coarsened by: leave out "
     "--coarsen"},
    {labels,
     own_engine,
     {},
     "a sum of energies does not tell its parts, and such an engine gives no more than the sum: ask a "
     "built-in engine for the truth"},
    {refraction,
     coarsening,
     {},
     "rays that bend are traced facet by facet, as fine as these are: leave out --coarsen, or give profile = "
     "\"constant\""},
    {two_receivers,
     coarsening,
     {},
     "phases tell apart far less than a sample of range or a beam, which facets are coarsened by: leave out "
     "--coarsen"},
    {tiles,
     coarsening,
     {},
     "what is coarsened is coarsened whole, and tiles come by and by: leave out --coarsen, or give load = "
     "\"whole\""},
    {relief,
     coarsening,
     {},
     "facets that relief was refined into are those that its law asks for: leave out --coarsen, or make "
     "cell_m larger"},
    {scatterings,
     coarsening,
     {},
     "sound that scatters on comes from facets as from points: leave out --coarsen, or give scatterings = 1"},
    {reference, coarsening, {}, "that is of the facets as they are given: leave out --coarsen"},
    {fast_binning,
     coarsening,
     {},
     "that takes a footprint for its centroid, which larger facets are worse for: leave out --coarsen, or "
     "--binning"},
    {own_engine,
     coarsening,
     {},
     "such an engine is asked about the facets as they are given: leave out --coarsen"},
    {trial,
     coarsening,
     {},
     "settings are held against the facets as they are given: leave out --coarsen, or find the settings "
     "without it first"},
});

/// A feature of the scene, its place in the scene file, and the subject of a sentence about it.
struct Found {
  Feature feature;
  SourcePlace place;
  std::string subject;
};

std::vector<Found> found_in(const Survey& survey, std::optional<std::size_t> only) {
  const Scene& scene = survey.scene;
  const SceneDescription& d = scene.description;
  std::vector<Found> found;
  if (scene.water->refracts())
    found.push_back(
        {refraction, d.water.place, fmt::format("the water's profile = \"{}\" refracts", d.water.profile)});
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    if (only && *only != s) continue;
    const Sensor& sensor = *survey.sensors[s].sensor;
    const auto add = [&](Feature feature, const char* what) {
      found.push_back({feature, sensor.description().place,
                       fmt::format("sensor '{}' {}", sensor.description().name, what)});
    };
    if (path_settings(scene, sensor.frequency_khz()))
      add(mirrors, "has paths over mirrors or two scatterings");
    if (sensor.has_separate_receiver()) add(separate_receiver, "has its receiver apart");
    if (sensor.has_receiver_pair()) add(two_receivers, "has two receivers");
    if (sensor.signals() != nullptr) add(signals, "records signals");
  }
  if (const auto material = material_of_inclined_mirrors(scene))
    found.push_back(
        {inclined_mirrors, d.materials[*material].place,
         fmt::format("material '{}' mirrors where it is not level", d.materials[*material].name)});
  if (d.paths.scatterings > 1)
    found.push_back({scatterings, d.paths.place, "[paths] asks for several scatterings"});
  if (survey.loaded_scene->is_tiled())
    found.push_back({tiles, d.terrains.front().place, "terrain is read by tiles"});
  if (survey.loaded_scene->relief.cell_m > 0)
    found.push_back({relief, d.refinement.place, "[relief] refines facets"});
  if (survey.loaded_scene->surface_mesh)
    found.push_back(
        {relief_each_transmission, d.refinement.place, "[relief] is refined for each transmission"});
  const auto add_material = [&](Feature feature, const auto& list, const char* what) {
    const auto with = std::ranges::find_if(list, [](const auto& one) { return one != nullptr; });
    if (with == list.end()) return;
    const MaterialDescription& material = d.materials[static_cast<std::size_t>(with - list.begin())];
    found.push_back({feature, material.place, fmt::format("material '{}' has {}", material.name, what)});
  };
  add_material(scattering_model, scene.scattering, "a law other than Lambert's");
  add_material(micro_texture, scene.reflectivity, "a micro-texture");
  if (const auto material = material_without_enclosure(scene.reflectivity))
    found.push_back(
        {unbounded_texture, d.materials[*material].place,
         fmt::format("the micro-texture of material '{}' is one's own", d.materials[*material].name)});
  return found;
}

std::optional<Refused> refused(std::vector<Found> found, std::span<const Feature> requested) {
  const std::size_t of_scene = found.size();
  for (const Feature feature : requested)
    found.push_back({feature, {}, std::string(name_of(feature)) + " is asked for"});
  const auto find = [&](Feature feature) { return std::ranges::find(found, feature, &Found::feature); };
  for (const Refusal& refusal : table) {
    const auto first = find(refusal.first), second = find(refusal.second);
    if (first == found.end() || second == found.end() ||
        std::ranges::any_of(refusal.more, [&](const std::optional<Feature>& feature) {
          return feature && find(*feature) == found.end();
        }))
      continue;
    Refused answer{&refusal, first->place, fmt::format("{}, and {}", first->subject, refusal.reason),
                   static_cast<std::size_t>(first - found.begin()) >= of_scene};
    // A feature that the command requests has no place in the scene file.
    for (const Feature other :
         {refusal.more[0].value_or(refusal.second), refusal.more[1].value_or(refusal.second), refusal.second})
      if (!answer.requested && (other == reference || other >= own_engine)) {
        answer.requested = true;
        answer.what = fmt::format("{}: {}", name_of(other), answer.what);
      }
    return answer;
  }
  return std::nullopt;
}

void require(const std::optional<Refused>& refused) {
  if (!refused) return;
  if (refused->requested) throw UsageError(refused->what);
  throw InputError(refused->place, refused->what);
}

}  // namespace

std::string_view name_of(Feature feature) { return names.at(static_cast<std::size_t>(feature)); }

std::span<const Refusal> refusals() { return table; }

std::optional<Refused> refused(const Survey& survey, std::span<const Feature> requested,
                               std::optional<std::size_t> sensor) {
  return refused(found_in(survey, sensor), requested);
}

std::vector<Feature> requested_by(const RunRequest& request) {
  std::vector<Feature> requested;
  if (request.own_engine) {
    requested.push_back(own_engine);
  } else if (request.engine == Engine::ray) {
    requested.push_back(rays);
  } else {
    if (request.visibility.arithmetic == Arithmetic::plain_double) requested.push_back(double_arithmetic);
    if (request.binning != Binning::exact) requested.push_back(fast_binning);
  }
  if (request.reference_tolerance) requested.push_back(reference);
  if (request.labels) requested.push_back(labels);
  if (request.coarseness > 0) requested.push_back(coarsening);
  return requested;
}

void require_able_to_run(const Survey& survey, const RunRequest& request) {
  require(refused(survey, requested_by(request)));
}

void require_able(const Survey& survey, const RunRequest& request, Feature requested,
                  std::optional<std::size_t> sensor) {
  require(refused(survey, {&requested, 1}, sensor));
  require_able(request, requested);
}

void require_able(const RunRequest& request, Feature requested) {
  // Only tube features count here. Rays and binnings are features of runs.
  std::vector<Feature> all{requested};
  if (requested == reference)
    all = requested_by(request);
  else if (request.visibility.arithmetic == Arithmetic::plain_double)
    all.push_back(double_arithmetic);
  if (requested == trial && request.coarseness > 0) all.push_back(coarsening);
  require(refused(std::vector<Found>{}, all));
}

}  // namespace tubefoot
