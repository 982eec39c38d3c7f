// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/bistatic_reference.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <stdexcept>

#include "engine/certified/bistatic_pieces.hpp"
#include "engine/certified/certified_cells.hpp"
#include "engine/certified/uncertain_edges.hpp"
#include "engine/visibility/bistatic_history.hpp"
#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/steps.hpp"

// Computes reference energies of bistatic paths in stratified water. It adds the certain energies of proven
// shared facets and the ambiguities at both ends: tube walls, occluding edges, close facets and unproven
// rays. See docs/notes/certified-energies.md, section "Of two ends".
namespace tubefoot {
namespace {

constexpr double slack = enclosure_slack;
constexpr FacetId none = std::numeric_limits<FacetId>::max();
using State = FacetEnclosure::State;
/// Facets of a run are usually neighbours, with the same bins.
constexpr std::size_t facets_in_run = 32;

/// Sector of a single tube.
Sector sector_of(const TubeSet& tubes, std::uint32_t tube, double unit_m) {
  TubeSet own = tubes;
  own.tubes = {tubes.tubes[tube]};
  return Sector(own, unit_m);
}

/// View of one end.
struct EndLook {
  TubeSet tubes;
  std::vector<Sector> sectors;  // by tube
  std::vector<TubeVisibility> seen;
  std::vector<FacetId> parent;       // base facet of each apparent facet
  std::vector<FacetId> apparent_of;  // apparent facet of each facet of the seabed
};

/// Ball and range interval around a part of a facet, as an end sees it.
struct About {
  glm::dvec3 centre_m{0};
  double radius_m = 0, nearest_m = 0, farthest_m = 0;

  About(std::span<const glm::dvec3> places_m, double off_m) {
    for (const glm::dvec3& p : places_m) centre_m += p / double(places_m.size());
    for (const glm::dvec3& p : places_m) {
      radius_m = std::max(radius_m, glm::distance(p, centre_m));
      farthest_m = std::max(farthest_m, glm::length(p));
    }
    radius_m = radius_m * (1 + slack) + off_m;
    nearest_m = std::max(glm::length(centre_m) * (1 - slack) - radius_m, 0.0);
    farthest_m = farthest_m * (1 + slack) + off_m;
  }
};

class BistaticReference {
 public:
  BistaticReference(const BistaticSurface& seabed, const BistaticTubes& tubes,
                    const VisibilityOptions& options, const ReceiveBeams& beams, const RangeSamples& samples,
                    const EchoModel& model, const Echo& ordinary, double tolerance)
      : seabed_(seabed),
        beams_(beams),
        model_(model),
        off_rad_(tubes.off_rad),
        unit_m_(seabed.grid.unit_m()),
        borders_(sample_borders_m(samples)),
        pieces_(model, borders_, samples.step_m, reference_targets(ordinary, tolerance), tolerance) {
    // Facets beyond the reach may have images within it. If sound is faster than the reference speed, the
    // two ends are effectively farther apart. The margin covers both.
    const double reach_m = std::max(tubes.tx.reach, tubes.rx.reach) * unit_m_,
                 apart_m = glm::distance(seabed.tx.water.apex_m(), seabed.rx.water.apex_m());
    margin_m_ = 0.01 * reach_m + 0.1 * apart_m;
    for (std::size_t e = 0; e < 2; ++e) {
      const BistaticEnd& end = seabed_.end(int(e));
      EndLook& look = looks_[e];
      look.tubes = e == 0 ? tubes.tx : tubes.rx;
      look.tubes.reach += margin_m_ / unit_m_;
      for (std::uint32_t tube = 0; tube < look.tubes.tubes.size(); ++tube)
        look.sectors.push_back(sector_of(look.tubes, tube, unit_m_));
      look.seen = tubefoot::look(end.surface_mesh.refined.mesh, end.tree, look.tubes, options);
      look.apparent_of.assign(seabed.mesh.facets.size(), none);
      for (std::size_t k = 0; k < end.origin.size(); ++k) {
        look.apparent_of[end.origin[k]] = FacetId(k);
        look.parent.push_back(seabed.parent[end.origin[k]]);
      }
    }
  }

