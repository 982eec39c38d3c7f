// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/refracted_images.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "engine/certified/bistatic_enclosure.hpp"
#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/mesh/weld_table.hpp"
#include "geometry/search/line_of_sight.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/tubes/part_corner_weights.hpp"
#include "geometry/tubes/window_tubes.hpp"
#include "geometry/visibility/contradictions.hpp"

// Unfolds chains of horizontal mirrors in stratified water, and maps one apparent seabed per chain. An image
// sees this seabed through its windows, the parts of the next mirror that the previous image sees. Source:
// docs/notes/multiple-paths.md, "Level mirrors in stratified water".

namespace tubefoot {
namespace {

struct Cone {
  std::vector<glm::dvec3> corners;
  std::uint32_t own_tube = 0;
};

std::array<std::int32_t, 3> heights_of(const FacetMesh& mesh, FacetId facet) {
  const auto& [a, b, c] = mesh.facets[facet];
  return {mesh.vertices[a].z, mesh.vertices[b].z, mesh.vertices[c].z};
}

/// Returns the mesh with each facet that extends to both sides of a height cut at this height. Updates
/// `origin`, the original facet per facet. An empty `origin` means that each facet is its own.
FacetMesh cut_at(const FacetMesh& mesh, std::int32_t height, std::vector<FacetId>& origin,
                 std::vector<PartWeights>& weights) {
  std::vector<FacetId> crossing;
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    const auto heights = heights_of(mesh, f);
    const auto [least, most] = std::ranges::minmax(heights);
    if (least < height && height < most) crossing.push_back(f);
  }
  if (crossing.empty()) return mesh;
  FacetMesh cut;
  WeldTable weld(cut.vertices);
  weld.reserve(mesh.vertices.size() + 4 * crossing.size());
  std::vector<FacetId> now;
  std::vector<PartWeights> lies;
  const auto of_whole = [&](FacetId whole) { return weights.empty() ? all_of_it : weights[whole]; };
  const auto add = [&](const FacetMesh& from, FacetId f, FacetId whole, const PartWeights& on_whole) {
    now.push_back(origin.empty() ? whole : origin[whole]);
    lies.push_back(on_whole);
    std::array<VertexId, 3> facet;
    for (std::size_t k = 0; k < 3; ++k) facet[k] = weld.id_of(from.vertices[from.facets[f][k]]);
    cut.facets.push_back(facet);
    cut.material.push_back(from.material[f]);
    cut.component.push_back(from.component[f]);
  };
  for (FacetId f = 0; f < mesh.facets.size(); ++f)
    if (!std::ranges::binary_search(crossing, f)) add(mesh, f, f, of_whole(f));
  const MirrorPlane below = MirrorPlane::horizontal(height), above{{0, 0, 1}, Int128(height)};
  for (const MirrorPlane& plane : {above, below}) {
    std::vector<std::array<PartCorner, 3>> corners;
    const MeshPart part = in_front_of(plane, mesh, crossing, &corners);
    for (FacetId f = 0; f < part.mesh.facets.size(); ++f)
      add(part.mesh, f, part.origin[f], weights_of(corners[f], of_whole(part.origin[f])));
  }
  origin = std::move(now);
  weights = std::move(lies);
  return cut;
}

glm::dvec3 upside_down(glm::dvec3 v) { return {v.x, v.y, -v.z}; }

/// Upper bound of the energy factor in a cone.
double most_of(const MirrorLoss& loss, const std::vector<glm::dvec3>& corners) {
  double least = 1;
  bool above = false, below = false;
  for (const glm::dvec3& corner : corners) {
    above = above || corner.z > 0;
    below = below || corner.z < 0;
    least = std::min(least, std::abs(corner.z));
  }
  if (above && below) least = 0;
  return loss.at({std::sqrt((1 - least) * (1 + least)), 0, least});
}

}  // namespace

/// Path from an end over a chain of mirrors.
struct RefractedImages::MirrorPath {
  MirrorPath(std::size_t of, Heights chain, const PathWater& water, const TubeSet& tubes,
             const SurfaceApex& surface_apex)
      : end(of),
        heights(std::move(chain)),
        up_first(!heights.empty() && heights.front() > tubes.apex.z),
        unfolded(unfold(water.column, water.rays, water.surface_height_m, in_metres(heights, water.grid),
                        up_first)),
        apparent_map(unfolded.water, water.grid.to_metres(tubes.apex), water.surface_height_m, unfolded.rays,
                     water.reference_speed_m_s, unfolded.unfolding,
                     {surface_apex.front, heights.empty() ? surface_apex.straight_within_m : 0}),
        rays(apparent_map, unfolded.rays),
        view_bounds(tubes, water.grid.unit_m(), apparent_map) {}
  MirrorPath(const MirrorPath&) = delete;
  MirrorPath& operator=(const MirrorPath&) = delete;

