// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/receiver_views.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

// Projects visible polygons to the planes of their facets, and intersects those of the two ends of a receiver
// pair. The source of the geometry in refracting water is docs/notes/multiple-paths.md, "Patches in
// stratified water".

namespace tubefoot {
namespace {

void set_box(ReceiverViews::Piece& piece, const std::vector<glm::dvec2>& polygon) {
  piece.low = piece.high = polygon.front();
  for (const glm::dvec2 p : polygon) {
    piece.low = glm::min(piece.low, p);
    piece.high = glm::max(piece.high, p);
  }
}

}  // namespace

double turning(const std::vector<glm::dvec2>& polygon) {
  double sum = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k)
    sum += cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
  return sum;
}

ReceiverViews::ReceiverViews(const Image& received, glm::dvec3 apex_m, VisibleSurface seabed)
    : ends_{{&received, apex_m,
             std::make_shared<const std::vector<RefractedFacet>>(std::move(seabed.refracted))}} {
  const SharedFootprints& seen = seabed.shared;
  const std::vector<RefractedFacet>& all_refracted = *ends_.front().refracted;
  const auto number_of = [&](const SharedFacet& facet) { return std::size_t(&facet - seen.facets.data()); };
  std::vector<const SharedFacet*> by_facet;
  for (const SharedFacet& facet : seen.facets) by_facet.push_back(&facet);
  std::stable_sort(by_facet.begin(), by_facet.end(),
                   [](const SharedFacet* a, const SharedFacet* b) { return a->facet < b->facet; });
  for (const SharedFacet* one : by_facet) {
    const RefractedFacet* refracted = all_refracted.empty() ? nullptr : &all_refracted[number_of(*one)];
    const FacetPlane plane =
        refracted == nullptr
            ? FacetPlane{one->plane_normal, one->transmit_distance_m}
            : FacetPlane{refracted->normal, -glm::dot(refracted->normal, refracted->lies.lies_m)};
    // Refracted rays may arrive at both sides of a facet.
    std::size_t at = facets_.size();
    while (at > 0 && facets_[at - 1].facet == one->facet &&
           !(refracted == nullptr || glm::dot(facets_[at - 1].plane.normal, plane.normal) > 0))
      --at;
    if (at == 0 || facets_[at - 1].facet != one->facet) {
      facets_.push_back({one->facet, plane, PlaneFrame(plane), {plane.distance_m, 0}, {}});
      at = facets_.size();
    }
    Facet& facet = facets_[at - 1];
    for (std::uint32_t k = one->first_piece; k < one->first_piece + one->piece_count; ++k) {
      const SharedPiece& from = seen.pieces[k];
      Piece piece;
      piece.tube = from.transmit_tube;
      piece.seen_as[0] = number_of(*one);
      std::vector<glm::dvec2>& corners = piece.seen.emplace_back();
      for (std::uint32_t c = 0; c < from.count; ++c) {
        const glm::dvec3 corner = seen.corners_m[from.first + c];
        corners.push_back(facet.frame.project(refracted == nullptr ? corner : refracted->lies.at(corner)));
      }
      const double area = turning(corners);
      if (area == 0) continue;
      if (area < 0) std::reverse(corners.begin(), corners.end());
      set_box(piece, corners);
      facet.pieces.push_back(std::move(piece));
    }
  }
}

ReceiverViews::ReceiverViews(const ReceiverViews& upper, const ReceiverViews& lower)
    : ends_{upper.ends_.front(), lower.ends_.front()} {
  const glm::dvec3 from_upper = ends_[1].apex_m - ends_[0].apex_m;
  for (const Facet& one : upper.facets_) {
    stop_if_wanted();
    const Facet* other = lower.find(one.facet, one.plane.normal);
    if (other == nullptr) continue;
    Facet both{one.facet, one.plane, one.frame, {one.height_m[0], other->height_m[0]}, {}};
    const glm::dvec2 foot = one.frame.project(from_upper);
    std::vector<Piece> others = other->pieces;
    for (Piece& piece : others) {
      for (glm::dvec2& corner : piece.seen[0])
        corner = foot + one.frame.project(corner.x * other->frame.u + corner.y * other->frame.v);
      if (turning(piece.seen[0]) < 0) std::reverse(piece.seen[0].begin(), piece.seen[0].end());
      set_box(piece, piece.seen[0]);
    }
    for (const Piece& piece : one.pieces)
      for (const Piece& with : others) {
        const glm::dvec2 low = glm::max(piece.low, with.low), high = glm::min(piece.high, with.high);
        if (low.x > high.x || low.y > high.y) continue;
        both.pieces.push_back(
            {piece.tube, {piece.seen_as[0], with.seen_as[0]}, {piece.seen[0], with.seen[0]}, low, high});
      }
    if (!both.pieces.empty()) facets_.push_back(std::move(both));
  }
}

const ReceiverViews::Facet* ReceiverViews::find(FacetId facet, glm::dvec3 normal) const {
  for (auto at = std::lower_bound(facets_.begin(), facets_.end(), facet,
                                  [](const Facet&a, FacetId b) { return a.facet < b; });
       at != facets_.end() && at->facet == facet; ++at)
    if (glm::dot(at->plane.normal, normal) > 0) return &*at;
  return nullptr;
}

double ReceiverViews::largest() const {
  double least = ends_.front().image->largest;
  for (const End& end : ends_) least = std::min(least, end.image->largest);
  return least;
}

OverFacet::OverFacet(const ReceiverViews::Facet& facet, glm::dvec3 from_received_m, double height_m,
                     const RefractedFacet* refracted)
    : height_(height_m), foot_(facet.frame.project(from_received_m)), refracted_(refracted) {
  lies_.foot_m = seen_.foot_m = -facet.plane.distance_m * facet.plane.normal - from_received_m;
  lies_.u = seen_.u = facet.frame.u;
  lies_.v = seen_.v = facet.frame.v;
  if (refracted == nullptr) {
    lies_.foot_m = -height_m * facet.plane.normal;
    return;
  }
  seen_.foot_m = refracted->seen.at(lies_.foot_m);
  seen_.u = refracted->seen.linear * lies_.u;
  seen_.v = refracted->seen.linear * lies_.v;
  steepest_ = std::sqrt(glm::dot(seen_.u, seen_.u) + glm::dot(seen_.v, seen_.v));
}

OverFacet::Met OverFacet::meet_refracted(glm::dvec2 p) const {
  Met met;
  const glm::dvec3 seen = seen_.at(p);
  met.lies_m = lies_.at(p);
  met.range = glm::length(seen);
  met.direction = seen / met.range;
  const RefractedFacet::Ray ray = refracted_->ray_to(met.lies_m);
  met.sine = refracted_->sine(seen, ray);
  met.tx = ray.tx;
  met.rx = ray.rx;
  return met;
}

}  // namespace tubefoot
