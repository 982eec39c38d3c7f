// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes rasters as terrain, relief and micro-texture. GDAL itself is not under test: validation/fuzzing.md.
#include <array>
#include <cmath>
#include <optional>

#include "files/shown.hpp"
#include "frame_on_earth.hpp"
#include "fuzz.hpp"
#include "gdal_is_quiet.hpp"
#include "named_file.hpp"
#include "scene/rasters/raster.hpp"
#include "scene/surfaces/reflectivity.hpp"
#include "scene/surfaces/relief_map.hpp"

namespace tubefoot::fuzz {
namespace {

void terrain(const std::filesystem::path& file, std::uint8_t options, Bytes& bytes) {
  RasterTerrain described;
  described.file = file;
  described.decimate = 1 + options % 4;
  described.depth_positive_down = (options & 4) != 0;
  if ((options & 8) != 0) {
    described.window.emplace();
    for (int& edge : *described.window) edge = bytes.take<std::int8_t>();
  }
  std::optional<LocalFrame> frame;
  if ((options & 16) != 0) frame = frame_on_earth();
  const ComponentMesh mesh = read_raster(described, frame);
  if (!frame) finding("a raster without a frame");
  if (mesh.triangles.empty()) finding("a raster without a facet");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= mesh.points_m.size()) finding("a corner out of range");
  for (const glm::dvec3& p : mesh.points_m)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) finding("a point at no place");
  for (const std::string& warning : mesh.warnings) check_message(shown(warning));
}

void relief(const std::filesystem::path& file, std::uint8_t options) {
  MapReliefDescription described;
  described.file = file;
  if ((options & 4) != 0) described.tile_m = 10;
  std::vector<std::string> warnings;
  const auto field =
      read_relief_map(described, (options & 16) != 0 ? frame_on_earth() : LocalFrame(), warnings);
  for (const glm::dvec3 place : {glm::dvec3(0), glm::dvec3(3, 4, 0), glm::dvec3(-1e4, 7e3, -5)})
    if (!std::isfinite(field->height_m(place))) finding("relief without a height");
  for (const std::string& warning : warnings) check_message(shown(warning));
}

void micro_texture(const std::filesystem::path& file, std::uint8_t options) {
  MaterialDescription material;
  material.place.file = "scene.toml";
  MapReflectivityKeys map;
  map.file = file;
  map.values = (options & 8) != 0 ? "db" : "factor";
  if ((options & 4) != 0) map.tile_m = {10, 20};
  ReflectivityDescription described;
  described.place.file = "scene.toml";
  described.kind = map;
  material.reflectivity.push_back(described);
  std::vector<std::string> warnings;
  const auto field =
      load_reflectivity(material, (options & 16) != 0 ? frame_on_earth() : LocalFrame(), warnings);
  for (const glm::dvec3 place : {glm::dvec3(0), glm::dvec3(3, 4, 0), glm::dvec3(-1e4, 7e3, -5)})
    if (!(field->factor(place) >= 0)) finding("micro-texture without a factor");
  for (const std::string& warning : warnings) check_message(shown(warning));
}

}  // namespace
}  // namespace tubefoot::fuzz

/// A byte each for the format, the use and its options, four for a window, then the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  const fuzz::NamedFile unopened;
  fuzz::Bytes bytes(data, size);
  constexpr std::array names{"r.asc", "r.tif", "r.nc", "r.png", "r.vrt"};
  const char* const name = names[bytes.below(names.size())];
  const std::uint32_t use = bytes.below(3);
  const auto options = bytes.take<std::uint8_t>();
  const std::string_view window = bytes.text(4);
  fuzz::Bytes edges(reinterpret_cast<const std::uint8_t*>(window.data()), window.size());
  const auto file = fuzz::scratch_file(name, bytes.rest());
  fuzz::may_refuse([&] {
    if (use == 0) return fuzz::terrain(file, options, edges);
    if (use == 1) return fuzz::relief(file, options);
    fuzz::micro_texture(file, options);
  });
  return 0;
}
