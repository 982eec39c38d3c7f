// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/bistatic_reference.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <stdexcept>

#include "engine/certified/flattened_pieces.hpp"
#include "engine/certified/pattern_ambiguity.hpp"
#include "engine/certified/receiver_pair_reference.hpp"
#include "engine/certified/uncertain_edges.hpp"
#include "engine/visibility/bistatic_history.hpp"
#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/numbers/scalars.hpp"

// Computes reference energies of bistatic paths in stratified water. It adds the certain energies of proven
// shared facets and the ambiguities at both ends: tube walls, occluding edges, close facets and unproven
// rays. A receiver pair has two such paths, and products over their common pieces. See
// docs/notes/certified-energies.md, sections "Of two ends" and "Of two receivers".
namespace tubefoot {
namespace {

using State = FacetEnclosure::State;

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
    radius_m = radius_m * (1 + enclosure_slack) + off_m;
    nearest_m = std::max(glm::length(centre_m) * (1 - enclosure_slack) - radius_m, 0.0);
    farthest_m = farthest_m * (1 + enclosure_slack) + off_m;
  }
};

/// Enclosed parts of a bistatic echo before summation.
struct BistaticParts {
  /// Bins of the certain parts by runs of proven facets, then bins of the conservative facets. From
  /// first_ambiguity[end] on, the list contains the bins of the ambiguities at this end.
  std::vector<BinIntervals> bins;
  std::size_t conservative = 0;  ///< index of the conservative facets' bins
  std::array<std::size_t, 2> first_ambiguity{};

  BinIntervals added_up() const {
    BinIntervals total;
    for (const BinIntervals& own : bins) add(own, total);
    return total;
  }
  static void add(const BinIntervals& bins, BinIntervals& total) {
    for (const auto& [bin, part] : bins) {
      total[bin].lo += part.lo;
      total[bin].hi += part.hi;
    }
  }
};

