// SPDX-License-Identifier: GPL-3.0-or-later
// Tests laws of exported scenes: plain numbers, near clipping planes that hide nothing, and even counts for
// Stonefish. The reference has the taper of Stonefish's forward-looking sonar.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <pugixml.hpp>
#include <random>
#include <regex>

#include "compare/output_models/output_model_file.hpp"
#include "exchange/plain_number.hpp"
#include "exchange/stonefish_beams.hpp"
#include "exchange/writers/scene_writers.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/test_folder.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(PlainNumbers, UndoRoundingOnly) {
  EXPECT_EQ(plain(59.99999999999999), 60);
  EXPECT_EQ(plain(0.1 + 0.2), 0.3);
  EXPECT_EQ(plain(1.0 / 3), 1.0 / 3);
  EXPECT_EQ(plain(1e300), 1e300);
  EXPECT_EQ(plain(1.2e-16, 1), 0);
  EXPECT_EQ(plain(1.2e-16), 1.2e-16);
  EXPECT_FALSE(std::signbit(plain(-0.0)));
  EXPECT_TRUE(std::isnan(plain(std::nan(""))));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(-9, 9), mantissa(-10, 10);
  for (int k = 0; k < 10'000; ++k) {
    const double value = mantissa(random) * std::pow(10, exponent(random));
    EXPECT_LE(std::abs(plain(value) - value), 1e-14 * std::abs(value));
    // A number of people, after a conversion to radians and back.
    const double written = std::round(value * 1000) / 1000;
    const double back = written / 180 * std::numbers::pi * 180 / std::numbers::pi;
    if (std::abs(written) < 1e8) {
      EXPECT_EQ(plain(back), written);
    }
  }
}

/// Azimuth of the centre of a column, by the matrices of the engine. The view is turned about the vertical,
/// and columns have equal widths on the picture plane.
double column_deg(double view_centre_deg, double view_width_deg, int columns, int column) {
  const double turn = view_centre_deg * std::numbers::pi / 180,
               x = std::tan(view_width_deg * std::numbers::pi / 360) * ((column + 0.5) / columns * 2 - 1);
  return std::atan2(x * std::cos(turn) + std::sin(turn), std::cos(turn) - x * std::sin(turn)) * 180 /
         std::numbers::pi;
}

TEST(StonefishBeams, AreColumnsOfViewsOfAtMost20Degrees) {
  EXPECT_EQ(stonefish_views(20), 1);
  EXPECT_EQ(stonefish_views(20.001), 2);
  EXPECT_EQ(stonefish_views(60), 3);
  const std::vector<double> divisible = stonefish_beam_angles_deg(48, 60);
  ASSERT_EQ(divisible.size(), 48);
  for (int k = 0; k < 48; ++k) {
    EXPECT_NEAR(divisible[static_cast<std::size_t>(k)], column_deg(20.0 * (k / 16) - 20, 20, 16, k % 16),
                1e-11);
    EXPECT_NEAR(divisible[static_cast<std::size_t>(k)], -divisible[static_cast<std::size_t>(47 - k)], 1e-11);
  }
  // 50 beams: 17, 17 and 16. Each view is as wide as 17 beams.
  const std::vector<double> others = stonefish_beam_angles_deg(50, 60);
  ASSERT_EQ(others.size(), 50);
  const double beam = 60.0 / 50, wide = 17 * beam;
  for (int k = 0; k < 50; ++k)
    EXPECT_NEAR(others[static_cast<std::size_t>(k)],
                column_deg(-30 + wide * (k / 17) + wide / 2, wide, 17, k % 17), 1e-11);
  EXPECT_TRUE(stonefish_beam_angles_deg(9, 120).empty());  // 6 views: 5 of 2 beams, the last of -1
  EXPECT_TRUE(stonefish_beam_angles_deg(1, 20).empty());
  EXPECT_TRUE(stonefish_beam_angles_deg(2, 360).empty());
}

