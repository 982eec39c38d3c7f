// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a second list of attacks on the input (docs/limits.md). An author who did not know the first list
// took it from the manuals of the formats. The list contains the attacks that succeeded at first.
#include <netcdf.h>
#include <ogrsf_frmts.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <fstream>

#include "fixtures/strangers_files.hpp"
#include "fixtures/watched_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct InputRegistryManuals : InputRegistry {
  /// Expects that `check` and `compare` both reject the file with these words.
  void expect_both_refuse(const std::string& name, const std::string& words) const {
    SCOPED_TRACE(name);
    expect_refused(with_raster(name), {name, words});
    const Outcome compared = run({"compare", (folder / name).string(), (folder / name).string()});
    expect_harmless(compared);
    EXPECT_EQ(compared.exit_code, 2);
    EXPECT_THAT(compared.err, HasSubstr(words));
  }
};

TEST_F(InputRegistryManuals, OverviewsOnAHostAreNotRequested) {
  const CalledHost host;
  const std::vector<std::string> names{"NETCDF:\"" + host.address() + "/a.nc\":z",
                                       "vrt://NETCDF:" + host.address() + "/a.nc", host.address() + "/a.nc"};
  for (const std::string& name : names)
    for (const bool in_tag : {true, false}) {
      SCOPED_TRACE(name);
      GDALAllRegister();
      // The test deletes the files itself, because GDAL would search the overviews of a deleted file.
      for (const char* old : {"grid.tif.aux.xml", "grid.tif"}) fs::remove(folder / old);
      GDALDatasetUniquePtr made(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
          (folder / "grid.tif").c_str(), 100, 100, 1, GDT_Float32, nullptr));
      if (in_tag) made->SetMetadataItem("OVERVIEW_FILE", name.c_str(), "OVERVIEWS");
      made.reset();
      if (!in_tag)
        folder.write("grid.tif.aux.xml",
                     "<PAMDataset><Metadata domain=\"OVERVIEWS\"><MDI key=\"OVERVIEW_FILE\">" + name +
                         "</MDI></Metadata></PAMDataset>");
      folder.write(
          "small.vrt",
          vrt_of(replaced(
              simple_band("grid.tif"), "<SourceBand>1</SourceBand>",
              "<SourceBand>1</SourceBand><SrcRect xOff=\"0\" yOff=\"0\" xSize=\"100\" ySize=\"100\"/>"
              "<DstRect xOff=\"0\" yOff=\"0\" xSize=\"3\" ySize=\"3\"/>")));
      expect_refused(with_raster("small.vrt"), {"refers to another file for its overviews"});
      EXPECT_FALSE(host.was_called());
    }
}

// After a link, ".." is another folder for the file system than in the text of the path.
TEST_F(InputRegistryManuals, WhatIsBehindALinkIsWhatIsHashed) {
  fs::create_directories(folder / "sub/deep");
  fs::create_directory_symlink("sub/deep", folder / "link");
  folder.write("grid.asc", grid);
  folder.write("sub/grid.asc", std::string(grid) + "\n");
  for (const std::string& name : {std::string("link/../grid.asc"), std::string("grid.asc")}) {
    const fs::path scene = folder.write("scene.toml", with_raster(name));
    const WatchedRun run = run_watched({"check", scene.string()});
    ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    std::set<std::string> hashed;
    for (const fs::path& input : read_scene_file(scene).inputs) hashed.insert(fs::canonical(input).string());
    EXPECT_EQ(run.opened.read, hashed);
    EXPECT_TRUE(hashed.contains(fs::canonical(folder / name).string()));
  }
  folder.write("mosaic.vrt", vrt_of(simple_band("link/../grid.asc")));
  expect_refused(with_raster("mosaic.vrt"), {"whose path follows a link and then leads back"});
}

TEST_F(InputRegistryManuals, FilesOfTheSystemHaveAnEnd) {
  expect_refused(replaced(small_scene, "thing.obj", "/proc/self/pagemap"), {"more than the 0 bytes"});
  expect_refused(replaced(small_scene, "thing.obj", "/proc/self/maps"), {"more than the 0 bytes"});
}

TEST_F(InputRegistryManuals, TheWorkingFolderIsNotRead) {
  int id = 0;
  ASSERT_EQ(nc_create((folder / "grid.nc").c_str(), NC_CLOBBER, &id), NC_NOERR);
  ASSERT_EQ(nc_close(id), NC_NOERR);
  for (const char* name : {".ncrc", ".daprc", ".dodsrc", "epsg"}) mkfifo((folder / name).c_str(), 0600);
  Surroundings here;
  here.before = {"/usr/bin/env", "-C", folder.path().string()};
  folder.write("scene.toml", with_raster("grid.nc"));
  EXPECT_EQ(run_program({"check", "scene.toml"}, here).exit_code, 2);
  EXPECT_EQ(run_program({"compare", "grid.nc", "grid.nc"}, here).exit_code, 2);
}

