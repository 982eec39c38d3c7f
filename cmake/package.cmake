# SPDX-License-Identifier: GPL-3.0-or-later
# Debian packages (`make package`, docs/installation.md): the program, and parts of it that not everybody needs. Included
# last: it wants to know all that is installed.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_CONTACT "tubefoot maintainers <maintainers@tubefoot.invalid>")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program development)
if(TUBEFOOT_WITH_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(TARGET tubefoot_mpi)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME tubefoot)
set(CPACK_DEBIAN_PROGRAM_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
list(JOIN TUBEFOOT_LOADED_PACKAGES ", " loaded)  # which dpkg-shlibdeps does not see: cmake/on_demand.cmake
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${loaded}")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS fonts-dejavu-core)  # without it pictures have no labels
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS libtubefoot-dev)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "tubefoot computes exactly which part of which facet of a scene every beam
of a sonar touches first, and integrates the echo over those polygons. It writes
echoes, pictures, footprints and the files that sidescans, multibeams and
acoustic cameras write, and measures how far other engines are off.")

# A static library asks the programs that link it for all that it is made of: what packages.txt lists for the program.
# Under the names that this distribution has for it.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/packages.txt)
execute_process(COMMAND ${PROJECT_SOURCE_DIR}/tools/setup --names program OUTPUT_VARIABLE needed)
string(REGEX MATCHALL "(lib|nlohmann|zlib)[^\n]*-dev" needed "${needed}")
list(PREPEND needed cmake g++ pkg-config)
list(JOIN needed ", " needed)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtubefoot-dev)
set(CPACK_DEBIAN_DEVELOPMENT_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${needed}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS tubefoot)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Static libraries, headers and find_package(tubefoot), for sonars and
engines of one's own: the example has one of each.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-tubefoot)
set(CPACK_DEBIAN_PYTHON_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-xarray, python3-geopandas")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "tubefoot's runs, references, footprints and comparisons as NumPy arrays, and
sonars and engines of one's own as Python functions.")

set(CPACK_DEBIAN_MPI_PACKAGE_NAME tubefoot-mpi)
set(CPACK_DEBIAN_MPI_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "tubefoot (= ${PROJECT_VERSION}), openmpi-bin")
set(CPACK_COMPONENT_MPI_DESCRIPTION "What tubefoot loads when mpirun starts it: the pings of a run are dealt to all its
processes.")

include(CPack)