TEST(EngineRanges, KeepTheEdgesOfAllBins) {
  std::mt19937 random(7);
  const auto between = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  for (int k = 0; k < 1000; ++k) {
    ExchangedSonar sonar;
    sonar.samples = static_cast<int>(between(1, 900));
    sonar.range_min_m = k % 3 == 0 ? between(0, 0.1) : between(0, 20);
    sonar.range_max_m = sonar.range_min_m + between(0.5, 100);
    const double step_m = (sonar.range_max_m - sonar.range_min_m) / sonar.samples;
    for (const bool even : {false, true}) {
      const EngineRanges ranges = engine_ranges(sonar, 0.02, even);
      EXPECT_EQ(ranges.samples, sonar.samples + ranges.nearer + ranges.farther);
      EXPECT_NEAR(ranges.range_min_m, sonar.range_min_m - ranges.nearer * step_m, 1e-12);
      EXPECT_NEAR((ranges.range_max_m - ranges.range_min_m) / ranges.samples, step_m, 1e-12);
      if (even) {
        EXPECT_EQ(ranges.samples % 2, 0);
      }
      if (ranges.samples < 16'000 && sonar.range_max_m - step_m > 0.02) {
        EXPECT_GE(ranges.range_min_m, 0.02 - 1e-9 * step_m - 1e-12);
        EXPECT_LT(ranges.range_min_m, 0.02 + step_m + 1e-12);
      }
    }
  }
}

std::string camera_with(const std::string& beams) {
  return R"(title = "Sand"
[water]
sound_speed_m_s = 1500
absorption_db_per_km = 0
[[materials]]
name = "sand"
lambert_db = -20
[[terrain]]
kind = "flat"
material = "sand"
width_m = 80
length_m = 80
[trajectory]
kind = "fixed"
position_m = [0.1, 0.2, 4]
heading_deg = 12
[[sensors]]
name = "camera"
kind = "imaging"
frequency_khz = 1000
vertical_deg = 30
tilt_deg = 30
samples = 101
range_min_m = 4
range_max_m = 14.1
)" + beams;
}

struct Exported : testing::Test {
  TestFolder folder;
  std::string name(const std::string& of) const { return (folder / of).string(); }
  void done(const std::vector<std::string>& words) const {
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << words.front() << ": " << outcome.err;
  }
  void export_to(const std::string& format, const std::string& beams) const {
    folder.write("scene.toml", camera_with(beams));
    done({"export", name("scene.toml"), "--to", format, "--quiet", "-o", name(format)});
  }
};

