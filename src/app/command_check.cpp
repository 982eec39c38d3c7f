// SPDX-License-Identifier: GPL-3.0-or-later
// The command `check`. It loads everything that a scene names and prints its frame, facets, materials,
// placement of objects, sensors and tracks. It measures the cost of a few pings and extrapolates the cost
// of a run.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "app/commands.hpp"
#include "files/atomic_output.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "plan/scene_drawing.hpp"
#include "run/abilities.hpp"
#include "run/console/amounts.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "run/fresnel_borders.hpp"
#include "run/fresnel_transition.hpp"
#include "run/no_return.hpp"
#include "run/placement.hpp"
#include "run/recorded_navigation.hpp"
#include "run/run_request.hpp"
#include "run/run_steps.hpp"
#include "run/settings.hpp"
#include "run/signals.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "run/tiles_in_view.hpp"
#include "run/transmission.hpp"
#include "run/transmission_ends.hpp"

namespace tubefoot {
namespace {

/// Formats a length in micrometres, millimetres or metres, whichever is readable.
std::string length_text(double metres) {
  if (metres == 0) return "0 m";
  if (metres < 1e-3) return fmt::format("{:.3g} um", metres * 1e6);
  if (metres < 1) return fmt::format("{:.3g} mm", metres * 1e3);
  return fmt::format("{:.3g} m", metres);
}

void print_components(const Scene& scene) {
  tell("{:<24} {:>10} {:>10} {:>10}  extent east, north, up (m)\n", "component", "in file", "facets",
       "hole cells");
  for (const ComponentReport& c : scene.report.components)
    tell("{:<24} {:>10} {:>10} {:>10}  {:.2f}..{:.2f}, {:.2f}..{:.2f}, {:.2f}..{:.2f}\n", c.name,
         c.facets_in_file, c.facets, c.hole_cells, c.lo_m.x, c.hi_m.x, c.lo_m.y, c.hi_m.y, c.lo_m.z,
         c.hi_m.z);
}

/// Prints the position of the frame on Earth.
void print_frame(const Scene& scene) {
  if (!scene.frame.is_georeferenced()) {
    tell("frame          local, in metres, without a position on Earth\n");
    return;
  }
  glm::dvec3 origin(0);
  scene.frame.to_lon_lat({&origin, 1}, {scene.description.file.string(), 0, 0});
  tell("frame          origin at latitude {:.6f}, longitude {:.6f}\n", origin.y, origin.x);
}

/// Prints the placement of each object relative to the seabed.
void print_standings(const std::vector<SeabedPlacement>& placements) {
  constexpr std::size_t most_listed = 50;
  if (!placements.empty()) tell("\n{:<24} placement relative to the seabed\n", "object");
  for (std::size_t i = 0; i < std::min(placements.size(), most_listed); ++i)
    tell("{:<24} {}\n", shown_line(placements[i].object), placements[i].words);
  if (placements.size() > most_listed) tell("and {} more objects\n", placements.size() - most_listed);
}

/// Prints the first and the last position and time of a sensor.
void print_places(const Scene& scene, const SensorPings& pings, const Trajectory& trajectory) {
  const auto place = [&](std::size_t ping) {
    const glm::dvec3 at_m = pings.poses[ping].position_m;
    const double altitude_m = pings.altitudes_m.empty() ? std::nan("") : pings.altitudes_m[ping];
    return fmt::format("east {:.2f}, north {:.2f}, up {:.2f} m{}", at_m.x, at_m.y, at_m.z,
                       scene.description.terrains.empty() ? std::string()
                       : std::isnan(altitude_m)           ? std::string(" (no terrain below)")
                                                : fmt::format(" ({:.4g} m above the seabed)", altitude_m));
  };
  const std::size_t last = pings.times_s.size() - 1;
  tell("               {}{}\n", place(0), last > 0 ? fmt::format(", to {}", place(last)) : std::string());
  if (!trajectory.is_fixed())
    tell("               from {:.9g} to {:.9g} s of a trajectory from {:.9g} to {:.9g} s\n",
         pings.times_s.front(), pings.times_s.back(), trajectory.begin_s(), trajectory.end_s());
}

/// Prints the chord errors of spheres, cylinders and cones.
void print_fineness(const Scene& scene) {
  for (const ComponentReport& c : scene.report.components)
    if (c.fineness.chord_error_m > 0)
      tell("{}: the facets have the area of the curved surface and are within {} of it ({})\n", c.name,
           length_text(c.fineness.chord_error_m), c.fineness.from);
}

/// Prints the materials of the seabed and of the objects. Areas are surface areas of the facets, not areas
/// of their projection onto a horizontal plane.
void print_materials(const Scene& scene) {
  std::vector<std::size_t> facets(scene.description.materials.size());
  std::vector<double> area_m2(facets.size());
  bool mapped = false;  // a map assigns materials to terrain of which only some tiles are in memory
  for (FacetId f = 0; f < scene.mesh.facets.size(); ++f) {
    const auto& [a, b, c] = scene.mesh.facets[f];
    const glm::dvec3 p = scene.grid.to_metres(scene.mesh.vertices[a]),
                     u = scene.grid.to_metres(scene.mesh.vertices[b]) - p,
                     v = scene.grid.to_metres(scene.mesh.vertices[c]) - p;
    ++facets[scene.mesh.material[f]];
    area_m2[scene.mesh.material[f]] += glm::length(glm::cross(u, v)) / 2;
  }
  for (std::size_t i = 0; i < scene.tiled.size(); ++i) {
    if (!scene.tiled[i].tiles) continue;
    if (scene.tiled[i].map) mapped = true;
    facets[scene.tiled[i].material] += scene.report.components[i].facets;
    area_m2[scene.tiled[i].material] = std::numeric_limits<double>::quiet_NaN();
  }
  tell("\n{:<24} {:>10} {:>14}\n", "material", "facets", "area (m2)");
  for (std::size_t m = 0; m < facets.size(); ++m)
    tell("{:<24} {:>10} {:>14}\n", scene.description.materials[m].name,
         mapped ? "-" : std::to_string(facets[m]),
         mapped || std::isnan(area_m2[m]) ? "-" : fmt::format("{:.6g}", area_m2[m]));
  for (const ComponentReport& c : scene.report.components)
    if (c.cut_facets > 0)
      tell("{}: {} facets are cut along the borders of its material map\n", c.name, c.cut_facets);
}

/// Prints the names by which facets of mesh files are selected, and the material of each name.
void print_mesh_names(const Scene& scene) {
  constexpr std::size_t most_listed = 50;
  for (const ComponentReport& c : scene.report.components) {
    if (c.names.empty()) continue;
    tell("\n{:<40} {:>10}  material\n", shown_line("names in " + c.name), "facets");
    for (std::size_t i = 0; i < std::min(c.names.size(), most_listed); ++i)
      tell("{:<40} {:>10}  {}\n", c.names[i].name.empty() ? "(none)" : shown_line(c.names[i].name),
           c.names[i].facets, c.names[i].material);
    if (c.names.size() > most_listed) tell("and {} more\n", c.names.size() - most_listed);
  }
}

/// Prints the tiles of a scene that keeps only some of its facets in memory.
void print_tiles(const Scene& scene) {
  std::size_t facets = 0;
  for (const ComponentReport& c : scene.report.components) facets += c.facets;
  tell("\nfacets         {}; those of", facets);
  const char* comma = "";
  for (std::size_t i = 0; i < scene.tiled.size(); ++i) {
    if (!scene.tiled[i].tiles) continue;
    const TerrainTiles& tiles = *scene.tiled[i].tiles;
    tell("{} '{}' in {} x {} tiles of {} x {} cells", comma, scene.report.components[i].name, tiles.columns(),
         tiles.rows(), TerrainTiles::cells_a_side, TerrainTiles::cells_a_side);
    comma = ",";
  }
  tell(", loaded where pings need them (area not measured)\n");
}

/// Sums over the probed pings.
struct Probe {
  std::size_t pings = 0, candidates = 0, footprints = 0;
  double seconds = 0, largest_travel_path_error_m = 0;
};

/// Computes visible polygons and echoes of the transmissions of one ping, and adds their cost to `sum`.
void probe(const Transmissions& transmissions, const SharedTransmissions& group, std::size_t ping,
           Probe& sum) {
  const Transmissions around(survey_around(transmissions, group, ping), transmissions.request());
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t number = 0; number < transmissions.survey().sensor_set->transmissions_per_ping(group);
       ++number) {
    const Transmission transmission = around.of(group, ping, number);
    if (const ApparentSurface* apparent = transmission.surface_mesh().apparent())
      sum.largest_travel_path_error_m =
          std::max(sum.largest_travel_path_error_m, apparent->largest_travel_path_error_m);
    const History history = transmission.trace(&sum.candidates);
    sum.footprints += history.footprints.footprints.size();
    for (const std::size_t s : group.sensors) {
      const SensorModel model = transmission.model(s);
      for (std::uint32_t fan = 0; fan < model.patterns.baselines.size(); ++fan)
        transmission.echo(transmission.trace_receiver_pair(s, fan, model.patterns.baselines[fan]), s, fan,
                          model);
      if (transmission.has_separate_receiver()) {
        const TransmissionEnds ends(transmission, s);
        transmission.echo(ends.seen().together.history, s, ends.model(s)->model);
      } else if (!transmission.sensor(s).has_receiver_pair()) {
        transmission.echo(history, s, model.model);
      }
      if (transmission.sensor(s).signals() != nullptr) signals_received(transmission, s, history);
    }
  }
  sum.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ++sum.pings;
}

/// Measures the cost of a few pings of each group of sensors, spread over the track, and extrapolates it.
void print_cost(const Survey& survey, RunRequest request, int threads, bool quiet) {
  const Scene& scene = survey.scene;
  request.binning = Binning::exact;
  const Transmissions transmissions(survey, request);
  const WritingCost writing = expected_writing(survey, request, {});
  double seconds = 0, largest_travel_path_error_m = 0;
  std::string told;  // messages to print once the progress bar is finished
  auto measuring = std::make_optional<Progress>("measuring", quiet);
  for (const SharedTransmissions& group : survey.transmissions) {
    const std::size_t pings = survey.sensor_set->pings(group), probes = std::min<std::size_t>(pings, 3);
    Probe sum;
    constexpr double enough_s = 5;  // a single ping of this duration suffices for the extrapolation
    for (std::size_t k = 0; k < probes && sum.seconds < enough_s; ++k)
      probe(transmissions, group, (2 * k + 1) * pings / (2 * probes), sum);
    const double per_ping = sum.seconds / static_cast<double>(sum.pings);
    std::string names;
    for (const std::size_t s : group.sensors)
      names += (names.empty() ? "" : ", ") + survey.sensors[s].sensor->description().name;
    told += fmt::format("  {}: about {} candidate facets and {} footprints per ping, {:.3g} ms\n", names,
                        sum.candidates / sum.pings, sum.footprints / sum.pings, per_ping * 1e3);
    seconds += per_ping * static_cast<double>(pings);
    largest_travel_path_error_m = std::max(largest_travel_path_error_m, sum.largest_travel_path_error_m);
  }
  measuring.reset();
  tell("{}", told);
  if (scene.water->refracts()) {
    const std::optional<double> requested_m = scene.description.water.travel_path_error_m;
    tell("refraction     the largest travel-path error in these pings is {}{}\n",
         length_text(largest_travel_path_error_m),
         requested_m ? fmt::format(", requested: {}", length_text(*requested_m)) : std::string());
  }
  tell(
      "expected cost  {} for all pings with the tube engine, {} arithmetic, {} threads (measured on up to 3 "
      "pings per sensor), then about {} for writing files\n",
      duration_text(seconds), name_of(request.visibility.arithmetic), threads,
      duration_text(writing.seconds_on(threads)));
  tell("expected disk  {} for energies during the run, and at most about {} for the result\n",
       size_text(layout_of(survey, request).bytes()), size_text(writing.bytes));
}

}  // namespace

