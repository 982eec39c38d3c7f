// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "engine/paths/patch_echo.hpp"
#include "engine/paths/path_echo.hpp"

// Adds paths with several scatterings to an echo, generation by generation. Source:
// docs/notes/multiple-paths.md, "Several scatterings".
namespace tubefoot {

/// Arguments of path_echo() for paths with several scatterings. All references must outlive the call.
struct PathScene {
  const FacetMesh& mesh;
  double unit_m;
  const ImageFinder& finder;
  const ReceiveBeams& beams;
  const RangeSamples& samples;
  const EchoModel& model;
  const PathSettings& settings;
  GridPoint apex;  ///< true apex of the transmitter
  double reach;    ///< TubeSet::reach
  /// Finder of the images in refracting water, or null. The finder may have cut the mesh. Facets are those
  /// of its base().
  const RefractedImages* refracted = nullptr;

  glm::dvec3 from_apex(GridPoint p) const;  ///< in m
  ReceiverViews received_by(const Image& image) const;
  /// Smallest distance of a patch from its facet, in grid units. In refracting water, corners of cut and
  /// mapped facets are rounded by up to 1.8 units. No corner may come to lie in front of the patch.
  double least_lift() const { return refracted != nullptr ? 4 : 0; }
  /// Surface that an image sees. The image belongs to `by`, or to the scene if `by` is null.
  VisibleSurface seen_by(const Image& image, const RefractedImages* by = nullptr) const;
};

/// Adds to `echo` the paths with 2 to settings.scatterings scatterings, generation by generation. The
/// surface that the images `sent` insonify becomes the first patches. The images `received` receive the
/// surface that these patches insonify. The same surface, gathered by facet and place, becomes the next
/// patches. In refracting water each patch has its own apparent seabed for rays from its own depth. In each
/// generation, the weakest patches are omitted that together scatter less than the cut-off relative to the
/// first generation.
void add_scattered_paths(const PathScene& scene, std::span<const Image> sent, std::span<const Image> received,
                         PathEcho& echo);

/// The same for receivers with their own rows, of which `echo` then has as many as beams. The rows contain
/// the energies at both ends of a receiver pair and the products of both signals. For isovelocity and for
/// refracting water.
void add_scattered_paths(const PathScene& scene, std::span<const Image> sent,
                         std::span<const ImageReceiver> received, PathEcho& echo);

}  // namespace tubefoot
