// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "files/input_error.hpp"
#include "scene/description/scene_component.hpp"

// What a scene file says, key by key, in the file's own units (degrees, metres, kHz). Nothing is loaded yet.
// docs/scene-file.md documents every key with unit, default and range.
namespace tubefoot {

/// Where the local east-north-up frame lies. Without it, coordinates are local metres already.
struct GeoreferenceDescription {
  SourcePlace place;
  std::optional<std::array<double, 2>> origin_lat_lon_deg;  ///< latitude, longitude (WGS 84)
  std::optional<std::string> crs;                   ///< e.g. "EPSG:32602": frame axes and origin below
  std::optional<std::array<double, 2>> origin_crs;  ///< easting, northing in `crs`
  double origin_height_m = 0;                       ///< height that becomes z = 0
};

struct WaterDescription {
  SourcePlace place;
  std::optional<double> sound_speed_m_s;       ///< else Mackenzie 1981 from T, S and depth
  std::optional<double> absorption_db_per_km;  ///< else Francois-Garrison 1982 at the sensor's frequency
  double temperature_c = 10, salinity_psu = 35, ph = 8;
  double depth_m = 10;  ///< for the two formulas
  std::string sound_speed_formula = "mackenzie", absorption_model = "francois-garrison";
  std::optional<double> latitude_deg;  ///< for Leroy's formula; else 45

