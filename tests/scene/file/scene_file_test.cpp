// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that scene files are read completely: every key with its value, defaults and inline tables. For
// damaged input the result is a scene or an InputError.

#include "sensors/kinds/scene_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "fixtures/full_scene.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "scene/file/scene_file_keys.hpp"
#include "sensors/kinds/kind_didson.hpp"
#include "sensors/kinds/kind_echosounder.hpp"
#include "sensors/kinds/kind_imaging.hpp"
#include "sensors/kinds/kind_interferometric.hpp"
#include "sensors/kinds/kind_sidescan.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Optional;
using testing::StartsWith;

TEST(SceneFile, ReadsEveryKey) {
  const FullSceneFolder folder;
  const SceneDescription scene = read_scene_file(folder.scene_file);
  EXPECT_EQ(scene.file, folder.scene_file);
  EXPECT_EQ(scene.title, "Everything");

  ASSERT_TRUE(scene.georeference);
  EXPECT_THAT(scene.georeference->origin_lat_lon_deg, Optional(ElementsAre(48.5, -4)));
  EXPECT_EQ(scene.georeference->origin_height_m, 51.5);
  EXPECT_EQ(scene.water.sound_speed_m_s, 1480);
  EXPECT_EQ(scene.water.absorption_db_per_km, 320.5);
  EXPECT_EQ(scene.water.temperature_c, 4);
  EXPECT_EQ(scene.water.salinity_psu, 30);
  EXPECT_EQ(scene.water.ph, 7.8);
  EXPECT_EQ(scene.water.depth_m, 120);
  EXPECT_EQ(scene.water.sound_speed_formula, "leroy");
  EXPECT_EQ(scene.water.latitude_deg, -30);
  EXPECT_EQ(scene.water.absorption_model, "ainslie-mccolm");
  EXPECT_EQ(scene.water.profile, "gradient");
  EXPECT_EQ(scene.water.surface_height_m, 2);
  EXPECT_EQ(scene.water.profile_bottom_m, 80);
  EXPECT_EQ(scene.water.gradient_per_s, 0.016);

  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[0].name, "mud");
  EXPECT_EQ(scene.materials[1].name, "steel");
  EXPECT_EQ(scene.materials[0].specular_loss_db, 12);
  EXPECT_EQ(scene.materials[1].lambert_db, -8.5);
  EXPECT_EQ(scene.materials[1].specular_loss_db, std::nullopt);

  ASSERT_EQ(scene.targets.size(), 2u);
  EXPECT_EQ(scene.targets[0].name, "tuna");
  EXPECT_THAT(scene.targets[0].position_m, ElementsAre(3, 4, -5));
  EXPECT_EQ(scene.targets[0].strength.target_strength_db, -25.5);
  EXPECT_THAT(scene.targets[1].position_lat_lon_deg, Optional(ElementsAre(48.5, -4.02)));
  ASSERT_TRUE(scene.targets[1].strength.file.has_value());
  EXPECT_TRUE(
      std::filesystem::equivalent(*scene.targets[1].strength.file, folder.outside.path() / "scene/eel.csv"));
  EXPECT_EQ(scene.targets[1].heading_deg, 11);
  EXPECT_EQ(scene.targets[1].pitch_deg, 12);
  EXPECT_EQ(scene.targets[1].roll_deg, 13);
  ASSERT_EQ(scene.target_populations.size(), 1u);
  const TargetPopulationDescription& krill = scene.target_populations[0];
  EXPECT_EQ(krill.name, "krill");
  EXPECT_EQ(krill.density_per_m3, 0.5);
  EXPECT_THAT(krill.centre_m, ElementsAre(7, -8));
  EXPECT_THAT(krill.size_m, ElementsAre(20, 30));
  EXPECT_EQ(krill.top_depth_m, 1.5);
  EXPECT_EQ(krill.bottom_depth_m, 9);
  EXPECT_EQ(krill.strength.target_strength_db, -75);
  EXPECT_EQ(krill.strength_spread_db, 2.5);
  EXPECT_EQ(krill.seed, 31u);

  ASSERT_TRUE(scene.sea_surface.has_value());
  EXPECT_EQ(scene.sea_surface->height_m, 3.5);
  EXPECT_EQ(scene.sea_surface->loss_db, 0.5);
  EXPECT_EQ(scene.sea_surface->rms_roughness_m, 0.25);
  EXPECT_EQ(scene.paths.order, 4);
  EXPECT_EQ(scene.paths.only_order, 3);
  EXPECT_EQ(scene.paths.cutoff_db, 40);
  EXPECT_EQ(scene.paths.scatterings, 2);
  EXPECT_EQ(scene.paths.patch_m, 0.125);
  EXPECT_EQ(scene.paths.most_images, 77);
  EXPECT_TRUE(scene.paths.direct);

  ASSERT_EQ(scene.terrains.size(), 3u);
  EXPECT_EQ(scene.terrains[0].name, "plain");
  EXPECT_EQ(scene.terrains[0].material, "mud");
  const auto& flat = std::get<FlatTerrain>(scene.terrains[0].kind);
  EXPECT_EQ(flat.width_m, 100);
  EXPECT_EQ(flat.length_m, 200);
  EXPECT_THAT(flat.centre_m, ElementsAre(1, 2, -3));
  EXPECT_EQ(flat.cell_m, 0.5);
  const auto& fractal = std::get<FractalTerrain>(scene.terrains[1].kind);
  EXPECT_EQ(fractal.width_m, 50);
  EXPECT_EQ(fractal.length_m, 60);
  EXPECT_THAT(fractal.centre_m, ElementsAre(100, 0, -3));
  EXPECT_EQ(fractal.cell_m, 0.25);
  EXPECT_EQ(fractal.rms_height_m, 0.3);
  EXPECT_EQ(fractal.hurst, 0.6);
  EXPECT_EQ(fractal.largest_wavelength_m, 12);
  EXPECT_EQ(fractal.seed, 9223372036854775807u);
  EXPECT_EQ(fractal.ripple_height_m, 0.05);
  EXPECT_EQ(fractal.ripple_wavelength_m, 0.75);
  EXPECT_EQ(fractal.ripple_direction_deg, 45);
  const auto& raster = std::get<RasterTerrain>(scene.terrains[2].kind);
  EXPECT_TRUE(std::filesystem::equivalent(raster.file, folder.outside.path() / "grids/chart.tif"));
  EXPECT_THAT(raster.window, Optional(ElementsAre(10, 20, 300, 400)));
  EXPECT_EQ(raster.decimate, 3);
  EXPECT_TRUE(raster.depth_positive_down);
  EXPECT_EQ(raster.load, "whole");

  const auto& classes = std::get<RasterMaterialMap>(scene.terrains[0].material_map.value().kind);
  EXPECT_TRUE(std::filesystem::equivalent(classes.file, folder.outside.path() / "grids/classes.tif"));
  ASSERT_EQ(classes.classes.size(), 2u);
  EXPECT_EQ(classes.classes[0].value, "-2");
  EXPECT_EQ(classes.classes[0].material, "steel");
  EXPECT_EQ(classes.classes[1].value, "7");
  EXPECT_THAT(classes.origin_m, Optional(ElementsAre(-50, -100)));
  EXPECT_EQ(classes.cell_m, 0.25);
  const auto& areas = std::get<PolygonMaterialMap>(scene.terrains[1].material_map.value().kind);
  EXPECT_TRUE(std::filesystem::equivalent(areas.file, folder.outside.path() / "grids/areas.geojson"));
  EXPECT_EQ(areas.layer, "areas");
  EXPECT_EQ(areas.attribute, "kind");
  ASSERT_EQ(areas.classes.size(), 1u);
  EXPECT_EQ(areas.classes[0].value, "Silty mud");
  EXPECT_EQ(areas.overlaps, "first");
  EXPECT_EQ(areas.coordinates, "local");
  const auto& patches = std::get<PatchMaterialMap>(scene.terrains[2].material_map.value().kind);
  EXPECT_EQ(patches.patch_size_m, 12.5);
  EXPECT_EQ(patches.seed, 44u);
  ASSERT_EQ(patches.shares.size(), 2u);
  EXPECT_EQ(patches.shares[0].material, "mud");
  EXPECT_EQ(patches.shares[0].share, 3);

  ASSERT_EQ(scene.objects.size(), 5u);
  const ObjectDescription& wreck = scene.objects[0];
  EXPECT_EQ(wreck.name, "wreck");
  EXPECT_EQ(wreck.material, "steel");
  EXPECT_EQ(std::get<MeshFile>(wreck.kind).file, folder.outside.path() / "scene/wreck.obj");
  EXPECT_EQ(std::get<MeshFile>(wreck.kind).up, "y");
  EXPECT_EQ(std::get<MeshFile>(wreck.kind).unit_m, 0.01);
  ASSERT_EQ(std::get<MeshFile>(wreck.kind).materials.size(), 1u);
  EXPECT_EQ(std::get<MeshFile>(wreck.kind).materials[0].value, "Oak planks");
  EXPECT_EQ(std::get<MeshFile>(wreck.kind).materials[0].material, "steel");
  EXPECT_THAT(wreck.position_m, ElementsAre(5, 6, -7));
  EXPECT_THAT(wreck.position_lat_lon_deg, Optional(ElementsAre(48.51, -4.01)));
  EXPECT_EQ(wreck.on_terrain_m, -0.5);
  EXPECT_EQ(wreck.heading_deg, 10);
  EXPECT_EQ(wreck.pitch_deg, -20);
  EXPECT_EQ(wreck.roll_deg, 30);
  EXPECT_THAT(wreck.scale, ElementsAre(0.001, 0.002, 0.003));
  EXPECT_EQ(std::get<SpherePrimitive>(scene.objects[1].kind).radius_m, 0.2);
  EXPECT_EQ(scene.objects[1].chord_error_m, 0.001);
  EXPECT_EQ(std::get<CylinderPrimitive>(scene.objects[2].kind).radius_m, 0.3);
  EXPECT_EQ(std::get<CylinderPrimitive>(scene.objects[2].kind).height_m, 4);
  EXPECT_EQ(scene.objects[2].chord_error_m, 0.002);
  EXPECT_EQ(std::get<ConePrimitive>(scene.objects[3].kind).radius_m, 0.8);
  EXPECT_EQ(std::get<ConePrimitive>(scene.objects[3].kind).top_radius_m, 0.4);
  EXPECT_EQ(std::get<ConePrimitive>(scene.objects[3].kind).height_m, 0.6);
  EXPECT_EQ(scene.objects[3].chord_error_m, 0.003);
  EXPECT_THAT(std::get<BoxPrimitive>(scene.objects[4].kind).size_m, ElementsAre(2, 3, 4));

  ASSERT_EQ(scene.trajectories.size(), 3u);
  EXPECT_EQ(scene.trajectories[0].name, "tripod");
  const auto& fixed = std::get<FixedTrajectory>(scene.trajectories[0].kind);
  EXPECT_THAT(fixed.position_m, ElementsAre(0, 0, 2));
  EXPECT_EQ(fixed.heading_deg, 90);
  EXPECT_EQ(fixed.pitch_deg, 1);
  EXPECT_EQ(fixed.roll_deg, 2);
  const auto& line = std::get<LineTrajectory>(scene.trajectories[1].kind);
  EXPECT_THAT(line.start_m, ElementsAre(-10, 0, 5));
  EXPECT_THAT(line.end_m, ElementsAre(10, 0, 5));
  EXPECT_EQ(line.speed_m_s, 2.5);
  EXPECT_EQ(line.pitch_deg, 3);
  EXPECT_EQ(line.roll_deg, 4);
  EXPECT_EQ(std::get<WaypointTrajectory>(scene.trajectories[2].kind).file,
            folder.outside.path() / "scene/track.csv");

  ASSERT_EQ(scene.sensors.size(), 5u);
  const SensorDescription& camera = scene.sensors[0];
  EXPECT_EQ(camera.name, "camera");
  EXPECT_EQ(camera.trajectory, "tripod");
  EXPECT_THAT(camera.lever_arm_m, ElementsAre(0.1, 0.2, 0.3));
  EXPECT_THAT(camera.receiver_arm_m, Optional(ElementsAre(0.5, -1.25, 2)));
  EXPECT_EQ(camera.yaw_deg, 5);
  EXPECT_EQ(camera.tilt_deg, 25);
  EXPECT_EQ(camera.roll_deg, 6);
  EXPECT_EQ(camera.first_ping_s, 1.5);
  EXPECT_EQ(camera.pings, 7);
  EXPECT_EQ(camera.ping_interval_s, 0.25);
  EXPECT_EQ(camera.shadow, "fresnel");
  EXPECT_EQ(camera.cone_tolerance, 1e-6);
  const auto& didson = camera.kind.as<DidsonDescription>();
  EXPECT_EQ(didson.frequency_khz, 1100);
  EXPECT_EQ(didson.beams, 48);
  EXPECT_EQ(didson.horizontal_deg, 28);
  EXPECT_EQ(didson.beam_centres, "even");
  EXPECT_EQ(didson.cycles, 4);
  EXPECT_EQ(didson.cycle_interval_s, 0.02);
  EXPECT_EQ(didson.firing_order, (std::vector<int>{0, 2, 1, 3}));
  EXPECT_EQ(didson.transmit_steering, "fan");
  EXPECT_EQ(didson.receive_margin_deg, 2);
  EXPECT_EQ(didson.pictures, "sequence");
  EXPECT_EQ(didson.vertical_deg, 12);
  EXPECT_EQ(didson.transmit_horizontal_deg, 27);
  EXPECT_EQ(didson.transmit_vertical_deg, 11);
  EXPECT_EQ(didson.samples, 256);
  EXPECT_EQ(didson.window_start_m, 2);
  EXPECT_EQ(didson.window_length_m, 10);
  EXPECT_EQ(scene.sensors[1].name, "fish_1-B");
  EXPECT_EQ(scene.sensors[1].trajectory, "track");
  const auto& sidescan = scene.sensors[1].kind.as<SidescanDescription>();
  EXPECT_EQ(sidescan.frequency_khz, 900);
  EXPECT_EQ(sidescan.along_track_deg, 0.2);
  EXPECT_EQ(sidescan.depression_min_deg, 5);
  EXPECT_EQ(sidescan.depression_max_deg, 80);
  EXPECT_EQ(sidescan.samples, 2000);
  EXPECT_EQ(sidescan.range_min_m, 1);
  EXPECT_EQ(sidescan.range_max_m, 75);
  const auto& imaging = scene.sensors.at(2).kind.as<ImagingDescription>();
  EXPECT_EQ(imaging.frequency_khz, 1200);
  EXPECT_EQ(imaging.beams, 130);
  EXPECT_EQ(imaging.horizontal_deg, 60);
  EXPECT_EQ(imaging.vertical_deg, 12);
  EXPECT_EQ(imaging.samples, 300);
  EXPECT_EQ(imaging.range_min_m, 0.2);
  EXPECT_EQ(imaging.range_max_m, 9);
  const auto& sounder = scene.sensors.at(3).kind.as<EchosounderDescription>();
  EXPECT_EQ(sounder.frequency_khz, 38);
  EXPECT_EQ(sounder.beam_deg, 12);
  EXPECT_EQ(sounder.sector_deg, 50);
  EXPECT_EQ(sounder.samples, 400);
  EXPECT_EQ(sounder.range_min_m, 3);
  EXPECT_EQ(sounder.range_max_m, 90);
  EXPECT_EQ(sounder.detection, "first_return");
  EXPECT_EQ(sounder.detection_threshold_db, -10);
  const SignalDescription& signal = scene.sensors[3].signal;
  EXPECT_EQ(signal.source_level_db, 205);
  EXPECT_EQ(signal.noise_level_db, 90);
  EXPECT_EQ(signal.speckle, "k");
  EXPECT_EQ(signal.speckle_looks, 3);
  EXPECT_EQ(signal.speckle_shape, 0.5);
  EXPECT_EQ(signal.tvg_spreading, 40);
  EXPECT_EQ(signal.tvg_absorption_db_per_km, 12);
  EXPECT_EQ(signal.tvg_gain_db, 6);
  EXPECT_EQ(signal.quantisation_bits, 12);
  EXPECT_EQ(signal.quantisation_bottom_db, 60);
  EXPECT_EQ(signal.quantisation_top_db, 140);
  EXPECT_EQ(scene.sensors[4].preset, "geoswath-500");
  const auto& swath = scene.sensors.at(4).kind.as<InterferometricDescription>();
  EXPECT_EQ(swath.frequency_khz, 500);
  EXPECT_EQ(swath.along_track_deg, 0.9);
  EXPECT_EQ(swath.range_max_m, 120);
  EXPECT_EQ(swath.baseline_m, 0.02);
  EXPECT_EQ(swath.receiver_pair_tilt_deg, 35);
  EXPECT_TRUE(swath.phase_noise);

  EXPECT_EQ(scene.run.start_utc, "2024-02-29T12:00:00Z");
  EXPECT_EQ(scene.run.engine, "ray");
  EXPECT_EQ(scene.run.arithmetic, "filtered");
  EXPECT_EQ(scene.run.binning, "spread");
  EXPECT_EQ(scene.run.facets_per_split, 24);
  EXPECT_EQ(scene.run.zero_tolerance, 1e-14);
  EXPECT_EQ(scene.run.sampling, "column");
  EXPECT_EQ(scene.run.rays_per_ping, 5000);
  EXPECT_FALSE(scene.run.rays_per_beam);
  EXPECT_EQ(scene.run.seed, 99u);
  EXPECT_EQ(scene.run.grid_exponent, 16);
  EXPECT_EQ(scene.run.threads, 3);
  EXPECT_EQ(scene.run.terrain_cache_mb, 700);
}

