// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the Python examples of docs/footprints.md unchanged with the recommended libraries. Their results
// agree with the CSV file.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <sstream>

#include "fixtures/program.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Returns the code block under a heading.
std::string example(const std::string& heading) {
  const std::string page = bytes_of(fs::path(TUBEFOOT_SOURCE_DIR) / "docs" / "footprints.md"),
                    begin = "```python\n";
  const std::size_t section = page.find(heading + "\n"), at = page.find(begin, section) + begin.size();
  if (section == std::string::npos) throw std::runtime_error("no section " + heading);
  return page.substr(at, page.find("```\n", at) - at);
}

constexpr std::string_view example_scene = R"([[materials]]
name = "sand"
[[materials]]
name = "painted steel"
[[terrain]]
name = "bed"
kind = "flat"
material = "sand"
width_m = 40
length_m = 60
[[objects]]
name = "ball"
material = "painted steel"
shape = "sphere"
radius_m = 0.5
position_m = [0.2, 4, 0.3]
[trajectory]
kind = "fixed"
position_m = [0, 0, 2.5]
[[sensors]]
name = "camera"
kind = "didson"
tilt_deg = 30
beams = 6
horizontal_deg = 12
window_start_m = 1
window_length_m = 20
)";

struct FootprintExamples : testing::Test {
  TestFolder folder;
  static constexpr const char* python = "/usr/bin/python3";

