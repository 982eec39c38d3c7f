// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the moving sea surface. Its facets at a ping equal a mesh at rest of the same heights. Waves do not
// hide mirror images. Sonars and land above the waves are errors or warnings.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/relief/wave_surface.hpp"
#include "engine/scattering/sea_surface_backscatter.hpp"
#include "fixtures/covered.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "scene/scene.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const std::string
    sea_grid = "[run]\ngrid_exponent = 14\n",
    still_sea_water = "[water]\nsound_speed_m_s = 1500\nabsorption_db_per_km = 0\n",
    wavy =
        "[sea_surface]\nsize_m = [24, 20]\ncentre_m = [1, 6]\ncell_m = 0.5\nwind_speed_m_s = 4\n"
        "wind_direction_deg = 200\nseed = 3\n",
    upward = "frequency_khz = 30\ntilt_deg = -40\n";

std::string stratified(double gradient_per_s) {
  return fmt::format(
      "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = {}\n"
      "profile_bottom_m = 40\nabsorption_db_per_km = 0\n",
      gradient_per_s);
}

std::string sea_sonar(int pings, const std::string& more = upward) {
  return fmt::format(
      "[[sensors]]\nname = \"sonar\"\nkind = \"imaging\"\nbeams = 6\nhorizontal_deg = 50\nvertical_deg = 30\n"
      "samples = 80\nrange_min_m = 2\nrange_max_m = 18\npings = {}\nping_interval_s = 0.7\n{}",
      pings, more);
}

std::string sea_scene(int pings, const std::string& sea = wavy, const std::string& more = upward) {
  return still_sea_water + sea + fixed_at(0, 0, -6) + sea_sonar(pings, more) + sea_grid;
}

struct SeaSurfaceRun : testing::Test {
  TestFolder folder;

  Echoes energies(const std::string& scene, std::vector<std::string> arguments = {}) const {
    arguments.insert(arguments.end(), {"--pictures", "none"});
    return echoes_in(folder, scene, arguments);
  }
  std::string message(const std::string& scene) const {
    const Outcome outcome = run_program({"check", folder.write("scene.toml", scene).string()});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    return outcome.err;
  }
  Outcome checked(const std::string& scene) const {
    return run_program({"check", folder.write("scene.toml", scene).string()});
  }
  Scene loaded(const std::string& scene) const {
    return load_scene(read_scene_file(folder.write("scene.toml", scene)));
  }
};

double energy_of_ping(const Echoes& echoes, std::size_t ping) {
  double sum = 0;
  for (std::size_t beam = 0; beam < echoes.beams; ++beam) sum += echoes.beam_total(ping, beam);
  return sum;
}

// A mesh file has the heights of the definition of the waves at the time of the ping.
TEST_F(SeaSurfaceRun, HasTheEchoesOfAMeshOfTheWaves) {
  const std::string rock = lambert_material("rock", -12);
  const Echoes moving = energies(rock + sea_scene(3, wavy + "material = \"rock\"\n"));
  const WaveSurface waves(WaveSpectrum::pierson_moskowitz(4), {200 + 180, 10}, 2, 3);
  for (std::size_t ping = 0; ping < 3; ++ping) {
    std::string obj;
    for (int row = 0; row <= 40; ++row)
      for (int column = 0; column <= 48; ++column) {
        const double east = -11 + 0.5 * column, north = -4 + 0.5 * row;
        double up = 0;
        for (const WaveSurface::Component& c : waves.components())
          up += c.amplitude_m *
                std::cos(c.east_rad_m * east + c.north_rad_m * north -
                         c.frequency_rad_s * 0.7 * static_cast<double>(ping) + std::atan2(c.sine, c.cosine));
        obj += fmt::format("v {} {} {}\n", east, north, up);
      }
    for (int row = 0; row < 40; ++row)
      for (int column = 0; column < 48; ++column) {
        const int a = 49 * row + column + 1, b = a + 1, c = a + 49, d = c + 1;
        obj += (row + column) % 2 == 0 ? fmt::format("f {} {} {}\nf {} {} {}\n", a, c, b, b, c, d)
                                       : fmt::format("f {} {} {}\nf {} {} {}\n", a, c, d, a, d, b);
      }
    folder.write("waves.obj", obj);
    const Echoes at_rest = energies(rock + sea_scene(3,
                                                     "[[objects]]\nname = \"waves\"\nshape = \"mesh\"\n"
                                                     "file = \"waves.obj\"\n"));
    ASSERT_GT(energy_of_ping(at_rest, ping), 0);
    for (std::size_t beam = 0; beam < moving.beams; ++beam)
      for (std::size_t k = 0; k < moving.samples; ++k)
        EXPECT_NEAR(moving.at(ping, beam, k), at_rest.at(ping, beam, k), 1e-9 * energy_of_ping(at_rest, ping))
            << ping;
    EXPECT_GT(std::abs(energy_of_ping(moving, ping) / energy_of_ping(moving, (ping + 1) % 3) - 1), 1e-4);
  }
}