TEST(SceneFile, RaysMayBeCountedByBeam) {
  const FullSceneFolder folder(replaced(full_scene, "rays_per_ping = 5000", "rays_per_beam = 17000"));
  EXPECT_EQ(read_scene_file(folder.scene_file).run.rays_per_beam, 17000);
}

TEST(SceneFile, ReliefIsRefinedOnlineUnlessItSaysOtherwise) {
  const FullSceneFolder folder;
  const RefinementDescription full = read_scene_file(folder.scene_file).refinement;
  EXPECT_EQ(full.mode, "offline");
  EXPECT_EQ(full.cell_m, 0.03);
  EXPECT_EQ(full.displace, "normal");
  EXPECT_FALSE(full.tolerance.has_value());
  EXPECT_EQ(full.file, (folder.scene_file.parent_path() / "bed.ply").string());
  const FullSceneFolder online(
      replaced(replaced(full_scene, "mode = \"offline\"", "tolerance = 0.2"), "file = \"bed.ply\"", ""));
  EXPECT_EQ(read_scene_file(online.scene_file).refinement.mode, "online");
  EXPECT_EQ(read_scene_file(online.scene_file).refinement.tolerance, 0.2);
  const FullSceneFolder both(replaced(full_scene, "mode = \"offline\"", "mode = \"online\""));
  EXPECT_THROW(read_scene_file(both.scene_file), InputError);
  const FullSceneFolder idle(replaced(full_scene, "cell_m = 0.03", "tolerance = 0.2"));
  EXPECT_THROW(read_scene_file(idle.scene_file), InputError);
}