  static std::vector<double> in_metres(const Heights& heights, const WorldGrid& grid) {
    std::vector<double> metres;
    for (const std::int32_t z : heights) metres.push_back(grid.to_metres({0, 0, z}).z);
    return metres;
  }

  std::size_t end;
  Heights heights;
  bool up_first;
  UnfoldedWater unfolded;
  ApparentMap apparent_map;
  RayEnclosure rays;
  ViewBounds view_bounds;
  std::unique_ptr<SceneTree> tree;                ///< search tree over the surface that its images see
  std::unique_ptr<CommonApparentSurfaces> alone;  ///< surface of a chain whose images have no computed
                                                  ///< visibility
};

RefractedImages::~RefractedImages() = default;

RefractedImages::RefractedImages(const FacetMesh& mesh, const SceneTree& tree,
                                 const VisibilityOptions& options, const Mirrors& mirrors, double least_loss,
                                 std::size_t most_images, double absorption_db_per_m, const PathWater& water,
                                 std::vector<TubeSet> ends, int order)
    : options_([&] {
        VisibilityOptions own = options;
        own.open_water = options.open_water || mirrors.surface.has_value();
        return own;
      }()),
      mirrors_(mirrors),
      least_loss_(least_loss),
      most_images_(most_images),
      absorption_db_per_m_(absorption_db_per_m),
      water_(water),
      ends_(std::move(ends)),
      order_(order),
      mesh_(&mesh),
      tree_(&tree) {
  find_levels(mesh);
  for (const auto& [height, reflection] : levels_) {
    FacetMesh cut = cut_at(*mesh_, height, cut_origin_, cut_weights_);
    if (cut.facets.size() == mesh_->facets.size()) continue;
    cut_ = std::move(cut);
    mesh_ = &cut_;
  }
  if (mesh_ == &cut_) {
    cut_tree_ = std::make_unique<SceneTree>(cut_);
    tree_ = cut_tree_.get();
  }
  map_apparent_paths();
}

RefractedImages::RefractedImages(const RefractedImages& others, const PathWater& water, TubeSet tubes,
                                 int order, const SurfaceApex& surface_apex)
    : options_(others.options_),
      mirrors_(others.mirrors_),
      least_loss_(others.least_loss_),
      most_images_(others.most_images_),
      absorption_db_per_m_(others.absorption_db_per_m_),
      water_(water),
      ends_{std::move(tubes)},
      order_(order),
      surface_apex_(surface_apex),
      levels_(others.levels_),
      mesh_(others.mesh_),
      tree_(others.tree_) {
  map_apparent_paths();
}

void RefractedImages::map_apparent_paths() {
  std::vector<FacetId> facets;
  for (std::size_t end = 0; end < ends_.size(); ++end) find_ways(end, {}, false, 1, 0, order_ - 1);
  std::vector<const ApparentMap*> straightenings;
  std::vector<const ViewBounds*> all_view_bounds;
  for (const MirrorPath& mirror_path : mirror_paths_) {
    stop_if_wanted();
    straightenings.push_back(&mirror_path.apparent_map);
    all_view_bounds.push_back(&mirror_path.view_bounds);
    const std::vector<FacetId> some = mirror_path.view_bounds.facets(*mesh_, *tree_, water_.grid);
    facets.insert(facets.end(), some.begin(), some.end());
  }
  std::ranges::sort(facets);
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  alike_ = map_apparent_together(*mesh_, facets, water_.grid, straightenings, absorption_db_per_m_,
                                 water_.apparent_map, water_.limits, all_view_bounds);
  for (std::size_t k = 0; k < mirror_paths_.size(); ++k)
    mirror_paths_[k].tree =
        std::make_unique<SceneTree>(alike_.seen[k].refined.mesh, SceneTree::HeightFieldSearch::ignored);
}

void RefractedImages::find_levels(const FacetMesh& mesh) {
  if (mirrors_.surface) levels_[mirrors_.surface->height] = mirrors_.surface->reflection;
  if (mirrors_.reflection.empty()) return;
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    const double reflection = mirrors_.reflection[mesh.material[f]];
    if (!(reflection > 0)) continue;
    const auto [a, b, c] = heights_of(mesh, f);
    if (a != b || b != c)
      throw std::invalid_argument("paths through stratified water need horizontal mirrors");
    double& most = levels_[a];
    most = std::max(most, reflection);
  }
}