TEST_F(SeaSurfaceRun, DoesNotDependOnThreadsAndHasATimeOfItsOwn) {
  const Echoes one = energies(sea_scene(3), {"--threads", "1"}),
               three = energies(sea_scene(3), {"--threads", "3"});
  EXPECT_EQ(one.energy, three.energy);
  const Echoes later = energies(sea_scene(2, wavy, upward + "first_ping_s = 0.7\n"));
  for (std::size_t ping = 0; ping < 2; ++ping)
    EXPECT_EQ(energy_of_ping(later, ping), energy_of_ping(one, ping + 1));
  EXPECT_NE(energy_of_ping(one, 0), energy_of_ping(one, 1));
}

// The facets scatter by the model at 4 m/s, without the slopes of waves of 2 m or more.
TEST_F(SeaSurfaceRun, ScattersByTheModelOfTheSeaSurface) {
  const double resolved = WaveSpectrum::pierson_moskowitz(4).slope_variance(0, deep_water_frequency(2));
  std::string rows;
  for (int k = 1; k <= 180; ++k)
    rows += fmt::format(
        "{}, {}\n", 0.5 * k,
        10 * std::log10(
                 sea_surface_cross_sections({4, 30, resolved}, 0.5 * k * 0.017453292519943295).total()));
  folder.write("sea.csv", rows);
  const std::string text =
      "[[materials]]\nname = \"rock\"\nlaw = \"table\"\nunbounded = true\ntable_file = \"sea.csv\"\n";
  const double by_model = energies(sea_scene(1)).total(),
               by_table = energies(text + sea_scene(1, wavy + "material = \"rock\"\n")).total();
  EXPECT_NEAR(by_model / by_table, 1, 0.01);
  EXPECT_GT(energies(sea_scene(1, wavy + "scattering_khz = 90\n")).total(), 1.1 * by_model);
}

TEST_F(SeaSurfaceRun, IsSeenByOtherEnginesAndReferences) {
  const double exact = energies(sea_scene(2)).total();
  EXPECT_NEAR(energies(sea_scene(2), {"--engine", "ray", "--rays-per-beam", "40000"}).total(), exact,
              0.02 * exact);
  EXPECT_NEAR(energies(sea_scene(2), {"--binning", "centroid"}).total(), exact, 0.05 * exact);
  const Echoes reference = energies(sea_scene(1), {"--reference"});
  EXPECT_NEAR(reference.total(), energy_of_ping(energies(sea_scene(1)), 0), 1e-9 * exact);
  EXPECT_GT(energies(sea_scene(2, wavy, upward + "receiver_arm_m = [0.5, 0, 0]\n")).total(), 0);
}

TEST_F(SeaSurfaceRun, IsAnObjectOfTheLabels) {
  const std::string seabed = lambert_material("mud", -25) + flat_terrain(60, 60, "centre_m = [0, 0, -9]\n");
  energies(seabed + sea_scene(2, wavy, "frequency_khz = 30\ntilt_deg = -10\n"), {"--labels"});
  const NetcdfReader file(folder / "results" / "echoes.nc");
  EXPECT_THAT(bytes_of(folder / "results" / "echoes.nc"), HasSubstr("sea surface"));
}

// The mirror is the mean plane, which the waves cross. The facets neither hide images nor appear in them.
TEST_F(SeaSurfaceRun, DoesNotHideTheImagesOfItsMirror) {
  const std::string seabed = lambert_material("mud", -25) + flat_terrain(60, 60, "centre_m = [0, 0, -9]\n") +
                             "[paths]\norder = 3\n",
                    down = "frequency_khz = 30\ntilt_deg = 10\nrange_max_m = 30\n",
                    roughness = "rms_roughness_m = 0.002\n",
                    sonar = replaced(replaced(sea_sonar(2, down), "range_max_m = 18\n", ""),
                                     "vertical_deg = 30", "vertical_deg = 120");
  const auto orders = [&](const std::string& sea, const std::vector<std::string>& words) {
    energies(seabed + still_sea_water + sea + fixed_at(0, 0, -6) + sonar + sea_grid, words);
    return nlohmann::json::parse(std::ifstream(folder / "results" / "stats.json"))
        .at("paths")
        .at("energy_of_order");
  };
  for (const std::vector<std::string>& words :
       {std::vector<std::string>(),
        std::vector<std::string>{"--engine", "ray", "--rays-per-beam", "20000"}}) {
    const auto flat = orders("[sea_surface]\n" + roughness, words), waves = orders(wavy + roughness, words);
    for (const char* order : {"2", "3"}) {
      ASSERT_GT(flat.at(order).get<double>(), 0);
      EXPECT_NEAR(waves.at(order).get<double>() / flat.at(order).get<double>(), 1, 1e-9) << order;
    }
  }
  // Without the key, the roughness is that of the spectrum, 0.2 m, which leaves nothing at 30 kHz.
  EXPECT_LT(orders(wavy, {}).at("2").get<double>(), 1e-30);
}

TEST_F(SeaSurfaceRun, HasTheRoughnessOfItsSpectrumForTheMirror) {
  const Scene scene = loaded(sea_scene(1));
  ASSERT_TRUE(scene.description.sea_surface->rms_roughness_m);
  EXPECT_NEAR(4 * *scene.description.sea_surface->rms_roughness_m,
              WaveSpectrum::pierson_moskowitz(4).significant_height_m(), 1e-12);
  EXPECT_EQ(loaded(sea_scene(1, wavy + "rms_roughness_m = 0.3\n")).description.sea_surface->rms_roughness_m,
            0.3);
}

TEST_F(SeaSurfaceRun, IsCoveredShownDrawnAndExported) {
  EXPECT_GT(covered(folder, sea_scene(2)).seen_m2, 20);
  const std::string file = folder.write("scene.toml", sea_scene(2)).string();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"view", file, "-o", (folder / "v.html").string()},
        {"check", file, "--png", (folder / "d.png").string()},
        {"footprints", file, "--sensor", "sonar", "-o", (folder / "f.csv").string()},
        {"export", file, "--to", "obj", "-o", (folder / "exported").string()},
        {"audit", file}}) {
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << words[0] << outcome.err;
  }
  EXPECT_THAT(bytes_of(folder / "f.csv"), HasSubstr("sea surface"));
  EXPECT_THAT(bytes_of(folder / "exported" / "README.txt"),
              HasSubstr("the motion and the reflections of the sea surface"));
}

TEST_F(SeaSurfaceRun, RefusesASonarAboveTheWaves) {
  // The sea of this seed has a trough at one of these places.
  std::string trough, crest;
  for (int east = -8; east <= 8; ++east) {
    const std::string scene = replaced(sea_scene(1), "[0, 0, -6]", fmt::format("[{}, 4.3, -0.05]", east));
    const Outcome outcome = checked(scene);
    (outcome.exit_code == 2 ? trough : crest) = outcome.exit_code == 2 ? outcome.err : "below";
  }
  EXPECT_THAT(trough,
              AllOf(HasSubstr("scene.toml:"), HasSubstr("above the waves of the sea surface at ping 0"),
                    HasSubstr("below the troughs")));
  EXPECT_EQ(crest, "below");
  EXPECT_THAT(message(replaced(sea_scene(1), "[0, 0, -6]", "[0, 0, 0.5]")),
              HasSubstr("m above the waves of the sea surface"));
}

