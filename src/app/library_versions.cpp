// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/library_versions.hpp"

#include <CGAL/version.h>
#include <OpenImageIO/imageio.h>
#include <OpenMesh/Core/System/config.h>
#include <cairo/cairo.h>
#include <flint/flint.h>
#include <fmt/format.h>
#include <gmp.h>
#include <hdf5.h>
#include <libdeflate.h>
#include <lz4.h>
#include <mpfr.h>
#include <netcdf.h>
#include <openssl/crypto.h>
#include <sqlite3.h>
#include <tbb/version.h>
#include <zip.h>
#include <zlib.h>
#include <zstd.h>

#include <CLI/Version.hpp>
#include <boost/version.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

namespace tubefoot {
namespace {

std::string first_word(std::string text) { return text.substr(0, text.find(' ')); }

std::string hdf5_version() {
  unsigned major = 0, minor = 0, patch = 0;
  H5get_libversion(&major, &minor, &patch);
  return fmt::format("{}.{}.{}", major, minor, patch);
}

/// Formats a version number of two digits per part: 20407 is 2.4.7, 100901 is 10.9.1.
std::string by_hundreds(int number) {
  return fmt::format("{}.{}.{}", number / 10000, number / 100 % 100, number % 100);
}

}  // namespace

std::string library_versions() {
  const int fmt_version = FMT_VERSION;
  const std::pair<const char*, std::string> versions[] = {
      // exact arithmetic
      {"cgal", CGAL_VERSION_STR},
      {"flint", flint_version},
      {"gmp", gmp_version},
      {"mpfr", mpfr_get_version()},
      {"boost",
       fmt::format("{}.{}.{}", BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100)},
      // threads, meshes
      {"tbb", TBB_runtime_version()},
      {"openmesh", fmt::format("{}.{}.{}", OM_GET_VER, OM_GET_MAJ, OM_GET_MIN)},
      // files and pictures
      {"netcdf", first_word(nc_inq_libvers())},
      {"hdf5", hdf5_version()},
      {"sqlite", sqlite3_libversion()},
      {"openssl", OpenSSL_version(OPENSSL_VERSION_STRING)},
      {"zlib", zlibVersion()},
      {"libdeflate", LIBDEFLATE_VERSION_STRING},
      {"lz4", LZ4_versionString()},
      {"zstd", ZSTD_versionString()},
      {"libzip", zip_libzip_version()},
      {"openimageio", by_hundreds(OIIO::openimageio_version())},
      {"cairo", cairo_version_string()},
      // text
      {"pugixml", fmt::format("{}.{}", PUGIXML_VERSION / 1000, PUGIXML_VERSION % 1000 / 10)},
      {"fmt", by_hundreds(fmt_version)},
      {"cli11", CLI11_VERSION},
      {"nlohmann_json", fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                    NLOHMANN_JSON_VERSION_PATCH)},
  };
  std::string words;
  for (const auto& [library, version] : versions) words += fmt::format("\n{}: {}", library, version);
  return words;
}

}  // namespace tubefoot