TEST(SceneFile, GeoreferenceMayBeAProjectedSystem) {
  const FullSceneFolder folder(replaced(full_scene, "origin_lat_lon_deg = [48.5, -4]",
                                        "crs = \"EPSG:32602\"\norigin_crs = [573000, 6012345.5]"));
  const SceneDescription scene = read_scene_file(folder.scene_file);
  ASSERT_TRUE(scene.georeference);
  EXPECT_FALSE(scene.georeference->origin_lat_lon_deg);
  EXPECT_EQ(scene.georeference->crs, "EPSG:32602");
  EXPECT_THAT(scene.georeference->origin_crs, Optional(ElementsAre(573000, 6012345.5)));
}

// Keeps the previous test complete: a new key must be added to the full scene.
TEST(SceneFile, FullSceneOfThisTestHasEveryKey) {
  const std::string text = "\n" + std::string(full_scene) +
                           // of the tests after it
                           "\ncrs = \norigin_crs = \nrays_per_beam = \ntolerance = "
                           "\nmaterial_map = "  // as separate tables
                           "\nswath_deg = \nspacing = \nbeam_across_deg = \ndetection = "
                           "\ndetection_threshold_db = \ngrid_cell_m = "  // multibeam_keys_test.cpp
                           "\naxis_depression_deg = \nsampling_frequency_khz = \npulse_length_us = "
                           "\ntvg_fixed_below_m = "                             // sidescan_keys_test.cpp
                           "\noctaves = \npersistence = \ndepth = \nvalues = "  // reflectivity_keys_test.cpp
                           "\ntile_m = \nresolution_m = \nspectral_exponent = \nspectral_strength_cm4 = "
                           "\nwavelength_m = \ndirection_deg = "  // relief_keys_test.cpp
                           "\nlaw = \nspecular_db = \nspecular_width_deg = \noblique_db = "
                           "\noblique_exponent = \ntransition_db = \ntransition_width_deg = "
                           "\ntable_grazing_deg = \ntable_db = \ntable_file = \nsediment = "
                           "\nsediment_khz = \nunbounded = "  // scattering_keys_test.cpp
                           "\nsmooth = \nreflection = \nfluid = \ngrain_size_phi = "
                           "\nroughness_m = "  // smooth_keys_test.cpp
                           "\nbandwidth_khz = \npulse_taper = \nbaseband_khz = \nreceivers = "
                           "\nreceiver_spacing_m = \nreceivers_m = \nstop_and_hop = \nown_sights = "
                           "\nsignal_tolerance = \nproducts = \nformats = \nbeams_deg = "
                           "\nbeams_depression_deg = \nbeams_plane = \nsides = \nbeam_window = "
                           "\nrange_window = \nping_window = \npicture_m = \npicture_up_m = "
                           "\npixel_m = \nhalf_beam_deg = \nupper = \nlower = \nlooks_range = "
                           "\nlooks_pings = \ntexture = \ntexture_shape = "
                           "\ntexture_cell_m = "  // array_keys_test.cpp
                           "\nprofile_step_m = \nmunk_axis_m = \nmunk_scale_m = \nmunk_epsilon = "
                           "\nprofile_file = \nprofile_error_m_s = \nvolume_scattering_db = "
                           "\nvolume_scattering_file = "  // water_keys_test.cpp
                           "\nslope_deg = \nslope_heading_deg = \nturn_s = \ncentre_lat_lon_deg = "
                           "\ncentre_crs = \nspacing_m = \none_way = \nup_m = \naltitude_m = "
                           "\nwater = \nprocessing = \nsound_speed_at_transducer_m_s = \nlatency_s = "
                           "\nattitude_latency_s = \ntide_m = \ntide_file = \nattitude_bias_deg = "
                           "\nattitude_drift_deg_per_hour = \nattitude_noise_deg = \nposition_bias_m = "
                           "\nposition_drift_m_per_hour = \nposition_noise_m = "  // processing_keys_test.cpp
                           "\nmotion_step_beams = \nreceive_along_track_deg = \nstabilisation = "
                           "\nstabilisation_heading_s = "  // motion_keys_test.cpp
                           "\nping_times_s = "             // ping_times_keys_test.cpp
                           "\nsector_edges_deg = \nsector_frequencies_khz = \nsector_tilts_deg = "
                           "\nsector_delays_us = \nsector_pulse_lengths_us = "
                           "\nsector_absorptions_db_per_km = "  // multibeam_sectors_test.cpp
                           "\naltitude_step_m = \nlook_at_m = \ndisplay_gain_db = "  // track_keys_test.cpp
                           "\nscan_deg = \nstep_deg = \nbeam_horizontal_deg = \nbeam_vertical_deg = "
                           "\nstep_interval_s = \nbeam_angles_deg = "  // robot_sonar_keys_test.cpp
                           "\nwind_speed_m_s = \nwind_direction_deg = \nspectrum = \nfetch_m = "
                           "\nspreading = \nscattering_khz = ";  // SeaSurfaceWithFacetsHasKeysOfItsOwn
  for (const SceneKey& key : scene_file_keys()) {
    // Not all keys of a beam pattern can be combined: beam_pattern_keys_test.cpp reads them.
    if (key.section == "[[sensors]]" && key.kind.empty() &&
        (key.name.starts_with("transmit_") || key.name.starts_with("receive_")))
      continue;
    EXPECT_NE(text.find("\n" + key.name + " = "), std::string::npos) << key.section << " " << key.name;
  }
}

TEST(SceneFile, SeaSurfaceWithFacetsHasKeysOfItsOwn) {
  const TestFolder folder;
  const auto sea = [&](const std::string& keys) {
    return *read_scene(folder, std::string(smallest_scene) + "[sea_surface]\n" + keys).sea_surface;
  };
  const SeaSurfaceDescription flat = sea("height_m = 9\n");
  EXPECT_FALSE(flat.has_facets());
  EXPECT_FALSE(flat.rms_roughness_m);
  const SeaSurfaceDescription waves =
      sea("height_m = 9\nsize_m = [40, 50]\ncentre_m = [1, -2]\ncell_m = 0.25\nwind_speed_m_s = 7\n"
          "wind_direction_deg = 225\nspectrum = \"jonswap\"\nfetch_m = 8000\nspreading = 4\nseed = 12\n"
          "material = \"sand\"\n");
  EXPECT_TRUE(waves.has_facets());
  EXPECT_THAT(waves.size_m, Optional(ElementsAre(40, 50)));
  EXPECT_THAT(waves.centre_m, ElementsAre(1, -2));
  EXPECT_EQ(waves.cell_m, 0.25);
  EXPECT_EQ(waves.wind_speed_m_s, 7);
  EXPECT_EQ(waves.wind_direction_deg, 225);
  EXPECT_EQ(waves.spectrum, "jonswap");
  EXPECT_EQ(waves.fetch_m, 8000);
  EXPECT_EQ(waves.spreading, 4);
  EXPECT_EQ(waves.seed, 12u);
  EXPECT_EQ(waves.material, "sand");
  EXPECT_EQ(sea("size_m = [4, 5]\nwind_speed_m_s = 7\nscattering_khz = 38\n").scattering_khz, 38);

  const auto error = [&](const std::string& keys) {
    return scene_error(folder, std::string(smallest_scene) + "[sea_surface]\n" + keys);
  };
  EXPECT_THAT(error("wind_speed_m_s = 7\n"),
              HasSubstr("13:18: 'wind_speed_m_s' applies only to a sea surface "
                        "with facets: add 'size_m'"));
  EXPECT_THAT(error("size_m = [4, 5]\n"), HasSubstr("needs the key 'wind_speed_m_s'"));
  EXPECT_THAT(error("size_m = [4, 5]\nwind_speed_m_s = 7\nspectrum = \"jonswap\"\n"),
              HasSubstr("15:12: spectrum = \"jonswap\" needs the key 'fetch_m'"));
  EXPECT_THAT(error("size_m = [4, 5]\nwind_speed_m_s = 7\nfetch_m = 800\n"),
              HasSubstr("15:11: 'fetch_m' belongs to spectrum = \"jonswap\""));
  EXPECT_THAT(error("size_m = [4, 5]\nwind_speed_m_s = 7\nmaterial = \"sand\"\nscattering_khz = 30\n"),
              HasSubstr("which 'material' replaces"));
  EXPECT_THAT(error("size_m = [4, 5]\nwind_speed_m_s = 7\nmaterial = \"send\"\n"),
              HasSubstr("did you mean \"sand\"?"));
}

TEST(SceneFile, PlacesTellWhereThingsStand) {
  const FullSceneFolder folder;
  const SceneDescription scene = read_scene_file(folder.scene_file);
  const std::string file = folder.scene_file.string();
  EXPECT_EQ(to_string(scene.georeference->place), file + ":3:1");
  EXPECT_EQ(to_string(scene.water.place), file + ":7:1");
  EXPECT_EQ(to_string(scene.materials[1].place), file + ":30:1");
  EXPECT_EQ(to_string(scene.terrains[0].place), file + ":34:1");
  EXPECT_EQ(to_string(scene.terrains[0].material_place), file + ":37:12");
  EXPECT_EQ(to_string(scene.objects[0].material_place), file + ":94:12");
  EXPECT_EQ(to_string(scene.sensors[0].trajectory_place), file + ":162:14");
}

TEST(SceneFile, LeavesTheRestAtTheDefaults) {
  const TestFolder folder;
  const SceneDescription scene = read_scene(folder, smallest_scene);
  EXPECT_EQ(scene.title, "");
  EXPECT_FALSE(scene.georeference);
  EXPECT_FALSE(scene.water.sound_speed_m_s);
  EXPECT_FALSE(scene.water.absorption_db_per_km);
  EXPECT_EQ(scene.water.temperature_c, 10);
  EXPECT_EQ(scene.water.salinity_psu, 35);
  EXPECT_EQ(scene.water.ph, 8);
  EXPECT_EQ(scene.water.depth_m, 10);
  EXPECT_EQ(to_string(scene.water.place), (folder.path() / "scene.toml").string());
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].lambert_db, -27);
  ASSERT_EQ(scene.terrains.size(), 1u);
  EXPECT_EQ(scene.terrains[0].name, "terrain");
  EXPECT_EQ(std::get<FlatTerrain>(scene.terrains[0].kind).cell_m, 0);
  EXPECT_TRUE(scene.objects.empty());
  ASSERT_EQ(scene.sensors.size(), 1u);
  EXPECT_FALSE(scene.sensors[0].pings);
  const auto& didson = scene.sensors[0].kind.as<DidsonDescription>();
  EXPECT_EQ(didson.beams, 96);
  EXPECT_EQ(didson.horizontal_deg, 29);
  EXPECT_EQ(didson.samples, 512);
  EXPECT_EQ(scene.run.engine, "tube");
  EXPECT_EQ(scene.run.arithmetic, "fixed");
  EXPECT_FALSE(scene.run.grid_exponent);
  EXPECT_EQ(scene.run.threads, 0);
}

