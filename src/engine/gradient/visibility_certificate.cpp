// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/visibility_certificate.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/integrals/plane_function.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

bool same_plane(const PlaneName& a, const PlaneName& b) {
  return a == b || (a.depth && b.depth && a.a == b.b && a.b == b.a);
}

PlaneName through(PointId a, PointId b) { return {std::min(a, b), std::max(a, b), false}; }

/// Names of one plane compare equal.
PlaneName ordered(PlaneName plane) {
  if (plane.b < plane.a) std::swap(plane.a, plane.b);
  return plane;
}
std::array<std::uint32_t, 3> words(const PlaneName& plane) {
  const PlaneName p = ordered(plane);
  return {p.a, p.b, p.depth};
}
std::array<std::uint32_t, 7> words(const CornerName& corner) {
  const auto p = words(corner.p), q = words(corner.q);
  const auto &low = std::min(p, q), &high = std::max(p, q);
  return {corner.point, low[0], low[1], low[2], high[0], high[1], high[2]};
}

bool lies_on(const CornerName& corner, const PlaneName& plane) {
  if (corner.point != no_point) return plane.contains(corner.point);
  return same_plane(corner.p, plane) || same_plane(corner.q, plane);
}

/// Returns a plane that contains both corners by name.
std::optional<PlaneName> common_plane(const CornerName& a, const CornerName& b) {
  if (a.point != no_point && b.point != no_point)
    return a.point == b.point ? std::nullopt : std::optional(through(a.point, b.point));
  const CornerName& meeting = a.point == no_point ? a : b;
  const CornerName& other = a.point == no_point ? b : a;
  for (const PlaneName& plane : {meeting.p, meeting.q})
    if (lies_on(other, plane)) return plane;
  return std::nullopt;
}

/// Encloses the product of a vector and the position of a moving one.
template <class Enclosure>
Enclosure along(glm::dvec3 direction, const std::array<Moving<Enclosure>, 3>& v) {
  return Enclosure(direction.x) * v[0].at + Enclosure(direction.y) * v[1].at +
         Enclosure(direction.z) * v[2].at;
}

std::array<MovingInterval, 3> intervals(const std::array<MovingBall, 3>& v) {
  std::array<MovingInterval, 3> of;
  for (std::size_t k = 0; k < 3; ++k) of[k] = {interval_of(v[k].at), interval_of(v[k].by)};
  return of;
}

}  // namespace

VisibilityCertificate::VisibilityCertificate(const NameContext& context, const TubeVisibility& seen,
                                             const SceneTree& tree, double reach, const SceneMotion& motion,
                                             double vertex_speed)
    : context_(context), tree_(tree), reach_(reach), motion_(motion), vertex_speed_(vertex_speed) {
  for (std::uint32_t k = 0; k < 4; ++k) {
    const GridPoint ray = seen.rays[k];
    rays_[k] = glm::normalize(glm::dvec3(ray.x, ray.y, ray.z));
    walls_[k] = through(ray_bit | k, ray_bit | (k + 1) % 4);
  }
  const glm::dvec3 ahead = glm::normalize(rays_[0] + rays_[1] + rays_[2] + rays_[3]);
  const glm::dvec3 right = glm::normalize(rays_[1] - rays_[0]);
  chart_ = {right, glm::cross(ahead, right), ahead};
  exact_.resize(identity_samples);
  for (const NamedPiece& piece : seen.pieces) is_certain_ = is_certain_ && add_polygon(seen, piece, false);
  for (const NamedPiece& piece : seen.open) is_certain_ = is_certain_ && add_polygon(seen, piece, true);
  is_certain_ = is_certain_ && borders_add_up();
  if (is_certain_) merge_polygons();
}

auto VisibilityCertificate::exact(int sample) -> Exact& {
  auto& vectors = exact_[std::size_t(sample)];
  if (!vectors)
    vectors =
        std::make_unique<Exact>(context_, [this, sample](PointId id) { return motion_.sample(id, sample); });
  return *vectors;
}

