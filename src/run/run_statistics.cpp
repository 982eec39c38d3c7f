// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_statistics.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "engine/surface/surface_mesh.hpp"
#include "run/checkpoint/build_identity.hpp"
#include "run/fresnel_borders.hpp"
#include "run/fresnel_transition.hpp"
#include "run/refraction.hpp"
#include "run/run_steps.hpp"

// This file collects the entries of stats.json: scene, build, settings, counts, times, memory, and the
// properties of coarsening, relief and refraction.

namespace tubefoot {

namespace {

/// Returns the relative change of Lambert's law at 45 degrees: cos^2(45 deg - turn) = (1 + sin(2 turn))
/// cos^2(45 deg).
double change_at_45_deg(double turn_rad) { return std::sin(2 * std::min(turn_rad, std::numbers::pi / 4)); }

nlohmann::ordered_json coarsening_json(const SceneCoarsening& coarse) {
  return {{"tolerance", coarse.tolerance},
          {"facets_before", coarse.facets_before},
          {"facets", coarse.facets},
          {"largest_move",
           {{"of",
             "displacement of a point of the surface; bounds the distance between the two surfaces in either "
             "direction"},
            {"is", "a bound, except for rounding errors"},
            {"m", coarse.largest_move_m},
            {"of_resolution", coarse.largest_share},
            {"samples_of_range", coarse.largest_share}}},
          {"turn",
           {{"of", "change of the normal at a point of the surface; rms over the changed area"},
            {"is", "bounds, except for rounding errors"},
            {"largest_deg", glm::degrees(coarse.largest_turn_rad)},
            {"rms_deg", glm::degrees(coarse.rms_turn_rad)}}},
          {"change_of_energy",
           {{"of", "relative change of the energy of a point by Lambert's law at an incidence of 45 degrees"},
            {"is",
             "pointwise bounds from the changes of the normals; changes of neighbouring points cancel, so "
             "the energies of bins change less; measured, not certified"},
            {"largest", change_at_45_deg(coarse.largest_turn_rad)},
            {"rms", change_at_45_deg(coarse.rms_turn_rad)}}},
          {"seconds", coarse.seconds}};
}

/// Returns the transition at shadow borders by sensor, for sensors that see shadows.
nlohmann::ordered_json fresnel_json(const Survey& survey, const RunRequest& request) {
  const Transmissions transmissions(survey, request);
  nlohmann::ordered_json json;
  for (std::size_t s = 0; s < survey.sensors.size(); ++s)
    if (const auto transition = fresnel_transition(transmissions, s))
      json[survey.sensors[s].sensor->description().name] = {
          {"pings", transition->pings},
          {"shadow_borders_m", transition->length_m},
          {"width_m_percentile_5", transition->width_m[0]},
          {"width_m_median", transition->width_m[1]},
          {"width_m_percentile_95", transition->width_m[2]}};
  return json;
}

}  // namespace

nlohmann::ordered_json statistics_json(const Survey& survey, const RunRequest& request,
                                       const SimulationStats& stats) {
  const LoadedScene& loaded_scene = *survey.loaded_scene;
  const Scene& scene = loaded_scene.scene;
  nlohmann::ordered_json json;
  json["scene"] = scene.description.file.string();
  json["scene_hash"] = scene.description.sha256;
  json["version"] = TUBEFOOT_VERSION;
  json["build"] = build_identity();
  if (const std::string revision = build_revision(); !revision.empty()) json["build"]["revision"] = revision;
  json["engine"] = engine_name(request);
  if (!request.own_engine && request.engine == Engine::tube) {
    json["arithmetic"] = name_of(request.visibility.arithmetic);
    json["binning"] = name_of(request.binning);
  } else if (!request.own_engine) {
    json["sampling"] = name_of(request.rays.sampling);
    json[request.rays.per == RaySettings::Per::beam ? "rays_per_beam" : "rays_per_ping"] = request.rays.rays;
    json["seed"] = request.rays.seed;
  }
  if (const Selection& selection = request.selection; !selection.is_all()) {
    nlohmann::ordered_json& requested = json["selection"];
    if (selection.sensor) requested["sensor"] = *selection.sensor;
    if (selection.pings) requested["pings"] = *selection.pings;
    if (selection.beams) requested["beams"] = *selection.beams;
  }
  if (request.reference_tolerance) {
    const ReferenceStats& reference = stats.reference;
    json["reference"] = {{"tolerance", *request.reference_tolerance},
                         {"bins_over_tolerance", reference.bins_over},
                         {"worst_bound_over_asked", reference.worst_ratio},
                         {"worst_sensor", reference.worst_sensor},
                         {"worst_ping", reference.worst_ping},
                         {"worst_beam", reference.worst_beam},
                         {"worst_sample", reference.worst_sample}};
  }
  json["grid_unit_m"] = scene.grid.unit_m();
  if (loaded_scene.relief.cell_m > 0) {
    const RefinementDescription& keys = scene.description.refinement;
    nlohmann::ordered_json& relief = json["relief"];
    relief = {{"mode", keys.mode}, {"cell_m", loaded_scene.relief.cell_m}, {"displace", keys.displace}};
    if (loaded_scene.surface_mesh) relief["tolerance"] = loaded_scene.surface_mesh->settings().tolerance;
    relief["base_facets"] = loaded_scene.relief.base_facets;
    if (!loaded_scene.refines_tiles())
      relief["facets_made"] = loaded_scene.surface_mesh ? stats.refined_facets : scene.mesh.facets.size();
    if (!loaded_scene.is_tiled()) relief["uniform_facets"] = loaded_scene.relief.uniform_facets;
    relief["change_by_finer_relief"] = {
        {"of", "relative change of the energy of a facet; mean over the worst ping, weighted by energy"},
        {"is", "first-order estimates from the statistics of the omitted relief; not proven bounds"},
        {"rms", stats.finer_relief_rms},
        {"largest", stats.finer_relief_largest}};
  }
  if (scene.water->refracts())
    json["refraction"] = refraction_json(survey, request.reference_tolerance.has_value(), stats);
  if (loaded_scene.is_tiled()) {
    std::size_t facets = 0;
    for (const ComponentReport& component : scene.report.components) facets += component.facets;
    json["facets"] = facets;
    const TerrainUse& use = *loaded_scene.terrain_use;
    json["terrain_by_tiles"] = {{"regions", use.regions.load()},
                                {"loads", use.loads.load()},
                                {"most_held_mb", static_cast<double>(use.most_bytes) / 1e6}};
  } else {
    json["facets"] = scene.mesh.facets.size();
    if (loaded_scene.facets_given > 0) json["facets_before_planes_were_merged"] = loaded_scene.facets_given;
  }
  if (loaded_scene.coarsening) json["coarsening"] = coarsening_json(*loaded_scene.coarsening);
  json["pings"] = stats.pings;
  json["tubes"] = stats.tubes;
  json["candidates"] = stats.candidates;
  json["footprints"] = stats.footprints;
  json["pieces"] = stats.pieces;
  json["ray_hits"] = stats.hits;
  if (nlohmann::ordered_json transitions = fresnel_json(survey, request); !transitions.empty())
    json["fresnel_transition"] = std::move(transitions);
  for (const SensorPings& pings : survey.sensors)
    if (has_fresnel_borders(*pings.sensor))
      json["shadow_borders"][pings.sensor->description().name] = fresnel_statement;
  const PathsDescription& paths = scene.description.paths;
  if (stats.images + stats.arrivals > 0 || paths.order > 1 || paths.direct) {
    nlohmann::ordered_json orders;
    for (int order = paths.direct ? 0 : 1; order <= paths.order; ++order)
      orders[std::to_string(order)] = stats.energy_of_order[std::size_t(order)];
    json["paths"] = {{"order", paths.order},
                     {"images", stats.images},
                     {"arrivals", stats.arrivals},
                     {"energy_of_order", orders}};
  }
  return json;
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;  // Linux counts kibibytes
}

}  // namespace tubefoot