TEST(SceneFile, TheOnlyMaterialAndTrajectoryNeedNoNaming) {
  const TestFolder folder;
  const SceneDescription scene = read_scene(folder, smallest_scene);
  EXPECT_EQ(scene.terrains[0].material, "sand");
  EXPECT_EQ(scene.sensors[0].trajectory, "trajectory");
}

TEST(SceneFile, SectionsMayBeInlineSingleOrRepeated) {
  const TestFolder folder;
  const SceneDescription scene =
      read_scene(folder,
                 "materials = [{name = \"a\"}, {name = \"b\", lambert_db = -20}]\n"
                 "water.temperature_c = 5\n"
                 "[terrain]\nkind = \"flat\"\nmaterial = \"a\"\nwidth_m = 1\nlength_m = 1\n"
                 "[[trajectory]]\nkind = \"fixed\"\nname = \"one\"\n"
                 "[[trajectories]]\nkind = \"fixed\"\nname = \"two\"\n"
                 "[[sensors]]\nkind = \"didson\"\nname = \"s\"\ntrajectory = \"two\"\n");
  EXPECT_EQ(scene.materials[1].lambert_db, -20);
  EXPECT_EQ(scene.water.temperature_c, 5);
  EXPECT_EQ(scene.terrains.size(), 1u);
  ASSERT_EQ(scene.trajectories.size(), 2u);
  EXPECT_EQ(scene.trajectories[1].name, "two");
}