bool VisibilityCertificate::add_polygon(const TubeVisibility& seen, const NamedPiece& piece, bool is_open) {
  Polygon polygon;
  if (!is_open) polygon.facet = piece.facet;
  const auto first = seen.corners.begin() + piece.first;
  polygon.corners.assign(first, first + piece.count);
  for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
    const auto plane = common_plane(polygon.corners[k], polygon.corners[(k + 1) % polygon.corners.size()]);
    if (!plane) return false;
    int sign = 0;
    for (std::size_t j = 0; sign == 0 && j < polygon.corners.size(); ++j)
      if (!lies_on(polygon.corners[j], *plane))
        sign = ExactNumber(dot(exact(0).normal(*plane), exact(0).ray(polygon.corners[j]))).sign();
    if (sign == 0) return false;
    polygon.edges.push_back({*plane, sign});
  }
  polygons_.push_back(std::move(polygon));
  return true;
}

bool VisibilityCertificate::borders_add_up() {
  // An edge adds its second corner to the sum of its plane and subtracts the first.
  struct End {
    PlaneName plane;
    CornerName corner;
    int count;
  };
  std::map<std::array<std::uint32_t, 10>, End> ends;
  const auto add = [&](const PlaneName& plane, const CornerName& corner, int count) {
    std::array<std::uint32_t, 10> key{};
    std::ranges::copy(words(plane), key.begin());
    std::ranges::copy(words(corner), key.begin() + 3);
    ends.try_emplace(key, End{ordered(plane), corner, 0}).first->second.count += count;
  };
  for (const Polygon& polygon : polygons_)
    for (std::size_t k = 0; k < polygon.edges.size(); ++k) {
      add(polygon.edges[k].plane, polygon.corners[k], -1);
      add(polygon.edges[k].plane, polygon.corners[(k + 1) % polygon.corners.size()], 1);
    }
  for (std::uint32_t k = 0; k < 4; ++k) {
    add(walls_[k], {ray_bit | k, {}, {}, 1}, 1);
    add(walls_[k], {ray_bit | (k + 1) % 4, {}, {}, 1}, -1);
  }
  std::vector<End> left;
  for (const auto& [key, end] : ends)
    if (end.count != 0) left.push_back(end);
  // Different names may denote one plane or one corner.
  const auto parallel = [&](const auto& vector_of) {
    for (int sample = 0; sample < identity_samples; ++sample)
      for (const ExactNumber& x : vector_of(exact(sample)))
        if (!x.is_zero()) return false;
    return true;
  };
  const auto are_one_plane = [&](const PlaneName& a, const PlaneName& b) {
    return a == b || parallel([&](Exact& at) { return cross(at.normal(a), at.normal(b)); });
  };
  const auto are_one_corner = [&](const CornerName& a, const CornerName& b) {
    return words(a) == words(b) || (parallel([&](Exact& at) { return cross(at.ray(a), at.ray(b)); }) &&
                                    ExactNumber(dot(exact(0).ray(a), exact(0).ray(b))) > 0);
  };
  stop_if_wanted();
  for (std::size_t k = 0; k < left.size(); ++k)
    for (std::size_t m = k + 1; m < left.size() && left[k].count != 0; ++m)
      if (left[m].count != 0 && are_one_plane(left[k].plane, left[m].plane) &&
          are_one_corner(left[k].corner, left[m].corner)) {
        left[m].count += left[k].count;
        left[k].count = 0;
      }
  return std::ranges::all_of(left, [](const End& end) { return end.count == 0; });
}

/// Merges polygons of one facet, so that borders between them, which degenerate earlier than visible ones,
/// become few.
void VisibilityCertificate::merge_polygons() {
  for (std::size_t k = 0; k < polygons_.size(); ++k)
    for (std::size_t m = k + 1; m < polygons_.size();) {
      if (polygons_[k].facet != polygons_[m].facet || !merge(polygons_[k], polygons_[m])) {
        ++m;
        continue;
      }
      polygons_.erase(polygons_.begin() + std::ptrdiff_t(m));
      m = k + 1;  // the larger polygon may have other neighbours
    }
}

