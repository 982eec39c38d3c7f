// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/echo/echo.hpp"
#include "run/shot_ground.hpp"

namespace tubefoot {

/// The echo law of a sensor at a shot, and the patterns that it refers to. Survey and ground outlive it.
struct SensorLaw {
  SensorLaw(const Survey& survey, const ShotGround& ground, std::size_t sensor, std::size_t ping,
            std::size_t shot);
  SensorLaw(const SensorLaw&) = delete;
  SensorLaw& operator=(const SensorLaw&) = delete;

  EchoLaw law;
  BeamPatterns patterns;
  std::vector<FacetMap> facet_maps;
};

}  // namespace tubefoot