class BistaticReference {
 public:
  BistaticReference(const BistaticSurface& seabed, const BistaticTubes& tubes,
                    const VisibilityOptions& options, const ReceiveBeams& beams, const RangeSamples& samples,
                    const EchoModel& model, const Echo& ordinary, double tolerance)
      : seabed_(seabed),
        beams_(beams),
        off_rad_(tubes.off_rad),
        unit_m_(seabed.grid.unit_m()),
        request_(model, samples, tolerance, reference_targets(ordinary, tolerance)) {
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
      look.apparent_of.assign(seabed.mesh.facets.size(), no_facet);
      for (std::size_t k = 0; k < end.origin.size(); ++k) {
        look.apparent_of[end.origin[k]] = FacetId(k);
        look.parent.push_back(seabed.parent[end.origin[k]]);
      }
    }
  }

  /// Flattens and encloses the facets that both ends see. `flatten(shared)`: flattens the shared facets, in
  /// their order.
  template <class Flatten>
  void enclose_shared(const Flatten& flatten) {
    const FootprintSharer sharer(
        {looks_[0].tubes, looks_[0].seen, &seabed_.tx.surface_mesh.refined.mesh, seabed_.tx.origin},
        {looks_[1].tubes, looks_[1].seen, &seabed_.rx.surface_mesh.refined.mesh, seabed_.rx.origin}, unit_m_);
    shared_ = sharer.all();
    bistatic_ = flatten(shared_);
    enclosures_ = enclose(seabed_, shared_.facets, bistatic_, request_.model);
    for (std::size_t e = 0; e < 2; ++e)
      for (FacetEnclosure& facet : enclosures_.ends[e].facets)
        if (facet.state == State::proven && 4 * facet.travel_path_error_m > margin_m_)
          facet.state = State::conservative;
  }

  const SharedFootprints& shared() const { return shared_; }
  ProvenFacet facet(std::size_t number) const { return {bistatic_[number], enclosures_.facets[number]}; }
  /// Returns whether a facet of shared() is proven, and both ends see it by one ray.
  bool is_proven(std::size_t number) const {
    const FacetId facet = shared_.facets[number].facet;
    return enclosures_.facets[number].proven && end_of(0, facet)->state == State::proven &&
           end_of(1, facet)->state == State::proven;
  }

  /// Computes all parts after enclose_shared(). `beside`: another receiver whose energies the ambiguities
  /// must also cover.
  BistaticParts parts(const BistaticReference* beside = nullptr) {
    beside_ = beside;
    BistaticParts found;
    std::vector<BinIntervals>& bins = found.bins;
    bins = enclose_tasks("facets", shared_.facets.size(), facets_in_run, BinIntervals(),
                         [&](std::size_t number, BinIntervals& own) {
                           if (is_proven(number)) add_pieces(number, own);
                         });
    // Facets for which only an upper bound of the return is known.
    found.conservative = bins.size();
    BinIntervals& conservative = bins.emplace_back();
    std::vector<char> proven(seabed_.mesh.facets.size(), 1);
    for (std::size_t number = 0; number < shared_.facets.size(); ++number)
      proven[shared_.facets[number].facet] = is_proven(number);
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
    return found;
  }

 private:
  const FacetEnclosure* end_of(std::size_t e, FacetId facet) const {
    const FacetId own = looks_[e].apparent_of[facet];
    return own == no_facet ? nullptr : &enclosures_.ends[e].facets[own];
  }
  std::pair<std::uint32_t, std::uint32_t> beams_of(std::uint32_t rx_tube) const {
    return request_.beams_of(rx_tube, beams_.of_tube);
  }
  /// Adds the pieces of a proven facet.
  void add_pieces(std::size_t number, BinIntervals& bins) const {
    const SharedFacet& facet = shared_.facets[number];
    FlattenedPieces pieces(request_, facet.facet, this->facet(number));
    each_received(request_, beams_, shared_, facet, [&](const SharedPiece& piece, const auto& received) {
      pieces.add_energies({shared_, piece}, piece.receive_tube, received, bins);
    });
  }
  /// Returns an upper bound of the product of mirror losses and patterns in these directions.
  double most_of(std::uint32_t transmit, std::uint32_t beam, const Towards& tx, const Towards& rx) const {
    const EchoModel& model = request_.model;
    const double passes =
        tubefoot::most_of(model.path.tx.loss, tx) * tubefoot::most_of(model.path.back().loss, rx);
    if (model.patterns == nullptr) return passes;
    return passes * tubefoot::most_of(model.patterns->transmit[transmit], tx) *
           tubefoot::most_of(model.patterns->receive[beam], rx);
  }
  /// Tubes that are received by the same beams and patterns have equal labels.
  std::array<std::uint32_t, 4> label_of(std::size_t e, std::uint32_t tube) const {
    const auto& fans = e == 0 ? beams_.fan_of_transmit_tube : beams_.fan_of_receive_tube;
    const std::uint32_t fan = fans.empty() ? 0 : fans[tube];
    if (e == 0) return {fan, 0, 0, 0};
    const auto [first, end] = beams_of(tube);
    return {fan, first, end,
            request_.model.patterns != nullptr ? request_.model.patterns->fan_of_tube[tube] : 0};
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
    const auto enclose_tube = [&](std::size_t number, BinIntervals& own_bins) {
      const auto tube = std::uint32_t(number);
      const TubeVisibility& seen = look.seen[tube];
      const NameContext context{mesh, look.tubes.apex, seen.rays};
      std::vector<AmbiguousPiece> pieces;
      for (const NamedPiece& piece : seen.pieces) {
        stop_if_wanted();
        pieces.push_back(seen_piece(piece, certified_polygon(context, seen.corners, piece, unit_m_)));
      }
      const std::vector<FacetId> nearby = looked.in(look.sectors[tube], end.tree);
      const AmbiguitySink sink = [&](const Ambiguity& ambiguity) { add(ambiguity, e, true, own_bins); };
      edges.add_ambiguities(context, seen, pieces, nearby, sink);
      edges.add_walls(walls[tube], off_rad_[e], looked.in(look.sectors[tube], end.tree, 2 * off_rad_[e]),
                      sink);
      if (const double begins = unknown.begins_m(look.sectors[tube]); begins < infinite)
        add_unknown(e, tube, (begins + std::min(nearest_other, begins)) / 2, own_bins);
    };
    for (BinIntervals& of_tube :
         enclose_tasks("tubes", look.tubes.tubes.size(), 1, BinIntervals(), enclose_tube))
      bins.push_back(std::move(of_tube));
  }

  /// Marks everything received in a tube of an end, at half path lengths from a limit on, as unbounded.
  void add_unknown(std::size_t e, std::uint32_t tube, double from_m, BinIntervals& bins) const {
    for (std::uint32_t rx = 0; rx < looks_[1].tubes.tubes.size(); ++rx) {
      if (e == 1 ? rx != tube : !beams_.in_one_fan(tube, rx)) continue;
      const auto [first, end] = beams_of(rx);
      const auto [from, to] = samples_between(request_.borders, from_m, infinite);
      for (std::uint32_t beam = first; beam < end; ++beam)
        for (std::size_t sample = from; sample < to; ++sample)
          bins[beam * request_.row() + sample].hi = infinite;
    }
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
    if (half_from > request_.borders.back() || half_to < request_.borders.front()) return;
    const auto [from_sample, to_sample] = samples_between(request_.borders, half_from, half_to);
    if (e == 1) std::swap(about[0], about[1]);
    for (const auto& [beam, weight] :
         received_of(about, received_beside(facet, about[1], e == 0 ? *there : here))) {
      const double energy = ambiguity.energy_j * weight * (1 + enclosure_slack);
      for (std::size_t sample = from_sample; sample < to_sample; ++sample) {
        Interval& bin = bins[beam * request_.row() + sample];
        if (less) bin.lo -= energy;
        bin.hi += energy;
      }
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
        weight = std::max(weight, most_of(label[3], beam, tx, {about[1].centre_m, about[1].radius_m}));
        if (beside) weight = std::max(weight, most_of(label[3], beam, tx, *beside));
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
    moved.radius_m = about.radius_m * stretch * (1 + enclosure_slack) + there->travel_path_error_m;
    return moved;
  }

  const BistaticSurface& seabed_;
  const ReceiveBeams& beams_;
  const BistaticReference* beside_ = nullptr;
  SharedFootprints shared_;
  std::vector<BistaticFacet> bistatic_;  // in the order of the facets of `shared_`
  std::array<double, 2> off_rad_;        // of apertures
  double unit_m_, margin_m_ = 0;
  CertifiedRequest request_;
  std::array<EndLook, 2> looks_;
  BistaticEnclosures enclosures_;
};

