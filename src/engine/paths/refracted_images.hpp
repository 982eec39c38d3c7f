// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/paths/image_tree.hpp"
#include "engine/paths/patch_water.hpp"
#include "engine/surface/facet_flattening.hpp"
#include "engine/water/eigenray.hpp"

// Finds the images of apexes in horizontal mirrors in stratified water by unfolding. Beyond each mirror the
// water has the mirrored sound-speed profile, and the ray continues through the mirror. Each chain of
// mirrors has one apparent seabed. Source: docs/notes/multiple-paths.md, "Level mirrors in stratified water".
namespace tubefoot {

struct BistaticSurface;  // engine/certified/bistatic_enclosure.hpp
class RayEnclosure;      // engine/water/ray_enclosure.hpp

/// Stratified water, and the accuracy of the apparent seabed in it.
struct PathWater {
  const WaterColumn& column;
  double surface_height_m = 0;  ///< depth = this - z
  EigenrayOptions rays;
  double reference_speed_m_s = 1500;  ///< converts a travel time to a range, in m/s
  ApparentMapSettings apparent_map;
  RefinementLimits limits;
  const WorldGrid& grid;
  /// Keeps all images in the largest number of mirrors, even if no ray from them reaches a receiver.
  bool keep_last = false;
};

/// Ray from an image over its mirrors to a receiver.
struct MirroredRay {
  GridPoint seen_at;             ///< apparent position of the receiver from the image
  glm::dvec3 sent{0};            ///< launch direction in the frame of the image, unit vector
  glm::dvec3 arrives{0};         ///< direction of travel at the receiver, unit vector
  double half_path_m = 0;        ///< half of the travel time times the reference speed, in m
  double kept = 1;               ///< energy factor of the absorption
  double tube_area_m2 = 0;       ///< area of the ray tube at the receiver, perpendicular to the ray, per
                                 ///< steradian at the apex
  double unfolded_height_m = 0;  ///< of the receiver, in m; identifies the chain of mirrors
};

/// Images of one apex or of two, over one seabed that is cut along the same lines for all of them. An image
/// has the position of its true apex. It sees the apparent seabed of the rays over its chain of mirrors
/// (`ApparentMap` with `Unfolding`), through its windows. Mirrors are the sea surface and horizontal facets.
/// Rays that turn are followed only if they turn before the first mirror or after the last.
class RefractedImages {
 public:
  /// `ends`: tubes of the transmitter, and of the receiver in a bistatic sonar. `order`: largest number of
  /// mirrors in a chain of the transmitter; chains of scattered paths have one mirror less. All referenced
  /// arguments must outlive this object. Throws the exceptions of map_apparent_together(), std::length_error
  /// for more than `most_images` chains, and std::invalid_argument for mirrors that are not horizontal.
  RefractedImages(const FacetMesh& mesh, const SceneTree& tree, const VisibilityOptions& options,
                  const Mirrors& mirrors, double least_loss, std::size_t most_images,
                  double absorption_db_per_m, const PathWater& water, std::vector<TubeSet> ends, int order);
  /// Images of one apex on the seabed, over the seabed of other images. Chains have at most `order` - 1
  /// mirrors. `water`: see continued_below().
  RefractedImages(const RefractedImages& others, const PathWater& water, TubeSet tubes, int order,
                  const SurfaceApex& surface_apex);
  ~RefractedImages();

  /// As ImageFinder::images_of(). `beside`: tubes of a place near the end (one end of a receiver pair),
  /// which sees the apparent seabed of the end.
  std::vector<Image> images_of(std::size_t end, std::span<const GridPoint> received_at = {},
                               const TubeSet* beside = nullptr);
  /// Vector from the apex of its end to the apex of an image, in m.
  glm::dvec3 beside_m(const Image& image) const;

  /// Mesh that contains the shared facets.
  const FacetMesh& seabed() const { return alike_.seabed.mesh; }
  /// Mesh before the cuts of the apparent map. seen_by() returns facets of this mesh.
  const FacetMesh& base() const { return *mesh_; }
  const PathWater& water() const { return water_; }
  /// Surface that an image with computed visibility sees.
  VisibleSurface seen_by(const Image& image) const;
  /// Counts of all apparent maps from an apex on the seabed. `seen`: surfaces that its images see.
  SurfaceCounts counts(std::span<const VisibleSurface> seen) const;
  /// Facet of the original mesh that contains a facet of seabed().
  FacetId uncut(FacetId facet) const {
    facet = alike_.seabed.parent[facet];
    return cut_origin_.empty() ? facet : cut_origin_[facet];
  }
  const WorldGrid& grid() const { return water_.grid; }
  /// For each facet that an image sees: its position on the facet of the original mesh that contains it.
  /// Requires refinement limits with weights.
  std::vector<PartWeights> weights(const Image& image) const;
  ApparentEnd end_of(const Image& image) const;
  /// Seabed between two images, which may be the same, for reference computations. Computes the apparent
  /// seabed of an image that has no computed visibility.
  BistaticSurface seabed_between(const Image& sent, const Image& received);
  const VisibilityOptions& options() const { return options_; }
  const ApparentMap& water_of(const Image& image) const;
  const RayEnclosure& rays_of(const Image& image) const;
  /// Index of the chain without the last mirror; none for an end itself.
  std::optional<std::size_t> way_before(const Image& image) const;
  /// Moves out the apparent surfaces of all chains with a mirror. Directions are launch directions.
  std::vector<ApparentSurface> take_surfaces();

  /// All rays from an image over its mirrors to a place that leave through a window and that no facet hides.
  std::vector<MirroredRay> rays_to(const Image& image, GridPoint place);
  /// The same without the tests of windows and facets.
  std::vector<MirroredRay> all_rays_to(const Image& image, GridPoint place) const;

 private:
  struct MirrorPath;
  using Heights = std::vector<std::int32_t>;
  struct Children;

  void map_apparent_paths();
  void find_levels(const FacetMesh& mesh);
  void find_ways(std::size_t end, const Heights& heights, bool up, double passes, double way_m, int most);
  MirrorPath& add_mirror_path(std::size_t end, const Heights& heights);
  bool is_next(const Heights& heights, bool up_first, std::int32_t apex, std::int32_t next, bool up) const;
  void look(Image& image);
  std::vector<Image> children_of(const Image& image, std::span<const GridPoint> received_at);
  bool is_hidden(const Image& image, const GridPoint& from, const GridPoint& to);

  const VisibilityOptions options_;
  const Mirrors& mirrors_;
  double least_loss_;
  std::size_t most_images_, found_ = 0;
  double absorption_db_per_m_;
  PathWater water_;
  std::vector<TubeSet> ends_;
  int order_;
  SurfaceApex surface_apex_;
  std::map<std::int32_t, double> levels_;  ///< heights of horizontal mirrors with their largest reflection
                                           ///< factor
  FacetMesh cut_;                          ///< mesh in which no facet extends to both sides of a mirror's
                                           ///< height
  std::vector<FacetId> cut_origin_;        ///< facet of the original mesh per facet of `cut_`
  std::vector<PartWeights> cut_weights_;   ///< position on that facet
  std::unique_ptr<SceneTree> cut_tree_;
  const FacetMesh* mesh_;
  const SceneTree* tree_;
  std::deque<MirrorPath> mirror_paths_;
  std::map<std::pair<std::size_t, Heights>, std::size_t> mirror_path_of_;
  CommonApparentSurfaces alike_;
};

}  // namespace tubefoot
