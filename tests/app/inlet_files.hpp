// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "app/hostile.hpp"
#include "sensors/kinds/scene_file.hpp"

// Files that a stranger could send, and scenes that name them.
namespace tubefoot {

constexpr std::string_view grid =
    "ncols 3\nnrows 3\nxllcorner -15\nyllcorner -15\ncellsize 10\n0 0 0\n0 1 0\n0 0 0\n";

inline std::string with_raster(const std::string& file) {
  return replaced(small_scene, "kind = \"flat\"\nwidth_m = 20\nlength_m = 30",
                  "kind = \"raster\"\nfile = '" + file + "'");
}

inline std::string with_map(const std::string& file) {
  return replaced(small_scene, "length_m = 30",
                  "length_m = 30\n[terrain.material_map]\nkind = \"polygons\"\nfile = \"" + file +
                      "\"\nattribute = \"material\"\ncoordinates = \"local\"\n");
}

inline std::string vrt_of(const std::string& bands, const std::string& attributes = "") {
  return "<VRTDataset rasterXSize=\"3\" rasterYSize=\"3\"" + attributes +
         ">\n<GeoTransform>-15,10,0,15,0,-10</GeoTransform>\n" + bands + "</VRTDataset>\n";
}

inline std::string simple_band(const std::string& source, bool relative = true) {
  return fmt::format(
      "<VRTRasterBand dataType=\"Float32\" band=\"1\">\n<SimpleSource>\n<SourceFilename "
      "relativeToVRT=\"{}\">{}</SourceFilename>\n<SourceBand>1</SourceBand>\n"
      "</SimpleSource>\n</VRTRasterBand>\n",
      relative ? 1 : 0, source);
}

/// Heights 0, 10 x 10 cells of 1 m, in HDF5 as netCDF-4 has it; `define` makes the variable "Band1" of a
/// space.
template <class Define>
void write_hdf5(const std::filesystem::path& file, const Define& define) {
  const hid_t id = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t size[2] = {10, 10};
  const hid_t space = H5Screate_simple(2, size, nullptr);
  define(id, space);
  H5Sclose(space);
  ASSERT_GE(H5Fclose(id), 0);
}

inline void write_dataset(hid_t file, const char* name, hid_t space, hid_t plan) {
  const hid_t data = H5Dcreate2(file, name, H5T_IEEE_F32LE, space, H5P_DEFAULT, plan, H5P_DEFAULT);
  H5Dclose(data);
}

struct Inlet : Hostile {
  /// 3 x 3 heights of 0 that lie nowhere.
  void write_tiff(const std::string& name) const {
    GDALAllRegister();
    const GDALDatasetUniquePtr made(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        (folder / name).c_str(), 3, 3, 1, GDT_Float32, nullptr));
  }
};

}  // namespace tubefoot
