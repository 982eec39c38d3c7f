// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the Python examples of docs/output-files.md that read and write echo files, unchanged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// Returns Debian's Python, or another with the modules that the examples import. Returns an empty string
/// if there is none.
std::string python_with_netcdf4() {
  for (const std::string python : {"/usr/bin/python3", "python3"})
    if (std::system((python + " -c 'import netCDF4, numpy' >/dev/null 2>&1").c_str()) == 0) return python;
  return {};
}

/// Returns the code block under a heading of the page.
std::string example(const std::string& heading) {
  const std::string page = bytes_of(std::filesystem::path(TUBEFOOT_SOURCE_DIR) / "docs" / "output-files.md"),
                    begin = "```python\n";
  const std::size_t section = page.find("\n### " + heading + "\n");
  if (section == std::string::npos) throw std::runtime_error("no section " + heading);
  const std::size_t block = page.find(begin, section);
  if (block == std::string::npos) throw std::runtime_error("no Python under " + heading);
  const std::size_t at = block + begin.size();
  return page.substr(at, page.find("```\n", at) - at);
}

const std::string reading = "The strongest echo", writing = "Write an echo file";

/// A flat seabed under a camera that by default has the beams and samples of the example.
const std::string camera_scene =
    replaced(smallest_scene, "kind = \"fixed\"\n", "kind = \"fixed\"\nposition_m = [0, 0, 2]\n") +
    "tilt_deg = 30\n";

struct EchoExamples : testing::Test {
  TestFolder folder;
  std::string python = python_with_netcdf4(), reference = (folder / "results" / "echoes.nc").string();

  void SetUp() override {
    if (python.empty()) GTEST_SKIP() << "no Python with netCDF4 and NumPy (Debian: python3-netcdf4)";
    echoes_in(folder, camera_scene);
  }
  /// Returns the output of an example for a file.
  std::string run(const std::string& heading, const std::string& file) const {
    const auto script = folder.write("example.py", example(heading));
    const auto output = folder / "output.txt";
    EXPECT_EQ(
        std::system(
            (python + " '" + script.string() + "' '" + file + "' >'" + output.string() + "' 2>&1").c_str()),
        0)
        << bytes_of(output);
    return bytes_of(output);
  }
};

TEST_F(EchoExamples, TheFirstReadsTheStrongestEcho) {
  EXPECT_THAT(run(reading, reference), HasSubstr("camera: -"));
  EXPECT_THAT(run(reading, reference), HasSubstr("ping 0, beam "));
}

TEST_F(EchoExamples, TheSecondWritesAFileThatCompares) {
  const std::string mine = (folder / "mine.nc").string();
  run(writing, mine);
  const Outcome outcome = run_program({"compare", reference, mine, "--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["candidate"]["engine"], "mine");
  EXPECT_NEAR(json["sensors"][0]["candidate_total_j"], 3e-9, 1e-20);
  // 3.771 m and 3.772 m lie in sample floor(2.931 / (5 / 512)) = 300.
  const Echoes echoes = read_echoes(mine);
  EXPECT_DOUBLE_EQ(echoes.at(0, 70, 300), 1e-9);
  EXPECT_DOUBLE_EQ(echoes.at(0, 12, 344), 2e-9);
  // An engine needs at most twenty lines, including imports.
  const std::string code = example(writing);
  EXPECT_LE(std::count(code.begin(), code.end(), '\n'), 20);
}

}  // namespace
}  // namespace tubefoot