TEST_F(InputRegistryManuals, AReferenceSystemNamesNoFile) {
  mkfifo((folder / "fifo").c_str(), 0600);
  const std::string file = (folder / "fifo").string();
  const std::string datum = "GEOGCS[\"a\",DATUM[\"b\",SPHEROID[\"WGS 84\",6378137,298.257223563]";
  const std::string rest = "],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
  for (const std::string& crs :
       {datum + ",EXTENSION[\"PROJ4_GRIDS\",\"" + file + "\"]" + rest,
        "+proj=longlat +datum=WGS84 +nadgrids=@null," + file + " +type=crs",
        "+proj=defmodel +model=" + file + " +type=crs", "DICT:" + file + ",1", std::string("+init=epsg:4326"),
        "{\"type\":\"BoundCRS\",\"value\":\"" + file + "\"}"}) {
    SCOPED_TRACE(crs);
    const std::string scene =
        replaced(small_scene, "[[materials]]",
                 "[georeference]\ncrs = '" + crs + "'\norigin_crs = [0, 0]\n[[materials]]");
    expect_refused(scene, {"scene.toml:2:1: ", "refers to a file or an operation"});
  }
  folder.write("grid.asc", grid);
  folder.write("grid.prj", datum + ",EXTENSION[\"PROJ4_GRIDS\",\"" + file + "\"]" + rest);
  expect_refused(with_raster("grid.asc"),
                 {"grid.prj: has a coordinate reference system that refers to correction files"});
  fs::remove(folder / "grid.prj");
  folder.write("grid.asc.aux.xml",
               "<PAMDataset><SRS>{\"type\":\"BoundCRS\",\"value\":\"" + file + "\"}</SRS></PAMDataset>");
  expect_refused(with_raster("grid.asc"),
                 {"grid.asc.aux.xml: has a coordinate reference system that refers to correction files"});
}

