// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/plain_sight.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t bits_a_word = 64;
/// What more facets than this may hide is looked at: setting so many apart would take as long.
constexpr int most_hiding = 48;

/// Whether the plane of an edge of a cone has all of another cone on its other side.
bool has_parting_edge(const FacetCone& cone, const FacetCone& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Vec64 inward = cross(cone.point[k], cone.point[next]);
    if (std::ranges::all_of(other.point, [&](GridPoint p) { return dot(inward, p) <= 0; })) return true;
  }
  return false;
}

}  // namespace

PlainSight::PlainSight(const FacetMesh& mesh)
    : mesh_(mesh), words_((mesh.facets.size() + bits_a_word - 1) / bits_a_word) {
  const std::size_t count = mesh.facets.size();
  if (count > most_facets) throw std::length_error("too many facets to keep the sides of all of them");
  before_.assign(words_ * count, 0);
  behind_.assign(words_ * count, 0);
  std::vector<std::int8_t> side_of_vertex(mesh.vertices.size());
  for (FacetId g = 0; g < count; ++g) {
    stop_if_wanted();
    const auto& [a, b, c] = mesh.facets[g];
    const GridPoint origin = mesh.vertices[a];
    planes_.push_back({cross(mesh.vertices[b] - origin, mesh.vertices[c] - origin), origin});
    for (VertexId v = 0; v < side_of_vertex.size(); ++v)
      side_of_vertex[v] = static_cast<std::int8_t>(sign(planes_[g].side(mesh.vertices[v])));
    for (FacetId f = 0; f < count; ++f) {
      bool before = false, behind = false;
      for (const VertexId v : mesh.facets[f]) {
        before = before || side_of_vertex[v] > 0;
        behind = behind || side_of_vertex[v] < 0;
      }
      if (before != behind)
        (before ? before_ : behind_)[words_ * f + g / bits_a_word] |= Word{1} << g % bits_a_word;
    }
  }
}

bool PlainSight::lies(const Bits& where, FacetId f, FacetId g) const {
  return (where[words_ * f + g / bits_a_word] >> g % bits_a_word & 1) != 0;
}

PlainSight::View PlainSight::seen_from(GridPoint place, FacetId on) const {
  const auto count = static_cast<FacetId>(mesh_.facets.size());
  View view;
  view.look.assign(count, 0);
  const int side = sign(planes_[on].side(place));
  if (side == 0) {
    view.look.assign(count, 1);
    return view;
  }
  const Bits &ahead = side > 0 ? before_ : behind_, &back = side > 0 ? behind_ : before_;
  // Those that may hide something, by the side that the place is on: ways to what lies ahead stay there, and
  // what subtends nothing hides nothing.
  std::vector<FacetCone> cones(count);
  std::vector<std::uint8_t> subtends(count);
  Bits from_before(words_, 0), from_behind(words_, 0);
  for (FacetId g = 0; g < count; ++g) {
    subtends[g] = FacetCone::make(mesh_, g, place, cones[g]);
    if (subtends[g] && g != on && !lies(back, g, on))
      (planes_[g].side(place) > 0 ? from_before : from_behind)[g / bits_a_word] |= Word{1} << g % bits_a_word;
  }
  const auto is_clear = [&](FacetId f) {
    const auto hiding = [&](std::size_t w) {
      const Word own = w == f / bits_a_word ? Word{1} << f % bits_a_word : 0;
      return ((from_before[w] & ~before_[words_ * f + w]) | (from_behind[w] & ~behind_[words_ * f + w])) &
             ~own;
    };
    int may_hide = 0;
    for (std::size_t w = 0; w < words_; ++w) may_hide += std::popcount(hiding(w));
    if (may_hide > most_hiding) return false;
    for (std::size_t w = 0; w < words_; ++w)
      for (Word left = hiding(w); left != 0; left &= left - 1) {
        const FacetCone& other = cones[w * bits_a_word + static_cast<std::size_t>(std::countr_zero(left))];
        if (!has_parting_edge(other, cones[f]) && !has_parting_edge(cones[f], other)) return false;
      }
    return true;
  };
  const auto is_ahead = [&](VertexId v) { return side * sign(planes_[on].side(mesh_.vertices[v])) > 0; };
  for (FacetId f = 0; f < count; ++f) {
    if (f == on || !subtends[f] || std::ranges::none_of(mesh_.facets[f], is_ahead)) continue;
    if (lies(ahead, f, on) && is_clear(f))
      view.whole.push_back(f);
    else
      view.look[f] = 1;
  }
  return view;
}

}  // namespace tubefoot
