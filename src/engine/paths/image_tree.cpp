// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/image_tree.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/search/line_of_sight.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/tubes/window_tubes.hpp"
#include "geometry/visibility/contradictions.hpp"

// Builds the tree of images generation by generation. The windows of a child are the visible pieces of a
// mirror, reflected. For the sea surface they are the part of the unobstructed region above the horizon.
// Source: docs/notes/multiple-paths.md, "Images and apertures".

namespace tubefoot {

struct Image::World {
  World(MeshPart p) : part(std::move(p)), tree(part.mesh) {}
  MeshPart part;
  SceneTree tree;
};

namespace {

/// Convex cone in which an image sees a part of a mirror, given by the directions of its corners from the
/// image.
struct Cone {
  std::vector<glm::dvec3> corners;
  std::uint32_t tube = 0;  ///< tube (or window) of the image
  FacetId mirror = no_facet;
  std::vector<WindowCorner> named;  ///< per corner; empty unless requested
};

glm::dvec3 unit_direction(const NameContext& context, const CornerName& corner) {
  return glm::normalize(direction_of(context, corner));
}

/// Part of a convex cone with z >= 0.
Cone upward(const Cone& whole) {
  const std::vector<glm::dvec3>& corners = whole.corners;
  Cone kept{{}, whole.tube, whole.mirror, {}};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::size_t next = (k + 1) % corners.size();
    const glm::dvec3 &a = corners[k], &b = corners[next];
    if (a.z >= 0) {
      kept.corners.push_back(a);
      if (!whole.named.empty()) kept.named.push_back(whole.named[k]);
    }
    if ((a.z < 0) == (b.z < 0)) continue;
    // Always from above to below, so that both neighbours of an edge compute the same point.
    const glm::dvec3 &above = a.z < 0 ? b : a, &below = a.z < 0 ? a : b;
    if (above.z == 0) continue;
    glm::dvec3 level = above.z * below - below.z * above;
    level.z = 0;
    if (level == glm::dvec3(0)) continue;
    kept.corners.push_back(glm::normalize(level));
    if (!whole.named.empty()) kept.named.push_back({whole.named[k].name, whole.named[next].name});
  }
  return kept;
}

/// Energy factor and phase (real, imaginary). Coplanar mirrors with different values make separate images.
using Reflection = std::array<double, 3>;

/// Because of rounding, images miss the common edge of two mirrors by at most this many grid units.
constexpr double edge_units = 4;

/// Fraction of the line from an image to a place that the visibility test ignores. The fraction ends in
/// front of the last mirror by `edge_units`, so that an adjoining mirror does not hide a path over the
/// common edge.
double part_to_mirror(const Image& image, GridPoint to) {
  if (!image.last) return 0;
  const double behind = -static_cast<double>(image.last->side(image.windows.apex)),
               before = static_cast<double>(image.last->side(to)),
               units = edge_units *
                       glm::length(glm::dvec3(double(image.last->normal.x), double(image.last->normal.y),
                                              double(image.last->normal.z)));
  return (behind + units) / (behind + before);
}

}  // namespace

CornerName named_in(const FacetMesh& mesh, const Image& image, CornerName name) {
  const auto convert = [&](PointId& id) {
    if ((id & ray_bit) || image.vertex.empty()) return;
    const PartVertex& of = image.vertex[id];
    id = of.from == of.to ? of.from : static_cast<PointId>(mesh.vertices.size() + id);
  };
  convert(name.point);
  for (PlaneName* plane : {&name.p, &name.q}) {
    if (!plane->depth) {
      convert(plane->a);
      convert(plane->b);
    } else if (!image.origin.empty()) {
      plane->a = image.origin[plane->a];
      plane->b = image.origin[plane->b];
    }
  }
  return name;
}

bool reaches(const Image& image, GridPoint place) {
  return (!image.last || image.last->side(place) > 0) &&
         in_view(*image.mesh, *image.tree, image.windows.apex, place, part_to_mirror(image, place));
}

