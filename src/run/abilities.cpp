// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/abilities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/certified/reference.hpp"
#include "files/usage_error.hpp"
#include "run/fresnel_borders.hpp"
#include "run/paths.hpp"
#include "run/run_request.hpp"
#include "run/survey.hpp"

// This file contains the table of features that cannot be combined, and finds the first refusal that applies
// to a scene and a request (docs/limits.md).

namespace tubefoot {
namespace {

using enum Feature;

constexpr std::array<std::string_view, features> names{"refraction",
                                                       "mirror paths",
                                                       "separate receiver",
                                                       "motion within a ping",
                                                       "receiver pair",
                                                       "signals",
                                                       "tiles",
                                                       "relief",
                                                       "relief of each transmission",
                                                       "scattering model",
                                                       "micro-texture",
                                                       "unbounded texture",
                                                       "inclined mirrors",
                                                       "several scatterings",
                                                       "moving objects",
                                                       "volume scattering",
                                                       "targets in the water",
                                                       "Fresnel shadow borders",
                                                       "moving sea surface",
                                                       "--reference",
                                                       "double arithmetic",
                                                       "fast binning",
                                                       "rays",
                                                       "a custom engine",
                                                       "--labels",
                                                       "--coarsen",
                                                       "--gradient",
                                                       "audit",
                                                       "coverage",
                                                       "view",
                                                       "footprints",
                                                       "exact corners",
                                                       "refine",
                                                       "chart, advise, --tolerance",
                                                       "a transmission in Python"};

constexpr auto refusal_table = std::to_array<Refusal>({
    {inclined_mirrors,
     refraction,
     {},
     "refracted rays via an inclined mirror have no closed form: make the facets horizontal, leave out "
     "'specular_loss_db', or set profile = \"constant\""},
    {refraction,
     mirrors,
     {two_receivers, reference},
     "certified phases of paths via mirrors need straight rays: leave out --reference, or set profile = "
     "\"constant\""},
    {scatterings,
     reference,
     {},
     "in the second scattering, tubefoot treats patches as points, for which there is no certified bound: "
     "leave out --reference, or set scatterings = 1"},
    {unbounded_texture, reference, {}, "there is no certified bound for this combination"},
    {reference,
     double_arithmetic,
     {},
     "certified bounds need exact arithmetic: use fixed, filtered or rational, not double"},
    {reference, fast_binning, {}, "certified bounds need footprints: use --binning exact"},
    {reference, rays, {}, "this output needs footprints: use --engine tube"},
    {reference, own_engine, {}, "this output needs footprints: use --engine tube"},
    {motion, two_receivers, {}, "receiver pairs have one pose per ping: set stop_and_hop = true"},
    {motion,
     gradient,
     {},
     "derivatives need one pose of the receiver per ping: leave out --gradient, or set stop_and_hop = true"},
    {motion,
     own_engine,
     {},
     "a custom engine computes all range bins of a ping at once: use a built-in engine, or set stop_and_hop "
     "= "
     "true"},
    {refraction,
     water_targets,
     {reference},
     "bounds of the echoes of targets need straight rays: leave out --reference, or set profile = "
     "\"constant\""},
    {refraction,
     water_targets,
     {two_receivers},
     "phase differences of targets need straight rays: use one receiver, or set profile = \"constant\""},
    {refraction,
     signals,
     {},
     "signals along refracted rays are not supported: leave out the array, or set profile = \"constant\""},
    {scatterings,
     signals,
     {},
     "echoes of a second scattering have no phase: leave out the array, or set scatterings = 1"},
    {signals,
     tiles,
     {},
     "signals need the whole terrain in memory, but tiles are loaded one by one: leave out the array, or set "
     "load = \"whole\""},
    {signals, rays, {}, "signals need visible polygons: leave out the array, or use --engine tube"},
    {signals,
     own_engine,
     {},
     "signals need visible polygons, which a custom engine does not provide: leave out the array, or use a "
     "built-in engine"},
    {signals,
     coarsening,
     {},
     "phases depend on lengths much smaller than a range bin or the width of a beam, to which --coarsen "
     "adapts the facets: leave out --coarsen"},
    {labels,
     own_engine,
     {},
     "labels need the energy from each object, but a custom engine returns only the total energy: use a "
     "built-in engine"},
    {water_targets,
     labels,
     {},
     "labels refer to objects and materials, but targets have neither: leave out --labels, or the targets"},
    {water_targets,
     gradient,
     {},
     "echoes of targets have no derivatives: leave out --gradient, or the targets"},
    {refraction,
     coarsening,
     {},
     "tubefoot already adapts the facets to the refraction: leave out --coarsen, or set profile = "
     "\"constant\""},
    {two_receivers,
     coarsening,
     {},
     "phases depend on lengths much smaller than a range bin or the width of a beam, to which --coarsen "
     "adapts the facets: leave out --coarsen"},
    {tiles,
     coarsening,
     {},
     "--coarsen needs the whole terrain in memory, but tiles are loaded one by one: leave out --coarsen, or "
     "set load = \"whole\""},
    {relief,
     coarsening,
     {},
     "--coarsen cannot merge facets that relief has refined: leave out --coarsen, or increase 'cell_m'"},
    {scatterings,
     coarsening,
     {},
     "in the second scattering, tubefoot treats facets as points: leave out --coarsen, or set scatterings = "
     "1"},
    {moving_objects,
     coarsening,
     {},
     "--coarsen cannot merge facets that move with facets at rest: leave out --coarsen, or 'trajectory' of "
     "the object"},
    {moving_objects,
     gradient,
     {},
     "derivatives refer to vertices at rest: leave out --gradient, or 'trajectory' of the object"},
    {moving_objects,
     refine,
     {},
     "a file of refined facets contains facets at rest: leave out 'trajectory' of the object"},
    {volume,
     refraction,
     {reference},
     "certified volume reverberation needs straight rays: leave out --reference, or set profile = "
     "\"constant\""},
    {volume,
     separate_receiver,
     {reference},
     "certified volume reverberation needs a receiver at the transmitter: leave out --reference, or "
     "'receiver_arm_m'"},
    {volume,
     motion,
     {reference},
     "certified volume reverberation needs one pose per ping: leave out --reference, or set stop_and_hop = "
     "true"},
    {volume,
     refraction,
     {separate_receiver},
     "volume reverberation with a separate receiver needs straight rays: leave out 'receiver_arm_m', or set "
     "profile = \"constant\""},
    {volume,
     refraction,
     {motion},
     "volume reverberation with motion within a ping needs straight rays: set stop_and_hop = true, or "
     "profile "
     "= \"constant\""},
    {volume,
     two_receivers,
     {},
     "volume reverberation needs one receiver: use one receiver, or leave out the volume scattering"},
    {volume, signals, {}, "volume reverberation has no phase: leave out the array, or the volume scattering"},
    {volume,
     labels,
     {},
     "labels refer to objects and materials, but the water has neither: leave out --labels, or the volume "
     "scattering"},
    {volume,
     gradient,
     {},
     "volume reverberation has no derivatives: leave out --gradient, or the volume scattering"},
    {volume,
     own_engine,
     {},
     "a custom engine computes all energies itself: use a built-in engine, or leave out the volume "
     "scattering"},
    {sea_waves,
     scatterings,
     {},
     "in the second scattering, tubefoot treats the sea surface as a plane: set scatterings = 1, or "
     "remove 'size_m' of [sea_surface]"},
    {sea_waves,
     coarsening,
     {},
     "--coarsen cannot merge facets that move with facets at rest: leave out --coarsen, or 'size_m' of "
     "[sea_surface]"},
    {sea_waves,
     gradient,
     {},
     "derivatives refer to vertices at rest: leave out --gradient, or 'size_m' of [sea_surface]"},
    {sea_waves,
     refine,
     {},
     "a file of refined facets contains facets at rest: leave out 'size_m' of [sea_surface]"},
    {reference, coarsening, {}, "this output refers to the facets of the scene: leave out --coarsen"},
    {fast_binning,
     coarsening,
     {},
     "--binning centroid and spread are less accurate with merged facets: leave out --coarsen, or --binning"},
    {own_engine,
     coarsening,
     {},
     "a custom engine computes with the facets of the scene: leave out --coarsen"},
    {trial,
     coarsening,
     {},
     "settings are tested on the facets of the scene: leave out --coarsen, or find the settings without it "
     "first"},
    {refraction,
     gradient,
     {reference},
     "certified derivatives need straight rays: leave out --reference, or set profile = \"constant\""},
    {refraction,
     mirrors,
     {gradient},
     "derivatives of paths via mirrors need straight rays: leave out --gradient, or set profile = "
     "\"constant\""},
    {refraction,
     separate_receiver,
     {gradient},
     "derivatives with a separate receiver need straight rays: leave out --gradient, or set profile = "
     "\"constant\""},
    {mirrors,
     gradient,
     {reference},
     "paths over mirrors have no certified derivatives: leave out --reference, or the mirrors and [paths]"},
    {scatterings,
     gradient,
     {},
     "in the second scattering, tubefoot treats patches as points, which have no derivatives: leave out "
     "--gradient, or set scatterings = 1"},
    {separate_receiver,
     gradient,
     {reference},
     "certified derivatives need a receiver at the transmitter: leave out --reference, or 'receiver_arm_m'"},
    {two_receivers, gradient, {}, "derivatives need one receiver: leave out --gradient, or use one receiver"},
    {scattering_model,
     gradient,
     {reference},
     "certified derivatives need Lambert's law: leave out --reference, or set law = \"lambert\""},
    {micro_texture,
     gradient,
     {reference},
     "certified derivatives need uniform materials: leave out --reference, or the micro-texture"},
    {unbounded_texture,
     gradient,
     {},
     "the custom micro-texture has no derivatives: leave out --gradient, or use a map or noise"},
    {relief_each_transmission,
     gradient,
     {},
     "these facets change with the position of the sonar: leave out --gradient, or set mode = \"offline\""},
    {gradient,
     double_arithmetic,
     {},
     "derivatives need the exact names of corners: use fixed, filtered or rational, not double"},
    {gradient,
     fast_binning,
     {},
     "derivatives need exact cuts at the borders of range bins: use --binning exact"},
    {gradient, rays, {}, "samples of rays have no derivatives: use --engine tube"},
    {gradient,
     own_engine,
     {},
     "derivatives need visible polygons, which a custom engine does not provide: use a built-in engine"},
    {gradient,
     trial,
     {},
     "the selected settings may have no derivatives: leave out --tolerance, or --gradient"},
    {refraction,
     fresnel_borders,
     {},
     "diffraction at shadow borders needs straight rays: set shadow = \"sharp\", or profile = "
     "\"constant\""},
    {mirrors,
     fresnel_borders,
     {},
     "diffraction at shadow borders is limited to the direct path: set shadow = \"sharp\", or leave out "
     "the mirrors and [paths]"},
    {two_receivers,
     fresnel_borders,
     {},
     "diffraction at shadow borders needs one receiver: set shadow = \"sharp\", or use one receiver"},
    {signals,
     fresnel_borders,
     {},
     "diffraction at shadow borders has no phase: set shadow = \"sharp\", or leave out the array"},
    {tiles,
     fresnel_borders,
     {},
     "diffraction at shadow borders needs the whole terrain in memory: set shadow = \"sharp\", or load = "
     "\"whole\""},
    {fresnel_borders,
     reference,
     {},
     "diffraction at shadow borders has no certified bound: set shadow = \"sharp\", or leave out "
     "--reference"},
    {fresnel_borders,
     double_arithmetic,
     {},
     "diffraction at shadow borders needs the exact names of corners: use fixed, filtered or rational, "
     "not double"},
    {fresnel_borders,
     fast_binning,
     {},
     "diffraction at shadow borders needs exact cuts at the borders of range bins: use --binning exact"},
    {fresnel_borders,
     rays,
     {},
     "diffraction at shadow borders needs the edges of visible polygons: set shadow = \"sharp\", or use "
     "--engine tube"},
    {fresnel_borders,
     own_engine,
     {},
     "diffraction at shadow borders needs the edges of visible polygons: set shadow = \"sharp\", or use "
     "a built-in engine"},
    {fresnel_borders,
     gradient,
     {},
     "energies with diffraction at shadow borders have no derivatives: set shadow = \"sharp\", or leave "
     "out --gradient"},
    {fresnel_borders,
     coarsening,
     {},
     "merged facets displace silhouette edges by more than the width of the diffraction: leave out "
     "--coarsen, or set shadow = \"sharp\""},
    {fresnel_borders, view, {}, "the page shows energies with geometric shadows: set shadow = \"sharp\""},
    {fresnel_borders,
     footprints,
     {},
     "the file contains energies with geometric shadows: set shadow = \"sharp\""},
    {fresnel_borders,
     exact_corners,
     {},
     "the file contains energies with geometric shadows: set shadow = \"sharp\""},
    {fresnel_borders,
     transmission,
     {},
     "a transmission in Python has geometric shadows: set shadow = \"sharp\""},
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
    found.push_back({refraction, d.water.place,
                     fmt::format("the water refracts sound (profile = \"{}\")", d.water.profile)});
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    if (only && *only != s) continue;
    const Sensor& sensor = *survey.sensors[s].sensor;
    const auto add = [&](Feature feature, const char* what) {
      found.push_back({feature, sensor.description().place,
                       fmt::format("sensor '{}' {}", sensor.description().name, what)});
    };
    if (path_settings(scene, sensor.frequency_khz()))
      add(mirrors, "has paths via mirrors or with second scattering");
    if (sensor.has_separate_receiver()) add(separate_receiver, "has a separate receiver");
    if (sensor.receiver_moves()) add(motion, "moves within a ping (stop_and_hop = false)");
    if (sensor.has_receiver_pair()) add(two_receivers, "has two receivers");
    if (sensor.signals() != nullptr) add(signals, "records signals");
    if (has_fresnel_borders(sensor))
      add(fresnel_borders, "has Fresnel shadow borders (shadow = \"fresnel\")");
  }
  if (const auto material = material_of_inclined_mirrors(scene))
    found.push_back({inclined_mirrors, d.materials[*material].place,
                     fmt::format("material '{}' is a mirror on facets that are not horizontal",
                                 d.materials[*material].name)});
  if (d.paths.scatterings > 1)
    found.push_back({scatterings, d.paths.place, "[paths] has several scatterings"});
  if (moving_sea_surface_of(scene) != nullptr)
    found.push_back({sea_waves, d.sea_surface->place, "the sea surface has facets that move as waves"});
  if (!scene.moving.empty() && !scene.moving.front().waves) {
    const ObjectDescription& object = d.objects[scene.moving.front().component - d.terrains.size()];
    found.push_back({moving_objects, object.trajectory_place, fmt::format("object '{}' moves", object.name)});
  }
  if (scene.volume.any()) found.push_back({volume, d.water.place, "the water scatters"});
  if (survey.loaded_scene->is_tiled())
    found.push_back({tiles, d.terrains.front().place, "the terrain is loaded in tiles"});
  if (survey.loaded_scene->relief.cell_m > 0)
    found.push_back({relief, d.refinement.place, "[relief] refines facets"});
  if (survey.loaded_scene->surface_mesh)
    found.push_back(
        {relief_each_transmission, d.refinement.place, "[relief] is refined for each transmission"});
  if (!d.targets.empty())
    found.push_back({water_targets, d.targets.front().place,
                     fmt::format("target '{}' is in the water", d.targets.front().name)});
  else if (!d.target_populations.empty())
    found.push_back({water_targets, d.target_populations.front().place,
                     fmt::format("population '{}' is in the water", d.target_populations.front().name)});
  const auto add_material = [&](Feature feature, const auto& list, const char* what) {
    const auto with = std::ranges::find_if(list, [](const auto& one) { return one != nullptr; });
    if (with == list.end()) return;
    const MaterialDescription& material = d.materials[static_cast<std::size_t>(with - list.begin())];
    found.push_back({feature, material.place, fmt::format("material '{}' has {}", material.name, what)});
  };
  add_material(scattering_model, scene.scattering, "a scattering model other than Lambert's law");
  add_material(micro_texture, scene.reflectivity, "a micro-texture");
  if (const auto material = material_without_enclosure(scene.reflectivity))
    found.push_back({unbounded_texture, d.materials[*material].place,
                     fmt::format("material '{}' has a custom micro-texture", d.materials[*material].name)});
  return found;
}

std::optional<Refused> refused(std::vector<Found> found, std::span<const Feature> requested) {
  const std::size_t of_scene = found.size();
  for (const Feature feature : requested)
    found.push_back({feature, {}, std::string(name_of(feature)) + " is requested"});
  const auto find = [&](Feature feature) { return std::ranges::find(found, feature, &Found::feature); };
  for (const Refusal& refusal : refusal_table) {
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

std::span<const Refusal> refusals() { return refusal_table; }

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
  if (!request.gradient.empty()) requested.push_back(gradient);
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
  if (requested == reference || requested == gradient)
    all = requested_by(request);
  else if (request.visibility.arithmetic == Arithmetic::plain_double)
    all.push_back(double_arithmetic);
  if (requested == trial && request.coarseness > 0) all.push_back(coarsening);
  if (requested == trial && !request.gradient.empty()) all.push_back(gradient);
  require(refused(std::vector<Found>{}, all));
}

}  // namespace tubefoot