  /// Flattens and encloses the facets that both ends see.
  void enclose_shared(const Flattening& flatten) {
    const FootprintSharer sharer(
        {looks_[0].tubes, looks_[0].seen, &seabed_.tx.surface_mesh.refined.mesh, seabed_.tx.origin},
        {looks_[1].tubes, looks_[1].seen, &seabed_.rx.surface_mesh.refined.mesh, seabed_.rx.origin}, unit_m_);
    shared_ = sharer.all();
    bistatic_ = flatten(shared_);
    enclosures_ = enclose(seabed_, shared_.facets, bistatic_, model_);
    for (std::size_t e = 0; e < 2; ++e)
      for (FacetEnclosure& facet : enclosures_.ends[e].facets)
        if (facet.state == State::proven && 4 * facet.travel_path_error_m > margin_m_)
          facet.state = State::conservative;
  }

  /// Computes all parts after enclose_shared(). `beside`: another receiver whose energies the ambiguities
  /// must also cover.
  BistaticParts parts(const BistaticReference* beside = nullptr) {
    beside_ = beside;
    const SharedFootprints& shared = shared_;
    const auto is_proven = [&](std::size_t number) {
      const FacetId facet = shared.facets[number].facet;
      return enclosures_.facets[number].proven && end_of(0, facet)->state == State::proven &&
             end_of(1, facet)->state == State::proven;
    };

    const std::size_t runs = (shared.facets.size() + facets_in_run - 1) / facets_in_run;
    BistaticParts found;
    std::vector<BinIntervals>& bins = found.bins;
    bins.resize(runs);
    Steps steps("facets", shared.facets.size());
    const auto add_pieces = [&](std::size_t number, BinIntervals& own) {
      if (!is_proven(number)) return;
      const SharedFacet& facet = shared.facets[number];
      BistaticPieces::OnFacet on = pieces_.on(facet.facet, bistatic_[number], enclosures_.facets[number]);
      for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
        stop_if_wanted();
        const SharedPiece& piece = shared.pieces[facet.first_piece + k];
        if (!in_one_fan(piece.transmit_tube, piece.receive_tube)) continue;
        pieces_.add(on, std::span(shared.corners_m).subspan(piece.first, piece.count), shared.receiver_m,
                    piece.receive_tube, beams_of(piece.receive_tube), own);
      }
    };
    tbb::parallel_for(std::size_t{0}, runs, [&](std::size_t run) {
      const std::size_t first = run * facets_in_run;
      for (std::size_t number = first; number < std::min(first + facets_in_run, shared.facets.size());
           ++number) {
        steps.done();
        add_pieces(number, bins[run]);
      }
    });
    // Facets for which only an upper bound of the return is known.
    found.conservative = bins.size();
    BinIntervals& conservative = bins.emplace_back();
    std::vector<char> proven(seabed_.mesh.facets.size(), 1);
    for (std::size_t number = 0; number < shared.facets.size(); ++number) {
      found.is_proven.push_back(is_proven(number));
      proven[shared.facets[number].facet] = found.is_proven.back();
    }
    for (FacetId f = 0; f < seabed_.mesh.facets.size(); ++f) {
      const FacetEnclosure *tx = end_of(0, f), *rx = end_of(1, f);
      if (tx == nullptr || rx == nullptr || tx->state == State::unproven || rx->state == State::unproven)
        continue;
      if (!proven[f] || tx->state == State::conservative || rx->state == State::conservative)
        add({tx->nearest_m, tx->farthest_m, tx->most, looks_[0].apparent_of[f], tx->seen}, 0, false,
            conservative);
    }
    for (std::size_t e = 0; e < 2; ++e) {
      found.first_ambiguity[e] = bins.size();
      add_ambiguities_of(e, bins);
    }
    found.shared = shared_;
    found.bistatic = bistatic_;
    found.facets = enclosures_.facets;
    return found;
  }

 private:
  const FacetEnclosure* end_of(std::size_t e, FacetId facet) const {
    const FacetId own = looks_[e].apparent_of[facet];
    return own == none ? nullptr : &enclosures_.ends[e].facets[own];
  }
  bool in_one_fan(std::uint32_t tx_tube, std::uint32_t rx_tube) const {
    return beams_.fan_of_transmit_tube.empty() ||
           beams_.fan_of_transmit_tube[tx_tube] == beams_.fan_of_receive_tube[rx_tube];
  }
  std::pair<std::uint32_t, std::uint32_t> beams_of(std::uint32_t rx_tube) const {
    if (model_.patterns != nullptr) return model_.patterns->beams_of_tube[rx_tube];
    return {beams_.of_tube[rx_tube], beams_.of_tube[rx_tube] + 1};
  }
  /// Tubes that are received by the same beams and patterns have equal labels.
  std::array<std::uint32_t, 4> label_of(std::size_t e, std::uint32_t tube) const {
    const auto& fans = e == 0 ? beams_.fan_of_transmit_tube : beams_.fan_of_receive_tube;
    const std::uint32_t fan = fans.empty() ? 0 : fans[tube];
    if (e == 0) return {fan, 0, 0, 0};
    const auto [first, end] = beams_of(tube);
    return {fan, first, end, model_.patterns != nullptr ? model_.patterns->fan_of_tube[tube] : 0};
  }

