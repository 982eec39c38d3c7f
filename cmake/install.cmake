# SPDX-License-Identifier: GPL-3.0-or-later
# What `make install` and `cmake --install` put where, and in which package (cmake/package.cmake): "program" is the
# program with man pages, shell completion, documents and scenes; "development", for programs of one's own, is
# libraries, headers and find_package(tubefoot) (docs/examples/own-sonar).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS tubefoot COMPONENT program)

# Man pages and completion say what --help says: they are made from it.
set(manual ${PROJECT_BINARY_DIR}/manual)
cmake_host_system_information(RESULT DISTRIBUTION QUERY DISTRIB_VERSION_CODENAME)  # bookworm, trixie
configure_file(packaging/changelog.in ${PROJECT_BINARY_DIR}/packaging/changelog @ONLY)
add_custom_command(OUTPUT ${manual}/made
  COMMAND ${TUBEFOOT_PYTHON3} ${PROJECT_SOURCE_DIR}/tools/manual
    $<TARGET_FILE:tubefoot> ${PROJECT_BINARY_DIR}/packaging/changelog ${manual}
  COMMAND gzip -9nc ${PROJECT_BINARY_DIR}/packaging/changelog > ${manual}/changelog.gz
  COMMAND ${CMAKE_COMMAND} -E touch ${manual}/made
  DEPENDS tubefoot tools/manual ${PROJECT_BINARY_DIR}/packaging/changelog
  COMMENT "Writing man pages and shell completion" VERBATIM)
add_custom_target(tubefoot_manual ALL DEPENDS ${manual}/made)
install(DIRECTORY ${manual}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
install(FILES ${manual}/bash/tubefoot DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  COMPONENT program)
install(FILES ${manual}/zsh/_tubefoot DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)

# The folders keep their places, so that README's links and the examples of --help hold.
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT program
  PATTERN big-terrain/terrain EXCLUDE)

get_property(libraries GLOBAL PROPERTY TUBEFOOT_LIBRARIES)
install(TARGETS ${libraries} EXPORT tubefoot-targets COMPONENT development)
# Included as "geometry/tubes/tube.hpp", "engine/echo/echo.hpp": as in here.
foreach(folder geometry sensors src/)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tubefoot COMPONENT development
    FILES_MATCHING PATTERN *.hpp)
endforeach()
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/tubefoot)
install(EXPORT tubefoot-targets NAMESPACE tubefoot:: DESTINATION ${package_folder} COMPONENT development)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tubefoot-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/tubefoot-config.cmake cmake/dependencies.cmake ${PROJECT_BINARY_DIR}/tubefoot-config-version.cmake
  DESTINATION ${package_folder} COMPONENT development)
install(DIRECTORY docs/examples/own-sonar DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libtubefoot-dev/examples
  COMPONENT development)

set(packages program:tubefoot development:libtubefoot-dev)
if(TUBEFOOT_WITH_PYTHON)
  list(APPEND packages python:python3-tubefoot)
endif()
if(TUBEFOOT_MPI AND MPI_CXX_FOUND)
  list(APPEND packages mpi:tubefoot-mpi)
endif()
foreach(package ${packages})
  string(REGEX MATCH "(.*):(.*)" package ${package})
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/${CMAKE_MATCH_2})
  install(FILES packaging/copyright ${manual}/changelog.gz DESTINATION ${folder} COMPONENT ${CMAKE_MATCH_1})
endforeach()
