// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/visibility/path_footprints.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <tuple>

#include "geometry/integrals/measure.hpp"
#include "geometry/steps/stop.hpp"

// Splits the shared facets of a bistatic history into footprints per pair of tubes and computes the range of
// half path lengths of each. The half path length is a convex function on a plane, so its minimum lies at the
// specular point or on the border.

namespace tubefoot {
namespace {

/// Half path lengths to the points of a plane, in the plane's frame about the foot of the transmit leg's
/// apex.
struct HalfPaths {
  double tx_m, rx_m;
  glm::dvec2 rx_foot;

  double at(glm::dvec2 p) const {
    return (std::hypot(p.x, p.y, tx_m) + std::hypot(p.x - rx_foot.x, p.y - rx_foot.y, rx_m)) / 2;
  }
  /// The minimum over the whole plane is the intersection with the line to the mirrored apex.
  glm::dvec2 lowest() const {
    const double both = tx_m + rx_m;
    return both > 0 ? rx_foot * (tx_m / both) : glm::dvec2(0);
  }
  /// The function is convex along an edge.
  double lowest_between(glm::dvec2 a, glm::dvec2 b) const {
    double lo = 0, hi = 1;
    for (int k = 0; k < 80; ++k) {
      const double p = lo + (hi - lo) / 3, q = hi - (hi - lo) / 3;
      if (at(a + p * (b - a)) < at(a + q * (b - a)))
        hi = q;
      else
        lo = p;
    }
    return std::min({at(a), at(b), at(a + (lo + hi) / 2 * (b - a))});
  }
  double lowest_in(const std::vector<glm::dvec2>& polygon) const {
    const glm::dvec2 c = lowest();
    bool inside = true;
    double least = at(polygon.front());
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const glm::dvec2 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
      inside = inside && (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) >= 0;
      least = std::min(least, lowest_between(a, b));
    }
    return inside ? at(c) : least;
  }
};

class Splitter {
 public:
  explicit Splitter(const BistaticHistory& from) : from_(from) {}

  PathFootprints split() {
    PathFootprints result;
    result.history = {from_.transmit, from_.receive, from_.grid_unit_m, {}, {}};
    SharedFootprints& to = result.history.shared;
    const SharedFootprints& shared = from_.shared;
    to.receiver_m = shared.receiver_m;
    struct One {
      std::uint32_t tx, rx, number, first, end;
    };
    std::vector<One> all;
    for (std::uint32_t f = 0; f < shared.facets.size(); ++f) {
      const SharedFacet& facet = shared.facets[f];
      const std::uint32_t last = facet.first_piece + facet.piece_count;
      for (std::uint32_t k = facet.first_piece; k < last;) {
        const SharedPiece& first = shared.pieces[k];
        One one{first.transmit_tube, first.receive_tube, f, k, k};
        for (;
             k < last && shared.pieces[k].transmit_tube == one.tx && shared.pieces[k].receive_tube == one.rx;
             ++k)
          ++one.end;
        all.push_back(one);
      }
    }
    std::stable_sort(all.begin(), all.end(), [](const One& a, const One& b) {
      return std::tuple(a.tx, a.rx, a.number) < std::tuple(b.tx, b.rx, b.number);
    });
    FootprintSet& set = result.footprints;
    for (const One& one : all) {
      stop_if_wanted();
      SharedFacet facet = shared.facets[one.number];
      facet.first_piece = static_cast<std::uint32_t>(to.pieces.size());
      facet.piece_count = one.end - one.first;
      Footprint footprint;
      footprint.facet = facet.facet;
      footprint.tube = one.tx;
      footprint.first_piece = facet.first_piece;
      footprint.piece_count = facet.piece_count;
      footprint.plane_normal = facet.plane_normal;
      footprint.plane_distance_m = facet.transmit_distance_m;
      for (std::uint32_t k = one.first; k < one.end; ++k) {
        SharedPiece piece = shared.pieces[k];
        const auto corners = shared.corners_m.begin() + piece.first;
        piece.first = static_cast<std::uint32_t>(to.corners_m.size());
        to.corners_m.insert(to.corners_m.end(), corners, corners + piece.count);
        to.pieces.push_back(piece);
        set.pieces.push_back({piece.first, piece.count});
      }
      to.facets.push_back(facet);
      if (!from_.bistatic.empty()) result.history.bistatic.push_back(from_.bistatic[one.number]);
      set.footprints.push_back(footprint);
      result.receive_tube.push_back(one.rx);
      result.receive_distance_m.push_back(facet.receive_distance_m);
    }
    set.corners_m = to.corners_m;
    measure(set);
    for (std::size_t k = 0; k < set.footprints.size(); ++k) set_half_paths(result, k);
    return result;
  }

 private:
  static void set_half_paths(PathFootprints& of, std::size_t k) {
    Footprint& footprint = of.footprints.footprints[k];
    const FacetPlane plane{footprint.plane_normal, footprint.plane_distance_m};
    const PlaneFrame frame(plane);
    const BistaticFacet* bistatic = of.history.bistatic.empty() ? nullptr : &of.history.bistatic[k];
    const HalfPaths half = bistatic ? HalfPaths{bistatic->transmit_distance_m, bistatic->receive_distance_m,
                                                bistatic->receive_foot_m}
                                    : HalfPaths{plane.distance_m, of.receive_distance_m[k],
                                                frame.project(of.history.shared.receiver_m)};
    double least = std::numeric_limits<double>::infinity(), most = 0;
    std::vector<glm::dvec2> polygon;
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      const Piece& piece = of.footprints.pieces[footprint.first_piece + p];
      polygon.clear();
      for (std::uint32_t c = 0; c < piece.count; ++c) {
        const glm::dvec3& corner = of.footprints.corners_m[piece.first + c];
        polygon.push_back(bistatic ? glm::dvec2(bistatic->to_plane.at(corner)) : frame.project(corner));
        most = std::max(most, half.at(polygon.back()));
      }
      least = std::min(least, half.lowest_in(polygon));
    }
    footprint.slant_range_min_m = std::min(least, most);
    footprint.slant_range_max_m = most;
  }

  const BistaticHistory& from_;
};

}  // namespace

glm::dvec3 PathFootprints::place(std::size_t footprint, glm::dvec3 seen_m, glm::dvec3 apex_m) const {
  if (history.bistatic.empty()) return apex_m + seen_m;
  const BistaticFacet& bistatic = history.bistatic[footprint];
  return bistatic.lies.at(glm::dvec2(bistatic.to_plane.at(seen_m)));
}

double PathFootprints::area_m2(std::size_t footprint) const {
  const Footprint& of = footprints.footprints[footprint];
  if (history.bistatic.empty()) return of.area_m2;
  const auto area_vector = [&](auto at) {
    glm::dvec3 sum(0);
    for (std::uint32_t p = 0; p < of.piece_count; ++p) {
      const Piece& piece = footprints.pieces[of.first_piece + p];
      for (std::uint32_t c = 1; c + 1 < piece.count; ++c)
        sum += glm::cross(at(piece.first + c) - at(piece.first), at(piece.first + c + 1) - at(piece.first));
    }
    return glm::length(sum) / 2;
  };
  return area_vector(
      [&](std::uint32_t c) { return place(footprint, footprints.corners_m[c], glm::dvec3(0)); });
}

PathFootprints path_footprints(const BistaticHistory& history) { return Splitter(history).split(); }

}  // namespace tubefoot
