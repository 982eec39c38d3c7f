// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/echo/echo.hpp"
#include "run/transmission_surface.hpp"

namespace tubefoot {

/// The echo model of a sensor at a transmission, and the patterns that it refers to. The site, and what the
/// ground refers to, outlive it.
struct SensorModel {
  /// On an apparent surface receiver pairs are as much longer as integrate_receiver_pair_echo() asks for.
  SensorModel(const Transmission& transmission, const TransmissionSurface& surface_mesh, std::size_t sensor);
  SensorModel(const SensorModel&) = delete;
  SensorModel& operator=(const SensorModel&) = delete;

  EchoModel model;
  BeamPatterns patterns;
  std::vector<FacetMap> facet_maps;
};

}  // namespace tubefoot
