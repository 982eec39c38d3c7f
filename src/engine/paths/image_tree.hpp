// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/scattering/path.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/mirror.hpp"
#include "geometry/visibility/visibility.hpp"

// An apex seen in mirrors, in mirrors of mirrors, and so on. docs/paths.md
namespace tubefoot {

/// The horizontal mirror over a scene.
struct SeaSurface {
  std::int32_t height = 0;  ///< grid units
  double reflection = 1;    ///< energy factor of each reflection, without roughness
  double roughness = 0;     ///< (2 k sigma)^2, k the wave number, sigma the standard deviation of its height
  /// What each reflection makes of a signal besides, of modulus 1: air behind it releases the pressure.
  std::complex<double> phase = -1;
};

/// What reflects.
struct Mirrors {
  std::optional<SeaSurface> surface;
  std::span<const double> reflection{};  ///< by material of the mesh: energy factor; 0: no mirror
  /// By material: as SeaSurface::phase, at all angles; empty: 1, as of what is rigid.
  std::span<const std::complex<double>> phase{};
};

/// An apex, or its image in a chain of mirrors. Straight lines from it through its windows are paths from the
/// true apex over the mirrors, as long as they; beyond the windows it sees the world as it is.
struct Image {
  std::uint32_t mirrors = 0;  ///< length of the chain; 0: the apex itself
  std::optional<MirrorPlane> last;
  std::vector<MirrorPlane> chain;       ///< its mirrors, the one next to the apex first
  TubeSet windows;                      ///< of the image; the apex's own tubes if there is no mirror
  std::vector<std::uint32_t> own_tube;  ///< by window: the true apex's tube that it belongs to
  Leg leg;                              ///< from it, but for its place
  double largest = 1;                   ///< of the loss over all windows, at least
  std::complex<double> phase = 1;       ///< in isovelocity water: product of its mirrors' phases
  /// Of what its parent sees of the last mirror and windows were made of: steradians, and summed lengths of
  /// the borders, radians.
  double mirror_sr = 0, border_rad = 0;

  std::size_t mirror_path = 0;  ///< in refracting water: its chain of mirrors (refracted_images.hpp)

  /// What it sees: `origin` empty if that is the whole mesh.
  const FacetMesh* mesh = nullptr;
  const SceneTree* tree = nullptr;
  std::span<const FacetId> origin{};
  std::vector<TubeVisibility> seen;  ///< by window; empty for images that nothing is scattered from

  ApexLook look() const { return {windows, seen, mesh, origin}; }

  /// Owner of mesh, tree and origin where they are its own.
  struct World;
  std::shared_ptr<const World> world;
};

/// Of three unit vectors (van Oosterom & Strackee 1983); with the sign of how they turn.
double solid_angle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c);
/// Adds a convex cone of unit vectors to what windows are made of.
void add_to_mirror(Image& image, std::span<const glm::dvec3> corners);

/// Directions that near to a window's border are taken as in it: windows are rounded to half of this.
constexpr double window_border_rad = 4e-9;

/// Whether what an image sends comes to a place unhindered: that lies in front of its last mirror, and no
/// facet in between. Windows are not asked. In isovelocity water.
bool reaches(const Image& image, GridPoint place);

/// Finds the images of apexes over one mesh. Thread-safe; results do not depend on the threads.
class ImageFinder {
 public:
  /// Windows through which no more than `least_loss` passes are left out. Images tell what they see of open
  /// water where there is a surface, or `options` say so. What is referred to must outlive it.
  ImageFinder(const FacetMesh& mesh, const SceneTree& tree, const VisibilityOptions& options,
              const Mirrors& mirrors, double least_loss, std::size_t most_images);
  ~ImageFinder();

  /// The apex of `tubes` (first) and its images in up to `most_mirrors` mirrors, those of fewer first. All
  /// have looked; but with `received_at`, images in `most_mirrors` mirrors have not, and are only those that
  /// have a window towards one of these places. tubes.reach should be twice the longest half path: a path may
  /// lie all on one side. Throws std::length_error if there are more images than `most_images`.
  std::vector<Image> images_of(TubeSet tubes, int most_mirrors,
                               std::span<const GridPoint> received_at = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot
