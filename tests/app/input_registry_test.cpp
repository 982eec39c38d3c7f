// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that all bytes that the program reads are reported, hashed and inside the permitted folder
// (docs/limits.md). The attacks use files that a stranger could send. One of the libraries under tubefoot
// would fall for each attack.
#include <gdal_priv.h>
#include <hdf5.h>
#include <netcdf.h>
#include <ogrsf_frmts.h>
#include <sys/stat.h>

#include <fstream>

#include "fixtures/hostile.hpp"
#include "fixtures/strangers_files.hpp"
#include "fixtures/watched_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

void write_external(const fs::path& file, const fs::path& storage) {
  write_hdf5(file, [&](hid_t id, hid_t space) {
    const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(plan, storage.c_str(), 0, 400);
    write_dataset(id, "Band1", space, plan);
    H5Pclose(plan);
  });
}

// --- the network

TEST_F(InputRegistry, NothingInAVirtualRasterCallsAHost) {
  const CalledHost host;
  const std::string address = host.address();
  folder.write("grid.asc", grid);
  const std::string web = "/vsicurl/" + address + "/a.tif";
  folder.write("map.wms",
               "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>" + address +
                   "/${z}/${x}/${y}.png</ServerUrl></Service><DataWindow><UpperLeftX>-15</UpperLeftX>"
                   "<UpperLeftY>15</UpperLeftY><LowerRightX>15</LowerRightX><LowerRightY>-15</LowerRightY>"
                   "<SizeX>3</SizeX><SizeY>3</SizeY></DataWindow><BandsCount>1</BandsCount><Cache><Path>" +
                   (folder / "cache").string() + "</Path></Cache></GDAL_WMS>");
  const std::vector<std::pair<std::string, std::string>> attacks{
      {"small letters",
       vrt_of("<vrtrasterband datatype=\"Float32\" band=\"1\"><simplesource><sourcefilename>" + web +
              "</sourcefilename></simplesource></vrtrasterband>")},
      {"an address", vrt_of(simple_band(address + "/a.tif", false))},
      {"a relative name that is an address", vrt_of(simple_band(address + "/a.tif"))},
      {"a virtual file system, relative", vrt_of(simple_band(web))},
      {"a subdataset", vrt_of(simple_band("NETCDF:\"" + address + "/a.nc\":z", false))},
      {"a warped raster", vrt_of("<VRTRasterBand dataType=\"Float32\" band=\"1\" "
                                 "subClass=\"VRTWarpedRasterBand\"/>\n<GDALWarpOptions>"
                                 "<SourceDataset>" +
                                     web + "</SourceDataset></GDALWarpOptions>\n",
                                 " subClass=\"VRTWarpedDataset\"")},
      {"a geolocation array",
       vrt_of("<Metadata domain=\"GEOLOCATION\">\n<MDI key=\"X_DATASET\">" + web +
              "</MDI>\n<MDI key=\"Y_DATASET\">" + web + "</MDI>\n<MDI key=\"X_BAND\">1</MDI>\n</Metadata>\n" +
              simple_band("grid.asc"))},
      {"an overview",
       vrt_of(replaced(simple_band("grid.asc"), "<SimpleSource>",
                       "<Overview><SourceFilename relativeToVRT=\"0\">" + web +
                           "</SourceFilename><SourceBand>1</SourceBand></Overview><SimpleSource>"))},
      {"open options", vrt_of(replaced(simple_band("grid.asc"), "<SourceBand>",
                                       "<OpenOptions><OOI key=\"A\">b</OOI></OpenOptions><SourceBand>"))},
      {"a web map as a source", vrt_of(simple_band("map.wms"))},
      {"code", vrt_of("<VRTRasterBand dataType=\"Float32\" band=\"1\" subClass=\"VRTDerivedRasterBand\">"
                      "<PixelFunctionLanguage>Python</PixelFunctionLanguage></VRTRasterBand>\n")},
  };
  for (const auto& [what, vrt] : attacks) {
    SCOPED_TRACE(what);
    folder.write("mosaic.vrt", vrt);
    expect_refused(with_raster("mosaic.vrt"), {"scene.toml:6:8: ", "mosaic.vrt"});
    EXPECT_FALSE(host.was_called());
    EXPECT_FALSE(fs::exists(folder / "cache"));
  }
}

