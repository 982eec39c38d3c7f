# SPDX-License-Identifier: GPL-3.0-or-later
# Shared libraries that the program loads at the first call of one of their functions, not at its start: most commands
# need neither pictures nor rasters nor echo files, and these libraries and theirs are nine tenths of all. tools/on_demand writes an
# object with a stand-in for every symbol that our libraries take from them, so that the linker leaves them out.
# src/run/console/on_demand.cpp loads them. Tests, the Python module and programs of others link them as usual, and so does the
# program on other processors and with sanitizers.
set(TUBEFOOT_ON_DEMAND OFF)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL x86_64 AND NOT TUBEFOOT_SANITIZE)
  set(TUBEFOOT_ON_DEMAND ON)
endif()

# tubefoot_loads(MEGABYTES THREADS INITIALIZER FILE...): the first file is loaded, the others come with it. With their
# initializers, which start THREADS threads, they take at most so many megabytes of addresses. INITIALIZER is "" or the
# function that sets variables.
set(TUBEFOOT_LOADED "")
set(TUBEFOOT_LOADED_PACKAGES "")
function(tubefoot_loads megabytes threads initializer)
  set(package "")
  foreach(file ${ARGN})
    file(REAL_PATH ${file} real)
    string(REGEX REPLACE "^/usr" "" below_root ${real})  # dpkg's name of some files, where /lib is a link
    execute_process(COMMAND dpkg-query -S ${real} ${below_root} OUTPUT_VARIABLE owner ERROR_QUIET)
    if(owner MATCHES "^([^:]+):")
      list(APPEND TUBEFOOT_LOADED_PACKAGES ${CMAKE_MATCH_1})
      if(NOT package)
        set(package ${CMAKE_MATCH_1})
      endif()
    endif()
  endforeach()
  list(REMOVE_DUPLICATES TUBEFOOT_LOADED_PACKAGES)
  list(JOIN ARGN "," files)
  list(APPEND TUBEFOOT_LOADED "${megabytes},${threads},${package},${initializer},${files}")
  set(TUBEFOOT_LOADED ${TUBEFOOT_LOADED} PARENT_SCOPE)
  set(TUBEFOOT_LOADED_PACKAGES ${TUBEFOOT_LOADED_PACKAGES} PARENT_SCOPE)
endfunction()

# tubefoot_load_on_demand(PROGRAM): has a program load them so. Called when all libraries that it links are known.
function(tubefoot_load_on_demand program)
  if(NOT TUBEFOOT_ON_DEMAND)
    return()
  endif()
  get_property(libraries GLOBAL PROPERTY TUBEFOOT_LIBRARIES)
  set(archives "")
  foreach(library ${libraries})
    list(APPEND archives $<TARGET_FILE:${library}>)
  endforeach()
  set(output ${PROJECT_BINARY_DIR}/on_demand)
  add_custom_command(OUTPUT ${output}.o
    COMMAND ${TUBEFOOT_PYTHON3} ${PROJECT_SOURCE_DIR}/tools/on_demand ${output}.s ${TUBEFOOT_LOADED} -- ${archives}
    COMMAND ${CMAKE_CXX_COMPILER} -c -x assembler ${output}.s -o ${output}.o
    DEPENDS ${PROJECT_SOURCE_DIR}/tools/on_demand ${libraries} VERBATIM
    COMMENT "Writing what stands in for libraries that are loaded on demand")
  target_sources(${program} PRIVATE ${output}.o)
  target_link_options(${program} PRIVATE -Wl,--as-needed)
endfunction()

if(TUBEFOOT_ON_DEMAND)
  get_target_property(gdal_library GDAL::GDAL LOCATION)
  tubefoot_loads(192 0 "" ${gdal_library})
  # log4cplus, below OpenImageIO, starts four threads.
  tubefoot_loads(416 4 "" ${openimageio_LINK_LIBRARIES})
  tubefoot_loads(16 0 "" ${GIF_LIBRARIES})
  set(libraries ${rsvg_LINK_LIBRARIES})
  list(FILTER libraries EXCLUDE REGEX "/libm[.]so")
  tubefoot_loads(160 0 "" ${libraries})
  list(GET netcdf_LINK_LIBRARIES 0 netcdf_library)
  tubefoot_loads(96 0 H5open ${netcdf_library} ${hdf5_LINK_LIBRARIES})
  tubefoot_loads(64 0 "" ${proj_LINK_LIBRARIES})
  tubefoot_loads(64 0 "" ${assimp_LINK_LIBRARIES})
endif()
