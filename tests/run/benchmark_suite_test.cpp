// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the shipped benchmark suite. It is complete, agrees with closed forms, and is reproducible by the
// current program. Its own script gives the same comparisons as `tubefoot compare`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "files/file_hash.hpp"
#include "fixtures/program.hpp"
#include "geometry/numbers/scalars.hpp"
#include "scene/description/scene_description.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/recordings/echo_reader.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double promised = 1e-9;

fs::path suite() { return fs::path(TUBEFOOT_SOURCE_DIR) / "validation" / "reference" / "v1"; }

SensorEchoes echoes_in_file(const fs::path& file) { return read_echo_file(file).sensors.at(0); }

std::vector<std::string> scenes() {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(suite()))
    if (fs::exists(entry.path() / "scene.toml")) names.push_back(entry.path().filename().string());
  return names;
}

/// Runs a scene of the benchmark suite with the current program.
fs::path run(const TestFolder& folder, const std::string& scene, std::vector<std::string> options) {
  std::vector<std::string> words{"run", (suite() / scene / "scene.toml").string(), "-o",
                                 (folder / "now").string(), "--quiet"};
  words.insert(words.end(), options.begin(), options.end());
  const Outcome outcome = run_program(words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return folder / "now" / "echoes.nc";
}

TEST(BenchmarkSuite, HoldsWhatItsChecksumsSay) {
  std::ifstream sums(suite() / "SHA256SUMS");
  std::set<std::string> listed;
  for (std::string digest, name; sums >> digest >> name;) {
    Sha256 hash;
    hash.update(bytes_of(suite() / name));
    EXPECT_EQ(hash.hex_digest(), digest) << name;
    listed.insert(name);
  }
  std::set<std::string> shipped;
  for (const std::string& name : names_below(suite()))
    if (fs::is_regular_file(suite() / name) && fs::path(name).has_parent_path()) shipped.insert(name);
  EXPECT_EQ(listed, shipped);
  EXPECT_GE(scenes().size(), 6u);
}

TEST(BenchmarkSuite, IsOfTheScenesBesideItAndAsNarrowAsPromised) {
  for (const std::string& scene : scenes()) {
    const fs::path file = suite() / scene / "echoes.nc";
    const SensorEchoes echoes = echoes_in_file(file);
    ASSERT_EQ(echoes.energy_bound.size(), echoes.energy.size()) << scene;
    const double strongest = *std::max_element(echoes.energy.begin(), echoes.energy.end());
    EXPECT_GT(strongest, 0) << scene;
    for (std::size_t beam = 0; beam < echoes.pings * echoes.beams; ++beam) {
      const auto first = echoes.energy.begin() + static_cast<std::ptrdiff_t>(beam * echoes.samples);
      const double of_beam = *std::max_element(first, first + static_cast<std::ptrdiff_t>(echoes.samples));
      for (std::size_t k = beam * echoes.samples; k < (beam + 1) * echoes.samples; ++k)
        ASSERT_LE(echoes.energy_bound[k],
                  promised * std::max({echoes.energy[k], 1e-6 * of_beam, 1e-12 * strongest}))
            << scene << ", bin " << k;
    }
    EXPECT_EQ(read_echo_file(file).provenance.scene_hash,
              read_scene_file(suite() / scene / "scene.toml").sha256)
        << scene;
  }
}

// README.md: E = mu h^2 w (r0^-4 - r1^-4) / 4 on the flat seabed, with w between the rounded corner rays.
TEST(BenchmarkSuite, FlatSeabedHoldsItsClosedForm) {
  const SensorEchoes echoes = echoes_in_file(suite() / "flat-bed" / "echoes.nc");
  ASSERT_EQ(echoes.beams, 32u);
  ASSERT_EQ(echoes.samples, 256u);
  constexpr double mu = 0.01, height_m = 2;
  const auto edge = [](std::size_t k) {
    const double azimuth = (static_cast<double>(k) - 16) * degree, across = std::cos(30 * degree);
    const double scale = std::ldexp(1.0, 30) - 1;
    return std::atan2(std::round(std::sin(azimuth) * across * scale),
                      std::round(std::cos(azimuth) * across * scale));
  };
  for (std::size_t beam = 0; beam < echoes.beams; ++beam)
    for (std::size_t k = 0; k < echoes.samples; ++k) {
      const double r0 = 4 + static_cast<double>(k) / 32, r1 = r0 + 1.0 / 32;
      const double truth = mu * height_m * height_m * (edge(beam + 1) - edge(beam)) *
                           (std::pow(r0, -4) - std::pow(r1, -4)) / 4;
      const std::size_t bin = beam * echoes.samples + k;
      ASSERT_LE(std::abs(echoes.energy[bin] - truth), echoes.energy_bound[bin])
          << "beam " << beam << ", sample " << k;
    }
  EXPECT_NEAR(echoes.energy[16 * 256 + 100], 1.17521e-9, 1e-14);  // as README.md states
}

TEST(BenchmarkSuite, ComesOutAgainWithinBothBounds) {
  const TestFolder folder;
  const SensorEchoes shipped = echoes_in_file(suite() / "box-and-wall" / "echoes.nc"),
                     now =
                         echoes_in_file(run(folder, "box-and-wall", {"--reference", "--tolerance", "1e-7"}));
  ASSERT_EQ(now.energy.size(), shipped.energy.size());
  for (std::size_t k = 0; k < now.energy.size(); ++k)
    ASSERT_LE(std::abs(now.energy[k] - shipped.energy[k]), now.energy_bound[k] + shipped.energy_bound[k])
        << "bin " << k;
}

/// Returns Debian's Python, or another with the modules that compare.py imports. Returns an empty string if
/// there is none.
std::string python_with_netcdf4() {
  for (const std::string python : {"/usr/bin/python3", "python3"})
    if (std::system((python + " -c 'import netCDF4, numpy' >/dev/null 2>&1").c_str()) == 0) return python;
  return {};
}

struct SuiteScript : testing::Test {
  TestFolder folder;
  std::string python = python_with_netcdf4();

  void SetUp() override {
    if (python.empty()) GTEST_SKIP() << "no Python with netCDF4 and NumPy (Debian: python3-netcdf4)";
  }
  /// Returns the exit code of the script. The output goes to output.txt.
  int compare(const fs::path& reference, const fs::path& candidate) const {
    const std::string script = (suite().parent_path() / "compare.py").string(),
                      output = (folder / "output.txt").string();
    const int status = std::system((python + " '" + script + "' '" + reference.string() + "' '" +
                                    candidate.string() + "' --json >'" + output + "' 2>&1")
                                       .c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string output() const { return bytes_of(folder / "output.txt"); }
};

/// The figures of the script equal those of the program, except for the rounding of sums.
void expect_same(const Json& script, const Json& program, const std::string& where) {
  if (program.is_object()) {
    for (const auto& [key, value] : program.items()) {
      ASSERT_TRUE(script.contains(key)) << where << " " << key;
      expect_same(script.at(key), value, where + " " + key);
    }
    EXPECT_EQ(script.size(), program.size()) << where;
  } else if (program.is_array()) {
    ASSERT_EQ(script.size(), program.size()) << where;
    for (std::size_t k = 0; k < program.size(); ++k)
      expect_same(script[k], program[k], where + " " + std::to_string(k));
  } else if (program.is_number_float()) {
    const double a = script.get<double>(), b = program.get<double>();
    EXPECT_NEAR(a, b, 1e-10 * std::abs(b) + (where.ends_with("energy_ratio_db") ? 1e-12 : 0)) << where;
  } else {
    EXPECT_EQ(script, program) << where;
  }
}

TEST_F(SuiteScript, MeasuresAsTubefootCompareDoes) {
  // With few rays, bins are missed and returns come late.
  for (const char* rays : {"600", "40000"}) {
    const TestFolder run_folder;
    const fs::path reference = suite() / "sphere" / "echoes.nc",
                   candidate = run(run_folder, "sphere", {"--engine", "ray", "--rays", rays});
    ASSERT_EQ(compare(reference, candidate), 0) << output();
    const Outcome program = run_program({"compare", reference.string(), candidate.string(), "--json", "-"});
    ASSERT_EQ(program.exit_code, 0) << program.err;
    const Json expected = Json::parse(program.out)["sensors"], found = Json::parse(output())["sensors"];
    EXPECT_GT(expected[0]["l1_error"], 0.01);
    EXPECT_GT(expected[0]["empty_where_lit"], 0);
    expect_same(found, expected, rays);
  }
}

TEST_F(SuiteScript, RefusesWhatTubefootCompareRefuses) {
  const fs::path reference = suite() / "sphere" / "echoes.nc";
  const auto rays = fs::path(run(folder, "bowl", {"--engine", "ray", "--rays", "1000"}));
  EXPECT_EQ(compare(reference, rays), 2);
  EXPECT_THAT(output(), testing::HasSubstr("compute the same scene"));
  EXPECT_EQ(compare(reference, suite() / "README.md"), 2);
  EXPECT_THAT(output(), testing::HasSubstr("cannot read the file"));
  EXPECT_EQ(compare(reference, reference), 0) << output();
  EXPECT_EQ(Json::parse(output())["sensors"][0]["l1_error"], 0);
}

}  // namespace
}  // namespace tubefoot
