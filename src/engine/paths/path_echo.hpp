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

// Computes the echoes of paths over mirrors and of multiple scattering, per order. A reflected path of
// length L returns losses * B_T B_R 10^(-alpha L / 10) / L^2. A scattered path is the bistatic echo between
// two images times the reflection losses. Source: docs/notes/multiple-paths.md.
namespace tubefoot {

/// Settings of the ray engine for paths: each ray of a transmission continues over the mirrors that it
/// meets.
struct SampledPaths {
  const RayScene* scene = nullptr;  ///< scene of the mesh; null in refracting water, where images have
                                    ///< apparent meshes
  WorldGrid grid;                   ///< grid of the mesh
  RaySettings rays;
  std::vector<std::uint32_t> beam_of_tube;  ///< beam per tube of the transmitter, as in RayPlan
  RayGuide guide{};                         ///< guide of adaptive rays
};

/// Selects paths, and describes the mirrors.
struct PathSettings {
  int order = 1;                    ///< largest number of interactions (reflections and scatterings) on a
                                    ///< path
  double cutoff_db = 100;           ///< paths with a larger loss are omitted
  int scatterings = 1;              ///< largest number of scatterings on a path
  double patch_m = 1;               ///< longest edge of the patches of multiple scattering
  std::size_t most_images = 10000;  ///< limit per apex; the limit of image pairs is 100 times this value
  bool direct = false;              ///< also the direct path from a transmitter to a separate receiver
  /// Requests energies with bounds at this tolerance, applied to each path (engine/certified/reference.hpp).
  /// Requires `scatterings` = 1.
  std::optional<double> reference_tolerance{};
  /// Computes bounds from rounded corners, as the benchmark suite, whose published answers keep their bytes.
  bool rounds_corners = false;
  Mirrors mirrors;
  Binning binning = Binning::exact;   ///< binning of the common visibility of two images
  const EchoModel* before = nullptr;  ///< model of all scatterings except the last; null: the model of the
                                      ///< last
  /// Least receive gain per beam; may be empty. In paths with several scatterings a beam receives nothing
  /// from directions of smaller gain. BeamPatterns::least does not apply to these paths, because their
  /// transmit leg ends on another facet.
  std::span<const double> least_received{};
  bool arrivals = true;                   ///< also paths without scattering
  std::optional<SampledPaths> sampled{};  ///< computes single scatterings by rays

  /// Smallest energy factor of a path.
  double least() const { return std::pow(10, -cutoff_db / 10); }
};

/// Energy of an unscattered path from an image of the transmitter, in the bin [beam][sample].
struct ArrivedEnergy {
  GridPoint from;
  /// Vector of the path as it arrives at the receiver. In refracting water its length is travel time times
  /// reference speed.
  GridPoint displacement;
  std::size_t chain = 0;  ///< index of the chain of mirrors in refracting water, where all images lie at the
                          ///< transmitter
  std::size_t order = 0, bin = 0;
  double energy_j = 0, bound_j = 0;
};

/// Echoes of several orders.
struct PathEcho {
  /// Per order, from 0 to the highest requested. Order 0 is the direct path from transmitter to receiver.
  /// Order 1 contains only reflections, because the ordinary echo is the single scattering.
  std::vector<Echo> by_order;
  /// With a reference, per order: half-widths of the energies' enclosures, in the layout of the energies.
  std::vector<std::vector<double>> bound_by_order;
  std::size_t images = 0, shared_pieces = 0, hits = 0, arrivals = 0, patches = 0;
  std::vector<ArrivedEnergy> arrived;  ///< per image and beam; included in the energies
  /// In refracting water: the apparent surface of each chain of mirrors, and the largest misfit of its
  /// facets (BistaticFacet).
  std::vector<ApparentSurface> surface_meshes;
  double largest_misfit_m = 0;
  SurfaceCounts seen_by_patches;  ///< counts over the apparent surfaces of all patches
};

/// Computes the echoes over mirrors of a transmission from the apex of `transmit`, received at the apex of
/// `receive`. Both are equal for a monostatic sonar. A path of order n has one scattering, several or none.
/// (1) One scattering: a chain of i mirrors from the transmitter, a facet, and a chain of j mirrors to the
/// receiver. The numbers fulfil i + j + 1 = n and i + j > 0. The echo is the integral of integrate_echo()
/// between the two images, times the reflection losses. The integral is over the common visibility of both
/// images, or over the hits of rays (settings.sampled). Such rays leave through the windows of the
/// transmitter's image, and the receiver's image must see the hits. Windows and patches are computed with
/// `options` in both cases.
/// (2) Several scatterings, up to settings.scatterings: facets scatter sqrt(sigma(incident)
/// sigma(scattered)), with chains of mirrors or none between them. All scatterings except the last are those
/// of patches, which act as points on the surfaces that they insonify. The error is proportional to the
/// square of the patch size. Each patch has its own exact visibility. The energy that a patch receives over
/// all paths is gathered at its centroid before the patch scatters. In each generation, the weakest patches
/// are omitted that together scatter less than the cut-off relative to the first generation.
/// (3) No scattering: a chain of n mirrors from transmitter to receiver with the total length L. The energy
/// is losses * B_T B_R 10^(-alpha L / 10) / L^2, in the sample that contains L / 2. Each chain and fan
/// counts once, even if its direction lies on the border of several windows.
///
/// Beam patterns are evaluated for the directions at the true apexes. `beams.of_tube`, the fans and the
/// tubes of `model.patterns` refer to the true tubes, and `model.material` to the mesh. TubeSet::reach must
/// be twice the end of the last sample, in grid units. Throws std::length_error if there are too many
/// images, pairs of images, patches or delays.
///
/// `water`: refracting water, or null for isovelocity water. Mirrors are horizontal in refracting water.
/// Unscattered paths arrive along eigenrays, each with exp(-absorption) divided by the area of its ray tube
/// at the receiver. Throws also the exceptions of `RefractedImages`.
PathEcho path_echo(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                   const VisibilityOptions& options, const TubeSet& transmit, const TubeSet& receive,
                   const ReceiveBeams& beams, const RangeSamples& samples, const EchoModel& model,
                   const PathSettings& settings, const PathWater* water = nullptr);

/// Images that were computed before.
struct KnownImages {
  const ImageFinder& finder;             ///< finder of the images
  std::span<const Image> sent;           ///< those in the largest number of mirrors have a window towards the
                                         ///< receiver
  std::span<const Image> received;       ///< in one mirror less; the same list for a monostatic sonar
  RefractedImages* refracted = nullptr;  ///< finder of the images in refracting water; keeps its apparent
                                         ///< surfaces
};
/// The same for known images.
PathEcho path_echo(const FacetMesh& mesh, double grid_unit_m, const KnownImages& images,
                   const TubeSet& receive, const ReceiveBeams& beams, const RangeSamples& samples,
                   const EchoModel& model, const PathSettings& settings);
/// The same without scattered paths.
PathEcho unscattered_echo(const FacetMesh& mesh, double grid_unit_m, const KnownImages& images,
                          const TubeSet& receive, const ReceiveBeams& beams, const RangeSamples& samples,
                          const EchoModel& model, const PathSettings& settings);

}  // namespace tubefoot
