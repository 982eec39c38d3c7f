// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that each scene of the benchmark suite covers its aspect. The checker of the suite reports a
// planted fault of one class at a time, and no other fault.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <regex>
#include <sstream>

#include "sensors/recordings/echo_reader.hpp"
#include "suite/npy.hpp"
#include "suite/packed.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// An edit of a scene file that gives the result of an engine without the aspect. The edit removes objects
/// by name.
struct Plant {
  std::string scene, pattern, instead;
};

std::string without(const std::string& object) {
  return "\\[\\[objects\\]\\]\nname = \"" + object + "\"\n([^\n]+\n)*\n";
}

const std::vector<Plant>& plants() {
  static const std::vector<Plant> all{
      {"absorption", "absorption_db_per_km = [0-9]+", "absorption_db_per_km = 0"},
      {"even-angles", "vertical_deg", "spacing = \"distance\"\nvertical_deg"},
      {"even-tangents", "spacing = \"distance\"\n", ""},
      {"listed-angles", "beam_angles_deg = [^\n]*", "beams = 64\nhorizontal_deg = 72"},
      {"side-lobes", "receive_[^\n]*\n", ""},
      {"near-plane", without("near-box"), ""},
      {"thin-wall", without("wall"), ""},
      {"silhouettes", without("sphere"), ""},
      {"occlusion-order", without("front"), ""},
      {"large-flat", "(position_m = \\[[^,]+, [^,]+), [^\\]]+", "$1, 2"},  // heights to the metre
      {"many-small", without("stones"), ""},
      {"moving-sonar", "\nspeed_m_s = [0-9.]+", "\nspeed_m_s = 0.001"},
      {"layered-water", "(profile|gradient|surface_height)[^\n]*\n", ""},
      {"surface-multiple", "order = 3", "order = 1"},
      {"two-scatterings", "order = 2\nscatterings = 2\npatch_m = [0-9.]+", "order = 1"},
      {"receivers-apart", "receiver_arm_m[^\n]*\n", ""},
      {"volume", "volume_scattering_db[^\n]*\n", ""},
      {"half-sample", "kind = \"imaging\"\n", "$&lever_arm_m = [0, -0.0098, 0]\n"},  // half a sample aft
      {"sectors", "sector_tilts_deg[^\n]*\n", ""},
      {"sectors", "sector_delays_us[^\n]*\n", ""},
      {"sectors", "sector_absorptions_db_per_km[^\n]*", "sector_absorptions_db_per_km = [200, 200, 200]"},
      {"moving-object", "trajectory = \"path\"", "position_m = [-0.5, -0.5, 0.5]"},
      {"shadow-border", "shadow = \"fresnel\"\n", ""},
  };
  return all;
}

/// A benchmark suite, and results that equal its answers until a fault is planted.
struct Results {
  explicit Results(const fs::path& of_suite) : suite(of_suite) {
    fs::create_directories(results);
    for (const fs::directory_entry& answer : fs::directory_iterator(suite / "answers"))
      if (answer.is_directory()) heal(answer.path().filename());
  }
  /// Multiplies energies by a factor of sample centre and ping.
  void change(const std::string& scene, const std::function<double(double range_m)>& factor) const {
    Array array = array_in(suite / "answers" / scene / "energy.npy");
    const Json samples = json_in(suite / "scenes" / scene / "scene.json")["samples"];
    for (std::size_t k = 0; k < array.values.size(); ++k)
      array.values[k] *=
          factor(samples["first_m"].get<double>() +
                 (static_cast<double>(k % array.samples) + 0.5) * samples["step_m"].get<double>());
    write_npy(results / (scene + ".npy"), {array.pings, array.beams, array.samples}, array.values);
  }
  void plant(const Plant& plant) const {
    const TestFolder edited;
    for (const fs::directory_entry& file : fs::directory_iterator(suite / "scenes" / plant.scene))
      fs::copy(file.path(), edited.path() / file.path().filename());
    const std::string text = bytes_of(edited / "scene.toml"),
                      other = std::regex_replace(text, std::regex(plant.pattern), plant.instead);
    ASSERT_NE(text, other) << plant.scene;
    edited.write("scene.toml", other);
    const Outcome outcome = run_program({"run", (edited / "scene.toml").string(), "-o",
                                         (edited / "out").string(), "--quiet", "--pictures", "none"});
    ASSERT_EQ(outcome.exit_code, 0) << plant.scene << ": " << outcome.err;
    const SensorEchoes echoes = read_echo_file(edited / "out" / "echoes.nc").sensors.at(0);
    write_npy(results / (plant.scene + ".npy"), {echoes.pings, echoes.beams, echoes.samples}, echoes.energy);
  }
  void heal(const std::string& scene) const {
    const fs::path answer = suite / "answers" / scene;
    if (fs::exists(answer / "strength.csv")) {
      fs::copy(answer / "strength.csv", results / (scene + ".csv"), fs::copy_options::overwrite_existing);
      return;
    }
    fs::copy(answer / "energy.npy", results / (scene + ".npy"), fs::copy_options::overwrite_existing);
    if (fs::exists(answer / "gradient.npy"))
      fs::copy(answer / "gradient.npy", results / (scene + "-gradient.npy"),
               fs::copy_options::overwrite_existing);
  }
  /// Multiplies the derivatives by one parameter.
  void change_gradient(std::size_t parameter, double factor) const {
    Array array = array_in(suite / "answers/gradient/gradient.npy");
    const std::size_t cells = array.beams * array.samples;
    for (std::size_t k = 0; k < cells; ++k) array.values.at(parameter * cells + k) *= factor;
    write_npy(results / "gradient-gradient.npy", {array.pings, array.beams, array.samples}, array.values);
  }
  /// Replaces each level of a table of target strengths [dB] by a function of it.
  void change_strength(const std::string& scene, const std::function<double(double level_db)>& change) const {
    std::istringstream table(bytes_of(suite / "answers" / scene / "strength.csv"));
    std::ostringstream changed;
    std::string line;
    std::getline(table, line);
    changed << "azimuth_deg,frequency_hz,target_strength_db\n";
    while (std::getline(table, line)) {
      std::array<double, 4> cells{};
      ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &cells[0], &cells[1], &cells[2], &cells[3]), 4);
      changed << cells[1] << ',' << cells[2] << ',' << change(cells[3]) << '\n';
    }
    std::ofstream(results / (scene + ".csv")) << changed.str();
  }
  /// Runs the checker of the suite.
  int check(const std::string& options = {}) const {
    return shell(python + " '" + (suite / "compare.py").string() + "' '" + suite.string() + "' '" +
                     results.string() + "' --json " + options,
                 folder / "said");
  }
  std::string said() const { return bytes_of(folder / "said"); }
  std::vector<std::string> wrong() const {
    std::vector<std::string> names;
    const Json report = Json::parse(said());
    for (const Json& entry : report["scenes"])
      if (!entry["agrees"].get<bool>()) names.push_back(entry["scene"]);
    return names;
  }

  TestFolder folder;
  fs::path suite, results = folder / "results";
  std::string python = python_with_netcdf4();
};

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