  /// Returns the walls of each tube beyond which the receiving beams or patterns change.
  std::vector<std::vector<UncertainEdges::Wall>> walls_of(std::size_t e) const {
    const TubeSet& tubes = looks_[e].tubes;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> sharers;
    const auto key = [](std::uint32_t a, std::uint32_t b) {
      return std::pair(std::min(a, b), std::max(a, b));
    };
    for (std::uint32_t tube = 0; tube < tubes.tubes.size(); ++tube)
      for (std::size_t k = 0; k < 4; ++k)
        sharers[key(tubes.tubes[tube][k], tubes.tubes[tube][(k + 1) % 4])].push_back(tube);
    std::vector<std::vector<UncertainEdges::Wall>> walls(tubes.tubes.size());
    const auto ray = [&](std::uint32_t r) {
      return glm::dvec3(double(tubes.rays[r].x), double(tubes.rays[r].y), double(tubes.rays[r].z));
    };
    for (const auto& [rays, own] : sharers) {
      if (rays.first == rays.second) continue;
      if (own.size() == 2 && label_of(e, own[0]) == label_of(e, own[1])) continue;
      walls[own.front()].push_back({ray(rays.first), ray(rays.second)});
    }
    return walls;
  }

  void add_ambiguities_of(std::size_t e, std::vector<BinIntervals>& bins) const {
    const BistaticEnd& end = seabed_.end(int(e));
    const EndLook& look = looks_[e];
    const FacetMesh& mesh = end.surface_mesh.refined.mesh;
    const ApparentEnclosures& own = enclosures_.ends[e];
    const UncertainEdges edges(mesh, look.parent, own, AmbiguitiesOf::places);
    const Unknown unknown(own.unproven, end.rays);
    const Looked looked(own.facets);
    const auto walls = walls_of(e);
    double nearest_other = infinite;
    const ApparentEnclosures& other = enclosures_.ends[1 - e];
    for (const auto* list : {&other.facets, &other.unproven})
      for (const FacetEnclosure& facet : *list) nearest_other = std::min(nearest_other, facet.nearest_m);
    std::vector<BinIntervals> by_tube(look.tubes.tubes.size());
    Steps steps("tubes", by_tube.size());
    tbb::parallel_for(std::uint32_t{0}, std::uint32_t(by_tube.size()), [&](std::uint32_t tube) {
      steps.done();
      const TubeVisibility& seen = look.seen[tube];
      const NameContext context{mesh, look.tubes.apex, seen.rays};
      std::vector<AmbiguousPiece> pieces;
      for (const NamedPiece& piece : seen.pieces) {
        stop_if_wanted();
        pieces.push_back(seen_piece(piece, certified_polygon(context, seen.corners, piece, unit_m_)));
      }
      const std::vector<FacetId> nearby = looked.in(look.sectors[tube], end.tree);
      const AmbiguitySink sink = [&](const Ambiguity& ambiguity) { add(ambiguity, e, true, by_tube[tube]); };
      edges.add_ambiguities(context, seen, pieces, nearby, sink);
      edges.add_walls(walls[tube], off_rad_[e], looked.in(look.sectors[tube], end.tree, 2 * off_rad_[e]),
                      sink);
      if (const double begins = unknown.begins_m(look.sectors[tube]); begins < infinite)
        add_unknown(e, tube, (begins + std::min(nearest_other, begins)) / 2, by_tube[tube]);
    });
    for (BinIntervals& of_tube : by_tube) bins.push_back(std::move(of_tube));
  }

  /// Marks everything received in a tube of an end, at half path lengths from a limit on, as unbounded.
  void add_unknown(std::size_t e, std::uint32_t tube, double from_m, BinIntervals& bins) const {
    for (std::uint32_t rx = 0; rx < looks_[1].tubes.tubes.size(); ++rx) {
      if (e == 1 ? rx != tube : !in_one_fan(tube, rx)) continue;
      const auto [first, end] = beams_of(rx);
      for (std::uint32_t beam = first; beam < end; ++beam)
        each_sample(from_m, infinite,
                    [&](std::size_t sample) { bins[beam * (borders_.size() - 1) + sample].hi = infinite; });
    }
  }