TEST_F(SeaSurfaceRun, WarnsOfLandAndOfShoals) {
  const auto with_seabed = [&](double up) {
    return lambert_material("mud", -25) + flat_terrain(10, 10, fmt::format("centre_m = [30, 0, {}]\n", up)) +
           sea_scene(1);
  };
  EXPECT_THAT(checked(with_seabed(0.5)).err, HasSubstr("facets reach above the sea surface: they end there"));
  EXPECT_THAT(checked(with_seabed(-0.1)).err,
              AllOf(HasSubstr("reaches to 0.1 m below the mean sea surface, above the troughs of the waves"),
                    Not(HasSubstr("reach above"))));
  EXPECT_THAT(checked(with_seabed(-8)).err, Not(AnyOf(HasSubstr("troughs"), HasSubstr("reach above"))));
}

TEST_F(SeaSurfaceRun, WarnsOfWhatItsModelsDoNotShow) {
  EXPECT_THAT(checked(sea_scene(1)).err, Not(HasSubstr("sea surface")));
  EXPECT_THAT(checked(sea_scene(1, wavy, "frequency_khz = 300\ntilt_deg = -40\n")).err,
              HasSubstr("is meant for 10 to 100 kHz, but is used at 300 kHz"));
  EXPECT_THAT(checked(sea_scene(1, replaced(wavy, "wind_speed_m_s = 4", "wind_speed_m_s = 20"))).err,
              HasSubstr("is meant for wind speeds of 3 to 15 m/s, but is used at 20 m/s"));
  EXPECT_THAT(checked(sea_scene(1, replaced(wavy, "cell_m = 0.5", "cell_m = 4"))).err,
              AllOf(HasSubstr("% of the variance of its height"), HasSubstr("reduce 'cell_m'")));
  EXPECT_THAT(
      checked(sea_scene(1) + "[[sensors]]\nname = \"other\"\nkind = \"imaging\"\nfrequency_khz = 60\n").err,
      HasSubstr("scatters as at 30 kHz for all sensors, but sensor 'other' works at 60 kHz"));
}

TEST_F(SeaSurfaceRun, RefusesWhatItCannotBe) {
  const std::string rock = lambert_material("rock", -12);
  EXPECT_THAT(message(sea_scene(1, replaced(wavy, "[24, 20]", "[5000, 5000]"))),
              HasSubstr("increase 'cell_m'"));
  EXPECT_THAT(message("[[materials]]\nname = \"ice\"\nspecular_loss_db = 3\n" +
                      sea_scene(1, wavy + "material = \"ice\"\n")),
              HasSubstr("the mirror of the sea surface is its mean plane"));
  EXPECT_THAT(message(rock + "[[objects]]\nname = \"sea surface\"\nshape = \"sphere\"\n" + sea_scene(1)),
              HasSubstr("give the object another 'name'"));
  EXPECT_THAT(message(sea_scene(1) + "[paths]\norder = 2\nscatterings = 2\n"),
              HasSubstr("treats the sea surface as a plane"));
  EXPECT_THAT(message(replaced(sea_scene(1), still_sea_water, stratified(0.5) + "surface_height_m = 1\n")),
              HasSubstr("set 'surface_height_m' of [water] to 'height_m'"));
}

// Water that hardly refracts gives the result of isovelocity water; stronger gradients do not.
TEST_F(SeaSurfaceRun, IsSeenThroughStratifiedWater) {
  const auto at = [&](double gradient_per_s) {
    return energies(replaced(sea_scene(1), still_sea_water, stratified(gradient_per_s)));
  };
  const Echoes isovelocity = energies(sea_scene(1)), almost = at(1e-6), refracted = at(3);
  EXPECT_LT(largest_relative_difference(isovelocity, almost), 1e-3);
  EXPECT_GT(largest_relative_difference(isovelocity, refracted), 0.01);
  EXPECT_NEAR(refracted.total() / isovelocity.total(), 1, 0.2);
}

}  // namespace
}  // namespace tubefoot
