// SPDX-License-Identifier: GPL-3.0-or-later

// Defines the sections of a scene file with their keys, ranges and checks: [georeference], [[materials]],
// [[terrain]], [[objects]], [[trajectories]], [run] and others (docs/scene-file.md).

#include "scene/file/scene_file_sections.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "files/utc.hpp"
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_scattering.hpp"
#include "scene/file/scene_file_tables.hpp"

namespace tubefoot {
namespace {

void check_georeference(const GeoreferenceDescription& g, const TomlTable& table) {
  if (g.origin_lat_lon_deg && (g.crs || g.origin_crs)) {
    throw InputError(
        place_of_pair(table, "origin_crs", "crs"),
        "the frame lies at 'origin_lat_lon_deg' or in 'crs' at 'origin_crs': give only one of the two");
  }
  if (!g.origin_lat_lon_deg && !g.crs && !g.origin_crs) {
    throw InputError(table.place, "[georeference] needs 'origin_lat_lon_deg', or 'crs' with 'origin_crs'");
  }
  if (g.crs.has_value() != g.origin_crs.has_value()) {
    throw InputError(
        place_of_pair(table, "origin_crs", "crs"),
        fmt::format("'crs' and 'origin_crs' go together: add '{}'", g.crs ? "origin_crs" : "crs"));
  }
}

void check_material(const MaterialDescription& material, const TomlTable& table) {
  check_scattering(material, table);
  check_smooth(material, table);
  if (!material.specular_loss_db || material.model != "lambert")
    return;  // load_scattering() checks other models
  const double scattered = std::numbers::pi * std::pow(10, material.lambert_db / 10);
  if (scattered + std::pow(10, -*material.specular_loss_db / 10) > 1)
    throw InputError(
        table.place_of("specular_loss_db"),
        fmt::format(
            "'{}' would return more than it receives: Lambert's law scatters {:.3g} of it, so what it "
            "mirrors must lose {:.6f} dB at least (or lower 'lambert_db')",
            material.name, scattered, std::max(0.0, -10 * std::log10(1 - scattered)) + 1e-6));
}

void check_terrain(const TerrainDescription& terrain, const TomlTable& table) {
  const auto* fractal = std::get_if<FractalTerrain>(&terrain.kind);
  if (fractal != nullptr && fractal->ripple_height_m > 0 &&
      fractal->ripple_wavelength_m <= 2 * fractal->cell_m) {
    throw InputError(
        place_of_pair(table, "ripple_wavelength_m", "cell_m"),
        fmt::format("cells of {} metres cannot show ripples of {} metres: 'cell_m' must be less than "
                    "half of 'ripple_wavelength_m'",
                    fractal->cell_m, fractal->ripple_wavelength_m));
  }
}

void check_survey(const SurveyTrajectory& survey, const TomlTable& table) {
  if (table.has("centre_m") + survey.centre_lat_lon_deg.has_value() + survey.centre_crs.has_value() > 1)
    throw InputError(table.place_of(survey.centre_crs ? "centre_crs" : "centre_lat_lon_deg"),
                     "the survey has more than one centre: keep one of 'centre_m', 'centre_lat_lon_deg' and "
                     "'centre_crs'");
  const int heights = survey.up_m.has_value() + survey.depth_m.has_value() + survey.altitude_m.has_value();
  if (heights != 1)
    throw InputError(
        table.place,
        fmt::format("a survey has {} height: give one of 'up_m' (in the local frame), 'depth_m' (below "
                    "the water's surface) and 'altitude_m' (above the terrain)",
                    heights == 0 ? "no" : "more than one"));
  if (survey.altitude_step_m && !survey.altitude_m)
    throw InputError(table.place_of("altitude_step_m"),
                     "'altitude_step_m' goes with 'altitude_m': remove it, or give the height by that");
}

void check_trajectory(const TrajectoryDescription& trajectory, const TomlTable& table) {
  if (const auto* survey = std::get_if<SurveyTrajectory>(&trajectory.kind)) check_survey(*survey, table);
  if (const auto* waypoints = std::get_if<WaypointTrajectory>(&trajectory.kind))
    if (table.has("turn_s") && !waypoints->speed_m_s)
      throw InputError(table.place_of("turn_s"),
                       "'turn_s' is for files without times: give 'speed_m_s', or remove 'turn_s'");
  const auto* line = std::get_if<LineTrajectory>(&trajectory.kind);
  if (line == nullptr) return;
  if (line->start_m == line->end_m) {
    throw InputError(table.place_of("end_m"),
                     "'end_m' equals 'start_m': a line has a length (kind = \"fixed\" stays in place)");
  }
  if (line->start_m[0] == line->end_m[0] && line->start_m[1] == line->end_m[1]) {
    throw InputError(
        table.place_of("end_m"),
        "'end_m' lies straight above or below 'start_m': heading follows the line, so a vertical one has "
        "none (use kind = \"waypoints\")");
  }
}

void check_run(const RunDescription& run, const TomlTable& table) {
  if (!unix_time_s(run.start_utc))
    throw InputError(
        table.place_of("start_utc"),
        fmt::format("expected a date and time like \"2026-07-01T12:30:00Z\", from 1970 to 2099, not "
                    "\"{}\"",
                    run.start_utc));
  if (run.rays_per_beam && table.has("rays_per_ping")) {
    throw InputError(table.place_of("rays_per_beam"),
                     "rays are counted by ping or by beam: remove 'rays_per_ping' or 'rays_per_beam'");
  }
}

}  // namespace

const TomlField<SceneDescription>& title_field() {
  static const auto title = field("title", &SceneDescription::title, {.longest = limits::title_bytes});
  return title;
}

const TomlSection<GeoreferenceDescription>& georeference_section() {
  using G = GeoreferenceDescription;
  static const auto section =
      TomlSection<G>("[georeference]")
          .keys({field("origin_lat_lon_deg", &G::origin_lat_lon_deg, {.ranges = {latitude, longitude}}),
                 field("crs", &G::crs), field("origin_crs", &G::origin_crs),
                 field("origin_height_m", &G::origin_height_m, {.ranges = {{.lo = -12000, .hi = 12000}}})})
          .check(check_georeference);
  return section;
}

const TomlSection<MaterialDescription>& material_section() {
  using M = MaterialDescription;
  static const auto section =
      TomlSection<M>("[[materials]]")
          .keys({field("name", &M::name, {.required = true, .longest = limits::name_bytes})})
          .keys(scattering_fields())
          .keys({field("specular_loss_db", &M::specular_loss_db, {.ranges = {{.lo = 0, .hi = 120}}})})
          .keys(smooth_fields())
          .tables("relief", &M::relief, relief_section())
          .tables("reflectivity", &M::reflectivity, reflectivity_section())
          .check(check_material);
  return section;
}

const TomlSection<TerrainDescription>& terrain_section() {
  using T = TerrainDescription;
  using Flat = FlatTerrain;
  using Fractal = FractalTerrain;
  using Raster = RasterTerrain;
  constexpr ValueRange slope{.lo = -80, .hi = 80};
  static const auto section =
      TomlSection<T>("[[terrain]]")
          .keys({field("name", &T::name, {.longest = limits::name_bytes}),
                 field("material", &T::material, {.default_value = "the only material"}),
                 material_map_field()})
          .kind<Flat>("kind", "flat",
                      {field("width_m", &Flat::width_m, {.ranges = {size}, .required = true}),
                       field("length_m", &Flat::length_m, {.ranges = {size}, .required = true}),
                       field("centre_m", &Flat::centre_m, {.ranges = {coordinate}}),
                       field("cell_m", &Flat::cell_m, {.ranges = {size_or_zero}}),
                       field("slope_deg", &Flat::slope_deg, {.ranges = {slope}}),
                       field("slope_heading_deg", &Flat::slope_heading_deg, {.ranges = {heading}})})
          .kind<Fractal>(
              "kind", "fractal",
              {field("width_m", &Fractal::width_m, {.ranges = {size}, .required = true}),
               field("length_m", &Fractal::length_m, {.ranges = {size}, .required = true}),
               field("centre_m", &Fractal::centre_m, {.ranges = {coordinate}}),
               field("cell_m", &Fractal::cell_m, {.ranges = {size}}),
               field("slope_deg", &Fractal::slope_deg, {.ranges = {slope}}),
               field("slope_heading_deg", &Fractal::slope_heading_deg, {.ranges = {heading}}),
               field("rms_height_m", &Fractal::rms_height_m, {.ranges = {height}}),
               field("hurst", &Fractal::hurst,
                     {.ranges = {{.lo = 0, .hi = 1, .lo_excluded = true, .hi_excluded = true}}}),
               field("largest_wavelength_m", &Fractal::largest_wavelength_m, {.ranges = {size_or_zero}}),
               field("seed", &Fractal::seed, {.ranges = {not_negative}}),
               field("ripple_height_m", &Fractal::ripple_height_m, {.ranges = {height}}),
               field("ripple_wavelength_m", &Fractal::ripple_wavelength_m, {.ranges = {size}}),
               field("ripple_direction_deg", &Fractal::ripple_direction_deg, {.ranges = {heading}})})
          .kind<Raster>(
              "kind", "raster",
              {field("file", &Raster::file, {.required = true}),
               field("window", &Raster::window, {.ranges = {index, index, count_of_two, count_of_two}}),
               field("decimate", &Raster::decimate, {.ranges = {{.lo = 1, .hi = 10000}}}),
               field("resolution_m", &Raster::resolution_m, {.ranges = {size_or_zero}}),
               field("depth_positive_down", &Raster::depth_positive_down),
               field("load", &Raster::load, {.choices = {"auto", "whole", "tiles"}})})
          .check(check_terrain);
  return section;
}

const TomlSection<ObjectDescription>& object_section() {
  using O = ObjectDescription;
  using Sphere = SpherePrimitive;
  using Cylinder = CylinderPrimitive;
  using Cone = ConePrimitive;
  constexpr ValueRange mesh_unit{.lo = 0, .hi = 1e6, .lo_excluded = true};
  static const auto chord_error = field("chord_error_m", &O::chord_error_m,
                                        {.ranges = {size}, .default_value = "as fine as the sensors see"});
  static const auto section =
      TomlSection<O>("[[objects]]")
          .keys({field("name", &O::name, {.required = true, .longest = limits::name_bytes}),
                 field("material", &O::material, {.default_value = "the only material"}),
                 field("position_m", &O::position_m, {.ranges = {coordinate}}),
                 field("position_lat_lon_deg", &O::position_lat_lon_deg, {.ranges = {latitude, longitude}}),
                 field("on_terrain_m", &O::on_terrain_m, {.ranges = {coordinate}}),
                 field("heading_deg", &O::heading_deg, {.ranges = {heading}}),
                 field("pitch_deg", &O::pitch_deg, {.ranges = {pitch}}),
                 field("roll_deg", &O::roll_deg, {.ranges = {roll}}),
                 field("scale", &O::scale, {.ranges = {{.lo = 0, .hi = 1e6, .lo_excluded = true}}})})
          .kind<MeshFile>("shape", "mesh",
                          {field("file", &MeshFile::file, {.required = true}),
                           field("up", &MeshFile::up, {.choices = {"x", "y", "z"}}),
                           field("unit_m", &MeshFile::unit_m, {.ranges = {mesh_unit}}),
                           classes_field("materials", &MeshFile::materials)})
          .kind<Sphere>("shape", "sphere", {field("radius_m", &Sphere::radius_m, {.ranges = {size}})},
                        {chord_error})
          .kind<Cylinder>("shape", "cylinder",
                          {field("radius_m", &Cylinder::radius_m, {.ranges = {size}}),
                           field("height_m", &Cylinder::height_m, {.ranges = {size}})},
                          {chord_error})
          .kind<Cone>("shape", "cone",
                      {field("radius_m", &Cone::radius_m, {.ranges = {size}}),
                       field("top_radius_m", &Cone::top_radius_m, {.ranges = {size_or_zero}}),
                       field("height_m", &Cone::height_m, {.ranges = {size}})},
                      {chord_error})
          .kind<BoxPrimitive>("shape", "box", {field("size_m", &BoxPrimitive::size_m, {.ranges = {size}})});
  return section;
}

const TomlSection<TrajectoryDescription>& trajectory_section() {
  using T = TrajectoryDescription;
  using Fixed = FixedTrajectory;
  using Line = LineTrajectory;
  using Waypoints = WaypointTrajectory;
  using Lines = SurveyTrajectory;
  constexpr ValueRange speed{.lo = 0, .hi = 100, .lo_excluded = true};
  constexpr ValueRange turn{.lo = 0.001, .hi = 1e6};
  static const auto section =
      TomlSection<T>("[[trajectories]]")
          .keys({field("name", &T::name, {.longest = limits::name_bytes})})
          .kind<Fixed>("kind", "fixed",
                       {field("position_m", &Fixed::position_m, {.ranges = {coordinate}}),
                        field("heading_deg", &Fixed::heading_deg, {.ranges = {heading}}),
                        field("pitch_deg", &Fixed::pitch_deg, {.ranges = {pitch}}),
                        field("roll_deg", &Fixed::roll_deg, {.ranges = {roll}})})
          .kind<Line>("kind", "line",
                      {field("start_m", &Line::start_m, {.ranges = {coordinate}, .required = true}),
                       field("end_m", &Line::end_m, {.ranges = {coordinate}, .required = true}),
                       field("speed_m_s", &Line::speed_m_s, {.ranges = {speed}}),
                       field("pitch_deg", &Line::pitch_deg, {.ranges = {pitch}}),
                       field("roll_deg", &Line::roll_deg, {.ranges = {roll}})})
          .kind<Waypoints>("kind", "waypoints",
                           {field("file", &Waypoints::file, {.required = true}),
                            field("speed_m_s", &Waypoints::speed_m_s, {.ranges = {speed}}),
                            field("turn_s", &Waypoints::turn_s, {.ranges = {turn}})})
          .kind<Lines>(
              "kind", "survey",
              {field("centre_m", &Lines::centre_m, {.ranges = {coordinate}}),
               field("centre_lat_lon_deg", &Lines::centre_lat_lon_deg, {.ranges = {latitude, longitude}}),
               field("centre_crs", &Lines::centre_crs),
               field("length_m", &Lines::length_m, {.ranges = {size}, .required = true}),
               field("width_m", &Lines::width_m, {.ranges = {size_or_zero}, .required = true}),
               field("spacing_m", &Lines::spacing_m, {.ranges = {size}, .required = true}),
               field("heading_deg", &Lines::heading_deg, {.ranges = {heading}}),
               field("one_way", &Lines::one_way), field("up_m", &Lines::up_m, {.ranges = {coordinate}}),
               field("depth_m", &Lines::depth_m, {.ranges = {{.lo = 0, .hi = 12000}}}),
               field("altitude_m", &Lines::altitude_m,
                     {.ranges = {{.lo = 0, .hi = 12000, .lo_excluded = true}}}),
               field("altitude_step_m", &Lines::altitude_step_m,
                     {.ranges = {size}, .default_value = "as altitude_m"}),
               field("speed_m_s", &Lines::speed_m_s, {.ranges = {speed}}),
               field("turn_s", &Lines::turn_s, {.ranges = {turn}}),
               field("pitch_deg", &Lines::pitch_deg, {.ranges = {pitch}}),
               field("roll_deg", &Lines::roll_deg, {.ranges = {roll}})})
          .check(check_trajectory);
  return section;
}

const TomlSection<RunDescription>& run_section() {
  using R = RunDescription;
  static const auto section =
      TomlSection<R>("[run]")
          .keys(
              {field("start_utc", &R::start_utc), field("engine", &R::engine, {.choices = {"tube", "ray"}}),
               field("arithmetic", &R::arithmetic, {.choices = {"fixed", "filtered", "rational", "double"}}),
               field("binning", &R::binning, {.choices = {"exact", "spread", "centroid"}}),
               field("facets_per_split", &R::facets_per_split, {.ranges = {{.lo = 2, .hi = 1e6}}}),
               field("zero_tolerance", &R::zero_tolerance, {.ranges = {{.lo = 0, .hi = 1e-3}}}),
               field("sampling", &R::sampling,
                     {.choices = {"stratified", "sobol", "adaptive", "regular", "random", "column"}}),
               field("rays_per_ping", &R::rays_per_ping, {.ranges = {{.lo = 1, .hi = 1e10}}}),
               field("rays_per_beam", &R::rays_per_beam, {.ranges = {{.lo = 1, .hi = 1e10}}}),
               field("seed", &R::seed, {.ranges = {not_negative}}),
               field("grid_exponent", &R::grid_exponent, {.ranges = {{.lo = 0, .hi = finest_grid_exponent}}}),
               field("threads", &R::threads, {.ranges = {{.lo = 0, .hi = 1024}}}),
               field("terrain_cache_mb", &R::terrain_cache_mb, {.ranges = {{.lo = 0, .hi = 1e6}}})})
          .check(check_run);
  return section;
}

}  // namespace tubefoot