  fs::path footprints(const std::string& name, const std::vector<std::string>& more = {}) const {
    const fs::path file = folder / name;
    std::vector<std::string> words{"footprints", folder.write("scene.toml", example_scene).string(),
                                   "--sensor",   "camera",
                                   "-o",         file.string(),
                                   "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return file;
  }
  /// Returns the output of the example under a heading for a file, or nothing if Python lacks an imported
  /// module.
  std::string run(const std::string& heading, const fs::path& file) const {
    const auto script = folder.write("example.py", example(heading));
    const auto output = folder / "output.txt";
    const int status = std::system(
        fmt::format("'{}' '{}' '{}' >'{}' 2>&1", python, script.string(), file.string(), output.string())
            .c_str());
    std::string printed = bytes_of(output);
    if (status != 0 && (printed.find("ModuleNotFoundError") != std::string::npos || !fs::exists(python)))
      return {};
    EXPECT_EQ(status, 0) << printed;
    return printed;
  }
  /// Returns the number after a text.
  static double behind(const std::string& output, const std::string& text) {
    const std::size_t at = output.find(text);
    if (at == std::string::npos) throw std::runtime_error("no '" + text + "' in: " + output);
    return std::stod(output.substr(at + text.size()));
  }

  struct Totals {
    std::size_t rows = 0, pieces = 0, occluders = 0;
    double area_m2 = 0, energy_j = 0;
    std::map<int, double> energy_of_beam;
  };
  Totals totals() const {
    GDALAllRegister();
    const std::unique_ptr<GDALDataset> data(GDALDataset::Open(
        footprints("table.csv").c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
    Totals all;
    for (const auto& feature : *data->GetLayer(0)) {
      const double energy = feature->GetFieldAsDouble("energy_j");
      ++all.rows;
      all.pieces += std::size_t(feature->GetFieldAsInteger("pieces"));
      all.area_m2 += feature->GetFieldAsDouble("area_m2");
      all.energy_j += energy;
      all.energy_of_beam[feature->GetFieldAsInteger("beam")] += energy;
      std::istringstream facets(feature->GetFieldAsString("occluders"));
      for (int facet; facets >> facet;) ++all.occluders;
    }
    return all;
  }
};

TEST_F(FootprintExamples, GeoPandasReadsTheGeoPackage) {
  const std::string output = run("### GeoPandas", footprints("camera.gpkg"));
  if (output.empty()) GTEST_SKIP() << "Debian's python3-geopandas is not installed";
  const Totals all = totals();
  EXPECT_THAT(output, HasSubstr(fmt::format("{} footprints in tubefoot local east-north\n", all.rows)));
  EXPECT_NEAR(behind(output, "m2, area "), all.area_m2, 1e-9 * all.area_m2);
  EXPECT_LT(behind(output, "plan area "), all.area_m2);
  EXPECT_EQ(all.energy_of_beam.size(), 6u);
  for (const auto& [beam, energy] : all.energy_of_beam)
    EXPECT_NEAR(behind(output, fmt::format("beam {} energy ", beam)), energy, 1e-9 * energy);
}

TEST_F(FootprintExamples, GeoPandasKnowsTheSceneOnEarth) {
  const auto local = footprints("camera.gpkg");
  const std::string here = run("### GeoPandas", local);
  if (here.empty()) GTEST_SKIP() << "Debian's python3-geopandas is not installed";
  const double area = behind(here, "plan area ");
  const std::string on_earth =
      "[georeference]\ncrs = \"EPSG:32632\"\norigin_crs = [431000, 5400000]\n" + std::string(example_scene);
  const auto file = folder / "utm.gpkg";
  ASSERT_EQ(run_program({"footprints", folder.write("utm.toml", on_earth).string(), "--sensor", "camera",
                         "-o", file.string(), "--quiet"})
                .exit_code,
            0);
  const std::string output = run("### GeoPandas", file);
  EXPECT_THAT(output, HasSubstr("footprints in WGS 84 / UTM zone 32N\n"));
  // a northing has a resolution of a nanometre
  EXPECT_NEAR(behind(output, "plan area "), area, 1e-5 * area);
}

TEST_F(FootprintExamples, VtkMeasuresTheCells) {
  const std::string output = run("### VTK", footprints("camera.vtp"));
  if (output.empty()) GTEST_SKIP() << "Debian's python3-vtk9 is not installed";
  const Totals all = totals();
  EXPECT_THAT(output, HasSubstr(fmt::format("{} pieces of {} footprints\n", all.pieces, all.rows)));
  EXPECT_NEAR(behind(output, "area "), all.area_m2, 1e-9 * all.area_m2);
  EXPECT_NEAR(behind(output, "energy "), all.energy_j, 1e-9 * all.energy_j);
  EXPECT_LT(behind(output, "worst "), 1e-9);
  EXPECT_EQ(behind(output, "occluders "), double(all.occluders));
  EXPECT_GT(all.occluders, 0u);
  EXPECT_THAT(output, HasSubstr("materials ['sand', 'painted steel']"));
}

TEST_F(FootprintExamples, NetcdfIsReadAsRaggedColumns) {
  const std::string output = run("### NumPy and netCDF4", footprints("camera.nc"));
  if (output.empty()) GTEST_SKIP() << "Debian's python3-netcdf4 is not installed";
  const Totals all = totals();
  EXPECT_THAT(output, HasSubstr(fmt::format("{} footprints", all.rows)));
  EXPECT_NEAR(behind(output, "energy "), all.energy_j, 1e-9 * all.energy_j);
  EXPECT_THAT(output, HasSubstr(" J m-2\n"));  // as in the file
  EXPECT_LT(behind(output, "worst "), 1e-9);
  EXPECT_THAT(output, HasSubstr(fmt::format("occluders {0} {0}\n", all.occluders)));
  EXPECT_THAT(output, HasSubstr("materials ['sand', 'painted steel']"));
}

TEST_F(FootprintExamples, FractionsCloseEveryTube) {
  const fs::path file = footprints("camera.txt", {"--beams", "2:3"});
  const std::string output = run("## Exact corners", file);
  if (output.empty()) GTEST_SKIP() << "Debian's python3 is not installed";
  const auto tubes = std::size_t(behind(output, ""));
  EXPECT_GT(tubes, 1u);
  EXPECT_THAT(output, HasSubstr(fmt::format("closed: {}\n", tubes)));
  EXPECT_GT(behind(output, "tubes, "), double(tubes));
  // The smallest error of a corner is detected.
  std::string text = bytes_of(file);
  const std::size_t piece = text.find("\npiece "), slash = text.find('/', piece);
  ASSERT_NE(slash, std::string::npos);
  char& digit = text[slash - 1];
  digit = digit == '9' ? '8' : char(digit + 1);
  EXPECT_THAT(run("## Exact corners", folder.write("off.txt", text)),
              HasSubstr(fmt::format("closed: {}\n", tubes - 1)));
}

}  // namespace
}  // namespace tubefoot
