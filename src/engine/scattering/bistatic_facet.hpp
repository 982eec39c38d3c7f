// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/scattering/facet_map.hpp"
#include "engine/scattering/scattering_model.hpp"

// A facet that a transmitter and a separate receiver see at different apparent positions in stratified water
// (docs/notes/bistatic.md). engine/surface/facet_flattening.hpp computes it.
namespace tubefoot {

/// Triangle that two apexes see, flattened into a plane. The length of each edge is the root mean square of
/// its two apparent lengths. Each apex lies where its distances to the corners equal the apparent ranges,
/// which in isovelocity water is its true position. The sum of the two distances is therefore exact at the
/// corners, and accurate to second order of the edges between them. If lengths and distances are
/// inconsistent, the apex lies a thousandth of its distance above the plane. Coordinates are those of
/// PathCutter.
struct BistaticFacet {
  double transmit_distance_m = 0, receive_distance_m = 0;  ///< from the plane
  glm::dvec2 receive_foot_m{0};
  FacetMap to_plane;  ///< from apparent positions relative to the transmitter to (x, y, 0)
  /// Affine maps of the plane to apparent positions relative to each apex, and to true positions in the
  /// local frame.
  LyingPlane transmit_seen, receive_seen, lies;
  struct Corner {
    /// Sines of grazing angles.
    double transmit_lies = 0, transmit_seen = 0, receive_lies = 0, receive_seen = 0;
    /// Return of a corner without its scattering, relative to 1 / (r_T^2 r_R^2) and reference absorption.
    double gain = 1;
  };
  std::array<Corner, 3> corners;
  double misfit_m = 0;  ///< largest error of half path lengths at the corners

  /// Moves the receiver from the middle of a receiver pair, to which the receive leg leads, to one of its
  /// ends. The apparent seabed does not move. Returns false if the plane is not in front of the receiver.
  bool move_receiver(glm::dvec3 by_m);
};

/// Returns the ratio between the return of a facet and the straight-ray return of its flattened facet. It is
/// the mean over the corners of gain sqrt(sigma(lies) sigma(lies)) / sqrt(sigma(seen) sigma(seen)). A null
/// model is Lambert's law.
double bistatic_factor(const BistaticFacet& facet, const ScatteringModel* model);

}  // namespace tubefoot
