// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that no coordinate reference system makes the program open another file, for any spelling of its
// text. The program uses the parsed result of PROJ, not the bytes (docs/limits.md).
#include <gdal_priv.h>
#include <hdf5.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>
#include <sys/stat.h>

#include <array>
#include <utility>

#include "fixtures/hostile.hpp"
#include "fixtures/strangers_files.hpp"
#include "fixtures/watched_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct CrsFiles : InputRegistry {
  /// The texts of this test name this path: once a file, once a pipe without a writer.
  const std::string named = (folder / "named").string();

  CrsFiles() { folder.write("grid.asc", grid); }

  /// Expects that the program rejects the scene with `words` in its message, without opening or waiting for
  /// the named file. In the first text of a test the name is a pipe, too.
  void expect_unopened(const std::string& scene, const std::string& words) {
    const fs::path file = folder.write("scene.toml", scene);
    const bool first = std::exchange(first_, false);
    for (const bool pipe : {false, true}) {
      if (pipe && !first) continue;
      SCOPED_TRACE(pipe ? "a pipe" : "a file");
      fs::remove(named);
      if (pipe)
        ASSERT_EQ(mkfifo(named.c_str(), 0600), 0);
      else
        folder.write("named", "what is in another file");
      const WatchedRun run = run_watched({"check", file.string()});
      EXPECT_EQ(run.outcome.signal, 0) << "it waited for the pipe";
      EXPECT_EQ(run.outcome.exit_code, 2) << run.outcome.err;
      EXPECT_THAT(run.outcome.err, HasSubstr(words));
      EXPECT_FALSE(run.opened.read.contains(fs::weakly_canonical(named).string()));
    }
  }
  void expect_unopened(const std::string& scene) {
    expect_unopened(scene, "has a coordinate reference system that refers to correction files");
  }

  /// WKT of a datum with a file of corrections, with `word` for PROJ4_GRIDS.
  std::string wkt(const std::string& word) const {
    return "GEOGCS[\"a\",DATUM[\"b\",SPHEROID[\"WGS 84\",6378137,298.257223563],EXTENSION[\"" + word +
           "\",\"" + named + "\"]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
  }
  /// Texts of systems that name a file. XML escapes spell the decisive word.
  std::vector<std::string> texts_in_xml() const {
    return {wkt("PROJ4_&#71;RIDS"),
            wkt("PROJ4_&#x47;RIDS"),
            "+proj=longlat +datum=WGS84 +n&#97;dgrids=" + named + " +type=crs",
            "+proj=longlat +datum=WGS84 +n&#97;dgrids=@" + named + " +type=crs",
            "+proj=longlat +datum=WGS84 +n&#97;dgrids=@null," + named + " +type=crs",
            "+proj=longlat +datum=WGS84 +geoid&#103;rids=" + named + " +vunits=m +type=crs",
            "+init=" + named + ":1",
            "+proj=pipeline +step +proj=hgrid&#115;hift +grids=" + named,
            "+proj=defm&#x6f;del +model=" + named + " +type=crs",
            "+proj=tinsh&#105;ft +file=" + named};
  }

 private:
  bool first_ = true;
};

TEST_F(CrsFiles, AreNotOpenedWhenXmlOfAVirtualRasterHidesTheWord) {
  for (const std::string& text : texts_in_xml()) {
    SCOPED_TRACE(text);
    folder.write("mosaic.vrt", vrt_of("<SRS>" + text + "</SRS>\n" + simple_band("grid.asc")));
    expect_unopened(with_raster("mosaic.vrt"));
  }
}

// GDAL reads the text as that of a virtual raster: one of each kind is enough.
TEST_F(CrsFiles, AreNotOpenedWhenXmlBesideARasterHidesTheWord) {
  for (const std::string& text :
       {wkt("PROJ4_&#71;RIDS"), "+proj=longlat +datum=WGS84 +n&#97;dgrids=@null," + named + " +type=crs",
        "+init=" + named + ":1", "+proj=tinsh&#105;ft +file=" + named}) {
    SCOPED_TRACE(text);
    folder.write("grid.asc.aux.xml", "<PAMDataset><SRS>" + text + "</SRS></PAMDataset>");
    expect_unopened(with_raster("grid.asc"));
  }
  write_tiff("grid.tif");
  folder.write("grid.tif.aux.xml", "<PAMDataset><SRS>" + wkt("PROJ4_&#71;RIDS") + "</SRS></PAMDataset>");
  expect_unopened(with_raster("grid.tif"));
  folder.write("mosaic.vrt", vrt_of(simple_band("grid.tif")));
  expect_unopened(with_raster("mosaic.vrt"));
}