TEST(SceneFile, IntegersDoWhereNumbersAreWanted) {
  const TestFolder folder;
  const SceneDescription scene = read_scene(
      folder, replaced(smallest_scene, "kind = \"fixed\"", "kind = \"fixed\"\nposition_m = [1, 2.5, 0x10]"));
  EXPECT_THAT(std::get<FixedTrajectory>(scene.trajectories[0].kind).position_m, ElementsAre(1, 2.5, 16));
}

TEST(SceneFile, PlacesNameTheFileAsItWasGiven) {
  const TestFolder folder;
  std::filesystem::create_directory(folder.path() / "scenes");
  folder.write("scenes/scene.toml", "[water]\ndepth_m = true\n");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  std::string message;
  try {
    read_scene_file("scenes/scene.toml");
  } catch (const InputError& error) {
    message = error.what();
  }
  std::filesystem::current_path(before);
  EXPECT_THAT(message, StartsWith("scenes/scene.toml:2:11: "));
}

TEST(SceneFile, RangesIncludeTheirEndsUnlessTheySayOtherwise) {
  const TestFolder folder;
  const auto camera = [](std::string_view keys) { return std::string(smallest_scene) + std::string(keys); };
  EXPECT_EQ(scene_error(folder,
                        camera("beams = 4096\nsamples = 16384\nvertical_deg = 170\nhorizontal_deg = 179.9")),
            "");
  EXPECT_EQ(scene_error(folder, camera("beams = 1024\nsamples = 65536")), "");
  EXPECT_EQ(scene_error(folder, camera("beams = 1\nsamples = 1\npings = 10000000\ntilt_deg = -90")), "");
  EXPECT_EQ(scene_error(folder, camera("[water]\nsalinity_psu = 0\nsound_speed_m_s = 1300\n")), "");
  EXPECT_EQ(scene_error(folder, camera("[water]\nsalinity_psu = 25\ndepth_m = 8000\ntemperature_c = -2\n")),
            "");
  EXPECT_EQ(scene_error(folder, replaced(smallest_scene, "\"sand\"", "\"sand\"\nlambert_db = -4.9715")), "");
}

// For any bytes the result is a scene, or an InputError that starts with the file name.
TEST(SceneFile, DamagedScenesAreReadOrRefused) {
  const unsigned seed = 20260101;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const FullSceneFolder folder;
  constexpr std::string_view spice = "[]{}\"'=.,#\n\\ -+_e0159nif\x00\xc3\xa9\xff";
  int refused = 0;
  for (int round = 0; round < 1000; ++round) {
    std::string text(full_scene);
    for (std::size_t damage = 1 + below(4); damage > 0; --damage) {
      const std::size_t at = below(text.size());
      switch (below(4)) {
        case 0:
          text[at] = spice[below(spice.size())];
          break;
        case 1:
          text.erase(at, 1 + below(20));
          break;
        case 2:
          text.insert(at, text.substr(below(text.size()), below(40)));
          break;
        default:
          text.insert(at, 1, spice[below(spice.size())]);
      }
    }
    folder.outside.write("scene/scene.toml", text);
    try {
      read_scene_file(folder.scene_file);
    } catch (const InputError& error) {
      ++refused;
      ASSERT_THAT(error.what(), StartsWith(folder.scene_file.string() + ":")) << text;
    }
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace tubefoot