/// Encloses the products of a receiver pair, by facets that both receivers share with the transmitter.
std::vector<FlattenedPieces::Products> products_of(const BistaticReference& upper,
                                                   const BistaticReference& lower,
                                                   const CertifiedRequest& request, double wavenumber_rad_m) {
  const auto facets = facets_of_receivers(upper.shared(), lower.shared());
  return enclose_tasks("facets", facets.size(), 1, FlattenedPieces::Products(),
                       [&](std::size_t number, FlattenedPieces::Products& found) {
                         const auto [up, down] = facets[number];
                         if (up == nullptr || down == nullptr) return;
                         const auto u = std::size_t(up - upper.shared().facets.data()),
                                    d = std::size_t(down - lower.shared().facets.data());
                         if (!upper.is_proven(u) || !lower.is_proven(d)) return;
                         FlattenedPieces pieces(request, up->facet, upper.facet(u), lower.facet(d));
                         each_common(upper.shared(), *up, lower.shared(), *down,
                                     [&](const ReceivedPiece& one, const ReceivedPiece& two) {
                                       pieces.add_products(wavenumber_rad_m, one, two, found);
                                     });
                       });
}

}  // namespace

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
  const BinIntervals total = reference.parts().added_up();
  return reference_between({&total, 1}, ordinary, tolerance);
}

