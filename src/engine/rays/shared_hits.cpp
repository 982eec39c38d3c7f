// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/shared_hits.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <unordered_map>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/steps/stop.hpp"

// Tests for each hit of a transmit ray whether the receiver sees the same point. The tests are the side of
// the facet, the receiver's tubes and a second ray from the receiver.

namespace tubefoot {
namespace {

/// Number of hits per task. It does not affect the result.
constexpr std::size_t hits_per_task = 1 << 12;
constexpr std::uint32_t no_tube = std::numeric_limits<std::uint32_t>::max();

glm::dvec3 metres(GridPoint p, double unit_m) { return unit_m * glm::dvec3(p.x, p.y, p.z); }

/// Maps points of a facet from its position for one apex to its position for the other.
struct Carried {
  std::array<glm::dvec3, 3> from, to;  // corners, relative to the apexes
  glm::dvec3 at(glm::dvec3 place) const {
    const glm::dvec3 u = from[1] - from[0], v = from[2] - from[0], p = place - from[0];
    const glm::dvec3 normal = glm::cross(u, v);
    const double area2 = glm::dot(normal, normal), along_u = glm::dot(glm::cross(p, v), normal) / area2,
                 along_v = glm::dot(glm::cross(u, p), normal) / area2;
    return to[0] + along_u * (to[1] - to[0]) + along_v * (to[2] - to[0]);
  }
};

/// A facet with hits, as both ends have it.
struct LitFacet {
  SharedFacet shared;
  FacetId received = 0;  // the facet of the receiver's scene, in ApparentFacets
  Carried carried;
  std::uint32_t number = no_tube;  // number among the facets with hits that both see
};

class Sharing {
 public:
  Sharing(const History& history, const SampledEnd& sent, const SampledEnd& received, const FacetMesh& common,
          const ApparentFacets* apparent)
      : hits_(history.hits.begin(), history.hits.end()),
        unit_m_(history.grid_unit_m),
        sent_(sent),
        received_(received),
        common_(common),
        apparent_(apparent),
        receiver_m_(metres(received.tubes.apex - sent.tubes.apex, unit_m_)) {}

  BistaticHistory find() {
    light();
    std::vector<std::vector<SharedHit>> parts((hits_.size() + hits_per_task - 1) / hits_per_task);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t task) {
      stop_if_wanted();
      const std::size_t end = std::min((task + 1) * hits_per_task, hits_.size());
      for (std::size_t k = task * hits_per_task; k < end; ++k)
        if (lit_by_[k] != no_tube) look_at(hits_[k], lit_by_[k], parts[task]);
    });
    BistaticHistory found{sent_.tubes, received_.tubes, unit_m_, {}};
    found.shared.receiver_m = receiver_m_;
    for (const auto& part : parts)
      for (SharedHit hit : part) {
        LitFacet& facet = facets_[hit.seen];
        if (facet.number == no_tube) {
          facet.number = std::uint32_t(found.shared.facets.size());
          found.shared.facets.push_back(facet.shared);
        }
        hit.seen = facet.number;
        found.hits.push_back(hit);
      }
    return found;
  }

 private:
  /// Finds the facets with hits, each once, and the facet of each hit. The facet is `no_tube` if the receiver
  /// is on the other side.
  void light() {
    std::unordered_map<FacetId, std::uint32_t> known;
    FacetId last = no_point;
    std::uint32_t number = no_tube;
    lit_by_.reserve(hits_.size());
    for (const RayHit& hit : hits_) {
      if (hit.facet != last) {
        last = hit.facet;
        const auto [at, is_new] = known.try_emplace(hit.facet, no_tube);
        if (is_new) at->second = add(hit.facet);
        number = at->second;
      }
      lit_by_.push_back(number);
    }
  }

  std::uint32_t add(FacetId seen) {
    const FacetId origin = sent_.origin_of(seen);
    LitFacet facet;
    const FacetMesh *there = &common_, *here = &common_;
    FacetId facet_here = origin;
    facet.received = origin;
    if (apparent_ != nullptr) {
      facet.received = apparent_->received[origin];
      if (facet.received == ApparentFacets::none) return no_tube;
      here = &sent_.scene.mesh();
      there = &received_.scene.mesh();
      facet_here = seen;
    }
    FacetCone from_transmitter, from_receiver;
    if (!FacetCone::make(*here, facet_here, sent_.tubes.apex, from_transmitter) ||
        !FacetCone::make(*there, facet.received, received_.tubes.apex, from_receiver) ||
        from_transmitter.reversed != from_receiver.reversed)
      return no_tube;
    facet.shared = facet_between(from_transmitter, from_receiver, unit_m_);
    facet.shared.facet = origin;
    for (std::size_t k = 0; k < 3; ++k) {
      facet.carried.from[k] = metres(from_transmitter.point[k], unit_m_);
      facet.carried.to[k] = metres(from_receiver.point[k], unit_m_);
    }
    facets_.push_back(facet);
    return std::uint32_t(facets_.size() - 1);
  }

  void look_at(const RayHit& hit, std::uint32_t lit, std::vector<SharedHit>& found) const {
    const LitFacet& facet = facets_[lit];
    const glm::dvec3 at = hit.slant_range_m * glm::normalize(glm::dvec3(hit.direction)),
                     from_receiver = apparent_ == nullptr ? at - receiver_m_ : facet.carried.at(at);
    const double range = glm::length(from_receiver);
    if (!(range > 0)) return;
    const std::size_t before = found.size();
    received_.finder.find(from_receiver, [&](std::uint32_t tube) {
      found.push_back({lit, hit.tube, tube, hit.solid_angle_sr, at});
    });
    if (found.size() == before) return;
    const FacetId wanted = apparent_ == nullptr ? facet.shared.facet : facet.received;
    if (!received_.scene.reaches(received_.tubes.apex, from_receiver / range, range, [&](FacetId met) {
          return (apparent_ == nullptr ? received_.origin_of(met) : met) == wanted;
        }))
      found.resize(before);
  }

  std::vector<RayHit> hits_;
  double unit_m_;
  const SampledEnd &sent_, &received_;
  const FacetMesh& common_;
  const ApparentFacets* apparent_;
  glm::dvec3 receiver_m_;
  std::vector<LitFacet> facets_;
  std::vector<std::uint32_t> lit_by_;
};

}  // namespace

BistaticHistory shared_hits(const History& history, const SampledEnd& sent, const SampledEnd& received,
                            const FacetMesh& common, const ApparentFacets* apparent) {
  return Sharing(history, sent, received, common, apparent).find();
}

}  // namespace tubefoot