/// Adds a polygon to one with a common edge. Returns false if there is none, or if the union is not convex.
bool VisibilityCertificate::merge(Polygon& one, const Polygon& other) {
  const std::size_t n = one.corners.size(), m = other.corners.size();
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < m; ++j) {
      if (words(one.edges[k].plane) != words(other.edges[j].plane) ||
          words(one.corners[k]) != words(other.corners[(j + 1) % m]) ||
          words(one.corners[(k + 1) % n]) != words(other.corners[j]))
        continue;
      Polygon whole;
      whole.facet = one.facet;
      const auto add = [&](const Polygon& from, std::size_t corner, std::size_t edge) {
        // A corner between two edges of one plane is none.
        if (!whole.edges.empty() && words(whole.edges.back().plane) == words(from.edges[edge].plane)) return;
        whole.corners.push_back(from.corners[corner]);
        whole.edges.push_back(from.edges[edge]);
      };
      for (std::size_t c = 1; c < n; ++c) add(one, (k + c) % n, (k + c) % n);
      for (std::size_t c = 1; c < m; ++c) add(other, (j + c) % m, (j + c) % m);
      if (words(whole.edges.front().plane) == words(whole.edges.back().plane)) {
        whole.corners.erase(whole.corners.begin());
        whole.edges.erase(whole.edges.begin());
      }
      for (const Edge& edge : whole.edges)
        for (const CornerName& corner : whole.corners)
          if (!lies_on(corner, edge.plane) &&
              edge.sign * ExactNumber(dot(exact(0).normal(edge.plane), exact(0).ray(corner))).sign() < 0)
            return false;
      one = std::move(whole);
      return true;
    }
  return false;
}

template <class Value>
bool VisibilityCertificate::vanishes(const Key& key, const Value& value) {
  const auto [place, is_new] = vanishes_.try_emplace(key, true);
  if (!is_new) return place->second;
  for (int sample = 0; place->second && sample < identity_samples; ++sample)
    place->second = ExactNumber(value(exact(sample))).is_zero();
  return place->second;
}

template <class Value>
Ball VisibilityCertificate::enclosure_of(const Value& value) {
  const MovingBall over = value(*all_);
  return over.at.may_be_zero() ? MovingBall(value(*middle_)).at + over.by * half_ : over.at;
}

template <class Value>
auto VisibilityCertificate::sign_of(const Key& key, const Value& value) -> Sign {
  // Intervals of doubles decide nearly all signs.
  const MovingInterval over = value(*quick_all_);
  Interval quick = over.at;
  if (quick.may_be_zero()) quick = MovingInterval(value(*quick_middle_)).at + over.by * interval_of(half_);
  if (!quick.may_be_zero()) return quick.surely_positive() ? Sign::positive : Sign::negative;
  const auto [place, is_new] = signs_.try_emplace(key, Sign::unknown);
  if (!is_new) return place->second;
  const Ball found = enclosure_of(value);
  Sign& sign = place->second;
  if (found.surely_positive())
    sign = Sign::positive;
  else if (found.surely_negative())
    sign = Sign::negative;
  else if (vanishes(key, value))
    sign = Sign::zero;
  return sign;
}

auto VisibilityCertificate::side(const PlaneName& plane, PointId point) -> Sign {
  if (plane.contains(point)) return Sign::zero;
  return sign_of({1, plane.a, plane.b, plane.depth, point},
                 [&](auto& at) { return dot(at.normal(plane), at.point(point)); });
}

auto VisibilityCertificate::side(const PlaneName& plane, const CornerName& corner) -> Sign {
  if (corner.point != no_point) return side(plane, corner.point);
  if (lies_on(corner, plane)) return Sign::zero;
  Key key{2, plane.a, plane.b, plane.depth};
  std::ranges::copy(words(corner), key.begin() + 4);
  // The sign of a corner and the order of its planes are the same wherever it occurs in a tube.
  return sign_of(key, [&](auto& at) { return dot(at.normal(plane), at.ray(corner)); });
}