RefractedReference certify_refracted_receiver_pair(const std::array<BistaticSurface, 2>& seabeds,
                                                   const std::array<BistaticTubes, 2>& tubes,
                                                   const VisibilityOptions& options,
                                                   const ReceiverBaseline& receiver_pair,
                                                   const RangeSamples& samples, const EchoModel& model,
                                                   const std::array<Echo, 2>& ordinary, double tolerance) {
  require_exact(options);
  std::array<BistaticSurface, 2> both = seabeds;
  for (std::size_t e = 0; e < 2; ++e) {
    both[e].beside = &seabeds[1 - e].rx;
    both[e].ranges_within_m = tolerance / (16 * receiver_pair.wavenumber_rad_m);
  }
  ReceiverPairFlattening flattening(seabeds[0].mesh, {seabeds[0].tx.surface_mesh, seabeds[0].tx.water},
                                    {&seabeds[0].rx.water, &seabeds[1].rx.water}, seabeds[0].grid);
  const PatternsOfEnds own(model);
  const std::vector<std::uint32_t> of_tube(tubes[0].rx.tubes.size(), 0);
  const ReceiveBeams beams{1, of_tube};
  BistaticReference upper(both[0], tubes[0], options, beams, samples, own.model, ordinary[0], tolerance),
      lower(both[1], tubes[1], options, beams, samples, own.model, ordinary[1], tolerance);
  upper.enclose_shared([&](const SharedFootprints& shared) { return flattening.of(shared, 0); });
  lower.enclose_shared([&](const SharedFootprints& shared) { return flattening.of(shared, 1); });
  const std::array<BistaticParts, 2> parts{upper.parts(&lower), lower.parts(&upper)};

  const auto row = std::size_t(samples.count);
  const CertifiedRequest request(model, samples, tolerance,
                                 receiver_pair_targets(ordinary[0].energy, ordinary[1].energy, tolerance));
  std::vector<Interval> total(4 * row);
  BinIntervals products;
  std::vector<double> ambiguous(row, 0);
  const auto take_ambiguous = [&](const BinIntervals& bins) {
    for (const auto& [bin, part] : bins) ambiguous[bin] += part.hi;
  };
  for (std::size_t e = 0; e < 2; ++e) {
    const std::span all(parts[e].bins);
    for (const auto& [bin, part] : parts[e].added_up())
      total[e * row + bin] = {std::max(part.lo, 0.0), part.hi};
    take_ambiguous(all[parts[e].conservative]);
    // Ambiguities of the transmitter belong to both receivers.
    for (const BinIntervals& bins : all.subspan(parts[e].first_ambiguity[e == 0 ? 0 : 1]))
      take_ambiguous(bins);
  }
  for (const FlattenedPieces::Products& of :
       products_of(upper, lower, request, receiver_pair.wavenumber_rad_m)) {
    BistaticParts::add(of.sure, products);
    take_ambiguous(of.ambiguous);
  }
  for (const auto& [bin, part] : products) total[2 * row + bin] = part;

  CertifiedEcho certified{Echo{4, int(row), std::vector<double>(4 * row)}, std::vector<double>(4 * row)};
  for (std::size_t bin = 0; bin < total.size(); ++bin) {
    const double more = bin < 2 * row ? 0 : ambiguous[bin % row] * (1 + enclosure_slack),
                 lo = total[bin].lo - more, hi = total[bin].hi + more;
    if (!std::isfinite(hi)) {
      certified.echo.energy[bin] = bin < 2 * row ? ordinary[bin / row].energy[bin % row] : 0;
      certified.bound[bin] = infinite;
      continue;
    }
    certified.echo.energy[bin] = lo + (hi - lo) / 2;
    certified.bound[bin] =
        (hi - lo) / 2 * (1 + enclosure_slack) + enclosure_slack * std::max(std::abs(lo), std::abs(hi));
  }
  return reference_of(std::move(certified), tolerance, receiver_pair_row_targets);
}

}  // namespace tubefoot
