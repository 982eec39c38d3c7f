// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "engine/paths/patch_echo.hpp"
#include "engine/paths/path_echo.hpp"

// Paths that are scattered more than once. docs/paths.md
namespace tubefoot {

/// What the paths of a transmission go through; as for path_echo(). All must outlive the call.
struct PathScene {
  const FacetMesh& mesh;
  double unit_m;
  const ImageFinder& finder;
  const ReceiveBeams& beams;
  const RangeSamples& samples;
  const EchoModel& model;
  const PathSettings& settings;
  GridPoint apex;  ///< true one of the transmitter
  double reach;    ///< TubeSet::reach
  /// In refracting water: who made the images, of a mesh that it may have cut; facets are its base()'s.
  const RefractedImages* refracted = nullptr;

  glm::dvec3 from_apex(GridPoint p) const;  ///< metres
  ReceiverViews received_by(const Image& image) const;
  /// How far patches stand off their facets, in grid units: where those are cut up and seen elsewhere, their
  /// corners are rounded by up to 1.8, and none must come to lie before the patch.
  double least_lift() const { return refracted != nullptr ? 4 : 0; }
  /// What an image sees that `by` has made, or which is one of the scene's.
  VisibleSurface seen_by(const Image& image, const RefractedImages* by = nullptr) const;
};

/// Adds to `echo` the paths with 2 to settings.scatterings scatterings, generation by generation: what the
/// images `sent` light becomes patches; what these light is received by the images `received`, and, gathered
/// by facet and place, becomes the next patches. In refracting water each patch sees the seabed through the
/// water from its own depth. Of each generation the weakest patches, which together scatter less than the
/// cut-off allows of what the first one does, are left out.
void add_scattered_paths(const PathScene& scene, std::span<const Image> sent, std::span<const Image> received,
                         PathEcho& echo);

/// The same for receivers that may have rows of their own, of which `echo` then has as many as beams:
/// energies at either end of a receiver pair, and products of both, through whatever water there is.
void add_scattered_paths(const PathScene& scene, std::span<const Image> sent,
                         std::span<const ImageReceiver> received, PathEcho& echo);

}  // namespace tubefoot
