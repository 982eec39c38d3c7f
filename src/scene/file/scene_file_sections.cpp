// SPDX-License-Identifier: GPL-3.0-or-later

// Defines the sections of a scene file with their keys, ranges and checks: [georeference], [[materials]],
// [[terrain]], [[objects]], [[trajectories]], [run] and others (docs/scene-keys.md).

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
        "'origin_lat_lon_deg' and 'crs' with 'origin_crs' both define the frame: give only one of the two");
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
  if (!material.specular_loss_db || material.model != "lambert" || material.unbounded)
    return;  // load_scattering() checks other models, and warns
  const double scattered = std::numbers::pi * std::pow(10, material.lambert_db / 10);
  if (scattered + std::pow(10, -*material.specular_loss_db / 10) > 1)
    throw InputError(
        table.place_of("specular_loss_db"),
        fmt::format(
            "'{}' would return more energy than it receives: with Lambert's law, it scatters a fraction of "
            "{:.3g}, so 'specular_loss_db' must be at least {:.6f} (or reduce 'lambert_db', or set unbounded "
            "= true if this is intended)",
            material.name, scattered, std::max(0.0, -10 * std::log10(1 - scattered)) + 1e-6));
}

void check_terrain(const TerrainDescription& terrain, const TomlTable& table) {
  const auto* fractal = std::get_if<FractalTerrain>(&terrain.kind);
  if (fractal != nullptr && fractal->ripple_height_m > 0 &&
      fractal->ripple_wavelength_m <= 2 * fractal->cell_m) {
    throw InputError(place_of_pair(table, "ripple_wavelength_m", "cell_m"),
                     fmt::format("cells of {} metres cannot resolve ripples of {} metres: 'cell_m' must be "
                                 "less than half of 'ripple_wavelength_m'",
                                 fractal->cell_m, fractal->ripple_wavelength_m));
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
    throw InputError(
        table.place_of("rays_per_beam"),
        "'rays_per_ping' and 'rays_per_beam' both set the number of rays: remove one of the two");
  }
}

}  // namespace

const TomlField<SceneDescription>& title_field() {
  static const auto title = field("title", &SceneDescription::title,
                                  {.meaning = "Title of the scene. tubefoot copies the title to the results.",
                                   .longest = limits::title_bytes});
  return title;
}

const TomlSection<GeoreferenceDescription>& georeference_section() {
  using G = GeoreferenceDescription;
  static const auto section =
      TomlSection<G>(
          "[georeference]",
          "Position of the local frame on the Earth. Give `origin_lat_lon_deg`, or `crs` with `origin_crs`. "
          "Without this section, coordinates are in metres in a local frame without a projection.")
          .keys({field("origin_lat_lon_deg", &G::origin_lat_lon_deg,
                       {.meaning = "Latitude and longitude (WGS 84) of the origin, where the frame is "
                                   "tangent to the ellipsoid. Not together with `crs`.",
                        .ranges = {latitude, longitude}}),
                 field("crs", &G::crs,
                       {.meaning = "Projected coordinate reference system, for example `\"EPSG:32602\"`. Its "
                                   "axes become those of the frame. Needs `origin_crs`."}),
                 field("origin_crs", &G::origin_crs,
                       {.meaning = "Easting and northing of the origin, in the units of `crs`."}),
                 field("origin_height_m", &G::origin_height_m,
                       {.meaning = "Height of z = 0 in the vertical datum of the files.",
                        .ranges = {{.lo = -12000, .hi = 12000}}})})
          .check(check_georeference);
  return section;
}

