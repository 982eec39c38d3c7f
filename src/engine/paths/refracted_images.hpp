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
#include "engine/surface/bistatic_facet.hpp"

// Apexes and their images in level mirrors, in refracting water. docs/paths.md, "In refracting water"
namespace tubefoot {

struct BistaticSurface;  // engine/certified/bistatic_enclosure.hpp
class RayEnclosure;      // engine/water/ray_enclosure.hpp

/// Water that refracts, and how finely the seabed is seen through it.
struct PathWater {
  const WaterColumn& column;
  double surface_height_m = 0;  ///< depth = this - z
  EigenrayOptions rays;
  double reference_speed_m_s = 1500;  ///< by which a travel time becomes a range
  ApparentMapSettings apparent_map;
  RefinementLimits limits;
  const WorldGrid& grid;
  /// Images in the most mirrors are kept whether anything seems to come from them or not.
  bool keep_last = false;
};

/// A ray from an image, over its mirrors, to a receiver.
struct MirroredRay {
  GridPoint seen_at;             ///< where the image sees the receiver
  glm::dvec3 sent{0};            ///< direction as the image has it, unit vector
  glm::dvec3 arrives{0};         ///< direction of travel at the receiver, unit vector
  double half_path_m = 0;        ///< half of what sound covers in its time at the reference speed
  double kept = 1;               ///< what absorption leaves of the energy
  double tube_area_m2 = 0;       ///< at the receiver, perpendicular to the ray, per steradian at the apex
  double unfolded_height_m = 0;  ///< of the receiver: tells chains of mirrors apart
};

/// The images of one apex or of two, over one seabed that is cut alike for all of them.
///
/// An image has the place of its true apex, and sees the seabed where rays over its chain of mirrors say
/// (Apparent map with Unfolding): through the windows that the mirror is seen in, as anywhere. Mirrors are
/// the sea surface and level facets; of rays that turn, those are followed that do it before the first mirror
/// or after the last.
class RefractedImages {
 public:
  /// `ends`: tubes of the transmitter, and of a receiver that is apart. `order`: most mirrors of a chain of
  /// the transmitter; one less of what scatters. What is referred to must outlive it. Throws as
  /// map_apparent_together(); std::length_error for more than `most_images` chains; std::invalid_argument for
  /// mirrors that are not level.
  RefractedImages(const FacetMesh& mesh, const SceneTree& tree, const VisibilityOptions& options,
                  const Mirrors& mirrors, double least_loss, std::size_t most_images,
                  double absorption_db_per_m, const PathWater& water, std::vector<TubeSet> ends, int order);
  /// Of an apex on the seabed of others, with one mirror less than `order` at most. `water`:
  /// continued_below().
  RefractedImages(const RefractedImages& others, const PathWater& water, TubeSet tubes, int order,
                  const SurfaceApex& surface_apex);
  ~RefractedImages();

  /// As ImageFinder::images_of() has them. `beside`: the tubes of a place near the end, which looks at what
  /// is seen from there (the end of a receiver pair).
  std::vector<Image> images_of(std::size_t end, std::span<const GridPoint> received_at = {},
                               const TubeSet* beside = nullptr);
  /// How far an image is from that of its end.
  glm::dvec3 beside_m(const Image& image) const;

  /// The seabed that shared facets are of.
  const FacetMesh& seabed() const { return alike_.seabed.mesh; }
  /// The seabed before it is cut for what is seen; seen_by() names its facets.
  const FacetMesh& base() const { return *mesh_; }
  const PathWater& water() const { return water_; }
  /// What an image that has looked sees.
  VisibleSurface seen_by(const Image& image) const;
  /// Of all that was mapped for an apex on the seabed, which sees that.
  SurfaceCounts counts(std::span<const VisibleSurface> seen) const;
  /// By facet of that: the one of the mesh that it is a part of.
  FacetId uncut(FacetId facet) const {
    facet = alike_.seabed.parent[facet];
    return cut_origin_.empty() ? facet : cut_origin_[facet];
  }
  const WorldGrid& grid() const { return water_.grid; }
  /// By facet that an image sees: where that lies on the one of the mesh that it is a part of. Of limits with
  /// weights.
  std::vector<PartWeights> weights(const Image& image) const;
  ApparentEnd end_of(const Image& image) const;
  /// The seabed between two images, for references; they may be the same. Those that have not looked, too,
  /// straighten it for that.
  BistaticSurface seabed_between(const Image& sent, const Image& received);
  const VisibilityOptions& options() const { return options_; }
  const ApparentMap& water_of(const Image& image) const;
  const RayEnclosure& rays_of(const Image& image) const;
  /// The way of those that have one mirror less; none of an end itself.
  std::optional<std::size_t> way_before(const Image& image) const;
  /// What came of apparent map, but for the apexes' own; by chain of mirrors. Directions are those of
  /// launch.
  std::vector<ApparentSurface> take_surfaces();

  /// All rays from an image over its mirrors to a place, those through its windows not hidden by facets.
  std::vector<MirroredRay> rays_to(const Image& image, GridPoint place);
  /// And whether anything lets them pass or not.
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
  std::map<std::int32_t, double> levels_;  ///< heights of level mirrors, and the most that one reflects
  FacetMesh cut_;                          ///< no facet lies on both sides of a mirror's height
  std::vector<FacetId> cut_origin_;        ///< by its facet: the one of the mesh
  std::vector<PartWeights> cut_weights_;   ///< and where it lies on that
  std::unique_ptr<SceneTree> cut_tree_;
  const FacetMesh* mesh_;
  const SceneTree* tree_;
  std::deque<MirrorPath> mirror_paths_;
  std::map<std::pair<std::size_t, Heights>, std::size_t> mirror_path_of_;
  CommonApparentSurfaces alike_;
};

}  // namespace tubefoot
