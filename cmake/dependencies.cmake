# SPDX-License-Identifier: GPL-3.0-or-later
# Every library comes from Debian 12 (packages.txt). Three snags of its packaging are met here, once.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)

find_package(CGAL REQUIRED)
find_library(ARB_LIBRARY NAMES flint-arb arb REQUIRED)  # Debian calls it flint-arb; neither ships a CMake package
find_library(FLINT_LIBRARY NAMES flint REQUIRED)
find_package(OpenMesh CONFIG REQUIRED)  # CONFIG: CGAL puts a failing FindOpenMesh on the module path
pkg_check_modules(assimp REQUIRED IMPORTED_TARGET assimp)
find_package(GDAL CONFIG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(fmt REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(TBB REQUIRED)
find_package(embree 3 REQUIRED)
find_package(nlohmann_json REQUIRED)
pkg_check_modules(fftw REQUIRED IMPORTED_TARGET fftw3l)
pkg_check_modules(geographiclib REQUIRED IMPORTED_TARGET geographiclib)  # ships no CMake package
pkg_check_modules(netcdf REQUIRED IMPORTED_TARGET netcdf)
pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5-serial)
pkg_check_modules(sqlite3 REQUIRED IMPORTED_TARGET sqlite3)
pkg_check_modules(crypto REQUIRED IMPORTED_TARGET libcrypto)
# OpenImageIO's CMake targets name OpenCV's include folder, which is not installed; pkg-config does not.
pkg_check_modules(openimageio REQUIRED IMPORTED_TARGET OpenImageIO)
pkg_check_modules(rsvg REQUIRED IMPORTED_TARGET librsvg-2.0 cairo)