/// Whether sound that has passed a chain of mirrors can next meet a mirror at height `next` on its way up
/// (or down).
bool RefractedImages::is_next(const Heights& heights, bool up_first, std::int32_t apex, std::int32_t next,
                              bool up) const {
  if (!up && mirrors_.surface && next == mirrors_.surface->height) return false;
  const std::int32_t from = heights.empty() ? apex : heights.back();
  if (!heights.empty() && up != ((heights.size() % 2 == 0) == up_first)) return false;
  return up ? next > from : next < from;
}

RefractedImages::MirrorPath& RefractedImages::add_mirror_path(std::size_t end, const Heights& heights) {
  if (mirror_paths_.size() > most_images_)
    throw std::length_error(fmt::format(
        "there are more than {} chains of horizontal mirrors: use a lower order, or an earlier cut-off",
        most_images_));
  mirror_path_of_[{end, heights}] = mirror_paths_.size();
  return mirror_paths_.emplace_back(end, heights, water_, ends_[end], surface_apex_);
}

void RefractedImages::find_ways(std::size_t end, const Heights& heights, bool up_first, double passes,
                                double way_m, int most) {
  add_mirror_path(end, heights);
  if (int(heights.size()) >= most) return;
  const std::int32_t apex = ends_[end].apex.z, from = heights.empty() ? apex : heights.back();
  double fastest = 0;
  for (const ProfilePoint& p : water_.column.profile.points()) fastest = std::max(fastest, p.sound_speed_m_s);
  for (const auto& [height, reflection] : levels_)
    for (const bool up : {true, false}) {
      if (!is_next(heights, up_first, apex, height, up)) continue;
      const double through = passes * reflection,
                   on_m = way_m + std::abs(double(height) - from) * water_.grid.unit_m(),
                   reach_m = ends_[end].reach * water_.grid.unit_m();
      if (!(through > least_loss_) || on_m * water_.reference_speed_m_s / fastest > reach_m) continue;
      Heights longer = heights;
      longer.push_back(height);
      find_ways(end, longer, heights.empty() ? up : up_first, through, on_m, most);
    }
}

void RefractedImages::look(Image& image) {
  image.seen.resize(image.windows.tubes.size());
  tbb::enumerable_thread_specific<VisibilityScratch> scratch;
  tbb::parallel_for(std::uint32_t{0}, std::uint32_t(image.seen.size()), [&](std::uint32_t tube) {
    see(*image.mesh, *image.tree, image.windows, tube, options_, scratch.local(), image.seen[tube]);
    if (options_.arithmetic == Arithmetic::plain_double)
      leave_out_contradictions(*image.mesh, image.windows.apex, image.seen[tube]);
  });
}

std::vector<Image> RefractedImages::images_of(std::size_t end, std::span<const GridPoint> received_at,
                                              const TubeSet* beside) {
  std::vector<Image> images(1);
  Image& root = images.front();
  root.windows = beside != nullptr ? *beside : ends_[end];
  for (std::uint32_t t = 0; t < root.windows.tubes.size(); ++t) root.own_tube.push_back(t);
  root.mirror_path = mirror_path_of_.at({end, {}});
  for (std::size_t first = 0, last = 1; first < last; first = last, last = images.size()) {
    const int mirrors = int(images[first].mirrors);
    if (mirrors >= order_) break;
    for (std::size_t i = first; i < last; ++i) {
      Image& image = images[i];
      image.mesh = &alike_.seen[image.mirror_path].refined.mesh;
      image.tree = mirror_paths_[image.mirror_path].tree.get();
      image.origin = alike_.origin[image.mirror_path];
      look(image);
    }
    const bool is_last = mirrors + 1 == order_;
    if (is_last && received_at.empty()) break;
    for (std::size_t i = first; i < last; ++i)
      for (Image& child : children_of(images[i], is_last ? received_at : std::span<const GridPoint>()))
        images.push_back(std::move(child));
  }
  return images;
}

glm::dvec3 RefractedImages::beside_m(const Image& image) const {
  return water_.grid.to_metres(image.windows.apex) -
         water_.grid.to_metres(ends_[mirror_paths_[image.mirror_path].end].apex);
}

std::vector<Image> RefractedImages::children_of(const Image& image, std::span<const GridPoint> received_at) {
  stop_if_wanted();
  const MirrorPath& mirror_path = mirror_paths_[image.mirror_path];
  const GridPoint apex = image.windows.apex;
  const std::int32_t level = ends_[mirror_path.end].apex.z;  // height about which unfolding reflects the
                                                             // scene
  // Key: height, whether the mirror is met from below, reflection factor, and whether it is the sea surface
  // (which has no facet).
  std::map<std::tuple<std::int32_t, bool, double, bool>, std::vector<Cone>> mirrors;
  for (std::uint32_t tube = 0; tube < image.seen.size(); ++tube) {
    const TubeVisibility& seen = image.seen[tube];
    const NameContext context{*image.mesh, apex, seen.rays};
    const auto cone_of = [&](const NamedPiece& piece) {
      Cone cone{{}, image.own_tube[tube]};
      for (std::uint32_t k = 0; k < piece.count; ++k)
        cone.corners.push_back(glm::normalize(direction_of(context, seen.corners[piece.first + k])));
      return cone;
    };
    if (mirrors_.surface)
      for (const NamedPiece& open : seen.open)
        mirrors[{mirrors_.surface->height, true, mirrors_.surface->reflection, true}].push_back(
            cone_of(open));
    for (const NamedPiece& piece : seen.pieces) {
      const double reflection =
          mirrors_.reflection.empty() ? 0 : mirrors_.reflection[image.mesh->material[piece.facet]];
      if (!(reflection > 0)) continue;
      // Side of the facet that the image sees. The apparent facet has the orientation of the true facet.
      glm::dvec3 lies[3], from_apex[3];
      for (std::size_t k = 0; k < 3; ++k) {
        lies[k] = water_.grid.to_metres(seabed().vertices[seabed().facets[image.origin[piece.facet]][k]]);
        from_apex[k] = water_.grid.to_metres(image.mesh->vertices[image.mesh->facets[piece.facet][k]]) -
                       water_.grid.to_metres(apex);
      }
      const bool faces =
          glm::dot(glm::cross(from_apex[1] - from_apex[0], from_apex[2] - from_apex[0]), from_apex[0]) < 0;
      const bool points_up = glm::cross(lies[1] - lies[0], lies[2] - lies[0]).z > 0;
      mirrors[{seabed().vertices[seabed().facets[image.origin[piece.facet]][0]].z, faces != points_up,
               reflection, false}]
          .push_back(cone_of(piece));
    }
  }
  std::vector<Image> children;
  for (const auto& [mirror, cones] : mirrors) {
    const auto [height, up, reflection, is_surface] = mirror;
    if (!is_next(mirror_path.heights, mirror_path.up_first, level, height, up)) continue;
    Heights chain = mirror_path.heights;
    chain.push_back(height);
    auto known = mirror_path_of_.find({mirror_path.end, chain});
    if (known == mirror_path_of_.end()) {
      if (received_at.empty()) continue;  // the chain passes too little, or is longer than the reach
      add_mirror_path(mirror_path.end, chain);
      known = mirror_path_of_.find({mirror_path.end, chain});
    }
    Image child;
    child.mirrors = image.mirrors + 1;
    child.mirror_path = known->second;
    const ApparentMap& water = mirror_paths_[child.mirror_path].apparent_map;
    child.leg.to_true[2][2] = water.unfolding().sign;
    child.leg.loss = image.leg.loss;
    child.leg.loss.factor *= reflection;
    if (is_surface && mirrors_.surface->roughness > 0) {
      const double depth_m =
                       water_.surface_height_m - water_.grid.to_metres({0, 0, mirrors_.surface->height}).z,
                   ratio = water_.column.profile.at(depth_m) / water.finder().source_speed_m_s();
      child.leg.loss.rough_normals.push_back({0, 0, 1});
      child.leg.loss.roughness = mirrors_.surface->roughness;
      child.leg.loss.bend = (ratio - 1) * (ratio + 1);
    }
    WindowTubes windows({apex.x, apex.y, 2 * level - apex.z}, image.windows.reach);
    std::vector<glm::dvec3> mirrored;
    child.largest = 0;
    for (const Cone& cone : cones) {
      mirrored.clear();
      for (auto corner = cone.corners.rbegin(); corner != cone.corners.rend(); ++corner)
        mirrored.push_back(upside_down(*corner));
      const double passes = most_of(child.leg.loss, mirrored);
      if (passes <= least_loss_) continue;
      child.largest = std::max(child.largest, passes);
      add_to_mirror(child, cone.corners);
      windows.add(mirrored, cone.own_tube);
    }
    if (windows.tubes().tubes.empty()) continue;
    child.windows = windows.tubes();
    child.own_tube = windows.labels();
    if (!received_at.empty() && !water_.keep_last &&
        std::ranges::all_of(received_at,
                            [&](const GridPoint& place) { return rays_to(child, place).empty(); }))
      continue;
    if (++found_ > most_images_)
      throw std::length_error(
          fmt::format("one apex has more than {} images, with up to {} mirrors each: use a lower order, or "
                      "an earlier cut-off",
                      most_images_, child.mirrors));
    children.push_back(std::move(child));
  }
  return children;
}

std::vector<PartWeights> RefractedImages::weights(const Image& image) const {
  const RefinedMesh& seen = alike_.seen[image.mirror_path].refined;
  std::vector<PartWeights> all = seen.weights;
  if (!cut_weights_.empty())
    for (FacetId f = 0; f < all.size(); ++f)
      all[f] = rounded_part_of_part(cut_weights_[seen.parent[f]], all[f]);
  return all;
}

ApparentEnd RefractedImages::end_of(const Image& image) const {
  return {alike_.seen[image.mirror_path], mirror_paths_[image.mirror_path].apparent_map};
}

BistaticSurface RefractedImages::seabed_between(const Image& sent, const Image& received) {
  for (const Image* image : {&sent, &received}) {
    MirrorPath& mirror_path = mirror_paths_[image->mirror_path];
    if (mirror_path.tree != nullptr) continue;
    mirror_path.alone = std::make_unique<CommonApparentSurfaces>(
        map_apparent_together(*mesh_, mirror_path.view_bounds.facets(*mesh_, *tree_, water_.grid),
                              water_.grid, std::array{&mirror_path.apparent_map}, absorption_db_per_m_,
                              water_.apparent_map, water_.limits, std::array{&mirror_path.view_bounds}));
    mirror_path.tree = std::make_unique<SceneTree>(mirror_path.alone->seen[0].refined.mesh,
                                                   SceneTree::HeightFieldSearch::ignored);
  }
  const auto end = [&](const Image& image) {
    const MirrorPath& mirror_path = mirror_paths_[image.mirror_path];
    const bool alone = mirror_path.alone != nullptr;
    return BistaticEnd{alone ? mirror_path.alone->seen[0] : alike_.seen[image.mirror_path], *mirror_path.tree,
                       alone ? mirror_path.alone->origin[0] : alike_.origin[image.mirror_path],
                       mirror_path.apparent_map, mirror_path.rays};
  };
  const RefinedMesh& cut =
      mirror_paths_[sent.mirror_path].alone ? mirror_paths_[sent.mirror_path].alone->seabed : alike_.seabed;
  return {cut.mesh, cut.parent, *mesh_, water_.grid, end(sent), end(received)};
}

const ApparentMap& RefractedImages::water_of(const Image& image) const {
  return mirror_paths_[image.mirror_path].apparent_map;
}

const RayEnclosure& RefractedImages::rays_of(const Image& image) const {
  return mirror_paths_[image.mirror_path].rays;
}

std::optional<std::size_t> RefractedImages::way_before(const Image& image) const {
  const MirrorPath& mirror_path = mirror_paths_[image.mirror_path];
  if (mirror_path.heights.empty()) return std::nullopt;
  return mirror_path_of_.at(
      {mirror_path.end, Heights(mirror_path.heights.begin(), mirror_path.heights.end() - 1)});
}

VisibleSurface RefractedImages::seen_by(const Image& image) const {
  const MirrorPath& mirror_path = mirror_paths_[image.mirror_path];
  const ApparentSurface& surface_mesh = alike_.seen[image.mirror_path];
  const FacetMesh& mesh = *image.mesh;
  const glm::dvec3 apex_m = water_.grid.to_metres(image.windows.apex);
  VisibleSurface seabed{shared_with_itself(mesh, {image.windows, image.seen}, water_.grid.unit_m())};
  std::unordered_map<VertexId, Eigenray> rays;
  for (SharedFacet& facet : seabed.shared.facets) {
    stop_if_wanted();
    glm::dvec3 seen[3], lies[3];
    Eigenray ray[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = mesh.facets[facet.facet][k];
      seen[k] = water_.grid.to_metres(mesh.vertices[v]);
      lies[k] = surface_mesh.truth[v];
      const auto [known, is_new] = rays.try_emplace(v);
      // a visible vertex has an apparent position
      if (is_new) known->second = mirror_path.apparent_map.apparent(lies[k])->ray;
      ray[k] = known->second;
    }
    seabed.refracted.push_back(
        refracted_facet(apex_m, seen, lies, ray, mirror_path.apparent_map, absorption_db_per_m_));
    facet.facet = alike_.seabed.parent[image.origin[facet.facet]];
  }
  return seabed;
}