void add_to_mirror(Image& image, std::span<const glm::dvec3> corners) {
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec3 &a = corners[0], &b = corners[k], &c = corners[(k + 1) % corners.size()];
    image.border_rad += std::atan2(glm::length(glm::cross(b, c)), glm::dot(b, c));
    image.mirror_sr += std::abs(solid_angle(a, b, c));
  }
}

double solid_angle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  return 2 * std::atan2(glm::dot(a, glm::cross(b, c)), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

struct ImageFinder::State {
  State(const FacetMesh& mesh, const SceneTree& tree, const VisibilityOptions& options,
        const Mirrors& mirrors, double least_loss, std::size_t most_images)
      : mesh_(mesh),
        tree_(tree),
        options_(options),
        mirrors_(mirrors),
        least_loss_(least_loss),
        most_images_(most_images) {
    options_.open_water = options.open_water || mirrors.surface.has_value();
    if (!mirrors.surface) return;
    // Same condition as in in_front_of(): a facet that touches the surface from below stays whole, and a
    // facet in the surface is removed.
    const auto height = [&](VertexId v) { return mesh.vertices[v].z; };
    all_below_ = std::all_of(mesh.facets.begin(), mesh.facets.end(), [&](const auto& facet) {
      const auto [least, most] = std::minmax({height(facet[0]), height(facet[1]), height(facet[2])});
      return most <= mirrors.surface->height && least < mirrors.surface->height;
    });
  }

  std::vector<Image> grow(TubeSet tubes, int most_mirrors, std::span<const GridPoint> received_at) {
    std::vector<Image> images(1);
    Image& root = images.front();
    root.windows = std::move(tubes);
    root.mesh = &mesh_;
    root.tree = &tree_;
    for (std::uint32_t t = 0; t < root.windows.tubes.size(); ++t) root.own_tube.push_back(t);
    std::atomic<std::size_t> found{0};
    for (std::size_t first = 0, end = 1; first < end; first = end, end = images.size()) {
      const int mirrors = int(images[first].mirrors);
      if (mirrors < most_mirrors || received_at.empty())
        tbb::parallel_for(first, end, [&](std::size_t i) { look(images[i]); });
      if (mirrors >= most_mirrors) break;
      const Wanted wanted{mirrors + 1 == most_mirrors ? received_at : std::span<const GridPoint>(), found};
      std::vector<std::vector<Image>> children(end - first);
      tbb::parallel_for(first, end, [&](std::size_t i) {
        children[i - first] = children_of(images[i], wanted);
        for (Image& child : children[i - first]) child.parent = i;
      });
      for (auto& some : children) std::move(some.begin(), some.end(), std::back_inserter(images));
    }
    return images;
  }

  /// Selects the images that are kept, and counts the images so far.
  struct Wanted {
    std::span<const GridPoint> received_at;  ///< empty: all images are kept
    std::atomic<std::size_t>& found;
  };

  void look(Image& image) {
    image.seen.resize(image.windows.tubes.size());
    tbb::parallel_for(std::uint32_t{0}, std::uint32_t(image.seen.size()), [&](std::uint32_t tube) {
      see(*image.mesh, *image.tree, image.windows, tube, options_, scratch_.local(), image.seen[tube]);
      if (options_.arithmetic == Arithmetic::plain_double)
        leave_out_contradictions(*image.mesh, image.windows.apex, image.seen[tube]);
    });
  }

  std::vector<Image> children_of(const Image& image, const Wanted& wanted) const {
    std::vector<Image> children;
    stop_if_wanted();
    if (mirrors_.surface) add_surface(image, wanted, children);
    std::map<MirrorPlane, std::map<Reflection, std::vector<Cone>>> facets;  // by plane and reflection
    for (std::uint32_t tube = 0; tube < image.seen.size(); ++tube) {
      const TubeVisibility& seen = image.seen[tube];
      const NameContext context{*image.mesh, image.windows.apex, seen.rays};
      for (const NamedPiece& piece : seen.pieces) {
        const std::size_t material = image.mesh->material[piece.facet];
        const double reflection = mirrors_.reflection.empty() ? 0 : mirrors_.reflection[material];
        if (!(reflection > 0)) continue;
        const std::complex<double> phase = mirrors_.phase.empty() ? 1 : mirrors_.phase[material];
        const FacetId origin = image.origin.empty() ? piece.facet : image.origin[piece.facet];
        Cone cone = cone_of(image, context, tube, piece, origin);
        facets[MirrorPlane::of_facet(mesh_, origin, image.windows.apex)]
              [{reflection, phase.real(), phase.imag()}]
                  .push_back(std::move(cone));
      }
    }
    for (const auto& [plane, by_reflection] : facets)
      for (const auto& [reflection, cones] : by_reflection)
        add_child(image, plane, reflection, cones, false, wanted, children);
    return children;
  }

  Cone cone_of(const Image& image, const NameContext& context, std::uint32_t tube, const NamedPiece& piece,
               FacetId mirror) const {
    Cone cone{{}, tube, mirror, {}};
    for (std::uint32_t k = 0; k < piece.count; ++k) {
      const CornerName& name = image.seen[tube].corners[piece.first + k];
      cone.corners.push_back(unit_direction(context, name));
      if (options_.corner_names) cone.named.push_back({named_in(mesh_, image, name)});
    }
    return cone;
  }

  void add_surface(const Image& image, const Wanted& wanted, std::vector<Image>& children) const {
    const MirrorPlane plane = MirrorPlane::horizontal(mirrors_.surface->height);
    if (plane.side(image.windows.apex) <= 0) return;
    std::vector<Cone> cones;
    for (std::uint32_t tube = 0; tube < image.seen.size(); ++tube) {
      const TubeVisibility& seen = image.seen[tube];
      const NameContext context{*image.mesh, image.windows.apex, seen.rays};
      for (const NamedPiece& open : seen.open) {
        Cone cone = upward(cone_of(image, context, tube, open, no_facet));
        if (cone.corners.size() >= 3) cones.push_back(std::move(cone));
      }
    }
    const SeaSurface& surface = *mirrors_.surface;
    add_child(image, plane, {surface.reflection, surface.phase.real(), surface.phase.imag()}, cones, true,
              wanted, children);
  }

  void add_child(const Image& image, const MirrorPlane& plane, const Reflection& reflection,
                 const std::vector<Cone>& cones, bool is_surface, const Wanted& wanted,
                 std::vector<Image>& children) const {
    if (cones.empty()) return;
    const GridPoint apex = plane.image(image.windows.apex);
    // The child lies as far behind the mirror as the image in front of it. After rounding it may lie in the
    // mirror.
    if (plane.side(apex) >= 0) return;
    Image child;
    child.mirrors = image.mirrors + 1;
    child.last = plane;
    child.chain = image.chain;
    child.chain.push_back(plane);
    const glm::dmat3 reflect = plane.reflection();
    child.leg.to_true = image.leg.to_true * reflect;
    child.leg.loss = image.leg.loss;
    child.leg.loss.factor *= reflection[0];
    child.phase = image.phase * std::complex<double>(reflection[1], reflection[2]);
    for (glm::dvec3& normal : child.leg.loss.rough_normals) normal = reflect * normal;
    if (is_surface && mirrors_.surface->roughness > 0) {
      child.leg.loss.rough_normals.push_back({0, 0, 1});
      child.leg.loss.roughness = mirrors_.surface->roughness;
    }
    WindowTubes windows(apex, image.windows.reach);
    std::vector<glm::dvec3> mirrored;
    child.largest = 0;
    for (std::uint32_t number = 0; number < cones.size(); ++number) {
      const Cone& cone = cones[number];
      stop_if_wanted();
      mirrored.clear();
      for (auto corner = cone.corners.rbegin(); corner != cone.corners.rend(); ++corner)
        mirrored.push_back(reflect * *corner);
      const double passes = most(child.leg.loss, mirrored);
      if (passes <= least_loss_) continue;
      child.largest = std::max(child.largest, passes);
      add_to_mirror(child, cone.corners);
      windows.add(mirrored, number);
    }
    if (windows.tubes().tubes.empty()) return;
    child.windows = windows.tubes();
    if (!wanted.received_at.empty() && std::ranges::none_of(wanted.received_at, [&](GridPoint place) {
          return has_window_to(child, place);
        }))
      return;
    if (++wanted.found > most_images_)
      throw std::length_error(fmt::format(
          "one apex has more than {} images, with up to {} mirrors each, because each mirror facet makes its "
          "own image: use fewer and larger mirror facets, a lower order, or an earlier cut-off",
          most_images_, child.mirrors));
    for (const std::uint32_t number : windows.labels())
      child.own_tube.push_back(image.own_tube[cones[number].tube]);
    if (options_.corner_names) name_windows(windows, cones, child);
    place(child, plane, is_surface);
    children.push_back(std::move(child));
  }

  /// Sets the origins of the windows of an image. The corners of the windows have the opposite order.
  static void name_windows(const WindowTubes& windows, const std::vector<Cone>& cones, Image& child) {
    for (std::size_t window = 0; window < windows.labels().size(); ++window) {
      const Cone& cone = cones[windows.labels()[window]];
      const std::array<std::uint32_t, 4>& numbers = windows.corner_numbers()[window];
      WindowOrigin origin{cone.tube, cone.mirror, {}, numbers[1] == numbers[2]};
      for (std::size_t k = 0; k < 4; ++k) origin.corners[k] = cone.named[cone.named.size() - 1 - numbers[k]];
      child.origins.push_back(origin);
    }
  }

  static bool has_window_to(const Image& image, GridPoint place) {
    const GridPoint along = place - image.windows.apex;
    for (std::uint32_t window = 0; window < image.windows.tubes.size(); ++window)
      if (holds(image.windows, window, along, window_border_rad)) return true;
    return false;
  }

  /// Upper bound of the energy factor in a cone. The sine of the angle to a plane is smallest in a corner,
  /// unless the plane cuts the cone.
  static double most(const MirrorLoss& loss, const std::vector<glm::dvec3>& corners) {
    double exponent = 0;
    for (const glm::dvec3& normal : loss.rough_normals) {
      double least = 1;
      bool above = false, below = false;
      for (const glm::dvec3& corner : corners) {
        const double sine = glm::dot(corner, normal);
        above = above || sine > 0;
        below = below || sine < 0;
        least = std::min(least, std::abs(sine));
      }
      if (!(above && below)) exponent += least * least;
    }
    return loss.factor * std::exp(-loss.roughness * exponent);
  }

  /// Sets the part of the scene that lies in front of the last mirror and within the windows.
  void place(Image& child, const MirrorPlane& plane, bool is_surface) const {
    if (is_surface && all_below_) {
      child.mesh = &mesh_;
      child.tree = &tree_;
      return;
    }
    std::vector<FacetId> near;
    for (const Tube& tube : child.windows.tubes) {
      stop_if_wanted();
      std::array<SceneTree::HalfSpace, 4> walls;
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec64 n = cross(child.windows.rays[tube[k]], child.windows.rays[tube[(k + 1) % 4]]);
        walls[k] = {double(n.x), double(n.y), double(n.z)};
      }
      tree_.query(child.windows.apex, walls, child.windows.reach, near);
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    auto world =
        std::make_shared<const Image::World>(in_front_of(plane, mesh_, near, nullptr, options_.corner_names));
    child.mesh = &world->part.mesh;
    child.tree = &world->tree;
    child.origin = world->part.origin;
    child.vertex = world->part.vertex;
    child.world = std::move(world);
  }

  const FacetMesh& mesh_;
  const SceneTree& tree_;
  VisibilityOptions options_;
  const Mirrors& mirrors_;
  double least_loss_;
  std::size_t most_images_;
  bool all_below_ = false;
  tbb::enumerable_thread_specific<VisibilityScratch> scratch_;
};

ImageFinder::ImageFinder(const FacetMesh& mesh, const SceneTree& tree, const VisibilityOptions& options,
                         const Mirrors& mirrors, double least_loss, std::size_t most_images)
    : state_(std::make_unique<State>(mesh, tree, options, mirrors, least_loss, most_images)) {}

ImageFinder::~ImageFinder() = default;

std::vector<Image> ImageFinder::images_of(TubeSet tubes, int most_mirrors,
                                          std::span<const GridPoint> received_at) const {
  return state_->grow(std::move(tubes), most_mirrors, received_at);
}

}  // namespace tubefoot