TEST_F(CrsFiles, AreNotOpenedWhenJsonHidesTheWord) {
  const auto map_with = [&](const std::string& crs) {
    folder.write("map.geojson",
                 "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"" +
                     crs +
                     "\"}},\"features\":[{\"type\":\"Feature\",\"properties\":{\"material\":\"sand\"},"
                     "\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1,0],[1,1],[0,0]]]}}]}");
  };
  const std::string local = with_map("map.geojson");
  const std::string on_earth = replaced(replaced(local, "coordinates = \"local\"\n", ""), "[[materials]]",
                                        "[georeference]\norigin_lat_lon_deg = [0, 0]\n[[materials]]");
  for (const std::string& crs : {"+proj=longlat +datum=WGS84 +n\\u0061dgrids=" + named + " +type=crs",
                                 "+proj=longlat +datum=WGS84 +nadgrid\\u0073=" + named + " +type=crs",
                                 "+init=" + named + ":1", "+proj=defmo\\u0064el +model=" + named}) {
    SCOPED_TRACE(crs);
    map_with(crs);
    expect_unopened(local);
  }
  expect_unopened(on_earth);
}

TEST_F(CrsFiles, AreNotOpenedWhenALineBreakHidesTheWord) {
  folder.write("grid.prj", wkt("PROJ4_\nGRIDS") + "\n");
  expect_unopened(with_raster("grid.asc"));

  GDALAllRegister();
  GDALDatasetUniquePtr made(GetGDALDriverManager()
                                ->GetDriverByName("ESRI Shapefile")
                                ->Create((folder / "map.shp").c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  OGRLayer* layer = made->CreateLayer("map", nullptr, wkbPolygon, nullptr);
  OGRFieldDefn field("material", OFTString);
  layer->CreateField(&field);
  OGRFeature feature(layer->GetLayerDefn());
  feature.SetField("material", "sand");
  OGRGeometry* polygon = nullptr;
  OGRGeometryFactory::createFromWkt("POLYGON((0 0,1 1,1 0,0 0))", nullptr, &polygon);
  feature.SetGeometryDirectly(polygon);
  ASSERT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
  made.reset();
  folder.write("map.prj", wkt("PROJ4_\nGRIDS") + "\n");
  expect_unopened(with_map("map.shp"));
}

TEST_F(CrsFiles, AreNotOpenedWhenMetadataOfABagHideTheWord) {
  GDALAllRegister();
  const fs::path file = folder / "grid.bag";
  const GDALDatasetUniquePtr plain(
      GetGDALDriverManager()->GetDriverByName("MEM")->Create("", 3, 3, 2, GDT_Float32, nullptr));
  std::array<double, 6> place{-15, 10, 0, 15, 0, -10};
  plain->SetGeoTransform(place.data());
  OGRSpatialReference crs;
  crs.importFromEPSG(4326);
  plain->SetSpatialRef(&crs);
  GDALDatasetUniquePtr written(GetGDALDriverManager()->GetDriverByName("BAG")->CreateCopy(
      file.c_str(), plain.get(), FALSE, nullptr, nullptr, nullptr));
  ASSERT_NE(written, nullptr);
  written.reset();

  constexpr const char* place_of_text = "/BAG_root/metadata";
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  hid_t data = H5Dopen2(id, place_of_text, H5P_DEFAULT);
  const hid_t type = H5Dget_type(data), space = H5Dget_space(data);
  std::string text(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)), '\0');
  ASSERT_GE(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), 0);
  H5Dclose(data), H5Sclose(space);
  text = replaced(text, "298.257223563,AUTHORITY[\"EPSG\",\"7030\"]]",
                  "298.257223563],EXTENSION[\"PROJ4_&#71;RIDS\",\"" + named + "\"]");
  H5Fclose(id);
  for (const bool packed : {false, true}) {
    SCOPED_TRACE(packed ? "packed" : "plain");
    const hid_t again = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Ldelete(again, place_of_text, H5P_DEFAULT);
    const hsize_t count = text.size();
    const hid_t extent = H5Screate_simple(1, &count, nullptr), plan = H5Pcreate(H5P_DATASET_CREATE);
    if (packed) H5Pset_chunk(plan, 1, &count), H5Pset_deflate(plan, 9);
    data = H5Dcreate2(again, place_of_text, type, extent, H5P_DEFAULT, plan, H5P_DEFAULT);
    ASSERT_GE(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), 0);
    H5Dclose(data), H5Pclose(plan), H5Sclose(extent);
    ASSERT_GE(H5Fclose(again), 0);
    expect_unopened(with_raster("grid.bag"));
  }
  H5Tclose(type);
}