  template <class Take>
  void each_sample(double nearest_m, double farthest_m, const Take& take) const {
    const auto first = std::upper_bound(borders_.begin(), borders_.end(), nearest_m),
               end = std::upper_bound(borders_.begin(), borders_.end(), farthest_m);
    const std::size_t from = std::size_t(std::max<std::ptrdiff_t>(first - borders_.begin() - 1, 0)),
                      to = std::min(std::size_t(end - borders_.begin()), borders_.size() - 1);
    for (std::size_t k = from; k < to; ++k) take(k);
  }

  /// Adds an ambiguity of one end to all beams that may receive it. With `less`, the energy may also be
  /// missing.
  void add(const Ambiguity& ambiguity, std::size_t e, bool less, BinIntervals& bins) const {
    if (!(ambiguity.energy_j > 0)) return;
    const FacetId facet = seabed_.end(int(e)).origin[ambiguity.facet];
    const FacetEnclosure &here = *end_of(e, facet), *there = end_of(1 - e, facet);
    // If the other end does not see the facet, nothing is received. If the other end has no proven ray,
    // everything behind is unbounded anyway.
    if (there == nullptr || there->state == State::unproven) return;
    const glm::dvec3 from[3]{here.seen[0], here.seen[1], here.seen[2]},
        to[3]{there->seen[0], there->seen[1], there->seen[2]};
    const FacetMap map = facet_map(from, to);
    std::vector<glm::dvec3> elsewhere;
    for (const glm::dvec3& p : ambiguity.part_m) elsewhere.push_back(map.at(p));
    // Outside of apertures nothing is visible. Next to their walls, something may be visible.
    const auto beside = [&](std::size_t end, const FacetEnclosure& seen) {
      return seen.travel_path_error_m + 2 * off_rad_[end] * seen.farthest_m;
    };
    std::array<About, 2> about{About(ambiguity.part_m, beside(e, here)),
                               About(elsewhere, beside(1 - e, *there))};
    const double nearest = std::max(ambiguity.nearest_m, about[0].nearest_m),
                 farthest = std::min(ambiguity.farthest_m, about[0].farthest_m + here.shift_m);
    const double half_from = (nearest + about[1].nearest_m) / 2,
                 half_to = (farthest + about[1].farthest_m) / 2;
    if (half_from > borders_.back() || half_to < borders_.front()) return;
    if (e == 1) std::swap(about[0], about[1]);
    for (const auto& [beam, weight] :
         received_of(about, received_beside(facet, about[1], e == 0 ? *there : here))) {
      const double energy = ambiguity.energy_j * weight * (1 + slack);
      each_sample(half_from, half_to, [&, beam = beam](std::size_t sample) {
        BinInterval& bin = bins[beam * (borders_.size() - 1) + sample];
        if (less) bin.lo -= energy;
        bin.hi += energy;
      });
    }
  }

  /// Returns the beams that may receive from this region, with an upper bound of the patterns. `beside`:
  /// region as the other receiver sees it; null: no other receiver.
  std::map<std::uint32_t, double> received_of(const std::array<About, 2>& about,
                                              const std::optional<Towards>& beside) const {
    std::vector<char> fans;
    for (std::uint32_t tube = 0; tube < looks_[0].tubes.tubes.size(); ++tube) {
      const std::uint32_t fan = label_of(0, tube)[0];
      if (fan < fans.size() && fans[fan]) continue;
      if (!looks_[0].sectors[tube].may_meet(about[0].centre_m, about[0].radius_m)) continue;
      if (fan >= fans.size()) fans.resize(fan + 1);
      fans[fan] = 1;
    }
    std::map<std::uint32_t, double> received;
    if (fans.empty()) return received;
    std::array<std::uint32_t, 4> last{};
    bool any = false;
    for (std::uint32_t tube = 0; tube < looks_[1].tubes.tubes.size(); ++tube) {
      const auto label = label_of(1, tube);
      if (label[0] >= fans.size() || !fans[label[0]] || (any && label == last)) continue;
      if (!looks_[1].sectors[tube].may_meet(about[1].centre_m, about[1].radius_m)) continue;
      last = label;
      any = true;
      for (std::uint32_t beam = label[1]; beam < label[2]; ++beam) {
        double& weight = received[beam];
        const Towards tx{about[0].centre_m, about[0].radius_m};
        weight =
            std::max(weight, pieces_.most_of(label[3], beam, tx, {about[1].centre_m, about[1].radius_m}));
        if (beside) weight = std::max(weight, pieces_.most_of(label[3], beam, tx, *beside));
      }
    }
    return received;
  }

