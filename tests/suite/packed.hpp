// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fixtures/program.hpp"

// Runs the program to write benchmark suites, and reads their files with code that is independent of the
// program.
namespace tubefoot {

using Json = nlohmann::json;

inline std::filesystem::path reference_folder() {
  return std::filesystem::path(TUBEFOOT_SOURCE_DIR) / "validation" / "reference";
}

inline std::filesystem::path packed(const TestFolder& folder, const std::string& name,
                                    const std::vector<std::string>& options) {
  std::vector<std::string> words{"suite", "-o", (folder / name).string(), "--quiet"};
  words.insert(words.end(), options.begin(), options.end());
  const Outcome outcome = run_program(words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return folder / name;
}

inline Json json_in(const std::filesystem::path& file) { return Json::parse(bytes_of(file)); }

/// An array of float64, read as README.md describes.
struct Array {
  std::size_t pings = 0, beams = 0, samples = 0;
  std::vector<double> values;
  double at(std::size_t ping, std::size_t beam, std::size_t sample) const {
    return values.at((ping * beams + beam) * samples + sample);
  }
  double of_beam(std::size_t beam, std::size_t first = 0) const {
    double sum = 0;
    for (std::size_t p = 0; p < pings; ++p)
      for (std::size_t k = first; k < samples; ++k) sum += at(p, beam, k);
    return sum;
  }
  double sum(std::size_t first_sample = 0) const {
    double all = 0;
    for (std::size_t b = 0; b < beams; ++b) all += of_beam(b, first_sample);
    return all;
  }
};

inline Array array_in(const std::filesystem::path& file) {
  const std::string bytes = bytes_of(file);
  const std::size_t header =
      10 + static_cast<unsigned char>(bytes.at(8)) + 256u * static_cast<unsigned char>(bytes.at(9));
  Array array;
  EXPECT_EQ(
      std::sscanf(bytes.c_str() + 10, "{'descr': '<f8', 'fortran_order': False, 'shape': (%zu, %zu, %zu)",
                  &array.pings, &array.beams, &array.samples),
      3);
  EXPECT_EQ(header % 64, 0u);
  array.values.resize(array.pings * array.beams * array.samples);
  EXPECT_EQ(bytes.size(), header + 8 * array.values.size());
  std::memcpy(array.values.data(), bytes.data() + header, bytes.size() - header);
  return array;
}

/// Vertices of an OBJ, and its triangles.
struct Mesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::size_t, 3>> facets;
};

inline Mesh mesh_in(const std::filesystem::path& file) {
  Mesh mesh;
  std::istringstream text(bytes_of(file));
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v")
      words >> mesh.vertices.emplace_back()[0] >> mesh.vertices.back()[1] >> mesh.vertices.back()[2];
    if (word == "f") {
      auto& facet = mesh.facets.emplace_back();
      for (std::size_t& corner : facet) words >> corner, --corner;
    }
  }
  return mesh;
}

/// Returns Debian's Python, or another with NumPy and netCDF4. Returns an empty string if there is none.
inline std::string python_with_netcdf4() {
  for (const std::string python : {"/usr/bin/python3", "python3"})
    if (std::system((python + " -c 'import netCDF4, numpy' >/dev/null 2>&1").c_str()) == 0) return python;
  return {};
}

/// Exit code of a shell command, whose output goes to a file.
inline int shell(const std::string& command, const std::filesystem::path& output) {
  const int status = std::system((command + " >'" + output.string() + "' 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace tubefoot