SurfaceCounts RefractedImages::counts(std::span<const VisibleSurface> seen) const {
  SurfaceCounts all;
  for (std::size_t k = 0; k < mirror_paths_.size(); ++k)
    all.add(counts_from(alike_.seen[k], mirror_paths_[k].apparent_map,
                        mirror_paths_[k].heights.empty() ? surface_apex_.front : glm::dvec3(0),
                        4 * water_.grid.unit_m()));
  for (const VisibleSurface& seabed : seen) all.folded += folded_facets(seabed);
  return all;
}

std::vector<ApparentSurface> RefractedImages::take_surfaces() {
  std::vector<ApparentSurface> surface_meshes;
  for (std::size_t k = 0; k < alike_.seen.size(); ++k) {
    if (mirror_paths_[k].heights.empty()) continue;
    for (UnclearPlace& place : alike_.seen[k].unclear)
      if (place.eigenrays > 0) place.direction.z *= mirror_paths_[k].apparent_map.unfolding().sign;
    surface_meshes.push_back(std::move(alike_.seen[k]));
  }
  return surface_meshes;
}

bool RefractedImages::is_hidden(const Image& image, const GridPoint& from, const GridPoint& to) {
  if (image.mesh != nullptr) return !in_view(*image.mesh, *image.tree, from, to);
  // Nothing is scattered after the last mirror, so its seabed is mapped only here.
  MirrorPath& mirror_path = mirror_paths_[image.mirror_path];
  const ApparentSurface surface_mesh =
      map_apparent(*mesh_, mirror_path.view_bounds.facets(*mesh_, *tree_, water_.grid), water_.grid,
                   mirror_path.apparent_map, absorption_db_per_m_, water_.apparent_map, water_.limits, {},
                   &mirror_path.view_bounds);
  const SceneTree tree(surface_mesh.refined.mesh, SceneTree::HeightFieldSearch::ignored);
  return !in_view(surface_mesh.refined.mesh, tree, from, to);
}

std::vector<MirroredRay> RefractedImages::rays_to(const Image& image, GridPoint place) {
  std::vector<MirroredRay> rays = all_rays_to(image, place);
  std::erase_if(rays, [&](const MirroredRay& ray) {
    const GridPoint along = ray.seen_at - image.windows.apex;
    bool in_window = false;
    for (std::uint32_t w = 0; w < image.windows.tubes.size() && !in_window; ++w)
      in_window = holds(image.windows, w, along, window_border_rad);
    return !in_window || is_hidden(image, image.windows.apex, ray.seen_at);
  });
  return rays;
}

std::vector<MirroredRay> RefractedImages::all_rays_to(const Image& image, GridPoint place) const {
  const ApparentMap& water = mirror_paths_[image.mirror_path].apparent_map;
  const glm::dvec3 at_m = water_.grid.to_metres(place), mirror_path = at_m - water.apex_m();
  std::vector<MirroredRay> rays;
  if (!water.unfolding().may_reach(at_m.z, at_m.z)) return rays;
  const double range = std::hypot(mirror_path.x, mirror_path.y);
  const glm::dvec2 across = range > 0 ? glm::dvec2(mirror_path) / range : glm::dvec2(0);
  for (const Eigenray& ray : water.finder().all(water.depth_m(at_m), range)) {
    if (!(ray.tube_area_m2_per_sr > 0)) continue;  // on a caustic, where ray theory is not valid
    const double distance = water.reference_speed_m_s() * ray.time_s;
    MirroredRay found;
    found.sent = {ray.launch_cosine * across, -water.unfolding().sign * ray.launch_sine};
    found.seen_at = water_.grid.snap(water.apex_m() + distance * found.sent);
    found.arrives = water.arrival_direction(at_m, ray);
    found.half_path_m = distance / 2;
    found.kept = std::exp(-ray.absorption_db * std::numbers::ln10 / 10);
    found.tube_area_m2 = ray.tube_area_m2_per_sr;
    found.unfolded_height_m = water.unfolding().height_m(at_m.z);
    rays.push_back(found);
  }
  return rays;
}

}  // namespace tubefoot