TEST_F(Exported, NearPlanesAreNotMinimumRanges) {
  export_to("stonefish", "beams = 48\nhorizontal_deg = 60\n");
  pugi::xml_document scn;
  ASSERT_TRUE(scn.load_file((folder / "stonefish/scene.scn").c_str()));
  const pugi::xml_node fls = scn.child("scenario").child("sensor");
  EXPECT_STREQ(fls.child("specs").attribute("output_format").value(), "float32");
  EXPECT_STREQ(fls.child("specs").attribute("horizontal_fov").value(), "60");
  // 101 bins of 0.1 m, 39 nearer ones down to 0.1 m, which makes 140.
  EXPECT_STREQ(fls.child("specs").attribute("bins").value(), "140");
  EXPECT_STREQ(fls.child("settings").attribute("range_min").value(), "0.1");
  EXPECT_STREQ(fls.child("settings").attribute("range_max").value(), "14.1");
  EXPECT_THAT(bytes_of(folder / "stonefish/README.txt"), HasSubstr("remove the 39 nearest bins"));
  EXPECT_THAT(bytes_of(folder / "stonefish/scene.scn"), HasSubstr("near clipping plane"));

  export_to("sdf", "beams = 48\nhorizontal_deg = 60\n");
  pugi::xml_document sdf;
  ASSERT_TRUE(sdf.load_file((folder / "sdf/scene.sdf").c_str()));
  const pugi::xml_node ray = sdf.select_node("//ray").node();
  EXPECT_STREQ(ray.child("range").child_value("min"), "0.1");
  EXPECT_STREQ(ray.child("range").child_value("max"), "14.1");
  EXPECT_THAT(bytes_of(folder / "sdf/scene.sdf"), HasSubstr("minimum range of the sonar is 4 m"));
  const pugi::xml_node world = sdf.child("sdf").child("world");
  const pugi::xml_node sensors = world.find_child_by_attribute("plugin", "filename", "gz-sim-sensors-system");
  EXPECT_STREQ(sensors.attribute("name").value(), "gz::sim::systems::Sensors");
  EXPECT_STREQ(sensors.child_value("render_engine"), "ogre2");
  EXPECT_STREQ(
      world.find_child_by_attribute("plugin", "filename", "multibeam_sonar_system").attribute("name").value(),
      "custom::MultibeamSonarSystem");
  const std::string readme = bytes_of(folder / "sdf/README.txt");
  for (const char* told :
       {"gz-sim-sensors-system", "ogre2", "custom::MultibeamSonarSystem", "clipping plane"})
    EXPECT_THAT(readme, HasSubstr(told));

  export_to("gltf", "beams = 48\nhorizontal_deg = 60\n");
  std::ifstream file(folder / "gltf/scene.gltf");
  const nlohmann::json gltf = nlohmann::json::parse(file);
  EXPECT_LE(gltf["cameras"][0]["perspective"]["znear"].get<double>(), 1e-3);
  EXPECT_EQ(gltf["nodes"].back()["extras"]["tubefoot_sonar"]["range_min_m"], 4);
}

/// The rays of DAVE's plugin (MultibeamSonarSensor.cc) from the exported elements. An even number becomes
/// odd, the outermost rays lie at the stated azimuths, and the rays fill twice the stated height.
TEST_F(Exported, RaysOfDaveAreTheBeamsOfTheScene) {
  for (const int beams : {1, 12, 15}) {
    SCOPED_TRACE(beams);
    export_to("sdf", fmt::format("beams = {}\nhorizontal_deg = 60\n", beams));
    pugi::xml_document sdf;
    ASSERT_TRUE(sdf.load_file((folder / "sdf/scene.sdf").c_str()));
    const pugi::xml_node scan = sdf.select_node("//scan").node(), across = scan.child("horizontal"),
                         up = scan.child("vertical");
    int rays = across.child("beams").text().as_int();
    if (rays % 2 == 0) ++rays;
    const double first = across.child("min_angle").text().as_double(),
                 last = across.child("max_angle").text().as_double();
    EXPECT_NEAR(2 * (up.child("max_angle").text().as_double() - up.child("min_angle").text().as_double()),
                std::numbers::pi / 6, 1e-12);
    const int omitted = beams == 1 ? 1 : 0;  // at starboard; the others are at port
    EXPECT_EQ(rays, beams == 1 ? 3 : beams + 1 - beams % 2);
    for (int k = 0; k < beams; ++k) {
      const double axis = -30.0 + (k + 0.5) * 60 / beams;  // to port
      EXPECT_NEAR((first + (k + omitted) * (last - first) / (rays - 1)) * 180 / std::numbers::pi, axis,
                  1e-11);
    }
  }
}