  /// Returns the region in which the other receiver sees a part of a facet. Without a proven ray there,
  /// everything is unbounded anyway.
  std::optional<Towards> received_beside(FacetId facet, const About& about,
                                         const FacetEnclosure& here) const {
    const FacetEnclosure* there = beside_ != nullptr ? beside_->end_of(1, facet) : nullptr;
    if (there == nullptr || there->state == State::unproven) return std::nullopt;
    const glm::dvec3 from[3]{here.seen[0], here.seen[1], here.seen[2]},
        to[3]{there->seen[0], there->seen[1], there->seen[2]};
    const FacetMap map = facet_map(from, to);
    Towards moved{map.at(about.centre_m), 0};
    // The map may stretch the ball.
    const glm::dmat3& m = map.linear;
    const double stretch = std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
    moved.radius_m = about.radius_m * stretch * (1 + slack) + there->travel_path_error_m;
    return moved;
  }

  const BistaticSurface& seabed_;
  const ReceiveBeams& beams_;
  const EchoModel& model_;
  const BistaticReference* beside_ = nullptr;
  SharedFootprints shared_;
  std::vector<BistaticFacet> bistatic_;  // in the order of the facets of `shared_`
  std::array<double, 2> off_rad_;        // of apertures
  double unit_m_, margin_m_ = 0;
  std::vector<double> borders_;
  BistaticPieces pieces_;
  std::array<EndLook, 2> looks_;
  BistaticEnclosures enclosures_;
};

void require_exact(const VisibilityOptions& options) {
  if (options.arithmetic == Arithmetic::plain_double)
    throw std::invalid_argument("certified bounds need exact arithmetic: fixed, filtered or rational");
}

/// Echo model with patterns in the directions of its path's ends.
struct PatternsOfEnds {
  explicit PatternsOfEnds(const EchoModel& of) : model(of) {
    if (of.patterns == nullptr) return;
    patterns = as_images_have(*of.patterns, of.path);
    model.patterns = &patterns;
  }
  PatternsOfEnds(const PatternsOfEnds&) = delete;
  PatternsOfEnds& operator=(const PatternsOfEnds&) = delete;
  EchoModel model;
  BeamPatterns patterns;
};

}  // namespace

BinIntervals added_up(std::span<const BinIntervals> parts) {
  BinIntervals total;
  for (const BinIntervals& own : parts)
    for (const auto& [bin, part] : own) {
      total[bin].lo += part.lo;
      total[bin].hi += part.hi;
    }
  return total;
}

RefractedReference certify_refracted_echo(const BistaticSurface& seabed, const BistaticTubes& tubes,
                                          const VisibilityOptions& options, const ReceiveBeams& beams,
                                          const RangeSamples& samples, const EchoModel& model,
                                          const Echo& ordinary, double tolerance) {
  require_exact(options);
  const PatternsOfEnds own(model);
  BistaticReference reference(seabed, tubes, options, beams, samples, own.model, ordinary, tolerance);
  reference.enclose_shared([&](const SharedFootprints& shared) {
    return bistatic_facets(shared, seabed.mesh, {seabed.tx.surface_mesh, seabed.tx.water},
                           {seabed.rx.surface_mesh, seabed.rx.water}, seabed.grid, model.absorption_db_per_m);
  });
  const BinIntervals total = added_up(reference.parts().bins);
  return reference_between({&total, 1}, ordinary, tolerance);
}

std::array<BistaticParts, 2> bistatic_parts(const std::array<BistaticSurface, 2>& seabeds,
                                            const std::array<BistaticTubes, 2>& tubes,
                                            const VisibilityOptions& options, const RangeSamples& samples,
                                            const EchoModel& model, const std::array<Echo, 2>& ordinary,
                                            double tolerance, const std::array<Flattening, 2>& flatten) {
  require_exact(options);
  const PatternsOfEnds own(model);
  const std::vector<std::uint32_t> of_tube(tubes[0].rx.tubes.size(), 0);
  const ReceiveBeams beams{1, of_tube};
  BistaticReference upper(seabeds[0], tubes[0], options, beams, samples, own.model, ordinary[0], tolerance),
      lower(seabeds[1], tubes[1], options, beams, samples, own.model, ordinary[1], tolerance);
  upper.enclose_shared(flatten[0]);
  lower.enclose_shared(flatten[1]);
  return {upper.parts(&lower), lower.parts(&upper)};
}

}  // namespace tubefoot