const TomlSection<MaterialDescription>& material_section() {
  using M = MaterialDescription;
  static const auto section =
      TomlSection<M>("[[materials]]", "Material of a surface. A scene needs at least one.")
          .keys({field("name", &M::name,
                       {.meaning = "Name by which terrains and objects refer to the material.",
                        .required = true,
                        .longest = limits::name_bytes})})
          .keys(scattering_fields())
          .keys({field("specular_loss_db", &M::specular_loss_db,
                       {.meaning = "Loss per specular reflection at facets of this material. Without this "
                                   "key, the facets do not reflect.",
                        .ranges = {{.lo = 0, .hi = 120}}})})
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
      TomlSection<T>(
          "[[terrain]]",
          "Part of the seabed. All entries together form the seabed. A single entry may be written as "
          "`[terrain]`. A scene needs at least one terrain or object.")
          .keys(
              {field("name", &T::name,
                     {.meaning = "Name of the terrain in reports.", .longest = limits::name_bytes}),
               field("material", &T::material,
                     {.meaning =
                          "Name of an entry of `[[materials]]`. Optional if the scene has only one material.",
                      .default_value = "the only material"}),
               material_map_field()})
          .kind<Flat>(
              "kind", "flat", "Level or sloping rectangle.",
              {field("width_m", &Flat::width_m,
                     {.meaning = "Extent from west to east.", .ranges = {size}, .required = true}),
               field("length_m", &Flat::length_m,
                     {.meaning = "Extent from south to north.", .ranges = {size}, .required = true}),
               field("centre_m", &Flat::centre_m,
                     {.meaning = "Centre of the terrain: east, north, up.", .ranges = {coordinate}}),
               field("cell_m", &Flat::cell_m,
                     {.meaning = "Largest side of a cell, which consists of two facets. 0: the whole terrain "
                                 "is one cell. At most 50 million cells.",
                      .ranges = {size_or_zero}}),
               field("slope_deg", &Flat::slope_deg,
                     {.meaning = "Slope about the centre.", .ranges = {slope}}),
               field(
                   "slope_heading_deg", &Flat::slope_heading_deg,
                   {.meaning =
                        "Downslope direction, clockwise from north. 90: the terrain is deepest in the east.",
                    .ranges = {heading}})})
          .kind<Fractal>(
              "kind", "fractal",
              "Rectangle with random fractal relief (a fractional Brownian surface) and optional sand "
              "ripples.",
              {field("width_m", &Fractal::width_m,
                     {.meaning = "Extent from west to east.", .ranges = {size}, .required = true}),
               field("length_m", &Fractal::length_m,
                     {.meaning = "Extent from south to north.", .ranges = {size}, .required = true}),
               field("centre_m", &Fractal::centre_m,
                     {.meaning = "Centre of the terrain: east, north, up.", .ranges = {coordinate}}),
               field("cell_m", &Fractal::cell_m,
                     {.meaning =
                          "Largest side of a cell, which consists of two facets. At most 50 million cells.",
                      .ranges = {size}}),
               field("slope_deg", &Fractal::slope_deg,
                     {.meaning = "Slope about the centre.", .ranges = {slope}}),
               field(
                   "slope_heading_deg", &Fractal::slope_heading_deg,
                   {.meaning =
                        "Downslope direction, clockwise from north. 90: the terrain is deepest in the east.",
                    .ranges = {heading}}),
               field("rms_height_m", &Fractal::rms_height_m,
                     {.meaning = "Root mean square height of the relief about its mean, without ripples.",
                      .ranges = {height}}),
               field("hurst", &Fractal::hurst,
                     {.meaning = "Hurst exponent of the relief: rough near 0, smooth near 1.",
                      .ranges = {{.lo = 0, .hi = 1, .lo_excluded = true, .hi_excluded = true}}}),
               field("largest_wavelength_m", &Fractal::largest_wavelength_m,
                     {.meaning = "Longest wavelength of the relief. 0: the larger of the two extents.",
                      .ranges = {size_or_zero}}),
               field("seed", &Fractal::seed,
                     {.meaning = "Seed of the relief. The same seed gives the same relief.",
                      .ranges = {not_negative}}),
               field("ripple_height_m", &Fractal::ripple_height_m,
                     {.meaning = "Height of sinusoidal sand ripples from trough to crest. 0: no ripples.",
                      .ranges = {height}}),
               field("ripple_wavelength_m", &Fractal::ripple_wavelength_m,
                     {.meaning = "Distance from crest to crest, which must exceed two cells.",
                      .ranges = {size}}),
               field("ripple_direction_deg", &Fractal::ripple_direction_deg,
                     {.meaning = "Compass direction perpendicular to the crests, clockwise from north.",
                      .ranges = {heading}})})
          .kind<Raster>(
              "kind", "raster", "Bathymetric grid from a file.",
              {field("file", &Raster::file,
                     {.meaning = "Grid in a format that GDAL reads: GeoTIFF, BAG, ESRI ASCII grid, netCDF, "
                                 "or VRT of local files. Cells without data are holes.",
                      .required = true}),
               field(
                   "window", &Raster::window,
                   {.meaning =
                        "Part of the raster to load: first column, first row, columns, rows, from the "
                        "north-west corner. For a BAG of variable resolution, the numbers count supergrids.",
                    .ranges = {index, index, count_of_two, count_of_two}}),
               field("decimate", &Raster::decimate,
                     {.meaning = "Load every n-th row and column.", .ranges = {{.lo = 1, .hi = 10000}}}),
               field("resolution_m", &Raster::resolution_m,
                     {.meaning = "For a BAG of variable resolution: side of the square cells to which the "
                                 "surface is resampled. 0: all nodes, without resampling.",
                      .ranges = {size_or_zero}}),
               field("depth_positive_down", &Raster::depth_positive_down,
                     {.meaning = "true: the values are depths. false: the values are heights."}),
               field("load", &Raster::load,
                     {.meaning = "Load the whole raster at once, or only the tiles that a ping needs. auto: "
                                 "tiles for rasters of more than 20 million pixels.",
                      .choices = {"auto", "whole", "tiles"}})})
          .check(check_terrain);
  return section;
}