void expect_every_plant_named(const fs::path& suite) {
  const Results results(suite);
  if (results.python.empty()) GTEST_SKIP() << "no Python with netCDF4 and NumPy (Debian: python3-netcdf4)";
  ASSERT_EQ(results.check(), 0) << results.said();
  EXPECT_THAT(results.wrong(), IsEmpty());
  EXPECT_EQ(Json::parse(results.said())["scenes"].size(), 28u);
  for (const Plant& plant : plants()) {
    results.plant(plant);
    ASSERT_EQ(results.check(), 3) << plant.scene << results.said();
    EXPECT_THAT(results.wrong(), ElementsAre(plant.scene));
    results.heal(plant.scene);
  }
  const std::function<double(double)> amplitude = [](double db) { return db / 2; },
                                      feet = [](double db) { return db + 20 * std::log10(1 / 0.3048); },
                                      without_4_pi = [](double db) {
                                        return db + 10 * std::log10(4 * std::numbers::pi);
                                      };
  for (const std::string scene : {"strength-m3", "strength-m5a", "strength-m5b"}) {
    for (const auto& plant : {amplitude, feet, without_4_pi}) {
      results.change_strength(scene, plant);
      ASSERT_EQ(results.check(), 3) << scene << results.said();
      EXPECT_THAT(results.wrong(), ElementsAre(scene));
    }
    results.heal(scene);
  }
  for (const std::size_t parameter : {0, 1, 2, 3, 4})
    for (const double factor : {-1.0, std::numbers::pi / 180}) {
      results.change_gradient(parameter, factor);
      ASSERT_EQ(results.check(), 3) << parameter << results.said();
      EXPECT_THAT(results.wrong(), ElementsAre("gradient"));
    }
}

/// The checksums in the source are those of the files that the program writes.
void expect_published_sums(const fs::path& suite, const std::string& version) {
  std::map<std::string, std::string> made;
  for (const std::string list : {"SHA256SUMS", "answers/SHA256SUMS"}) {
    std::istringstream sums(bytes_of(suite / list));
    for (std::string digest, name; sums >> digest >> name;)
      made[(list.starts_with("a") ? "answers/" : "") + name] = digest;
  }
  std::size_t published = 0;
  std::istringstream sums(bytes_of(reference_folder() / ("v" + version) / "SHA256SUMS"));
  for (std::string digest, name; sums >> digest >> name; ++published) EXPECT_EQ(made[name], digest) << name;
  for (const auto& [name, digest] : made)
    published += name.ends_with("echoes.nc") || name == "pack.json" || name.find('/') == std::string::npos ||
                 name.starts_with("tubefoot_suite/") || name.find("/forms/") != std::string::npos;
  EXPECT_EQ(published, made.size());
}