auto VisibilityCertificate::side(const PlaneName& plane, const NearCorner& corner) -> Sign {
  if (corner.far == no_point) return side(plane, corner.vertex);
  if (plane.contains(corner.vertex) && plane.contains(corner.far)) return Sign::zero;
  if (corner.may_be_far) return side_of_doubtful(plane, corner);
  return sign_of({3, plane.a, plane.b, plane.depth, corner.vertex, corner.far, corner.plane}, [&](auto& at) {
    using Number = std::remove_cvref_t<decltype(at.plane(0).offset)>;
    const auto& facet = at.plane(corner.plane);
    const auto height = [&](VertexId v) { return Number(facet.offset - dot(facet.normal, at.point(v))); };
    const Number over = height(corner.vertex), under = height(corner.far);
    return Number(over * dot(at.normal(plane), at.point(corner.far)) -
                  under * dot(at.normal(plane), at.point(corner.vertex)));
  });
}

auto VisibilityCertificate::side_of_doubtful(const PlaneName& plane, const NearCorner& corner) -> Sign {
  const auto height = [&](VertexId v) {
    return enclosure_of([&](auto& at) {
      const auto& facet = at.plane(corner.plane);
      return facet.offset - dot(facet.normal, at.point(v));
    });
  };
  const auto beside = [&](VertexId v) {
    if (side(plane, v) == Sign::zero) return Ball(0);
    return enclosure_of([&](auto& at) { return dot(at.normal(plane), at.point(v)); });
  };
  const Ball over = Ball::between(0, std::max(height(corner.vertex).hi(), 0.0));
  const Ball sum = over * beside(corner.far) - height(corner.far) * beside(corner.vertex);
  return sum.surely_positive() ? Sign::positive : sum.surely_negative() ? Sign::negative : Sign::unknown;
}

auto VisibilityCertificate::nearer(FacetId facet, VertexId vertex) -> Sign {
  const auto& own = context_.mesh.facets[facet];
  if (std::ranges::find(own, vertex) != own.end()) return Sign::zero;
  const Key key{4, facet, vertex};
  const auto value = [&](auto& at) {
    const auto& plane = at.plane(facet);
    return std::remove_cvref_t<decltype(plane.offset)>(plane.offset - dot(plane.normal, at.point(vertex)));
  };
  // A motion of all four points together does not change their order.
  if (std::ranges::all_of(own, [&](VertexId v) { return motion_.move_alike(v, vertex); })) {
    const auto [place, is_new] = constant_.try_emplace(key, Sign::unknown);
    if (is_new) place->second = Sign(ExactNumber(value(exact(0))).sign());
    return place->second;
  }
  return sign_of(key, value);
}

auto VisibilityCertificate::orientation(FacetId facet) -> Sign {
  return sign_of({5, facet}, [&](auto& at) { return at.plane(facet).offset; });
}

PlaneName VisibilityCertificate::edge_of(FacetId facet, int k, int& sign) const {
  FacetCone cone;
  FacetCone::make(context_.mesh, facet, context_.apex, cone);
  const VertexId a = cone.vertex[std::size_t(k)], b = cone.vertex[std::size_t((k + 1) % 3)];
  sign = a < b ? 1 : -1;
  return through(a, b);
}

