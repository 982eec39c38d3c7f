# SPDX-License-Identifier: GPL-3.0-or-later
# find_package(tubefoot): tubefoot::tubefoot_app and what it is made of, down to tubefoot::tubefoot_geometry.
include(${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/tubefoot-targets.cmake)