const TomlSection<ObjectDescription>& object_section() {
  using O = ObjectDescription;
  using Sphere = SpherePrimitive;
  using Cylinder = CylinderPrimitive;
  using Cone = ConePrimitive;
  constexpr ValueRange mesh_unit{.lo = 0, .hi = 1e6, .lo_excluded = true};
  static const auto chord_error =
      field("chord_error_m", &O::chord_error_m,
            {.meaning = "Largest distance between the curved surface and its facets. Default: a sixteenth of "
                        "the sensor resolution, at least 3/10000 and at most 1/50 of the radius.",
             .ranges = {size},
             .default_value = "computed from the sensor resolution"});
  static const auto section =
      TomlSection<O>("[[objects]]", "Object in the water or on the seabed.")
          .keys(
              {field("name", &O::name,
                     {.meaning = "Name of the object in reports.",
                      .required = true,
                      .longest = limits::name_bytes}),
               field("material", &O::material,
                     {.meaning =
                          "Name of an entry of `[[materials]]`. Optional if the scene has only one material.",
                      .default_value = "the only material"}),
               field("position_m", &O::position_m,
                     {.meaning = "Centre of a primitive, or origin of a mesh file: east, north, up.",
                      .ranges = {coordinate}}),
               field("position_lat_lon_deg", &O::position_lat_lon_deg,
                     {.meaning = "Latitude and longitude (WGS 84), instead of the first two numbers of "
                                 "`position_m`. Needs `[georeference]`.",
                      .ranges = {latitude, longitude}}),
               field("on_terrain_m", &O::on_terrain_m,
                     {.meaning = "Height of the lowest point of the object above the highest terrain at this "
                                 "position, instead of the third number of `position_m`. Negative values "
                                 "embed the object in the terrain.",
                      .ranges = {coordinate}}),
               field("trajectory", &O::trajectory,
                     {.meaning = "Name of an entry of `[[trajectories]]` on which the object moves. "
                                 "`position_m` is then relative to the carrier: starboard, forward, up. The "
                                 "angles are relative to its axes. Excludes `position_lat_lon_deg` and "
                                 "`on_terrain_m`.",
                      .default_value = "none: the object is at rest"}),
               field("heading_deg", &O::heading_deg,
                     {.meaning = "Rotation about the vertical, clockwise from north.", .ranges = {heading}}),
               field("pitch_deg", &O::pitch_deg,
                     {.meaning = "Rotation that raises the y axis (bow) of the object.", .ranges = {pitch}}),
               field("roll_deg", &O::roll_deg,
                     {.meaning = "Rotation that lowers the x axis (starboard side) of the object.",
                      .ranges = {roll}}),
               field("scale", &O::scale,
                     {.meaning = "Scale factors along the axes of the object, applied before the rotations. "
                                 "For a mesh, the rotation by `up` comes first.",
                      .ranges = {{.lo = 0, .hi = 1e6, .lo_excluded = true}}})})
          .kind<MeshFile>(
              "shape", "mesh", "Facets from a mesh file.",
              {field("file", &MeshFile::file,
                     {.meaning = "Mesh file: OBJ, PLY, STL, OFF, COLLADA, glTF (GLB), 3DS or FBX.",
                      .required = true}),
               field("up", &MeshFile::up,
                     {.meaning = "Axis of the file that points up. Default: z for OBJ, PLY, STL and OFF, y "
                                 "for glTF, and the stated axis for COLLADA and FBX. Required for 3DS.",
                      .choices = {"x", "y", "z"}}),
               field("unit_m", &MeshFile::unit_m,
                     {.meaning = "Length of one unit of the file, for example 0.001 for millimetres. "
                                 "Default: 1 for OBJ, PLY, STL, OFF and glTF, and the stated unit for "
                                 "COLLADA (1 if it states none) and FBX. Required for 3DS.",
                      .ranges = {mesh_unit}}),
               classes_field("materials", &MeshFile::materials,
                             {.meaning = "Names of faces in the mesh and their materials in the scene. Other "
                                         "faces have the `material` of the object."})})
          .kind<Sphere>(
              "shape", "sphere",
              "Sphere with its centre at `position_m`. The facets together have the area of the sphere.",
              {field("radius_m", &Sphere::radius_m, {.meaning = "Radius of the sphere.", .ranges = {size}})},
              {chord_error})
          .kind<Cylinder>("shape", "cylinder",
                          "Closed cylinder along the z axis of the object, with its centre at `position_m`. "
                          "The side facets together have the area of the curved side.",
                          {field("radius_m", &Cylinder::radius_m,
                                 {.meaning = "Radius of the cylinder.", .ranges = {size}}),
                           field("height_m", &Cylinder::height_m,
                                 {.meaning = "Height along the z axis of the object.", .ranges = {size}})},
                          {chord_error})
          .kind<Cone>(
              "shape", "cone",
              "Closed cone along the z axis of the object, pointed or truncated. `position_m` is the point "
              "on its axis at half of its height.",
              {field("radius_m", &Cone::radius_m, {.meaning = "Radius at the bottom.", .ranges = {size}}),
               field("top_radius_m", &Cone::top_radius_m,
                     {.meaning = "Radius at the top. 0: a pointed cone.", .ranges = {size_or_zero}}),
               field("height_m", &Cone::height_m,
                     {.meaning = "Height along the z axis of the object.", .ranges = {size}})},
              {chord_error})
          .kind<BoxPrimitive>("shape", "box", "Box with its centre at `position_m`.",
                              {field("size_m", &BoxPrimitive::size_m,
                                     {.meaning = "Edge lengths along the x, y and z axes of the object.",
                                      .ranges = {size}})});
  return section;
}