TEST_F(InputRegistry, ARefusedElementIsNamedWithItsLine) {
  folder.write("grid.asc", grid);
  folder.write("mosaic.vrt",
               "<!-- <PansharpeningOptions> -->\n" +
                   vrt_of("<PansharpeningOptions>\n</PansharpeningOptions>\n" + simple_band("grid.asc")));
  expect_refused(with_raster("mosaic.vrt"),
                 {"mosaic.vrt:4: has an element <PansharpeningOptions>, which tubefoot does not read"});
  folder.write("mosaic.vrt", vrt_of(replaced(simple_band("grid.asc"), "band=\"1\"",
                                             "band=\"1\" subClass=\"VRTRawRasterBand\"")));
  expect_refused(
      with_raster("mosaic.vrt"),
      {"mosaic.vrt:3: has <VRTRasterBand subClass=\"VRTRawRasterBand\">, which tubefoot does not read"});
}

TEST_F(InputRegistry, FoldersNamedLikeAddressesAreFolders) {
  const CalledHost host;
  const std::string name = "NETCDF:\"" + host.address();
  fs::create_directories(folder / name);
  folder.write(name + "/grid.asc", grid);
  const WatchedRun run =
      run_watched({"check", folder.write("scene.toml", with_raster(name + "/grid.asc")).string()});
  EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
  EXPECT_TRUE(run.opened.read.contains(fs::canonical(folder / name / "grid.asc").string()));
  EXPECT_FALSE(host.was_called());
}