const std::vector<FacetId>& VisibilityCertificate::facets_that_may_hide(double from, double to) {
  // A facet that hides nothing in an interval hides nothing in a part of it.
  while (!may_hide_.empty() && !(may_hide_.back().from <= from && to <= may_hide_.back().to))
    may_hide_.pop_back();
  std::array<std::array<Interval, 3>, 4> inwards;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& normal = all_->normal(walls_[k]);
    const bool turned = walls_[k].a != (ray_bit | std::uint32_t(k));
    for (std::size_t c = 0; c < 3; ++c)
      inwards[k][c] = turned ? -interval_of(normal[c].at) : interval_of(normal[c].at);
  }
  const double step = std::max(std::abs(from), std::abs(to));
  std::vector<FacetId> found;
  const auto test = [&](FacetId facet) {
    std::array<std::array<Interval, 3>, 3> point;
    for (std::size_t v = 0; v < 3; ++v) {
      const VertexId id = context_.mesh.facets[facet][v];
      const GridPoint p = context_.point(id);
      const double moved = motion_.reach(id, step);
      point[v] = {outwards(p.x - moved, p.x + moved), outwards(p.y - moved, p.y + moved),
                  outwards(p.z - moved, p.z + moved)};
    }
    const bool outside = std::ranges::any_of(inwards, [&](const auto& n) {
      return std::ranges::all_of(
          point, [&](const auto& p) { return (n[0] * p[0] + n[1] * p[1] + n[2] * p[2]).hi < 0; });
    });
    Interval distance2;
    for (std::size_t c = 0; c < 3; ++c)
      distance2 += squared(hull(hull(point[0][c], point[1][c]), point[2][c]));
    if (!outside && !(std::sqrt(distance2.lo) * (1 - 1e-15) > reach_)) found.push_back(facet);
  };
  if (may_hide_.empty()) {
    const double margin = vertex_speed_ * step * (1 + 1e-12);
    const GridPoint apex = context_.apex;
    std::vector<FacetId> near;
    const auto around = [margin](std::int64_t low, std::int64_t high, std::int64_t origin) {
      return outwards(double(low - origin) - margin, double(high - origin) + margin);
    };
    tree_.query(
        [&](const GridPoint& lowest, const GridPoint& highest) {
          const std::array<Interval, 3> box{around(lowest.x, highest.x, apex.x),
                                            around(lowest.y, highest.y, apex.y),
                                            around(lowest.z, highest.z, apex.z)};
          return std::ranges::none_of(
              inwards, [&](const auto& n) { return (n[0] * box[0] + n[1] * box[1] + n[2] * box[2]).hi < 0; });
        },
        near);
    std::ranges::for_each(near, test);
  } else {
    std::ranges::for_each(may_hide_.back().facets, test);
  }
  return may_hide_.emplace_back(from, to, std::move(found)).facets;
}

template <class Value>
bool VisibilityCertificate::is_positive(const Value& value) {
  return value(*quick_all_, *quick_middle_).surely_positive() || value(*all_, *middle_).surely_positive();
}

bool VisibilityCertificate::is_proper(const Polygon& polygon) {
  const auto in_front = [&](const CornerName& corner) {
    return is_positive([&](auto& all, auto&) { return along(chart_[2], all.ray(corner)); });
  };
  for (const CornerName& corner : polygon.corners)
    if (!in_front(corner)) return false;
  for (std::size_t k = 0; k < polygon.edges.size(); ++k) {
    const Edge& edge = polygon.edges[k];
    const CornerName* beside = nullptr;
    for (const CornerName& corner : polygon.corners) {
      const Sign found = side(edge.plane, corner);
      if (found == Sign::unknown || int(found) * edge.sign < 0) return false;
      if (found != Sign::zero) beside = &corner;
    }
    if (beside == nullptr) return false;
    // The direction of the edge does not change in the interval, because no corner passes another one.
    const CornerName& next = polygon.corners[(k + 1) % polygon.corners.size()];
    if (!is_positive([&](auto&, auto& middle) {
          return dot(cross(middle.ray(polygon.corners[k]), middle.ray(next)), middle.ray(*beside)).at;
        }))
      return false;
  }
  return true;
}

auto VisibilityCertificate::box_of(const Polygon& polygon) -> ChartBox {
  ChartBox box;
  for (const CornerName& corner : polygon.corners) {
    const auto ray = quick_all_->ray(corner);
    Interval depth = infinite;
    if (polygon.facet != none) {
      const auto& plane = quick_all_->plane(polygon.facet);
      const Interval share = plane.offset.at / dot(plane.normal, ray).at;
      depth = share * along(chart_[2], ray);
    }
    box.add(along(chart_[0], ray), along(chart_[1], ray), along(chart_[2], ray), depth);
  }
  return box;
}

auto VisibilityCertificate::box_of(FacetId facet) -> ChartBox {
  ChartBox box;
  for (const VertexId vertex : context_.mesh.facets[facet]) {
    const auto& point = quick_all_->point(vertex);
    const Interval depth = along(chart_[2], point);
    box.add(along(chart_[0], point), along(chart_[1], point), depth, depth);
  }
  return box;
}

bool VisibilityCertificate::is_in_facet(const Polygon& polygon) {
  if (orientation(polygon.facet) != Sign::positive) return false;
  for (int k = 0; k < 3; ++k) {
    int sign = 0;
    const PlaneName plane = edge_of(polygon.facet, k, sign);
    for (const CornerName& corner : polygon.corners)
      if (const Sign found = side(plane, corner); found == Sign::unknown || int(found) * sign < 0)
        return false;
  }
  return true;
}