const TomlSection<RunDescription>& run_section() {
  using R = RunDescription;
  static const auto section =
      TomlSection<R>("[run]",
                     "Settings of the computation. Options on the command line override these settings.")
          .keys(
              {field("start_utc", &R::start_utc,
                     {.meaning = "UTC date and time at which the time of trajectories is 0. Files with dates "
                                 "contain dates relative to this instant."}),
               field("engine", &R::engine,
                     {.meaning = "tube: integrates footprints exactly. ray: samples footprints with rays.",
                      .choices = {"tube", "ray"}}),
               field("arithmetic", &R::arithmetic,
                     {.meaning = "Arithmetic of the tube engine. fixed, filtered and rational are exact; "
                                 "double is for comparison.",
                      .choices = {"fixed", "filtered", "rational", "double"}}),
               field("binning", &R::binning,
                     {.meaning = "Distribution of the energy of a footprint over range bins. exact: "
                                 "footprints are cut at bin borders. spread: uniformly over the ranges of "
                                 "the footprint. centroid: all in the bin of the centroid.",
                      .choices = {"exact", "spread", "centroid"}}),
               field("facets_per_split", &R::facets_per_split,
                     {.meaning = "Number of possible occluders above which the tube engine splits a facet "
                                 "before the subtraction of hidden parts. Affects only the run time.",
                      .ranges = {{.lo = 2, .hi = 1e6}}}),
               field("zero_tolerance", &R::zero_tolerance,
                     {.meaning = "For `arithmetic = \"double\"`: relative magnitude up to which a value "
                                 "counts as zero.",
                      .ranges = {{.lo = 0, .hi = 1e-3}}}),
               field("sampling", &R::sampling,
                     {.meaning = "Directions of rays. stratified: one random ray per cell. sobol: scrambled "
                                 "Sobol' points. adaptive: more rays where neighbouring cells differ. "
                                 "regular: cell centres. random: independent. column: one column per beam.",
                      .choices = {"stratified", "sobol", "adaptive", "regular", "random", "column"}}),
               field("rays_per_ping", &R::rays_per_ping,
                     {.meaning = "Number of rays per ping of the ray engine.",
                      .ranges = {{.lo = 1, .hi = 1e10}}}),
               field("rays_per_beam", &R::rays_per_beam,
                     {.meaning = "Number of rays per beam of the ray engine, instead of `rays_per_ping`.",
                      .ranges = {{.lo = 1, .hi = 1e10}}}),
               field("seed", &R::seed,
                     {.meaning = "Seed of the ray engine, of noise and speckle, and of the scatterers.",
                      .ranges = {not_negative}}),
               field("grid_exponent", &R::grid_exponent,
                     {.meaning = "Exponent k of the grid unit, which is 2^-k metres. Default: the largest "
                                 "value up to 20 for which the scene fits on the grid.",
                      .ranges = {{.lo = 0, .hi = finest_grid_exponent}}}),
               field("threads", &R::threads,
                     {.meaning = "Number of threads. 0: one per core.", .ranges = {{.lo = 0, .hi = 1024}}}),
               field("terrain_cache_mb", &R::terrain_cache_mb,
                     {.meaning = "Memory for tiled terrain in megabytes, in addition to the tiles in use.",
                      .ranges = {{.lo = 0, .hi = 1e6}}})})
          .check(check_run);
  return section;
}

}  // namespace tubefoot
