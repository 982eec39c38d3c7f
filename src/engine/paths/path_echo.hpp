// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/paths/image_tree.hpp"
#include "engine/paths/refracted_images.hpp"
#include "engine/rays/ray_engine.hpp"
#include "geometry/numbers/world_grid.hpp"

// Echoes over mirrors. docs/paths.md
namespace tubefoot {

/// Rays in place of footprints: each of a transmission's rays goes on over the mirrors that it meets.
struct SampledPaths {
  const RayScene* scene = nullptr;  ///< of the mesh; null in refracting water, where images see others
  WorldGrid grid;                   ///< its grid
  RaySettings rays;
  std::vector<std::uint32_t> beam_of_tube;  ///< of the transmitter, as RayPlan takes it
  RayGuide guide{};                         ///< of adaptive rays
};

/// Which paths, and what they meet.
struct PathSettings {
  int order = 1;                    ///< most interactions of a path: reflections, and a scattering
  double cutoff_db = 100;           ///< paths that lose more are left out
  int scatterings = 1;              ///< most of them on a path
  double patch_m = 1;               ///< longest edge of the patches that scatter on to others
  std::size_t most_images = 10000;  ///< of one apex; and a hundred times as many pairs of images
  bool direct = false;              ///< also the way straight from a transmitter to a separate receiver
  /// Energies with bounds, each path's as narrow as that asks (engine/certified/reference.hpp); one
  /// scattering.
  std::optional<double> reference_tolerance{};
  Mirrors mirrors;
  Binning binning = Binning::exact;   ///< of what two images share
  const EchoModel* before = nullptr;  ///< by which all scatterings but the last go; null: as that
  /// By beam, or none: of paths with several scatterings a beam receives nothing from directions whose
  /// receive gain is less. BeamPatterns::least does not apply to them: the direction of the transmit leg is
  /// that of another facet.
  std::span<const double> least_received{};
  bool arrivals = true;                   ///< also what comes without scattering
  std::optional<SampledPaths> sampled{};  ///< instead of that

  /// The part of the energy that has to be left.
  double least() const { return std::pow(10, -cutoff_db / 10); }
};

/// What came straight from an image of the transmitter, in a bin [beam][sample].
struct ArrivedEnergy {
  GridPoint from;
  /// To the receiver, as it arrives there; in refracting water as long as its time by the reference speed.
  GridPoint displacement;
  std::size_t chain = 0;  ///< Image::mirror_path: in refracting water images are where the transmitter is
  std::size_t order = 0, bin = 0;
  double energy_j = 0, bound_j = 0;
};

/// Echoes of several orders.
struct PathEcho {
  /// By order, 0 to the highest asked for. Order 0 is the way straight from transmitter to receiver; order 1
  /// holds only reflections without scattering: the scattering on its own is the ordinary echo.
  std::vector<Echo> by_order;
  /// With a reference, by order: the half-widths of the energies' enclosures, laid out as these.
  std::vector<std::vector<double>> bound_by_order;
  std::size_t images = 0, shared_pieces = 0, hits = 0, arrivals = 0, patches = 0;
  std::vector<ArrivedEnergy> arrived;  ///< by image and beam; part of the energies
  /// In refracting water: what each chain of mirrors made of the seabed, and the largest misfit of its facets
  /// (BistaticFacet).
  std::vector<ApparentSurface> surface_meshes;
  double largest_misfit_m = 0;
  SurfaceCounts seen_by_patches;  ///< what all patches made of it
};

/// The echoes over mirrors of a transmission from `transmit`'s apex, received at `receive`'s (both the same
/// for a sonar in one place). A path of order n is
///  - scattered once: a chain of i mirrors from the transmitter, a facet, a chain of j mirrors to the
///    receiver, i + j + 1 = n, i + j > 0. integrate()'s law between the two images, times the
///    reflections; over what both images see, or over the hits of rays (settings.sampled), which leave by the
///    windows of the one and are seen by the other. Windows and patches are those of `options` also then;
///  - scattered n times, up to `scatterings`: chains of mirrors, or none, between facets that scatter
///    sqrt(sigma(incident) sigma(scattered)). All but the last scatter as patches, which are points to those
///    that they light (the error goes with the square of their size), each with its own exact visibility;
///    what one receives over all ways is gathered, at its energy's middle, before it is scattered again. Of
///    each scattering the weakest patches, which together send less than the cut-off of what the first one
///    does, are left out;
///  - not scattered: a chain of n mirrors from transmitter to receiver, of whole length L: reflections
///    * B_T B_R 10^(-alpha L / 10) / L^2, in the sample that holds L / 2. Once for each chain and fan,
///    however many windows meet in its direction.
/// Patterns are taken in the directions at the true apexes. `beams.of_tube` and the fans are those of
/// the true tubes, as are `law.patterns`' tubes; `law.material` that of the mesh. TubeSet::reach must be
/// twice the end of the last sample (in grid units). Throws std::length_error if there are more images (or
/// pairs of them, patches, or their delays) than may be.
///
/// `water`: what refracts, null where it is even. Mirrors are level there, and ways without scattering arrive
/// with exp(-absorption) over the area of their ray tube at the receiver, one for each ray (RefractedImages,
/// whose errors are thrown too).
PathEcho path_echo(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                   const VisibilityOptions& options, const TubeSet& transmit, const TubeSet& receive,
                   const ReceiveBeams& beams, const RangeSamples& samples, const EchoModel& model,
                   const PathSettings& settings, const PathWater* water = nullptr);

/// Images that are known.
struct KnownImages {
  const ImageFinder& finder;        ///< that made them
  std::span<const Image> sent;      ///< with the most mirrors those that have a window towards the receiver
  std::span<const Image> received;  ///< with one mirror less; the very same for a sonar in one place
  RefractedImages* refracted = nullptr;  ///< in refracting water: that made them; its grounds are left to it
};
/// The same between these.
PathEcho path_echo(const FacetMesh& mesh, double grid_unit_m, const KnownImages& images,
                   const TubeSet& receive, const ReceiveBeams& beams, const RangeSamples& samples,
                   const EchoModel& model, const PathSettings& settings);

}  // namespace tubefoot