// SQLite stores a long text in pages, so that one word may lie in two pages.
TEST_F(CrsFiles, AreNotOpenedWhenPagesOfAGeoPackageDivideTheWord) {
  GDALAllRegister();
  const fs::path file = folder / "map.gpkg";
  const auto write = [&](const std::string& definition) {
    fs::remove(file);
    GDALDatasetUniquePtr made(
        GetGDALDriverManager()->GetDriverByName("GPKG")->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    OGRSpatialReference crs;
    crs.importFromEPSG(32632);
    OGRLayer* layer = made->CreateLayer("beds", &crs, wkbPolygon, nullptr);
    OGRFieldDefn field("material", OFTString);
    layer->CreateField(&field);
    OGRFeature feature(layer->GetLayerDefn());
    feature.SetField("material", "sand");
    OGRGeometry* polygon = nullptr;
    OGRGeometryFactory::createFromWkt("POLYGON((0 0,1 0,1 1,0 0))", nullptr, &polygon);
    feature.SetGeometryDirectly(polygon);
    EXPECT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
    const std::string sql =
        "UPDATE gpkg_spatial_ref_sys SET definition = '" + definition + "' WHERE srs_id = 32632";
    made->ReleaseResultSet(made->ExecuteSQL(sql.c_str(), nullptr, "DEBUG"));
  };
  const auto padded = [&](std::size_t before, std::size_t behind) {
    return replaced(replaced(wkt("PROJ4_GRIDS"), "\"a\"", "\"" + std::string(before, 'a') + "\""),
                    "\"degree\"", "\"" + std::string(behind, 'a') + "\"");
  };
  const auto is_whole = [&] { return bytes_of(file).find("PROJ4_GRIDS") != std::string::npos; };
  write(padded(1, 6));
  EXPECT_TRUE(is_whole());
  expect_unopened(with_map("map.gpkg"));
  // The last page of a text is full: more letters after the word move it towards the previous page.
  constexpr std::size_t before = 9000, behind = 5000, page_bytes = 4096;
  write(padded(before, behind));
  const std::size_t at = bytes_of(file).find("PROJ4_GRIDS");
  ASSERT_NE(at, std::string::npos);
  write(padded(before, behind + at % page_bytes + 1));
  ASSERT_FALSE(is_whole()) << "no page ends within it";
  expect_unopened(with_map("map.gpkg"));
}

// PROJ searches the working folder last, also for its own file names.
TEST_F(CrsFiles, OfTheWorkingFolderAreNotOpened) {
  mkfifo((folder / "conus").c_str(), 0600);
  mkfifo((folder / "named").c_str(), 0600);
  Surroundings here;
  here.before = {"/usr/bin/env", "-C", folder.path().string()};
  for (const std::string& text : {std::string("+proj=longlat +datum=WGS84 +n&#97;dgrids=named +type=crs"),
                                  std::string("+proj=longlat +datum=WGS84 +n&#97;dgrids=./named +type=crs"),
                                  std::string("+init=named:1")}) {
    SCOPED_TRACE(text);
    folder.write("mosaic.vrt", vrt_of("<SRS>" + text + "</SRS>\n" + simple_band("grid.asc")));
    folder.write("scene.toml", with_raster("mosaic.vrt"));
    const Outcome outcome = run_program({"check", "scene.toml"}, here);
    EXPECT_EQ(outcome.signal, 0) << "it waited for a pipe";
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("refers to correction files"));
  }
}

TEST_F(CrsFiles, OfAHostAreNotFetched) {
  const CalledHost host;
  Surroundings online;
  online.before = {"/usr/bin/env", "PROJ_NETWORK=ON", "PROJ_NETWORK_ENDPOINT=" + host.address()};
  for (const std::string& grid_file : {host.address() + "/a.tif", std::string("us_noaa_conus.tif")}) {
    SCOPED_TRACE(grid_file);
    folder.write("mosaic.vrt", vrt_of("<SRS>+proj=longlat +datum=WGS84 +n&#97;dgrids=" + grid_file +
                                      " +type=crs</SRS>\n" + simple_band("grid.asc")));
    folder.write("scene.toml", with_raster("mosaic.vrt"));
    const Outcome outcome = run_program({"check", (folder / "scene.toml").string()}, online);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_FALSE(host.was_called());
  }
}

// Web Mercator uses the same word to state that it has no grid.
TEST_F(CrsFiles, ThatAreNoneDoNoHarm) {
  OGRSpatialReference crs;
  crs.importFromEPSG(3857);
  char* text = nullptr;
  crs.exportToWkt(&text);
  folder.write("grid.prj", text);
  CPLFree(text);
  const Outcome outcome = check(with_raster("grid.asc"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

}  // namespace
}  // namespace tubefoot
