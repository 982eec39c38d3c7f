# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` puts where: the program; and, for programs of one's own, libraries, headers and
# find_package(tubefoot) (examples/own-sonar).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS tubefoot)
get_property(libraries GLOBAL PROPERTY TUBEFOOT_LIBRARIES)
install(TARGETS ${libraries} EXPORT tubefoot-targets)
# Included as "geometry/tube.hpp", "engine/echo.hpp": as in here.
foreach(folder geometry sensors src/app src/compare src/engine src/medium src/scene src/seabed src/study src/viewer)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tubefoot FILES_MATCHING PATTERN *.hpp)
endforeach()

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/tubefoot)
install(EXPORT tubefoot-targets NAMESPACE tubefoot:: DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tubefoot-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/tubefoot-config.cmake cmake/dependencies.cmake ${PROJECT_BINARY_DIR}/tubefoot-config-version.cmake
  DESTINATION ${package_folder})
