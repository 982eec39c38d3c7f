# SPDX-License-Identifier: GPL-3.0-or-later
# Whether the Python module is built, and how the libraries have to be compiled for it.
option(TUBEFOOT_PYTHON "Build the Python module" ON)
set(TUBEFOOT_WITH_PYTHON OFF)
if(TUBEFOOT_PYTHON AND TUBEFOOT_SANITIZE)
  message(STATUS "No Python module: /usr/bin/python3 does not load what is built with sanitizers")
elseif(TUBEFOOT_PYTHON)
  set(Python_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "The interpreter that the module is for")
  find_package(Python 3.9 QUIET COMPONENTS Interpreter Development.Module)
  if(Python_FOUND)
    find_package(pybind11 2.10 CONFIG QUIET)
  endif()
  if(Python_FOUND AND pybind11_FOUND)
    set(TUBEFOOT_WITH_PYTHON ON)
    message(STATUS "Python module: for ${Python_EXECUTABLE} ${Python_VERSION}, by pybind11 ${pybind11_VERSION}")
  else()
    message(STATUS "No Python module: it needs Debian's pybind11-dev and python3-dev (tools/setup python installs them)")
  endif()
endif()

if(TUBEFOOT_PYTHON AND NOT TUBEFOOT_SANITIZE)
  # The static libraries end in a shared object too, now or when pybind11 will have been installed: nothing is then
  # compiled twice. Hidden symbols cost it nothing, unlike ones that may be replaced.
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
  set(CMAKE_CXX_VISIBILITY_PRESET hidden)
  set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
endif()