bool VisibilityCertificate::is_separate(Polygon& polygon, FacetId facet) {
  const bool open = polygon.facet == none;
  const auto& vertices = context_.mesh.facets[facet];
  std::vector<NearCorner> near;
  bool level = false;  // all vertices lie in the plane of the polygon's facet
  if (open) {
    for (const VertexId v : vertices) near.push_back({v});
  } else {
    std::array<Sign, 3> above;
    for (std::size_t k = 0; k < 3; ++k) above[k] = nearer(polygon.facet, vertices[k]);
    const auto count = [&](Sign sign) { return std::ranges::count(above, sign); };
    level = count(Sign::zero) == 3;
    if (!level && count(Sign::positive) + count(Sign::unknown) == 0) return true;
    for (std::size_t k = 0; k < 3; ++k) {
      if (above[k] == Sign::negative) continue;
      near.push_back({vertices[k]});
      if (above[k] == Sign::zero) continue;
      for (std::size_t m = 0; m < 3; ++m)
        if (above[m] == Sign::negative)
          near.push_back({vertices[k], vertices[m], polygon.facet, above[k] == Sign::unknown});
    }
  }
  const auto is_outside = [&](const PlaneName& plane, int sign, const auto& corners) {
    return std::ranges::all_of(corners, [&](const auto& corner) {
      const Sign found = side(plane, corner);
      return found != Sign::unknown && int(found) * sign <= 0;
    });
  };
  const std::size_t edges = polygon.edges.size();
  const auto test = [&](std::size_t k) {
    if (k < edges) return is_outside(polygon.edges[k].plane, polygon.edges[k].sign, near);
    if (orientation(facet) != Sign::positive) return false;
    if (k < edges + 3) {
      int sign = 0;
      const PlaneName plane = edge_of(facet, int(k - edges), sign);
      return is_outside(plane, sign, polygon.corners);
    }
    return !open && !level && is_outside({polygon.facet, facet, true}, 1, polygon.corners);
  };
  const auto [last, is_new] = polygon.separated_by.try_emplace(facet, 0);
  if (test(last->second)) return true;
  for (std::uint32_t k = 0; k < edges + 4; ++k)
    if (test(k)) {
      last->second = k;
      return true;
    }
  // Coincident facets: the order of their positions decides, which a common motion does not change.
  if (level) {
    const auto& own = context_.mesh.facets[polygon.facet];
    return std::ranges::all_of(vertices, [&](VertexId v) { return motion_.move_alike(v, own[0]); }) &&
           std::ranges::all_of(own, [&](VertexId v) { return motion_.move_alike(v, own[0]); });
  }
  // A facet that is seen from its side for all values hides nothing.
  return orientation(facet) == Sign::zero;
}

bool VisibilityCertificate::holds(double from, double to) {
  if (!is_certain_) return false;
  stop_if_wanted();
  signs_.clear();
  const Ball over = Ball::between(from, to), middle = over.centre();
  half_ = over - middle;
  middle_.emplace(context_, [this, middle](PointId id) { return motion_.enclosure(id, middle); });
  all_.emplace(context_, [this, over](PointId id) { return motion_.enclosure(id, over); });
  quick_middle_.emplace(context_, [this](PointId id) { return intervals(middle_->point(id)); });
  quick_all_.emplace(context_, [this](PointId id) { return intervals(all_->point(id)); });
  std::vector<ChartBox> boxes;
  for (const Polygon& polygon : polygons_) {
    if (!is_proper(polygon) || (polygon.facet != none && !is_in_facet(polygon))) return false;
    boxes.push_back(box_of(polygon));
  }
  for (const FacetId facet : facets_that_may_hide(from, to)) {
    const ChartBox box = box_of(facet);
    for (std::size_t k = 0; k < polygons_.size(); ++k)
      if (facet != polygons_[k].facet && !box.is_beside_or_behind(boxes[k]) &&
          !is_separate(polygons_[k], facet))
        return false;
  }
  return true;
}

}  // namespace tubefoot