TEST_F(InputRegistry, ALinkedCrsOfAMapIsNotFetched) {
  const CalledHost host;
  folder.write(
      "map.geojson",
      "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"link\",\"properties\":{\"href\":\"" +
          host.address() +
          "/crs\",\"type\":\"proj4\"}},\"features\":[{\"type\":\"Feature\",\"properties\":"
          "{\"material\":\"sand\"},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1,0],[1,1],"
          "[0,0]]]}}]}");
  const Outcome outcome = check(with_map("map.geojson"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_FALSE(host.was_called());
}

// --- other files

TEST_F(InputRegistry, ARawBandReadsNoFileOfTheMachine) {
  folder.write("secret", std::string(4096, '\1'));
  folder.write("raw.vrt",
               vrt_of("<VRTRasterBand dataType=\"Byte\" band=\"1\" subClass=\"VRTRawRasterBand\">\n"
                      "<SourceFilename relativeToVRT=\"1\">secret</SourceFilename>\n"
                      "<ImageOffset>0</ImageOffset><PixelOffset>1</PixelOffset>"
                      "<LineOffset>3</LineOffset>\n</VRTRasterBand>\n"));
  expect_refused(with_raster("raw.vrt"), {"raw.vrt:3: has <VRTRasterBand subClass=\"VRTRawRasterBand\">"});
}

TEST_F(InputRegistry, Hdf5ReadsNoOtherFile) {
  folder.write("secret", std::string(4096, '\1'));
  write_external(folder / "external.nc", folder / "secret");
  write_hdf5(folder / "source.nc",
             [](hid_t id, hid_t space) { write_dataset(id, "Band1", space, H5P_DEFAULT); });
  write_hdf5(folder / "virtual.nc", [](hid_t id, hid_t space) {
    const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_virtual(plan, space, "source.nc", "Band1", space);
    write_dataset(id, "Band1", space, plan);
    H5Pclose(plan);
  });
  write_hdf5(folder / "link.nc", [](hid_t id, hid_t space) {
    write_dataset(id, "other", space, H5P_DEFAULT);
    H5Lcreate_external("source.nc", "/Band1", id, "Band1", H5P_DEFAULT, H5P_DEFAULT);
  });
  for (const auto& [name, what] : {std::pair{"external.nc", "other files (external storage)"},
                                   {"virtual.nc", "other files (a virtual dataset)"},
                                   {"link.nc", "a link into another file"}}) {
    SCOPED_TRACE(name);
    expect_refused(with_raster(name), {"scene.toml:6:8: ", name, what});
    const Outcome compared = run({"compare", (folder / name).string(), (folder / name).string()});
    EXPECT_EQ(compared.exit_code, 2);
    EXPECT_THAT(compared.err, HasSubstr(what));
  }
}

TEST_F(InputRegistry, FilesThatNameFilesOnTheMachineForProjections) {
  for (const char* crs :
       {"+proj=longlat +datum=WGS84 +nadgrids=/etc/hostname +type=crs", "+init=/etc/hostname:x",
        "+proj=longlat +geoidgrids=/etc/hostname +datum=WGS84 +vunits=m +type=crs"}) {
    SCOPED_TRACE(crs);
    const std::string scene =
        replaced(small_scene, "[[materials]]",
                 fmt::format("[georeference]\ncrs = \"{}\"\norigin_crs = [0, 0]\n[[materials]]", crs));
    const WatchedRun run = run_watched({"check", folder.write("scene.toml", scene).string()});
    EXPECT_EQ(run.outcome.exit_code, 2) << run.outcome.out;
    EXPECT_THAT(run.outcome.err, HasSubstr("refers to a file"));
  }
}

TEST_F(InputRegistry, AGeoPackageIsTablesAndNothingElse) {
  const auto with = [&](const std::string& sql) {
    const fs::path file = folder / "map.gpkg";
    fs::remove(file);
    GDALAllRegister();
    GDALDatasetUniquePtr made(
        GetGDALDriverManager()->GetDriverByName("GPKG")->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    OGRSpatialReference local;
    OGRLayer* layer = made->CreateLayer("beds", nullptr, wkbPolygon, nullptr);
    OGRFieldDefn field("material", OFTString);
    layer->CreateField(&field);
    OGRFeature feature(layer->GetLayerDefn());
    feature.SetField("material", "sand");
    OGRGeometry* polygon = nullptr;
    OGRGeometryFactory::createFromWkt("POLYGON((0 0,1 0,1 1,0 0))", nullptr, &polygon);
    feature.SetGeometryDirectly(polygon);
    EXPECT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
    if (!sql.empty()) made->ReleaseResultSet(made->ExecuteSQL(sql.c_str(), nullptr, "DEBUG"));
    made.reset();
  };
  with("");
  EXPECT_EQ(check(with_map("map.gpkg")).exit_code, 0);
  with("CREATE VIEW more AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i FROM n");
  expect_refused(with_map("map.gpkg"), {"map.gpkg: has a view, 'more', which tubefoot does not read"});
  with("CREATE TABLE more (a INTEGER, b BLOB GENERATED ALWAYS AS (zeroblob(1000000000)))");
  expect_refused(with_map("map.gpkg"), {"map.gpkg: has a table with computed columns, 'more'"});
  with("CREATE VIRTUAL TABLE more USING fts4(a)");
  expect_refused(with_map("map.gpkg"), {"map.gpkg: has a virtual table, 'more'"});
  with("");
  folder.write("map.gpkg-wal", "changes");
  expect_refused(with_map("map.gpkg"), {"map.gpkg: is being written", "'map.gpkg-wal'"});
}

// --- pipes

TEST_F(InputRegistry, PipesAreNotWaitedFor) {
  const auto pipe = [&](const std::string& name) { mkfifo((folder / name).c_str(), 0600); };
  folder.write("grid.asc", grid);
  folder.write("mosaic.vrt", vrt_of(simple_band("grid.asc")));
  pipe("grid.asc.aux.xml");
  expect_refused(with_raster("mosaic.vrt"), {"grid.asc.aux.xml: is a special file", "move it away"});
  fs::remove(folder / "grid.asc.aux.xml");
  EXPECT_EQ(check(with_raster("mosaic.vrt")).exit_code, 0);

  pipe("storage");
  write_external(folder / "external.nc", folder / "storage");
  expect_refused(with_raster("external.nc"), {"external storage"});
  EXPECT_EQ(run({"compare", (folder / "external.nc").string(), (folder / "external.nc").string()}).exit_code,
            2);

  write_tiff("grid.tif");
  pipe("grid.tifw");
  expect_refused(with_raster("grid.tif"), {"grid.tifw: is a special file", "move it away"});
  pipe("echoes.nc");
  const Outcome compared = run({"compare", (folder / "echoes.nc").string(), (folder / "echoes.nc").string()});
  EXPECT_EQ(compared.exit_code, 2);
  EXPECT_THAT(compared.err, HasSubstr("is a special file"));
}

// --- the hash

struct InputRegistryHash : InputRegistry {
  std::string hash(const std::string& scene) {
    return read_scene_file(folder.write("scene.toml", scene)).sha256;
  }
};

TEST_F(InputRegistryHash, SeesWhatGivesARasterItsPlace) {
  constexpr const char* here = "10\n0\n0\n-10\n-10\n10\n";
  constexpr const char* there = "10\n0\n0\n-10\n90\n10\n";
  for (const auto& [raster, beside] : {std::pair{"a.tif", "a.tfw"},
                                       {"b.tif", "b.tifw"},
                                       {"c.TIFF", "c.tfw"},
                                       {"d.tiff", "d.tiffw"},
                                       {"e.tif", "e.wld"},
                                       {"f.tif", "f.TFW"}}) {
    SCOPED_TRACE(beside);
    write_tiff(raster);
    folder.write(beside, here);
    const std::string before = hash(with_raster(raster));
    EXPECT_EQ(check(with_raster(raster)).exit_code, 0);
    folder.write(beside, there);
    EXPECT_NE(hash(with_raster(raster)), before);
    fs::remove(folder / beside);
    EXPECT_NE(hash(with_raster(raster)), before);
  }
}

TEST_F(InputRegistryHash, SeesWhatBelongsToTheSourcesOfAMosaic) {
  write_tiff("part.tif");
  folder.write("mosaic.vrt", vrt_of(simple_band("part.tif")));
  const std::string bare = hash(with_raster("mosaic.vrt"));
  folder.write("part.tif.aux.xml", "<PAMDataset><Metadata><MDI key=\"A\">1</MDI></Metadata></PAMDataset>");
  const std::string with = hash(with_raster("mosaic.vrt"));
  EXPECT_NE(with, bare);
  folder.write("part.tif.aux.xml", "<PAMDataset><Metadata><MDI key=\"A\">2</MDI></Metadata></PAMDataset>");
  EXPECT_NE(hash(with_raster("mosaic.vrt")), with);
}

// Data outside of the hash has no effect: an overview, a table or notes of another program change no cell.
TEST_F(InputRegistryHash, WhatIsNotHashedIsNotRead) {
  folder.write("grid.asc", grid);
  const std::string scene = with_raster("grid.asc");
  const std::string before = hash(scene);
  for (const char* name : {"grid.aux", "grid.rrd", "grid.asc.ovr", "grid.tab", "grid.imd"})
    folder.write(name, "what another program keeps here");
  EXPECT_EQ(hash(scene), before);
  const WatchedRun run = run_watched({"check", (folder / "scene.toml").string()});
  EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
  EXPECT_EQ(run.opened.read, (std::set<std::string>{fs::canonical(folder / "scene.toml").string(),
                                                    fs::canonical(folder / "grid.asc").string(),
                                                    fs::canonical(folder / "thing.obj").string()}));
}

TEST_F(InputRegistryHash, ARunDoesNotGoOnWithAnotherTerrain) {
  write_tiff("grid.tif");
  folder.write("grid.tifw", "10\n0\n0\n-10\n-10\n10\n");
  const std::string scene = folder.write("scene.toml", with_raster("grid.tif")).string();
  const std::string out = (folder / "out").string();
  ASSERT_EQ(run({"run", scene, "-o", out, "--quiet"}).exit_code, 0);
  fs::rename(out, out + "-before");
  folder.write("grid.tifw", "10\n0\n0\n-10\n-8\n10\n");
  ASSERT_EQ(run({"run", scene, "-o", out, "--quiet"}).exit_code, 0);
  const Outcome compared = run({"compare", out + "-before/echoes.nc", out + "/echoes.nc"});
  EXPECT_EQ(compared.exit_code, 2) << compared.out;
  EXPECT_THAT(compared.err, HasSubstr("scene"));
}

/// Shipped scenes.
std::vector<fs::path> shipped_scenes() {
  std::vector<fs::path> scenes;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(TUBEFOOT_SOURCE_DIR "/scenes"))
    if (entry.path().extension() == ".toml" && entry.path().string().find("preset") == std::string::npos)
      scenes.push_back(entry.path());
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

TEST(InputRegistryOfShippedScenes, OpensWhatTheHashIsOf) {
  std::size_t files = 0, skipped = 0, plain = 0;
  for (const fs::path& scene : shipped_scenes()) {
    SCOPED_TRACE(scene);
    std::set<std::string> hashed;
    try {
      for (const fs::path& input : read_scene_file(scene).inputs)
        hashed.insert(fs::canonical(input).string());
    } catch (const InputError& error) {
      // make_terrain.py writes the tiles of this scene: 10^8 facets.
      EXPECT_THAT(scene.string(), HasSubstr("big-terrain")) << error.what();
      ++skipped;
      continue;
    }
    // Scenes of one file open only that file. A few of them are enough.
    if (hashed.size() == 1 && ++plain > 3 && std::getenv("TUBEFOOT_ALL_SCENES") == nullptr) continue;
    const WatchedRun run = run_watched({"check", scene.string()});
    EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    // Shipped scenes give no warnings.
    for (const char* alarm : {"receives nothing", "is buried", "outside of the terrain",
                              "times as wide as the terrain", "radians", "antenna", "in metres?", "seconds?"})
      EXPECT_THAT(run.outcome.err, Not(HasSubstr(alarm)));
    EXPECT_EQ(run.opened.read, hashed);
    EXPECT_EQ(run.opened.written, std::set<std::string>());
    files += hashed.size();
  }
  std::printf("%zu files opened, as many hashed; %zu scenes without their data\n", files, skipped);
  EXPECT_GT(files, 10u);
}

TEST_F(InputRegistryHash, EveryKindOfFileIsOpenedAsItIsHashed) {
  write_tiff("grid.tif");
  folder.write("grid.tfw", "10\n0\n0\n-10\n-10\n10\n");
  folder.write("grid.tif.aux.xml", "<PAMDataset></PAMDataset>");
  folder.write("grid.asc", grid);
  folder.write("grid.prj", "Projection UTM\nZone 30\nDatum WGS84\nUnits METERS\nParameters\n");
  fs::remove(folder / "grid.prj");
  folder.write("outer.vrt", vrt_of(simple_band("inner.vrt")));
  folder.write("inner.vrt", vrt_of(simple_band("grid.asc")));
  GDALAllRegister();
  const GDALDatasetUniquePtr source(GDALDataset::Open((folder / "grid.asc").c_str()));
  for (const auto& [driver, name] : {std::pair{"netCDF", "classic.nc"}, {"netCDF", "four.nc"}}) {
    const char* const options[] = {std::string_view(name) == "four.nc" ? "FORMAT=NC4" : "FORMAT=NC", nullptr};
    const GDALDatasetUniquePtr made(GetGDALDriverManager()->GetDriverByName(driver)->CreateCopy(
        (folder / name).c_str(), source.get(), FALSE, const_cast<char**>(options), nullptr, nullptr));
    ASSERT_NE(made, nullptr);
  }
  // GDAL takes a small grid without CRS for degrees, so that the test gives its axes in metres.
  for (const char* name : {"classic.nc", "four.nc"}) {
    int id = 0, variable = 0;
    ASSERT_EQ(nc_open((folder / name).c_str(), NC_WRITE, &id), NC_NOERR);
    nc_redef(id);
    for (const char* axis : {"lat", "lon"}) {
      if (nc_inq_varid(id, axis, &variable) != NC_NOERR) continue;
      for (const char* attribute : {"standard_name", "long_name"}) nc_del_att(id, variable, attribute);
      nc_put_att_text(id, variable, "units", 1, "m");
    }
    nc_close(id);
  }
  for (const char* raster : {"grid.tif", "grid.asc", "outer.vrt", "classic.nc", "four.nc"}) {
    SCOPED_TRACE(raster);
    const fs::path scene = folder.write("scene.toml", with_raster(raster));
    std::set<std::string> hashed;
    for (const fs::path& input : read_scene_file(scene).inputs) hashed.insert(fs::canonical(input).string());
    const WatchedRun run = run_watched({"check", scene.string()});
    EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    EXPECT_EQ(run.opened.read, hashed);
    EXPECT_EQ(run.opened.written, std::set<std::string>());
  }
}

// --- the folder

TEST_F(InputRegistry, ConfinedReadsNothingOutsideOfTheFolder) {
  const TestFolder elsewhere;
  elsewhere.write("other.obj", tetrahedron);
  elsewhere.write("world", "10\n0\n0\n-10\n-10\n10\n");
  folder.write("grid.asc", grid);
  elsewhere.write("far.asc", grid);
  const auto confined = [&](const std::string& scene) {
    return run_watched({"check", folder.write("scene.toml", scene).string(), "--confined"});
  };
  EXPECT_EQ(confined(with_raster("grid.asc")).outcome.exit_code, 0);
  fs::create_symlink(elsewhere / "other.obj", folder / "linked.obj");
  fs::create_symlink(elsewhere / "world", folder / "grid.prj");
  folder.write("mosaic.vrt", vrt_of(simple_band((elsewhere / "far.asc").string(), false)));
  for (const std::string& scene : {replaced(small_scene, "thing.obj", "linked.obj"),
                                   replaced(small_scene, "thing.obj", (elsewhere / "other.obj").string()),
                                   with_raster("grid.asc"), with_raster("mosaic.vrt")}) {
    const WatchedRun run = confined(scene);
    EXPECT_EQ(run.outcome.exit_code, 2) << run.outcome.err;
    EXPECT_THAT(run.outcome.err,
                AllOf(HasSubstr("lies outside of the scene's folder, at '"), HasSubstr("--confined")));
    for (const std::string& file : run.opened.read)
      EXPECT_TRUE(file.starts_with(fs::canonical(folder.path()).string())) << file;
    const Outcome told = check(scene);
    EXPECT_THAT(told.err, HasSubstr("lies outside of the scene's folder, at '"));
  }
}

// --- sizes

TEST_F(InputRegistry, AnEchoFileLargerThanMemoryIsRefusedByItsSizesAlone) {
  const fs::path file = folder / "echoes.nc";
  int id = 0, ping = 0, beam = 0, sample = 0, energy = 0;
  ASSERT_EQ(nc_create(file.c_str(), NC_NETCDF4, &id), NC_NOERR);
  nc_def_dim(id, "ping", 4000, &ping), nc_def_dim(id, "beam", 50, &beam),
      nc_def_dim(id, "sample", 1000, &sample);
  const int dimensions[] = {ping, beam, sample};
  nc_def_var(id, "energy", NC_DOUBLE, 3, dimensions, &energy);
  nc_put_att_text(id, energy, "units", 1, "J");
  const std::size_t chunk[] = {20, 50, 1000};
  nc_def_var_chunking(id, energy, NC_CHUNKED, chunk);
  nc_def_var_deflate(id, energy, 0, 1, 9);
  const std::vector<double> none(20 * 50 * 1000, 0.0);
  for (std::size_t at = 0; at < 4000; at += 20) {
    const std::size_t start[] = {at, 0, 0};
    ASSERT_EQ(nc_put_vara_double(id, energy, start, chunk, none.data()), NC_NOERR);
  }
  ASSERT_EQ(nc_close(id), NC_NOERR);
  ASSERT_LT(fs::file_size(file), 8u << 20);  // 1.6 GB of zeros
  const Outcome outcome = run({"compare", file.string(), file.string()});
  expect_harmless(outcome, 200);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("echoes.nc: its values would need 1.6 GB of memory"),
                                 HasSubstr("are available")));
}

}  // namespace
}  // namespace tubefoot