TEST_F(InputRegistryManuals, Hdf5WithoutEndIsRefused) {
  write_hdf5(folder / "circle.nc", [](hid_t id, hid_t space) {
    write_dataset(id, "Band1", space, H5P_DEFAULT);
    const hid_t group = H5Gcreate2(id, "a", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_hard(group, ".", group, "b", H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(group);
  });
  expect_both_refuse("circle.nc", "under several names");
  write_hdf5(folder / "deep.nc", [](hid_t id, hid_t) {
    std::string name;
    for (int k = 0; k < 100; ++k) {
      name += "/g";
      H5Gclose(H5Gcreate2(id, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    }
  });
  expect_both_refuse("deep.nc", "nests groups");
  write_hdf5(folder / "lattice.nc", [](hid_t id, hid_t) {
    std::string name;
    for (int k = 0; k < 20; ++k) {
      const std::string inner = name + "/a";
      H5Gclose(H5Gcreate2(id, inner.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      H5Lcreate_hard(id, inner.c_str(), id, (name + "/b").c_str(), H5P_DEFAULT, H5P_DEFAULT);
      name = inner;
    }
  });
  expect_both_refuse("lattice.nc", "under several names");
}

TEST_F(InputRegistryManuals, Hdf5DescriptionsHaveASize) {
  const auto write_text = [&](const std::string& name, hsize_t count) {
    write_hdf5(folder / name, [&](hid_t id, hid_t) {
      const hid_t space = H5Screate_simple(1, &count, nullptr), type = H5Tcopy(H5T_C_S1);
      const hid_t group = H5Gcreate2(id, "BAG_root", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
      const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
      const hsize_t chunk = 4096;
      H5Pset_chunk(plan, 1, &chunk);
      H5Dclose(H5Dcreate2(group, "metadata", type, space, H5P_DEFAULT, plan, H5P_DEFAULT));
      H5Pclose(plan), H5Gclose(group), H5Tclose(type), H5Sclose(space);
    });
  };
  write_text("large.bag", (hsize_t{1} << 32) + 10);
  expect_both_refuse("large.bag", "a text larger than 64 MB");
}

TEST_F(InputRegistryManuals, AClassicHeaderWhoseSizesOverflowIsRefused) {
  std::string header("CDF\2\0\0\0\0\0\0\0\x0a\0\0\0\5", 16);
  const auto number = [&header](std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) header += static_cast<char>(value >> shift & 255);
  };
  for (std::uint32_t k = 0; k < 5; ++k) {
    number(1);
    header += std::string{static_cast<char>('a' + k), '\0', '\0', '\0'};
    number(k < 3 ? 1u << 20 : 2);
  }
  number(0), number(0);   // no attributes
  number(11), number(1);  // one variable
  number(1), header += std::string("z\0\0\0", 4), number(5);
  for (std::uint32_t k = 0; k < 5; ++k) number(k);
  number(0), number(0), number(5), number(0), number(0), number(200);
  header += std::string(400, '\0');
  folder.write("grid.nc", header);
  expect_both_refuse("grid.nc", "cut off");
}

TEST_F(InputRegistryManuals, AMosaicOfMosaicsOfTheSameIsCounted) {
  folder.write("0.asc", grid);
  std::string inner = "0.asc";
  for (int level = 1; level <= 5; ++level) {
    std::string band = "<VRTRasterBand dataType=\"Float32\" band=\"1\">\n";
    for (int k = 0; k < 100; ++k)
      band +=
          "<SimpleSource><SourceFilename relativeToVRT=\"1\">" + inner + "</SourceFilename></SimpleSource>\n";
    inner = std::to_string(level) + ".vrt";
    folder.write(inner, vrt_of(band + "</VRTRasterBand>\n"));
  }
  expect_refused(with_raster("5.vrt"), {"a virtual raster of more than 50000 rasters"});
}

TEST_F(InputRegistryManuals, ATiffOfADirectoryThatFollowsItselfIsRefused) {
  write_tiff("grid.tif");
  std::string bytes = bytes_of(folder / "grid.tif");
  const auto at = [&bytes](std::size_t k) { return static_cast<unsigned char>(bytes.at(k)); };
  const std::size_t first = at(4) | at(5) << 8 | at(6) << 16 | at(7) << 24;
  const std::size_t entries = at(first) | at(first + 1) << 8;
  for (std::size_t k = 0; k < 4; ++k) bytes.at(first + 2 + 12 * entries + k) = bytes.at(4 + k);
  folder.write("grid.tif", bytes);
  expect_refused(with_raster("grid.tif"), {"grid.tif: has a chain of more than 1000 pictures"});
}

TEST_F(InputRegistryManuals, WhatStandsBesideARasterIsShort) {
  folder.write("grid.asc", grid);
  folder.write("grid.prj", std::string(50'000'000, '\n'));
  expect_refused(with_raster("grid.asc"), {"grid.prj: has more than 65536 bytes", "move it away"});
}

TEST_F(InputRegistryManuals, AGeoPackageWithALogIsNotWrittenTo) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "map.gpkg").c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, "PRAGMA journal_mode=WAL; CREATE TABLE a (b)", nullptr, nullptr, nullptr);
  sqlite3_close(database);
  for (const char* name : {"map.gpkg-wal", "map.gpkg-shm"}) fs::remove(folder / name);
  const std::set<std::string> before = names_below(folder.path());
  expect_refused(with_map("map.gpkg"), {"map.gpkg: is being written"});
  std::set<std::string> after = names_below(folder.path());
  after.erase("scene.toml");
  EXPECT_EQ(after, before);
  mkfifo((folder / "map.gpkg-journal").c_str(), 0600);
  expect_refused(with_map("map.gpkg"), {"'map.gpkg-journal'"});
}

TEST_F(InputRegistryManuals, AGeoPackageComputesNothing) {
  const auto with = [&](const std::string& sql) {
    fs::remove(folder / "map.gpkg");
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open((folder / "map.gpkg").c_str(), &database), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  };
  with("CREATE TABLE more (a DEFAULT '--', b AS (zeroblob(1000000000)))");
  expect_refused(with_map("map.gpkg"), {"a table with computed columns, 'more'"});
  with("CREATE TABLE more (a, b \"t\"AS(zeroblob(1000000000)))");
  expect_refused(with_map("map.gpkg"), {"a table with computed columns, 'more'"});
}

TEST_F(InputRegistryManuals, AResultThatNamesASceneElsewhereIsReported) {
  const TestFolder elsewhere, here;
  elsewhere.write("thing.obj", tetrahedron);
  const std::string scene = elsewhere.write("scene.toml", small_scene).string();
  const std::string out = (folder / "out").string(), page = (folder / "page.html").string();
  Surroundings inside;
  inside.before = {"/usr/bin/env", "-C", here.path().string()};
  ASSERT_EQ(run_program({"run", scene, "-o", out, "--quiet"}, inside).exit_code, 0);
  const Outcome told = run_program({"view", out, "-o", page}, inside);
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_THAT(told.err, HasSubstr("outside of the current folder"));
  EXPECT_EQ(run_program({"view", out, "-o", page, "--confined"}, inside).exit_code, 2);
  EXPECT_EQ(run_program({"view", out, "-o", page, "--confined", "--scene", scene}, inside).exit_code, 0);
}

}  // namespace
}  // namespace tubefoot