TEST(SuiteAspects, OfVersion2KeepTheirPublishedSums) {
  const TestFolder folder;
  expect_published_sums(packed(folder, "second", {"--version", "2"}), "2");
}

/// The whole debug set takes minutes. All other tests that need the whole set are thus here, too.
TEST(SuiteAspects, OfTheDebugSetAreWhatItsPublishedSumsSay) {
  const TestFolder folder;
  const fs::path suite = packed(folder, "debug", {});
  expect_published_sums(suite, "3");
  expect_every_plant_named(suite);
}

TEST(SuiteAspects, OfAValidationSetAreNamedAsWell) {
  const TestFolder folder;
  expect_every_plant_named(packed(folder, "drawn", {"--seed", "a word of the day"}));
}

TEST(SuiteAspects, ALawOfRangeIsNamedOnceAndTakenOffTheOthers) {
  const TestFolder folder;
  const Results results(
      packed(folder, "a", {"--scenes", "range-law,absorption,grazing,even-angles,near-plane,large-flat"}));
  if (results.python.empty()) GTEST_SKIP() << "no Python with netCDF4 and NumPy (Debian: python3-netcdf4)";
  const auto everywhere = [&](const std::function<double(double)>& factor) {
    for (const std::string scene :
         {"range-law", "absorption", "grazing", "even-angles", "near-plane", "large-flat"})
      results.change(scene, factor);
  };
  everywhere([](double r) { return 2 * r; });
  ASSERT_EQ(results.check(), 3);
  EXPECT_THAT(results.wrong(), ElementsAre("range-law"));
  Json taken = Json::parse(results.said())["taken_off"];
  EXPECT_NEAR(taken["range_exponent"], 1, 0.01);
  EXPECT_NEAR(taken["gain_db"], 10 * std::log10(2.0), 0.1);
  everywhere([](double) { return 3.0; });
  ASSERT_EQ(results.check(), 3);
  EXPECT_THAT(results.wrong(), ElementsAre("range-law"));
  ASSERT_EQ(results.check("--relative"), 0) << results.said();
  // Another grazing law: sin instead of sin^2 is one power of range on a flat seabed. It has no effect on
  // plates perpendicular to the line of sight.
  everywhere([](double) { return 1.0; });
  for (const std::string scene : {"grazing", "large-flat"}) results.change(scene, [](double r) { return r; });
  ASSERT_EQ(results.check(), 3);
  EXPECT_THAT(results.wrong(), ElementsAre("grazing", "large-flat"));
  EXPECT_TRUE(Json::parse(results.said())["taken_off"].is_null());
}

TEST(SuiteAspects, ResultsThatCannotBeComparedAreNamed) {
  const TestFolder folder;
  const fs::path suite = packed(folder, "a", {"--scenes", "range-law,grazing"});
  const Results results(suite);
  if (results.python.empty()) GTEST_SKIP() << "no Python with netCDF4 and NumPy (Debian: python3-netcdf4)";
  const std::string whole = bytes_of(results.results / "grazing.npy");
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{7}, std::size_t{60}, std::size_t{128}, whole.size() - 1}) {
    results.folder.write("results/grazing.npy", whole.substr(0, length));
    ASSERT_EQ(results.check(), 3) << results.said();
    EXPECT_THAT(results.wrong(), ElementsAre("grazing")) << length;
  }
  std::string minus = whole;
  minus.back() = static_cast<char>(minus.back() | 0x80);
  minus[minus.size() - 2] = '\x7f';
  results.folder.write("results/grazing.npy", minus);
  ASSERT_EQ(results.check(), 3);
  EXPECT_THAT(results.said(), HasSubstr("has negative values or values that are not finite"));
  write_npy(results.results / "grazing.npy", {1, 2, 2}, std::vector<double>{1, 2, 3, 4});
  ASSERT_EQ(results.check(), 3);
  EXPECT_THAT(results.said(), HasSubstr("use the numbers of the reference"));
  const std::vector<double> silence(32 * 128);
  write_npy(results.results / "grazing.npy", {1, 32, 128}, silence);
  ASSERT_EQ(results.check(), 3) << results.said();
  EXPECT_THAT(results.wrong(), ElementsAre("grazing"));
  fs::remove(results.results / "grazing.npy");
  ASSERT_EQ(results.check(), 0);
  EXPECT_THAT(Json::parse(results.said())["missing"], ElementsAre("grazing"));
  fs::remove(results.results / "range-law.npy");
  EXPECT_EQ(results.check(), 2);
  EXPECT_THAT(results.said(), HasSubstr("found no result of any scene"));
  // Suite v1: figures, no verdicts.
  const std::string v1 = (reference_folder() / "v1").string();
  EXPECT_EQ(
      shell(results.python + " '" + (suite / "compare.py").string() + "' " + v1 + " " + v1, folder / "said"),
      0)
      << bytes_of(folder / "said");
  EXPECT_THAT(bytes_of(folder / "said"), HasSubstr("box-and-wall"));
}

}  // namespace
}  // namespace tubefoot