TEST_F(Exported, OddNumbersOfBeamsBecomeEvenAndKeepTheirWidth) {
  export_to("stonefish", "beams = 15\nhorizontal_deg = 60\n");
  pugi::xml_document scn;
  ASSERT_TRUE(scn.load_file((folder / "stonefish/scene.scn").c_str()));
  const pugi::xml_node fls = scn.child("scenario").child("sensor");
  EXPECT_STREQ(fls.child("specs").attribute("beams").value(), "16");
  EXPECT_STREQ(fls.child("specs").attribute("horizontal_fov").value(), "64");
  // Half a beam of 4 degrees to starboard: the port border stays, and the additional beam is at starboard.
  const auto exported = exchanged_scene(*open_survey(read_scene_file(folder / "scene.toml")), {}, 0);
  const double half_rad = std::numbers::pi / 90;
  const glm::dvec3 ahead =
      exported.sonars[0].placement.turn * glm::dvec3(std::sin(half_rad), std::cos(half_rad), 0);
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(fls.child("world_transform").attribute("rpy").value(), "%lf %lf %lf", &x, &y, &z), 3);
  const glm::dvec3 theirs = turn_of({x, y, z})[2];  // z ahead, in north, east, down
  EXPECT_LT(glm::length(theirs - glm::dvec3(ahead.y, ahead.x, -ahead.z)), 1e-12);
  EXPECT_THAT(bytes_of(folder / "stonefish/README.txt"), HasSubstr("remove the last column"));
}

TEST_F(Exported, BeamsThatStonefishCannotDivideAreReported) {
  folder.write("scene.toml", camera_with("beams = 12\nhorizontal_deg = 150\n"));
  const Outcome outcome =
      run_program({"export", name("scene.toml"), "--to", "stonefish", "-o", name("stonefish")});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("cannot divide 12 beams into 8 views"));
  EXPECT_THAT(outcome.err, HasSubstr("there is no output model"));
  EXPECT_FALSE(fs::exists(folder / "stonefish/fls-output-model.toml"));
}

/// Every number of a text with more than 12 significant digits.
std::vector<std::string> long_numbers(const std::string& text) {
  std::vector<std::string> found;
  const std::regex number(R"([-+]?(\d+)\.?(\d*)([eE][-+]?\d+)?)");
  for (std::sregex_iterator at(text.begin(), text.end(), number), end; at != end; ++at) {
    std::string digits = (*at)[1].str() + (*at)[2].str();
    digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size()));
    if (digits.size() > 12) found.push_back(at->str());
  }
  return found;
}

bool has_short_form(const std::string& number) {
  const double value = std::strtod(number.c_str(), nullptr);
  char text[40];
  std::snprintf(text, sizeof text, "%.11e", value);
  return std::abs(std::strtod(text, nullptr) - value) <= 1e-15 * std::abs(value);
}

TEST_F(Exported, NumbersAreAsShortAsTheirRoundingAllows) {
  for (const std::string scene : {"imaging", "multibeam", "echosounder", "interferometric"})
    for (const std::string format : {"sdf", "stonefish", "gltf", "holoocean"}) {
      const std::string out = scene + "-" + format;
      SCOPED_TRACE(out);
      done({"export", TUBEFOOT_SOURCE_DIR "/scenes/" + scene + "/scene.toml", "--to", format, "--quiet", "-o",
            name(out)});
      const std::string text = bytes_of(folder / (out + "/" +
                                                  (format == "sdf"         ? "scene.sdf"
                                                   : format == "stonefish" ? "scene.scn"
                                                   : format == "gltf"      ? "scene.gltf"
                                                                           : "scenario.json")));
      for (const std::string& number : long_numbers(text)) EXPECT_FALSE(has_short_form(number)) << number;
    }
}