  // How sound speed changes with depth (scene/scene_water.hpp); depth = surface height - z.
  std::string profile = "constant";
  std::optional<std::filesystem::path> profile_file;  ///< of a table or a cast
  std::optional<double> surface_height_m;             ///< else 0
  std::optional<double> profile_bottom_m;             ///< of a profile by formula: constant below
  std::optional<double> gradient_per_s;
  std::optional<double> munk_axis_m, munk_scale_m, munk_epsilon;
  std::optional<double> profile_error_m_s, profile_step_m;  ///< of sampling a curved profile
  std::optional<double> refraction_gap_m;                   ///< else a quarter of a range sample
  std::optional<double> refraction_tolerance_db;            ///< else 0.1
};

/// Micro-texture: octaves of improved Perlin noise.
struct PerlinReflectivityKeys {
  double wavelength_m = 0.5;  ///< the longest
  int octaves = 3;
  double persistence = 0.5;
  double depth = 0.25;
  std::uint64_t seed = 1;
};
/// Micro-texture: a raster, over and over from the frame's origin on, or where it lies on Earth.
struct MapReflectivityKeys {
  std::filesystem::path file;
  std::string values = "factor";                ///< factor | db
  std::optional<std::array<double, 2>> tile_m;  ///< east, north
};
struct ReflectivityDescription {
  SourcePlace place;
  std::variant<PerlinReflectivityKeys, MapReflectivityKeys> kind;
};

/// Relief of a material as a fractional Brownian surface: 'hurst' or 'spectral_exponent' (2 hurst + 2), and
/// 'rms_height_m' or 'spectral_strength_cm4'.
struct FractalReliefDescription {
  std::optional<double> hurst, spectral_exponent, rms_height_m, spectral_strength_cm4;
  bool operator==(const FractalReliefDescription&) const = default;
};
/// Ripples by a translated spectrum.
struct RippleReliefDescription {
  double wavelength_m = 1;
  double direction_deg = 0;  ///< compass direction of the wave vector (across the crests)
  double rms_height_m = 0.01;
  double hurst = 0.9;  ///< width of the band: the larger, the narrower
  bool operator==(const RippleReliefDescription&) const = default;
};
/// A measured map of deviations from the facets.
struct MapReliefDescription {
  std::filesystem::path file;    ///< already resolved against the scene file's folder
  std::optional<double> tile_m;  ///< repeated, its width being this; else it lies where its georeference says
  double scale = 1;              ///< of its heights
  bool operator==(const MapReliefDescription&) const = default;
};
struct ReliefDescription {
  SourcePlace place;
  double tile_m = 0;  ///< period of what is synthesised
  double resolution_m = 0;
  std::uint64_t seed = 1;
  std::variant<FractalReliefDescription, RippleReliefDescription, MapReliefDescription> kind;
};

struct MaterialDescription {
  SourcePlace place;
  std::string name;
  double lambert_db = -27;      ///< 10 log10 mu; energy conservation wants <= -4.9715
  std::string law = "lambert";  ///< lambert | gsab | table | sediment; docs/scattering.md
  std::optional<double> specular_db, specular_width_deg;      ///< gsab: A and B
  std::optional<double> oblique_db, oblique_exponent;         ///< gsab: C and D
  std::optional<double> transition_db, transition_width_deg;  ///< gsab: E and F
  std::vector<double> table_grazing_deg, table_db;            ///< table, in the scene file
  std::optional<std::filesystem::path> table_file;            ///< table, apart
  std::optional<std::string> sediment;                        ///< sediment: its name
  double sediment_khz = 300;                                  ///< sediment: frequency of its table
  bool unbounded = false;                                     ///< may scatter more than it receives
  std::vector<ReliefDescription> relief;                      ///< their sum; none: facets are flat
  std::vector<ReflectivityDescription> reflectivity;          ///< their product; none: even
  std::optional<double> specular_loss_db;  ///< of what it mirrors; none: it mirrors nothing
};

/// A horizontal mirror over the scene.
struct SeaSurfaceDescription {
  SourcePlace place;
  double height_m = 0;
  double loss_db = 0;          ///< of every reflection
  double rms_roughness_m = 0;  ///< standard deviation of its heights: a further loss, Rayleigh's
};

/// Which paths are followed. docs/paths.md
struct PathsDescription {
  SourcePlace place;
  int order = 1;                  ///< most interactions (scattering and reflections) of a path
  std::optional<int> only_order;  ///< leave out all but this one
  double cutoff_db = 100;         ///< paths that lose more are not followed
  int scatterings = 1;            ///< most of them on a path
  double patch_m = 1;             ///< longest edge of patches, which all but the last scatter as
  int most_images = 10000;        ///< of one apex
  bool direct = false;            ///< a receiver apart also hears its transmitter straight
};

struct FlatTerrain {
  double width_m = 0, length_m = 0;  ///< east-west, north-south extent, centred on `centre_m`
  std::array<double, 3> centre_m{0, 0, 0};
  double cell_m = 0;  ///< 0: two facets in all
};

/// Seeded fractal relief: fractional Brownian surface by midpoint-free spectral-like noise; same seed, same
/// bed.
struct FractalTerrain {
  double width_m = 0, length_m = 0;
  std::array<double, 3> centre_m{0, 0, 0};
  double cell_m = 1;
  double rms_height_m = 0.1;
  double hurst = 0.8;               ///< 0..1
  double largest_wavelength_m = 0;  ///< 0: the larger extent
  std::uint64_t seed = 1;
  double ripple_height_m = 0;  ///< crest to trough of sinusoidal sand ripples, 0: none
  double ripple_wavelength_m = 0.2;
  double ripple_direction_deg = 0;  ///< compass direction of the wave vector (across the crests)
};

struct RasterTerrain {
  std::filesystem::path file;                ///< already resolved against the scene file's folder
  std::optional<std::array<int, 4>> window;  ///< column, row, columns, rows (from the north-west corner)
  int decimate = 1;                          ///< keep every n-th row and column
  double resolution_m = 0;                   ///< of a BAG of variable resolution; 0: every node
  bool depth_positive_down = false;          ///< values are depths, not heights
  std::string load = "auto";                 ///< auto | whole | tiles (docs/big-terrain.md)
};

/// What a material map calls a material, and what the scene calls it.
struct MaterialClass {
  std::string value, material;
  SourcePlace place;
};
struct RasterMaterialMap {
  std::filesystem::path file;
  std::vector<MaterialClass> classes;             ///< values are whole numbers
  std::optional<std::array<double, 2>> origin_m;  ///< east, north of the raster's south-west corner
  std::optional<double> cell_m;                   ///< goes with origin_m
};
struct PolygonMaterialMap {
  std::filesystem::path file;
  std::optional<std::string> layer;
  std::string attribute = "material";
  std::vector<MaterialClass> classes;  ///< empty: the attribute names the materials themselves
  std::string overlaps = "last";       ///< last | first: which of two polygons counts
  std::string coordinates = "crs";     ///< crs | local: local metres, whatever CRS the file states
};
struct MaterialShare {
  std::string material;
  double share = 0;
  SourcePlace place;
};
/// Seeded patches: the cells of the Voronoi diagram of one point in each square of a lattice.
struct PatchMaterialMap {
  double patch_size_m = 0;
  std::vector<MaterialShare> shares;
  std::uint64_t seed = 1;
};
struct MaterialMapDescription {
  SourcePlace place;
  std::variant<RasterMaterialMap, PolygonMaterialMap, PatchMaterialMap> kind;
};

struct TerrainDescription {
  SourcePlace place;
  std::string name = "terrain";
  std::string material;
  SourcePlace material_place;
  std::optional<MaterialMapDescription> material_map;  ///< `material` is what it leaves out
  std::variant<FlatTerrain, FractalTerrain, RasterTerrain> kind;
  std::shared_ptr<const ComponentMesh> facets;  ///< given in memory, in place of `kind`; else null
};

struct MeshFile {
  std::filesystem::path file;
  std::optional<std::string> up;         ///< the file's axis that is up: x | y | z; else what the file says
  std::optional<double> unit_m;          ///< metres in one of the file's units; else what the file says
  std::vector<MaterialClass> materials;  ///< by the names that the mesh gives to its faces
};
struct SpherePrimitive {
  double radius_m = 1;
};
struct CylinderPrimitive {
  double radius_m = 1, height_m = 1;
};  ///< along z, closed
struct ConePrimitive {
  double radius_m = 1, top_radius_m = 0, height_m = 1;
};  ///< along z, closed
struct BoxPrimitive {
  std::array<double, 3> size_m{1, 1, 1};
};

struct ObjectDescription {
  SourcePlace place;
  std::string name;
  std::string material;
  SourcePlace material_place;
  std::variant<MeshFile, SpherePrimitive, CylinderPrimitive, ConePrimitive, BoxPrimitive> kind;
  std::shared_ptr<const ComponentMesh> facets;  ///< given in memory, in place of `kind`; else null
  std::array<double, 3> position_m{0, 0, 0};    ///< of the primitive's centre / the file's origin
  std::optional<std::array<double, 2>> position_lat_lon_deg;  ///< instead of x and y of position_m
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
  std::array<double, 3> scale{1, 1, 1};
  /// Largest distance between a curved primitive and its facets; else as fine as sensors see
  /// (facet_fineness.hpp).
  std::optional<double> chord_error_m;
  /// Put the object's lowest point this far above the terrain below its position (position z is then
  /// ignored).
  std::optional<double> on_terrain_m;
};

/// Pose of the carrier: position in the local frame, heading clockwise from north, pitch bow up,
/// roll starboard down.
struct FixedTrajectory {
  std::array<double, 3> position_m{0, 0, 0};
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
};
struct LineTrajectory {
  std::array<double, 3> start_m{0, 0, 0}, end_m{0, 0, 0};  ///< heading follows the line
  double speed_m_s = 1;
  double pitch_deg = 0, roll_deg = 0;
};
/// CSV with a header line: time_s, east_m, north_m, up_m, heading_deg, pitch_deg, roll_deg.
struct WaypointTrajectory {
  std::filesystem::path file;
};

struct TrajectoryDescription {
  SourcePlace place;
  std::string name = "trajectory";
  std::variant<FixedTrajectory, LineTrajectory, WaypointTrajectory> kind;
};

/// Acoustic camera: a fan of beams side by side, one elevation cell.
struct DidsonDescription {
  double frequency_khz = 1800;
  int beams = 96;
  /// even: equal cells over `horizontal_deg` | lens: where the lens of a DIDSON has its 48 or 96 beams
  std::string beam_centres = "even";
  double horizontal_deg = 29, vertical_deg = 14;  ///< receive sector
  /// Transmit sector, about the same axis; without it, the receive sector. Tubes cover what both look at.
  std::optional<double> transmit_horizontal_deg, transmit_vertical_deg;
  /// With a receive pattern: how far the sector that is lit and heard reaches beyond the outermost beams.
  double receive_margin_deg = 0;
  int cycles = 1;                          ///< shots of a frame: beam b belongs to cycle b mod cycles
  std::optional<double> cycle_interval_s;  ///< else as long as the echo of the window's end takes, and 420 us
  std::vector<int> firing_order;           ///< cycles as they follow one another; empty: 0, 1, 2, ...
  std::optional<std::string> transmit_steering;  ///< fan | beams; else beams if there are cycles
  int samples = 512;
  double window_start_m = 0.84, window_length_m = 5;
  std::string pictures = "all";  ///< all | sequence
};
/// Two fans about the along-track axis, port (beam 0) and starboard (beam 1).
struct SidescanDescription {
  double frequency_khz = 455;
  double along_track_deg = 0.5;                            ///< one-way width of the ideal rectangular beam
  double depression_min_deg = 2, depression_max_deg = 85;  ///< the fan's limits below the horizontal
  std::optional<double> axis_depression_deg;               ///< what patterns are about; else the fan's middle
  int samples = 1000;
  std::optional<double> sampling_frequency_khz;  ///< instead of samples: each is c / (2 f) long
  double range_min_m = 0.5, range_max_m = 50;
};
/// Imaging or forward-looking sonar: `beams` equal azimuth cells over `horizontal_deg`, one elevation cell.
struct ImagingDescription {
  double frequency_khz = 700;
  int beams = 256;
  double horizontal_deg = 130, vertical_deg = 20;
  int samples = 512;
  double range_min_m = 0.5, range_max_m = 20;
};
/// One beam straight down. Where no patterns are given it sends and hears with a Gaussian about its axis.
struct EchosounderDescription {
  double frequency_khz = 200;
  double beam_deg = 7;               ///< full one-way width at -3 dB
  std::optional<double> sector_deg;  ///< side of the square that is looked at; none: three beam widths
  int samples = 1000;
  double range_min_m = 0.5, range_max_m = 50;
  std::string detection = "energy_centroid";  ///< first_return | energy_centroid | maximum
  double detection_threshold_db = -20;        ///< of samples that count, over the largest
};
/// Sidescan whose two receivers a side sit on a staff, above and below the transmitter.
struct InterferometricDescription : SidescanDescription {
  double baseline_m = 0.012;   ///< from receiver to receiver
  double staff_tilt_deg = 30;  ///< of the direction that the staff faces, below the horizontal
  bool phase_noise = false;    ///< soundings from phases with the noise of a single look
};

/// Multibeam echosounder: a fan of beams across the track, beam 0 port-most.
struct MultibeamDescription {
  double frequency_khz = 240;
  int beams = 101;
  double swath_deg = 150;                               ///< between the axes of the outermost beams
  std::string spacing = "angle";                        ///< angle | distance: what is equal from beam to beam
  double beam_across_deg = 1.5, along_track_deg = 1.5;  ///< one-way widths of the ideal rectangular beam
  int samples = 2000;
  double range_min_m = 0.5, range_max_m = 100;
  std::string detection = "energy_centroid";  ///< first_return | energy_centroid | maximum
  double detection_threshold_db = -20;        ///< of samples that count, over the beam's largest
  double grid_cell_m = 0;                     ///< of the depth grid; 0: chosen
};

/// Beam pattern (power) of a transmitter or a receiver.
struct PatternDescription {
  std::string pattern = "none";      ///< none | line | piston | gaussian | table
  std::string angle = "azimuth";     ///< azimuth | elevation | off_axis: what all but piston depend on
  std::optional<double> aperture_m;  ///< line: length; piston: diameter
  std::optional<double> width_deg;   ///< gaussian: full one-way width at -3 dB
  std::optional<std::filesystem::path> file;  ///< table
  SourcePlace file_place;
};

/// What the receiver makes of the echoes in the files that a sonar would write; echoes.nc keeps the energies.
struct SignalDescription {
  double source_level_db = 210;          ///< dB re 1 uPa at 1 m
  std::optional<double> noise_level_db;  ///< dB re 1 uPa in the receiver's band
  std::string speckle = "none";          ///< none | rayleigh | k
  int speckle_looks = 1;
  double speckle_shape = 1;             ///< nu of the K law
  std::optional<double> tvg_spreading;  ///< Sp of the gain Sp log10 R + 2 alpha R + G; none: no gain
  std::optional<double> tvg_absorption_db_per_km;  ///< alpha; else the water's own
  double tvg_gain_db = 0;
  double tvg_fixed_below_m = 10;          ///< nearer than this the gain stays what it is here
  std::optional<double> pulse_length_us;  ///< echoes are spread over c tau / 2; none: not spread
};

struct SensorDescription {
  SourcePlace place;
  std::string name;
  std::string preset = "none";  ///< of sensor_presets(); its keys are in here already
  std::string trajectory;       ///< may be empty when the scene has just one
  SourcePlace trajectory_place;
  std::array<double, 3> lever_arm_m{0, 0, 0};  ///< starboard, forward, up from the carrier's reference point
  std::optional<std::array<double, 3>> receiver_arm_m;  ///< of a receiver apart from the transmitter
  double yaw_deg = 0, tilt_deg = 0, roll_deg = 0;       ///< mounting: yaw to starboard, tilt downwards, roll
  double first_ping_s = 0;
  int pings = 1;
  double ping_interval_s = 0.1;
  /// How far off a beam's height may be, relative, as its cones are cut by planes (angles.hpp).
  double cone_tolerance = 4.5e-5;
  PatternDescription transmit, receive;
  SignalDescription signal;
  std::variant<DidsonDescription, SidescanDescription, MultibeamDescription, ImagingDescription,
               EchosounderDescription, InterferometricDescription>
      kind;
};

/// How the materials' relief gets into facets.
struct RefinementDescription {
  SourcePlace place;
  std::string mode = "online";        ///< online | offline | off
  std::optional<double> cell_m;       ///< else the finest detail of all relief
  std::string displace = "vertical";  ///< vertical | normal
  /// Online: RMS change of a range sample's energy, relative; 0: cells everywhere; none: 0.01, unless a run
  /// is asked for a tolerance.
  std::optional<double> tolerance;
  std::optional<std::string>
      file;  ///< offline: of 'tubefoot refine', resolved; it is no part of the scene hash
  SourcePlace file_place;
};

struct RunDescription {
  SourcePlace place;
  std::string start_utc = "2000-01-01T00:00:00Z";  ///< of the scene's time 0 (unix_time_s)
  std::string engine = "tube";                     ///< tube | ray
  std::string arithmetic = "fixed";                ///< fixed | filtered | rational | double
  std::string binning = "exact";              ///< exact | spread | centroid: footprints into range samples
  std::int64_t facets_per_split = 64;         ///< VisibilityOptions::facets_per_split
  double zero_tolerance = 0;                  ///< VisibilityOptions::tolerance, for double
  std::string sampling = "stratified";        ///< ray engine: stratified | regular | random | column
  std::int64_t rays_per_ping = 100000;        ///< ray engine
  std::optional<std::int64_t> rays_per_beam;  ///< ray engine: instead of rays_per_ping
  std::uint64_t seed = 1;
  std::optional<int> grid_exponent;  ///< unit 2^-k m
  int threads = 0;                   ///< 0: all cores
  int terrain_cache_mb = 512;        ///< of terrain that is read by tiles
};

struct SceneDescription {
  std::filesystem::path file;
  std::string sha256;  ///< of the scene file's text and of every file it names, in order: the scene hash
  /// What that hash is of, the scene file first, then every file that it names, with those that are read
  /// along.
  std::vector<std::filesystem::path> inputs;
  /// Those of them that lie outside of its folder, as messages; refused if it is `confined`.
  std::vector<std::string> outside;
  bool confined = false;
  std::string title;
  std::optional<GeoreferenceDescription> georeference;
  WaterDescription water;
  std::optional<SeaSurfaceDescription> sea_surface;
  PathsDescription paths;
  std::vector<MaterialDescription> materials;
  std::vector<TerrainDescription> terrains;
  std::vector<ObjectDescription> objects;
  std::vector<TrajectoryDescription> trajectories;
  std::vector<SensorDescription> sensors;
  RefinementDescription refinement;
  RunDescription run;
};

/// Reads and checks a scene file: keys, types, ranges, names that refer to each other, files that must exist.
/// Throws InputError "scene.toml:12:5: ..." that says what was expected. `confined`: what lies outside of the
/// scene file's folder, links followed, is refused; else it is noted.
SceneDescription read_scene_file(const std::filesystem::path& file, bool confined = false);
/// The same from a text, as if it stood in `file`: relative paths start from that one's folder, and messages
/// name it. It need not exist.
SceneDescription read_scene_text(const std::string& text, const std::filesystem::path& file,
                                 bool confined = false);

}  // namespace tubefoot
