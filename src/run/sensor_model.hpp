// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/echo/echo.hpp"
#include "run/transmission_surface.hpp"

namespace tubefoot {

/// The echo model of a sensor at a transmission, and the beam patterns to which it refers. The loaded scene
/// and the objects to which the surface mesh refers must outlive it.
struct SensorModel {
  /// On an apparent surface, the baselines of receiver pairs are longer by the factor that
  /// integrate_receiver_pair_echo() requires.
  SensorModel(const Transmission& transmission, const TransmissionSurface& surface_mesh, std::size_t sensor);
  SensorModel(const SensorModel&) = delete;
  SensorModel& operator=(const SensorModel&) = delete;

  EchoModel model;
  BeamPatterns patterns;
  std::vector<FacetMap> facet_maps;
};

}  // namespace tubefoot