/// On flat ground, energies divided by solid angles are mu h / r^3 times the taper at the depression of the
/// range: a closed form.
TEST_F(Exported, TheReferenceForStonefishHasItsTaper) {
  export_to("stonefish", "beams = 6\nhorizontal_deg = 15\n");
  std::map<std::string, std::vector<double>> energies;
  for (const std::string which : {"reference", "angles"}) {
    done({"run", name("stonefish/fls-" + which + ".toml"), "--quiet", "--pictures", "none", "-o",
          name("stonefish/" + which)});
    energies[which] = NetcdfReader(folder / ("stonefish/" + which + "/echoes.nc")).values("/", "energy");
  }
  const OutputModel model = read_output_model(folder / "stonefish/fls-output-model.toml");
  ASSERT_EQ(model.steps.size(), 5);
  EXPECT_NEAR(std::get<GainStep>(model.steps[2].kind).factor, 100, 1e-10);
  const std::vector<double>&tapered = energies["reference"], &angles = energies["angles"];
  constexpr std::size_t beams = 6, samples = 140;
  ASSERT_EQ(tapered.size(), beams * samples);
  ASSERT_EQ(angles.size(), beams * samples);
  const double edge = std::tan(std::numbers::pi / 12);
  const auto smooth = [](double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
  };
  std::size_t compared = 0;
  for (std::size_t beam = 2; beam < 4; ++beam)
    for (std::size_t s = 0; s < samples; ++s) {
      const double r = 0.15 + 0.1 * static_cast<double>(s), height = 4;
      if (r < 5 || !(angles[beam * samples + s] > 0)) continue;
      const double depression = std::asin(height / r), elevation = std::numbers::pi / 6 - depression;
      const double v = (1 + std::tan(elevation) / edge) / 2;
      const double taper = smooth(v / 0.2) * (1 - smooth((v - 0.8) / 0.2));
      if (taper < 0.3) continue;
      const double expected = 0.01 * height / r * taper;
      EXPECT_NEAR(tapered[beam * samples + s] / angles[beam * samples + s], expected, 0.03 * expected) << r;
      if (taper > 0.999) {
        EXPECT_NEAR(tapered[beam * samples + s] / angles[beam * samples + s], expected, 0.01 * expected) << r;
      }
      ++compared;
    }
  EXPECT_GT(compared, 60);
}

/// Export, import, check and export again: the same facets and poses.
TEST_F(Exported, ScenesComeBackAndPassTheCheck) {
  for (const std::string scene : {"imaging/scene", "multibeam/scene", "echosounder/scene", "wellhead/plain",
                                  "chart/box-and-wall", "shadows/wall"})
    for (const std::string format : {"sdf", "stonefish"}) {
      SCOPED_TRACE(scene + " " + format);
      const std::string stem = scene.substr(0, scene.find('/')) + "-" + format;
      const std::string file = format == "sdf" ? "scene.sdf" : "scene.scn";
      done({"export", TUBEFOOT_SOURCE_DIR "/scenes/" + scene + ".toml", "--to", format, "--quiet", "-o",
            name(stem)});
      done({"import-scene", name(stem + "/" + file), "--quiet", "-o", name(stem + "-in")});
      done({"check", name(stem + "-in/scene.toml")});
      const auto exported = [](const fs::path& scene_file) {
        return exchanged_scene(*open_survey(read_scene_file(scene_file)), {}, 0);
      };
      const ExchangedScene own = exported(TUBEFOOT_SOURCE_DIR "/scenes/" + scene + ".toml"),
                           again = exported(folder / (stem + "-in/scene.toml"));
      ASSERT_EQ(again.pieces.size(), own.pieces.size());
      for (std::size_t k = 0; k < own.pieces.size(); ++k) {
        ASSERT_EQ(again.pieces[k].triangles, own.pieces[k].triangles);
        double farthest = 0;
        for (std::size_t p = 0; p < own.pieces[k].points_m.size(); ++p)
          farthest = std::max(farthest, glm::length(again.pieces[k].points_m[p] - own.pieces[k].points_m[p]));
        EXPECT_LT(farthest, 1e-6);
      }
      ASSERT_EQ(again.sonars.size(), own.sonars.size());
      for (std::size_t k = 0; k < own.sonars.size(); ++k) {
        EXPECT_EQ(again.sonars[k].keys, own.sonars[k].keys);
        EXPECT_LT(glm::length(again.sonars[k].own.position_m - own.sonars[k].own.position_m), 1e-9);
        for (int c = 0; c < 3; ++c)
          EXPECT_LT(glm::length(again.sonars[k].own.turn[c] - own.sonars[k].own.turn[c]), 1e-9);
      }
    }
}

}  // namespace
}  // namespace tubefoot
