// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
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

// Finds the images of an apex in plane mirrors by the image-source method: images, images of images, and so
// on. The method is exact beam tracing. The part of a mirror that an image sees is the window of the next
// image. Source: docs/notes/multiple-paths.md, "Images and apertures".
namespace tubefoot {

/// Horizontal mirror over a scene.
struct SeaSurface {
  std::int32_t height = 0;  ///< grid units
  double reflection = 1;    ///< energy factor of each reflection, without roughness
  double roughness = 0;     ///< (2 k sigma)^2 with the wave number k and the standard deviation sigma of the
                            ///< surface height
  /// Factor of modulus 1 by which each reflection multiplies a signal. The default is that of a
  /// pressure-release surface (air behind it).
  std::complex<double> phase = -1;
};

/// Reflecting surfaces of a scene.
struct Mirrors {
  std::optional<SeaSurface> surface;
  std::span<const double> reflection{};  ///< energy factor per material of the mesh; 0: no mirror
  /// Phase factor per material, as SeaSurface::phase, at all angles. Empty means 1, the factor of a rigid
  /// surface.
  std::span<const std::complex<double>> phase{};
};

/// Corner of the cone in which an image sees a mirror. In the plane of the horizon it is the direction
/// between two corners.
struct WindowCorner {
  CornerName name;
  std::optional<CornerName> other{};
};

/// Origin of a window: the part of a mirror that a window of the parent image shows. Names refer to the whole
/// mesh (named_in()), and to the rays of TubeVisibility::rays of the parent's window.
struct WindowOrigin {
  std::uint32_t parent_window = 0;
  FacetId mirror = no_facet;              ///< no_facet: the sea surface
  std::array<WindowCorner, 4> corners{};  ///< by ray of the window
  bool third_is_sum = false;              ///< whether the third ray is the sum of the second and the fourth
};

/// Apex, or its image in a chain of mirrors. A straight line from the image through its windows has the
/// length of the path from the true apex over the mirrors. Beyond the windows the image sees the scene in
/// front of its last mirror.
struct Image {
  std::uint32_t mirrors = 0;  ///< length of the chain; 0: the apex itself
  std::optional<MirrorPlane> last;
  std::vector<MirrorPlane> chain;       ///< mirrors of the chain, beginning with the one next to the apex
  TubeSet windows;                      ///< windows of the image; without a mirror: the tubes of the apex
  std::vector<std::uint32_t> own_tube;  ///< tube of the true apex that each window belongs to
  Leg leg;                              ///< leg from the image, except for the position of the image
  double largest = 1;                   ///< upper bound of the loss factor over all windows
  std::complex<double> phase = 1;       ///< isovelocity water: product of the mirrors' phase factors
  /// Part of the last mirror that the parent sees, from which the windows were made. The two values are its
  /// solid angle in sr and the summed lengths of the borders in rad.
  double mirror_sr = 0, border_rad = 0;
  std::size_t parent = 0;               ///< index of the parent image in the result of images_of()
  std::vector<WindowOrigin> origins{};  ///< per window, with VisibilityOptions::corner_names

  std::size_t mirror_path = 0;  ///< index of its chain of mirrors in refracting water (refracted_images.hpp)

  /// Surface that the image sees. `origin` is empty if this is the whole mesh.
  const FacetMesh* mesh = nullptr;
  const SceneTree* tree = nullptr;
  std::span<const FacetId> origin{};
  std::span<const PartVertex> vertex{};  ///< MeshPart::vertex, with VisibilityOptions::corner_names
  std::vector<TubeVisibility> seen;      ///< per window; empty for images from which nothing is scattered

  ApexLook look() const { return {windows, seen, mesh, origin}; }

  /// Owns mesh, tree and origin if they belong to this image only.
  struct World;
  std::shared_ptr<const World> world;
};

/// Solid angle of three unit vectors, positive if they turn counter-clockwise as seen from outside the unit
/// sphere (van Oosterom & Strackee 1983).
double solid_angle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c);
/// Adds a convex cone of unit vectors to the seen part of the last mirror (`mirror_sr`, `border_rad`).
void add_to_mirror(Image& image, std::span<const glm::dvec3> corners);

/// Converts a name of a corner that an image sees. In the result, facets and vertices are those of the whole
/// mesh, which must have been searched with VisibilityOptions::corner_names. Vertex v at which a mirror cuts
/// a facet is the point mesh.vertices.size() + v.
CornerName named_in(const FacetMesh& mesh, const Image& image, CornerName name);

/// A direction within this angle of the border of a window counts as inside. Corners of windows are rounded
/// by up to half of this angle.
constexpr double window_border_rad = 4e-9;

/// Whether sound from an image reaches a place: the place lies in front of the last mirror, and no facet
/// hides it. The windows are not tested. For isovelocity water.
bool reaches(const Image& image, GridPoint place);

/// Finds the images of apexes over one mesh. Thread-safe. Results do not depend on the number of threads.
class ImageFinder {
 public:
  /// Omits windows that pass no more than `least_loss`. Images report their unobstructed region if there is
  /// a sea surface or if `options` request it. All referenced arguments must outlive this object.
  ImageFinder(const FacetMesh& mesh, const SceneTree& tree, const VisibilityOptions& options,
              const Mirrors& mirrors, double least_loss, std::size_t most_images);
  ~ImageFinder();

  /// Returns the apex of `tubes` first, then its images in up to `most_mirrors` mirrors, in the order of the
  /// number of mirrors. Computes the visible polygons of all images. With `received_at`, images in
  /// `most_mirrors` mirrors have no visible polygons. The result then contains only those of them with a
  /// window towards one of these places. The value of tubes.reach should be twice the longest half path,
  /// because a path may lie on one leg only. Throws std::length_error for more than `most_images` images.
  std::vector<Image> images_of(TubeSet tubes, int most_mirrors,
                               std::span<const GridPoint> received_at = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot
