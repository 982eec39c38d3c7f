// SPDX-License-Identifier: GPL-3.0-or-later
// Tests small input that requests large resources. The program rejects it before allocation, with the
// position, the limit and a remedy. No recursion follows deep or degenerate input.
#include <fmt/format.h>
#include <netcdf.h>

#include <cstring>

#include "fixtures/hostile.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

std::string with_mesh(const std::string& extension) {
  return replaced(small_scene, "thing.obj", "thing." + extension);
}

TEST_F(Hostile, MeshesThatAnnounceMoreThanTheyHold) {
  folder.write("thing.off", "OFF\n4294967294 4294967294 0\n");
  expect_refused(with_mesh("off"), {"scene.toml:8:1: ", "thing.off:2", "it is cut off"});
  folder.write(
      "thing.ply",
      "ply\nformat binary_little_endian 1.0\nelement face 4294967294\nproperty list uint int "
      "vertex_indices\nelement vertex 4294967294\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n\xff\xff\xff\xff");
  expect_refused(with_mesh("ply"), {"thing.ply: is cut off in face 1 of 4294967294"});
  folder.write("thing.stl", std::string(80, '\0') + "\xff\xff\xff\xff");
  expect_refused(with_mesh("stl"), {"declares 4294967295 facets", "the file has 84"});
  folder.write("thing.stl", "");
  fs::resize_file(folder / "thing.stl", std::uintmax_t{1} << 40);  // a sparse file
  expect_refused(with_mesh("stl"), {"scene.toml:11:8: 'file'", "more than 64 GiB", "cut the file"});
}

/// A TIFF of single-precision cells of one block without data, which readers take for zeros.
std::string sparse_tiff(std::uint32_t columns, std::uint32_t rows, std::uint32_t rows_a_block) {
  std::string bytes("II*\0\x08\0\0\0", 8);
  const auto put = [&bytes](auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const std::uint32_t blocks = (rows + rows_a_block - 1) / rows_a_block;
  const auto entry = [&](std::uint16_t tag, std::uint16_t type, std::uint32_t count, std::uint32_t value) {
    put(tag), put(type), put(count), put(value);
  };
  constexpr std::uint16_t entries = 12, two_bytes = 3, four_bytes = 4, real = 12;
  const std::uint32_t scale_at = 8 + 2 + entries * 12 + 4, tie_at = scale_at + 3 * 8,
                      blocks_at = tie_at + 6 * 8;
  const std::uint32_t list_at = blocks == 1 ? 0 : blocks_at;
  put(entries);
  entry(256, four_bytes, 1, columns);
  entry(257, four_bytes, 1, rows);
  entry(258, two_bytes, 1, 32);
  entry(259, two_bytes, 1, 8);  // deflated, because GDAL reads an uncompressed block by rows
  entry(262, two_bytes, 1, 1);
  entry(273, four_bytes, blocks, list_at);  // the offsets of the blocks are 0
  entry(277, two_bytes, 1, 1);
  entry(278, four_bytes, 1, rows_a_block);
  entry(279, four_bytes, blocks, list_at);
  entry(339, two_bytes, 1, 3);  // floating point
  entry(33550, real, 3, scale_at);
  entry(33922, real, 6, tie_at);
  put(std::uint32_t{0});
  for (const double value : {1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}) put(value);
  if (blocks > 1) bytes.append(4 * std::size_t{blocks}, '\0');
  return bytes;
}

std::string with_raster_keys(const std::string& more) {
  return replaced(small_scene, "kind = \"flat\"\nwidth_m = 20\nlength_m = 30",
                  "kind = \"raster\"\nfile = \"grid.tif\"\n" + more);
}

TEST_F(Hostile, RastersThatAnnounceMoreThanTheyHold) {
  folder.write("grid.tif", sparse_tiff(100'000, 100'000, 1000));
  expect_refused(with_raster_keys(""),
                 {"scene.toml:4:1: ", "100000 x 100000 cells exceed the limit of 2e+09", "decimate"});
  expect_refused(with_raster_keys("load = \"whole\""),
                 {"scene.toml:4:1: ", "100000 x 100000 cells exceed the limit of 5e+07", "decimate"});
  // The scene requests only a corner of the raster.
  folder.write("grid.tif", sparse_tiff(100'000, 100'000, 100'000));
  expect_refused(with_raster_keys("window = [0, 0, 10, 10]"),
                 {"blocks of 100000 x 100000 cells, which are larger than 512 MB each", "gdal_translate"});
  folder.write("grid.tif", sparse_tiff(2'000'000'000, 2, 1));
  expect_refused(with_raster_keys("window = [0, 0, 10, 2]"), {"blocks of 2000000000 x 1 cells"});
  folder.write("grid.tif", sparse_tiff(40'000, 1000, 100));
  const Outcome corner = check(with_raster_keys("window = [0, 0, 10, 10]"));
  EXPECT_EQ(corner.exit_code, 0) << corner.err;
  // The other readers of rasters.
  const std::string tile =
      "\n[[materials.reflectivity]]\nkind = \"map\"\ntile_m = [10, 10]\nfile = \"grid.tif\"";
  folder.write("grid.tif", sparse_tiff(100'000, 100'000, 100'000));
  expect_refused(replaced(small_scene, "name = \"sand\"", "name = \"sand\"" + tile),
                 {"100000 x 100000 pixels exceed the limit of 5e+07", "shrink the image"});
  expect_refused(replaced(small_scene, "length_m = 30",
                          "length_m = 30\n[terrain.material_map]\nkind = \"raster\"\nfile = "
                          "\"grid.tif\"\nclasses = { 0 = \"sand\" }"),
                 {"100000 x 100000 cells exceed the limit of 5e+07"});
}

TEST_F(Hostile, TablesOfOneEndlessLine) {
  const std::string on_a_track = replaced(small_scene, "kind = \"fixed\"\nposition_m = [0, 0, 2]",
                                          "kind = \"waypoints\"\nfile = \"track.csv\"");
  for (const char filling : {',', '\0'}) {
    SCOPED_TRACE(filling);
    folder.write("track.csv", std::string(3 << 20, filling));
    expect_refused(on_a_track, {"track.csv:1: the line is longer than 1048576 bytes"});
  }
  folder.write("law.csv", std::string(3 << 20, ' '));
  expect_refused(
      replaced(small_scene, "name = \"sand\"", "name = \"sand\"\nlaw = \"table\"\ntable_file = \"law.csv\""),
      {"law.csv:1: the line is longer than 1048576 bytes"});
}

std::string sphere(double chord_error_m) {
  return replaced(small_scene, "shape = \"mesh\"\nfile = \"thing.obj\"",
                  fmt::format("shape = \"sphere\"\nchord_error_m = {}", chord_error_m));
}

TEST_F(Hostile, NumbersInASceneFile) {
  expect_refused(
      replaced(small_scene, "width_m = 20", "width_m = 1e7\ncell_m = 1e-3"),
      {"scene.toml:4:1: ", "the terrain would have 3e+14 cells, but at most 5e+07", "larger cell_m"});
  expect_refused(sphere(1e-12),
                 {"scene.toml:8:1: ", "but at most 2e+07 are allowed", "larger chord_error_m"});
  expect_refused(replaced(small_scene, "beams = 4", "beams = 4096\nsamples = 65536"),
                 {"scene.toml:19:11: ", "268435456 range bins per ping, but at most 67108864"});
  expect_refused(
      replaced(small_scene, "beams = 4\n", "beams = 4000\ncycles = 4000\npings = 10000000\n"),
      {"scene.toml:20:", "with 4000 transmissions each give 40000000000 transmissions, but at most 100000000",
       "distribute the pings"});
  const std::string relief =
      "name = \"sand\"\n[[materials.relief]]\nkind = \"fbm\"\ntile_m = 1000\nresolution_m = 1e-6\nhurst = "
      "0.5\nrms_height_m = 0.1\n";
  expect_refused(replaced(small_scene, "name = \"sand\"\n", relief),
                 {"the limit is 16384", "coarser resolution_m"});
  expect_refused(
      replaced(small_scene, "length_m = 30",
               "length_m = 30\n[terrain.material_map]\nkind = \"patches\"\npatch_size_m = 1e-6\nshares = { "
               "sand = 1 }"),
      {"more than 200000", "increase 'patch_size_m'"});
}

struct HostileToMemory : Hostile {
  void SetUp() override {
#ifdef TUBEFOOT_SANITIZED
    GTEST_SKIP() << "sanitizers set aside terabytes of addresses, so there is no limit to exceed";
#endif
  }
};

TEST_F(HostileToMemory, NumbersWithinAllOtherLimits) {
  expect_refused(
      replaced(small_scene, "width_m = 20\nlength_m = 30", "width_m = 7000\nlength_m = 7000\ncell_m = 1"),
      {"scene.toml:4:1: ", "4.9e+07 cells would need 7.84 GB of memory", "GB are available",
       "larger cell_m"});
  expect_refused(sphere(3e-7), {"scene.toml:8:1: ", "facets would need", "larger chord_error_m"});
  expect_refused(replaced(small_scene, "beams = 4\n", "beams = 4\ncycles = 4\npings = 10000000\n"),
                 {"scene.toml:15:1: ", "the poses of 4e+07 transmissions would need 3.6 GB",
                  "reduce the number of pings"});
  folder.write("grid.tif", sparse_tiff(7000, 7000, 100));
  expect_refused(with_raster_keys("load = \"whole\""),
                 {"facets between 7000 x 7000 cells would need 7.84 GB of memory", "decimate"});
}

// Each part fits, but their sum does not.
TEST_F(HostileToMemory, SumsOfWhatFits) {
  std::string scene(small_scene);
  for (int k = 0; k < 12; ++k)
    scene += fmt::format(
        "[[objects]]\nname = \"ball{}\"\nshape = \"sphere\"\nposition_m = [0, 9, 5]\nchord_error_m = 4e-6\n",
        k);
  expect_refused(scene, {"facets would need", "GB are available"}, 800);
}

TEST_F(Hostile, RunsThatWouldFillTheDisk) {
  folder.write("scene.toml",
               replaced(small_scene, "beams = 4", "beams = 4096\nsamples = 16384\npings = 100000"));
  const auto before = names_below(folder.path());
  const Outcome outcome = run({"run", (folder / "scene.toml").string(), "-o", (folder / "results").string()});
  expect_harmless(outcome);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("results.partial: cannot reserve 53740814.6 MB"),
                                 HasSubstr("choose another -o")));
  EXPECT_EQ(names_below(folder.path()), before);
}

TEST_F(Hostile, SceneFilesAsDeepAsTheyGet) {
  std::string deep = "x = [\n";
  constexpr int levels = 120;
  for (int k = 0; k < levels; ++k) {
    deep += '{';
    for (int n = 0; n < 60; ++n) deep += n == 0 ? "a" : ".a";
    deep += " = [\n";
  }
  for (int k = 0; k < levels; ++k) deep += "]}\n";
  expect_refused(deep + "]\n", {"scene.toml:1:1: unknown section or key 'x'"});
  expect_refused("x = " + std::string(100'000, '['), {"scene.toml:1:", "not valid TOML"});
  expect_refused("x" + std::string(100'000, '.'), {"scene.toml"});
  expect_refused(std::string((8 << 20) + 1, '\n'), {"scene.toml: is larger than 8388608 bytes"});
  std::string many(small_scene);
  while (many.size() < 8'000'000) many += "x" + std::to_string(many.size()) + " = []\n";
  expect_refused(many, {"scene.toml:21:1: unknown key"});
}

TEST_F(Hostile, PolygonsNestedWithoutEnd) {
  const std::string map = replaced(small_scene, "length_m = 30",
                                   "length_m = 30\n[terrain.material_map]\nkind = \"polygons\"\nfile = "
                                   "\"map.geojson\"\ncoordinates = \"local\"");
  folder.write("map.geojson",
               R"({"type":"Feature","properties":{"material":"sand"},"geometry":{"type":"Polygon",)"
               R"("coordinates":)" +
                   std::string(200'000, '['));
  expect_refused(map, {"scene.toml:", "map.geojson"});
}

// No split separates these facets, so that each would be compared with each.
TEST_F(Hostile, ManyFacetsOnOneSpot) {
  const auto audit = [&](const std::string& mesh) {
    folder.write("scene.toml", small_scene);
    folder.write("thing.obj", mesh);
    const Outcome outcome = run({"audit", (folder / "scene.toml").string(), "--quiet"});
    expect_harmless(outcome);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  const std::string alone = audit(std::string(tetrahedron));
  std::string copies(tetrahedron);
  for (int k = 0; k < 50'000; ++k) copies += "f 1 3 2\nf 3 1 2\nf 4 3 1\nf 2 4 3\n";
  EXPECT_EQ(audit(copies), alone);
}

// A few kilobytes that claim to contain 8 TB of energies.
TEST_F(Hostile, EchoFilesThatWereNeverWritten) {
  const std::string file = (folder / "echoes.nc").string();
  int id = 0, energy = 0, dimensions[3];
  ASSERT_EQ(nc_create(file.c_str(), NC_NETCDF4, &id), NC_NOERR);
  nc_def_dim(id, "ping", 100'000, &dimensions[0]);
  nc_def_dim(id, "beam", 1000, &dimensions[1]);
  nc_def_dim(id, "sample", 10'000, &dimensions[2]);
  nc_def_var(id, "energy", NC_DOUBLE, 3, dimensions, &energy);
  const std::size_t chunk[3] = {1, 1000, 10'000};
  nc_def_var_chunking(id, energy, NC_CHUNKED, chunk);
  nc_put_att_text(id, energy, "units", 1, "J");
  ASSERT_EQ(nc_close(id), NC_NOERR);
  ASSERT_LT(fs::file_size(file), 100'000u);
  const Outcome outcome = run({"compare", file, file});
  expect_harmless(outcome);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("echoes.nc: "), HasSubstr("(see docs/output-files.md for the layout)")));
}

}  // namespace
}  // namespace tubefoot