int check_command(const CheckOptions& options) {
  SceneDescription description = described(options);
  std::optional<OutputFile> picture;
  if (options.picture) {
    if (options.picture->extension() != ".png")
      throw UsageError(
          fmt::format("'{}': the name of a picture must end in .png", options.picture->string()));
    picture.emplace(*options.picture, inputs_of(description));
  }
  const ThreadLimit limit(description.run.threads);
  const auto survey = [&] {
    const Progress loading("scene", 1, options.quiet);
    return open_survey(description);
  }();
  const Scene& scene = survey->scene;
  const RunRequest request = request_of(description.run);
  require_able_to_run(*survey, request);
  print_warnings(scene.report.warnings, options.quiet);
  print_warnings(files_left_out(*survey), options.quiet);
  const std::vector<SeabedPlacement> placements = tubefoot::placements(*survey);
  for (const SeabedPlacement& placement : placements)
    if (!placement.warning.empty()) print_warnings({placement.warning}, options.quiet);
  print_warnings(vast_windows(*survey), options.quiet);
  for (const NoReturn& no_return : expected_no_returns(*survey, request))
    print_warnings({no_return.warning}, options.quiet);
  if (picture) {
    write_scene_picture(picture->path(), *survey, placements);
    picture->commit();
  }

  tell("scene          {}\n",
       shown_line(description.title.empty() ? description.file.string() : description.title));
  tell("scene hash     {}\n", description.sha256);
  print_frame(scene);
  tell("\n");
  print_components(scene);
  print_fineness(scene);
  print_standings(placements);
  print_materials(scene);
  print_mesh_names(scene);
  std::size_t refused = 0;
  for (const ComponentReport& c : scene.report.components) refused += c.kept_outside_halfedge;
  if (survey->loaded_scene->is_tiled())
    print_tiles(scene);
  else
    tell("\nfacets         {} ({} degenerate, {} duplicate, {} non-manifold; the simulation uses all)\n",
         scene.mesh.facets.size(), scene.report.mesh.degenerate_facets, scene.report.mesh.duplicate_facets,
         refused);
  if (survey->loaded_scene->relief.cell_m > 0)
    tell("relief         {}, cells of {}: {}{} unrefined facets\n", description.refinement.mode,
         length_text(survey->loaded_scene->relief.cell_m),
         survey->loaded_scene->is_tiled()
             ? "the tiles in use, from "
             : fmt::format("{} facets from ", survey->loaded_scene->relief.uniform_facets),
         survey->loaded_scene->relief.base_facets);
  if (!survey->loaded_scene->is_tiled()) tell("vertices       {}\n", scene.mesh.vertices.size());
  tell("grid unit      2^-{} m = {}\n", scene.grid.exponent(), length_text(scene.grid.unit_m()));
  if (!survey->loaded_scene->is_tiled())
    tell("largest snap   {}\n", length_text(scene.report.mesh.largest_snap_m));
  if (scene.water->refracts())
    tell("water          stratified: profile \"{}\" with {} points\n", description.water.profile,
         scene.water->profile().points().size());
  else
    tell("water          {:.2f} m/s\n", scene.sound_speed_m_s);
  if (survey->loaded_scene->is_tiled())
    tell("loading        {:.2f} s to read all tiles once\n\n", survey->loaded_scene->load_seconds);
  else
    tell("loading        {:.2f} s, tree {:.2f} s, {:.0f} bytes per facet\n\n",
         survey->loaded_scene->load_seconds, survey->loaded_scene->tree_seconds,
         (static_cast<double>(survey->loaded_scene->tree->bytes()) +
          static_cast<double>(scene.mesh.vertices.size() * sizeof(GridPoint)) +
          static_cast<double>(scene.mesh.facets.size() * (sizeof(scene.mesh.facets[0]) + 4))) /
             static_cast<double>(scene.mesh.facets.size()));

  const Transmissions transmissions(*survey, request);
  for (std::size_t s = 0; s < survey->sensors.size(); ++s) {
    const SensorPings& pings = survey->sensors[s];
    const Sensor& sensor = *pings.sensor;
    const RangeSamples& samples = sensor.samples();
    tell(
        "sensor         {}: {} pings{}, {} beams, {} range bins from {:g} to {:g} m, {:g} kHz, absorption "
        "{:.1f} dB/km\n",
        sensor.description().name, pings.times_s.size(),
        pings.line_starts.empty() ? "" : fmt::format(" on {} lines", pings.line_starts.size()),
        sensor.beams().size(), samples.count, samples.first_m,
        samples.first_m + samples.step_m * samples.count, sensor.frequency_khz(),
        1000 * absorption_db_per_m(scene, sensor));
    for (std::size_t t = 0; t < sensor.transmit_sectors().size(); ++t) {
      const std::size_t first = sensor.first_transmission(t);
      const std::vector<std::uint32_t>& beams = sensor.beams_of_transmission(first);
      tell(
          "               sector {}: beams {} to {}, {:g} kHz, absorption {:.1f} dB/km, tilt {:g} degrees, "
          "delay {:g} us\n",
          t, beams.front(), beams.back(), sensor.frequency_khz(first),
          1000 * absorption_db_per_m(scene, sensor, first),
          glm::degrees(sensor.transmit_sectors()[t].tilt_rad), 1e6 * sensor.transmission_delay_s(first));
    }
    print_places(scene, pings, scene.trajectories[scene.sensor_trajectory[s]]);
    if (!pings.water.empty())
      tell("               sound speed {:.2f} m/s at the first position\n", pings.sound_speed_m_s);
    if (const auto transition = fresnel_transition(transmissions, s))
      tell("               Fresnel transition {}\n", text_of(*transition));
    if (has_fresnel_borders(sensor)) tell("               shadow borders: {}\n", fresnel_statement);
    if (const auto assumed = assumed_configuration_text(scene, pings))
      tell("               files assume: {}\n", *assumed);
  }
  print_cost(*survey, request, limit.threads(), options.quiet);
  if (picture) tell("wrote {}\n", options.picture->string());
  return 0;
}

}  // namespace tubefoot
