# SPDX-License-Identifier: GPL-3.0-or-later
# Every library comes from the distribution (packages.txt). Snags of its packaging, and what differs between Debian 12
# and 13, are met here, once.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)

find_package(CGAL REQUIRED)
find_library(FLINT_LIBRARY NAMES flint REQUIRED)  # neither it nor Arb ships a CMake package
find_path(FLINT_WITH_ARB flint/arb.h)  # since FLINT 3
if(FLINT_WITH_ARB)
  set(ARB_LIBRARY ${FLINT_LIBRARY})
else()
  find_library(ARB_LIBRARY NAMES flint-arb arb REQUIRED)  # Debian calls it flint-arb
endif()
find_package(OpenMesh CONFIG REQUIRED)  # CONFIG: CGAL puts a failing FindOpenMesh on the module path
pkg_check_modules(assimp REQUIRED IMPORTED_TARGET assimp)
find_package(GDAL CONFIG REQUIRED)
pkg_check_modules(proj REQUIRED IMPORTED_TARGET proj)  # the one under GDAL
find_package(ZLIB REQUIRED)
find_package(fmt REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(TBB REQUIRED)
find_package(embree 4 QUIET)  # src/engine/rays/embree.hpp prefers it, too
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED)
endif()
find_package(nlohmann_json REQUIRED)
find_package(pugixml REQUIRED)
pkg_check_modules(fftw REQUIRED IMPORTED_TARGET fftw3l)
pkg_check_modules(geographiclib REQUIRED IMPORTED_TARGET geographiclib)  # ships no CMake package
pkg_check_modules(netcdf REQUIRED IMPORTED_TARGET netcdf)
pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5-serial)
pkg_check_modules(libdeflate REQUIRED IMPORTED_TARGET libdeflate)
pkg_check_modules(sqlite3 REQUIRED IMPORTED_TARGET sqlite3)
pkg_check_modules(lz4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(yaml_cpp REQUIRED IMPORTED_TARGET yaml-cpp)
pkg_check_modules(zip REQUIRED IMPORTED_TARGET libzip)
pkg_check_modules(crypto REQUIRED IMPORTED_TARGET libcrypto)
# OpenImageIO's CMake targets name OpenCV's include folder, which is not installed; pkg-config does not.
pkg_check_modules(openimageio REQUIRED IMPORTED_TARGET OpenImageIO)
find_package(GIF 5 REQUIRED)
pkg_check_modules(rsvg REQUIRED IMPORTED_TARGET librsvg-2.0 cairo)
