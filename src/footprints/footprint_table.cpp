// SPDX-License-Identifier: GPL-3.0-or-later

// Computes the table of footprints of a transmission (docs/footprints.md): measures, energies, corners and
// occluders. One end is enough for a monostatic path. Bistatic paths and paths over mirrors use the common
// visibility of two ends.

#include "footprints/footprint_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "engine/echo/echo.hpp"
#include "engine/visibility/path_footprints.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/steps/stop.hpp"
#include "run/transmission_ends.hpp"
#include "run/transmission_images.hpp"

namespace tubefoot {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

using T = FootprintTable;
const std::array<FootprintColumn, 23> columns{{
    {"ping", "1", "ping, counted from 0", &T::ping},
    {"transmission", "1", "transmission of the ping, counted from 0", &T::transmission},
    {"beam", "1", "beam that the receive tube belongs to, counted from 0", &T::beam},
    {"tube", "1", "tube of the transmission, counted from 0", &T::tube},
    {"receive_tube", "1",
     "tube of the receiver, counted from 0; differs from tube for separate receivers and mirror paths",
     &T::receive_tube},
    {"facet", "1", "facet of the transmission's surface mesh, counted from 0", &T::facet},
    {"base_facet", "1", "facet of the scene as loaded, counted from 0", &T::base_facet},
    {"component_index", "1", "component of the scene, counted from 0", &T::component},
    {"material_index", "1", "material of the scene, counted from 0", &T::material},
    {"path_order", "1", "number of interactions along the path; 1 for the direct echo", &T::path_order},
    {"tx_reflections", "1", "number of reflections on the transmit leg", &T::mirrors_tx},
    {"rx_reflections", "1", "number of reflections on the receive leg", &T::mirrors_rx},
    {"area_m2", "m2", "area", &T::area_m2},
    {"solid_angle_sr", "sr", "solid angle at the sensor", &T::solid_angle_sr},
    {"grazing_deg", "degree", "grazing angle at the centroid", &T::grazing_deg},
    {"azimuth_deg", "degree", "direction of the centroid from the sensor, clockwise from north",
     &T::azimuth_deg},
    {"slant_range_min_m", "m", "slant range of the nearest point", &T::slant_range_min_m},
    {"slant_range_max_m", "m", "slant range of the farthest point", &T::slant_range_max_m},
    {"energy_j", "J m-2",
     "energy density summed over all beams and range bins, for a source of 1 J/sr at 1 m", &T::energy_j},
    {"own_beam_energy_j", "J m-2", "energy density in the beam of the tube, summed over its range bins",
     &T::own_beam_energy_j},
    {"centroid_east_m", "m", "centroid, east in the local frame", &T::centroid_east_m},
    {"centroid_north_m", "m", "centroid, north in the local frame", &T::centroid_north_m},
    {"centroid_up_m", "m", "centroid, up in the local frame", &T::centroid_up_m},
}};

template <class Value>
void append_all(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Appends offsets that begin with 0, shifted by the last offset of `to`.
void append_offsets(std::vector<std::uint64_t>& to, const std::vector<std::uint64_t>& from) {
  const std::uint64_t base = to.back();
  for (std::size_t k = 1; k < from.size(); ++k) to.push_back(base + from[k]);
}

/// Occluding facets, by the facet that they hide and the tube.
using Occluders = std::map<std::pair<FacetId, std::uint32_t>, std::vector<FacetId>>;

/// `end` maps a facet of its mesh to the name that both ends share, and to its number in the scene.
template <class End>
Occluders occluders_of(const FootprintSet& set, const End& end) {
  Occluders all;
  for (const Footprint& f : set.footprints) {
    auto& its = all[{end.name_of(f.facet), f.tube}];
    for (std::uint32_t k = 0; k < f.occluder_count; ++k)
      its.push_back(end.number_of(set.occluders[f.first_occluder + k]));
  }
  return all;
}

/// Returns the occluders of a facet in a tube of the transmit leg or in a tube of the receive leg.
std::vector<FacetId> of_either(const Occluders& tx, std::uint32_t tx_tube, const Occluders& rx,
                               std::uint32_t rx_tube, FacetId facet) {
  std::vector<FacetId> occluders;
  const auto add = [&](const Occluders& all, std::uint32_t tube) {
    // With plain doubles, the common visibility may contain a part that one end alone does not see.
    if (const auto its = all.find({facet, tube}); its != all.end())
      occluders.insert(occluders.end(), its->second.begin(), its->second.end());
  };
  add(tx, tx_tube);
  add(rx, rx_tube);
  std::sort(occluders.begin(), occluders.end());
  occluders.erase(std::unique(occluders.begin(), occluders.end()), occluders.end());
  return occluders;
}

/// A path over mirrors, or the path without mirrors.
struct RowPath {
  std::uint32_t mirrors_tx = 0, mirrors_rx = 0;
  glm::dmat3 to_true{1};  ///< maps a direction of the transmit leg to that at the true apex
};

/// Rows of footprints for all kinds of path.
class Rows {
 public:
  Rows(const Transmission& transmission, std::size_t s)
      : transmission_(transmission), sensor_(transmission.sensor(s)) {}

  /// `number` is the number of the facet in files. `place` maps a corner, relative to the apex, to its true
  /// position.
  template <class Place>
  void add(const Footprint& footprint, const FootprintSet& set, std::uint32_t receive_tube, FacetId number,
           FacetId base, const FacetMesh& mesh, double area_m2, double energy_j, double own_beam_energy_j,
           std::span<const FacetId> occluders, const Place& place, const RowPath& path = {}) {
    const FacetId facet = footprint.facet;
    table.ping.push_back(static_cast<std::uint32_t>(transmission_.ping()));
    table.transmission.push_back(static_cast<std::uint32_t>(transmission_.number()));
    table.beam.push_back(sensor_.beams_of_transmission(
        transmission_.number())[sensor_.beam_of_tube(transmission_.number())[receive_tube]]);
    table.tube.push_back(footprint.tube);
    table.receive_tube.push_back(receive_tube);
    table.facet.push_back(number);
    table.base_facet.push_back(base);
    table.component.push_back(mesh.component[facet]);
    table.material.push_back(mesh.material[facet]);
    table.path_order.push_back(path.mirrors_tx + path.mirrors_rx + 1);
    table.mirrors_tx.push_back(path.mirrors_tx);
    table.mirrors_rx.push_back(path.mirrors_rx);
    table.area_m2.push_back(area_m2);
    table.solid_angle_sr.push_back(footprint.solid_angle_sr);
    table.grazing_deg.push_back(footprint.grazing_angle_rad * degrees);
    const glm::dvec3 sent = path.to_true * footprint.centroid_m;
    const double azimuth = std::atan2(sent.x, sent.y) * degrees;
    table.azimuth_deg.push_back(azimuth < 0 ? std::fmod(azimuth + 360, 360) : azimuth);
    table.slant_range_min_m.push_back(footprint.slant_range_min_m);
    table.slant_range_max_m.push_back(footprint.slant_range_max_m);
    table.energy_j.push_back(energy_j);
    table.own_beam_energy_j.push_back(own_beam_energy_j);
    const glm::dvec3 centroid = place(footprint.centroid_m);
    table.centroid_east_m.push_back(centroid.x);
    table.centroid_north_m.push_back(centroid.y);
    table.centroid_up_m.push_back(centroid.z);
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      const Piece& piece = set.pieces[footprint.first_piece + p];
      for (std::uint32_t c = piece.count; c-- > 0;)
        table.corners_m.push_back(place(set.corners_m[piece.first + c]));
      table.first_corner.push_back(table.corners_m.size());
    }
    table.first_piece.push_back(table.first_corner.size() - 1);
    table.occluders.insert(table.occluders.end(), occluders.begin(), occluders.end());
    table.first_occluder.push_back(table.occluders.size());
  }

  FootprintTable table;

 private:
  const Transmission& transmission_;
  const Sensor& sensor_;
};

/// Returns the footprints in the common visibility of two ends, in some tubes of the receiver.
FootprintTable table_of_two_ends(const Transmission& transmission, std::size_t s,
                                 std::span<const std::uint32_t> tubes) {
  const Sensor& sensor = transmission.sensor(s);
  const TransmissionEnds ends(transmission, s);
  const auto [alone, seen] = ends.seen();
  const std::vector<std::uint32_t>& beam_of_tube = sensor.beam_of_tube(transmission.number());
  const std::vector<std::uint32_t> fans = sensor.fan_of_tube(transmission.number());
  FootprintSet received = seen.footprints;
  for (std::size_t k = 0; k < received.footprints.size(); ++k)
    received.footprints[k].tube = seen.receive_tube[k];
  const FootprintEnergies energies =
      footprint_energies(received, seen.history, beam_of_tube, transmission.beams_by_fans(s, fans),
                         transmission.samples(s), ends.model(s)->model, transmission.request().binning);
  const Occluders tx = occluders_of(alone[0].footprints, ends.tx()),
                  rx = occluders_of(alone[1].footprints, ends.rx());
  const glm::dvec3 apex = transmission.scene().grid.to_metres(ends.tx().tubes.apex);
  Rows rows(transmission, s);
  for (std::size_t k = 0; k < seen.footprints.footprints.size(); ++k) {
    stop_if_wanted();
    const Footprint& footprint = seen.footprints.footprints[k];
    if (!std::ranges::binary_search(tubes, seen.receive_tube[k])) continue;
    if (fans[footprint.tube] != fans[seen.receive_tube[k]])
      continue;  // no beam receives sound of another fan
    rows.add(footprint, seen.footprints, seen.receive_tube[k], ends.tx().number_of_name(footprint.facet),
             ends.base_facet(footprint.facet), ends.shared_mesh(), seen.area_m2(k), energies.all_beams[k],
             energies.own_beam[k], of_either(tx, footprint.tube, rx, seen.receive_tube[k], footprint.facet),
             [&](glm::dvec3 corner) { return seen.place(k, corner, apex); });
  }
  return std::move(rows.table);
}

/// Rows for paths that are scattered once over mirrors.
class PathRows {
 public:
  /// `tubes` are those of the receiver.
  PathRows(const Transmission& transmission, std::size_t s, const PathSettings& settings,
           std::span<const std::uint32_t> tubes)
      : transmission_(transmission),
        s_(s),
        tubes_(tubes),
        images_(transmission, s, settings, PathEnds(transmission, s)),
        model_(transmission, images_.surface_mesh(), s),
        fans_(transmission.sensor(s).fan_of_tube(transmission.number())),
        rows_(transmission, s) {}

  FootprintTable table() {
    const PathImages& images = images_.images();
    std::vector<ImagePair> pairs = images.pairs();
    if (images.one_place())  // each path has a reverse path
      for (std::size_t k = pairs.size(); k-- > 0;)
        if (pairs[k].sent != pairs[k].received) pairs.push_back({pairs[k].received, pairs[k].sent});
    const auto path = [&](const ImagePair& pair) {
      const std::uint32_t tx = images.sent()[pair.sent].mirrors,
                          rx = images.received()[pair.received].mirrors;
      return std::tuple(tx + rx, tx, pair.sent, pair.received);
    };
    std::ranges::sort(pairs, {}, path);
    for (const Image& image : images.sent()) tx_.push_back(hidden_of(image));
    if (!images.one_place())
      for (const Image& image : images.received()) rx_.push_back(hidden_of(image));
    for (const ImagePair& pair : pairs)
      if (is_order_wanted(transmission_.scene(), std::get<0>(path(pair)) + 1)) add(pair);
    return std::move(rows_.table);
  }

 private:
  /// Returns the occluders of each facet that an image sees, by the facet names that all images share.
  Occluders hidden_of(const Image& image) const {
    struct End {
      const Image& image;
      const PathRows& rows;
      FacetId name_of(FacetId facet) const { return image.origin.empty() ? facet : image.origin[facet]; }
      FacetId number_of(FacetId facet) const { return rows.number_of(name_of(facet)); }
    };
    std::vector<FootprintSet> of_window(image.seen.size());
    for (std::uint32_t window = 0; window < image.seen.size(); ++window)
      append_footprints(*image.mesh, image.windows, window, image.seen[window],
                        transmission_.scene().grid.unit_m(), of_window[window]);
    return occluders_of(joined(of_window), End{image, *this});
  }

  FacetId number_of(FacetId facet) const {
    return images_.images().is_cut() ? facet : images_.surface_mesh().number_of(facet);
  }

  void add(const ImagePair& pair) {
    stop_if_wanted();
    const PathImages& images = images_.images();
    const Image &sent = images.sent()[pair.sent], &received = images.received()[pair.received];
    const BistaticHistory history = images.history(sent, received);
    if (history.shared.pieces.empty()) return;
    const PathFootprints seen = path_footprints(history);
    const PairModel model =
        images.model(sent, received, model_.model, transmission_.beams_by_fans(s_, fans_));
    FootprintSet at_rx = seen.footprints;
    for (std::size_t k = 0; k < at_rx.footprints.size(); ++k) at_rx.footprints[k].tube = seen.receive_tube[k];
    const FootprintEnergies energies =
        footprint_energies(at_rx, seen.history, model.beams.of_tube, model.beams, transmission_.samples(s_),
                           model.model, transmission_.request().binning);
    const glm::dvec3 apex = transmission_.scene().grid.to_metres(sent.windows.apex);
    const RowPath path{sent.mirrors, received.mirrors, sent.leg.to_true};
    const Occluders& rx = (images.one_place() ? tx_ : rx_)[pair.received];
    for (std::size_t k = 0; k < seen.footprints.footprints.size(); ++k) {
      Footprint footprint = seen.footprints.footprints[k];
      const std::uint32_t window = footprint.tube, receive_tube = received.own_tube[seen.receive_tube[k]];
      if (!std::ranges::binary_search(tubes_, receive_tube)) continue;
      if (!model.beams.in_one_fan(window, seen.receive_tube[k]))
        continue;  // no beam receives sound of another fan
      footprint.tube = sent.own_tube[window];
      rows_.add(
          footprint, seen.footprints, receive_tube, number_of(footprint.facet),
          images_.surface_mesh().base_facet(images.uncut(footprint.facet)), images.seabed(), seen.area_m2(k),
          energies.all_beams[k], energies.own_beam[k],
          of_either(tx_[pair.sent], window, rx, seen.receive_tube[k], footprint.facet),
          [&](glm::dvec3 corner) { return seen.place(k, corner, apex); }, path);
    }
  }

  const Transmission& transmission_;
  std::size_t s_;
  std::span<const std::uint32_t> tubes_;
  TransmissionImages images_;
  SensorModel model_;
  std::vector<std::uint32_t> fans_;
  Rows rows_;
  std::vector<Occluders> tx_, rx_;  // index: image
};

}  // namespace

std::span<const FootprintColumn> footprint_columns() { return columns; }

void FootprintTable::append(const FootprintTable& more) {
  for (const FootprintColumn& column : columns)
    std::visit([&](auto values) { append_all(this->*values, more.*values); }, column.values);
  append_offsets(first_piece, more.first_piece);
  append_offsets(first_corner, more.first_corner);
  append_offsets(first_occluder, more.first_occluder);
  append_all(corners_m, more.corners_m);
  append_all(occluders, more.occluders);
}

std::vector<std::uint32_t> tubes_of_beams(const Transmission& transmission, std::size_t s,
                                          std::span<const std::uint32_t> beams) {
  const std::vector<std::uint32_t>& beam_of_tube = transmission.sensor(s).beam_of_tube(transmission.number());
  const std::vector<std::uint32_t>& beams_of_transmission =
      transmission.sensor(s).beams_of_transmission(transmission.number());
  std::vector<std::uint32_t> tubes;
  for (std::uint32_t tube = 0; tube < beam_of_tube.size(); ++tube)
    if (beams.empty() ||
        std::binary_search(beams.begin(), beams.end(), beams_of_transmission[beam_of_tube[tube]]))
      tubes.push_back(tube);
  return tubes;
}

TubeSet only_tubes(TubeSet set, std::span<const std::uint32_t> tubes) {
  const std::vector<Tube> all = std::move(set.tubes);
  set.tubes.clear();
  for (const std::uint32_t tube : tubes) set.tubes.push_back(all[tube]);
  return set;
}

namespace {

FootprintTable table_of_one_end(const Transmission& transmission, std::size_t s,
                                std::span<const std::uint32_t> tubes) {
  const Scene& scene = transmission.scene();
  const TransmissionSurface& surface_mesh = transmission.surface_mesh();
  History history = transmission.trace(only_tubes(transmission.tubes_of(s), tubes));
  for (Footprint& footprint : history.footprints.footprints) footprint.tube = tubes[footprint.tube];
  const std::vector<std::uint32_t>& beam_of_tube = transmission.sensor(s).beam_of_tube(transmission.number());
  const FootprintEnergies energies = footprint_energies(
      history.footprints, history, beam_of_tube, {transmission.beams(s), beam_of_tube},
      transmission.samples(s), transmission.model(s).model, transmission.request().binning);

  const FootprintSet& set = history.footprints;
  const ApparentSurface* apparent = surface_mesh.apparent();
  const glm::dvec3 apex = scene.grid.to_metres(history.tubes.apex);
  Rows rows(transmission, s);
  std::vector<FacetId> occluders;
  for (std::size_t k = 0; k < set.footprints.size(); ++k) {
    stop_if_wanted();
    const Footprint& footprint = set.footprints[k];
    const FacetId facet = footprint.facet;
    occluders.clear();
    for (std::uint32_t o = 0; o < footprint.occluder_count; ++o)
      occluders.push_back(surface_mesh.number_of(set.occluders[footprint.first_occluder + o]));
    rows.add(footprint, set, footprint.tube, surface_mesh.number_of(facet), surface_mesh.base_facet(facet),
             surface_mesh.mesh(),
             footprint.area_m2 * (apparent == nullptr ? 1 : apparent->area_ratio(facet, scene.grid)),
             energies.all_beams[k], energies.own_beam[k], occluders, [&](glm::dvec3 corner) {
               return apparent == nullptr ? apex + corner
                                          : apparent->true_place(facet, apex + corner, scene.grid);
             });
  }
  if (apparent != nullptr) rows.table.facets_of_several_rays = apparent->facets_of_several;
  return std::move(rows.table);
}

}  // namespace

FootprintTable footprint_table(const Transmission& transmission, std::size_t s,
                               std::span<const std::uint32_t> beams) {
  const std::vector<std::uint32_t> tubes = tubes_of_beams(transmission, s, beams);
  FootprintTable table;
  if (tubes.empty()) return table;
  if (is_order_wanted(transmission.scene(), 1))
    table = transmission.has_separate_receiver() ? table_of_two_ends(transmission, s, tubes)
                                                 : table_of_one_end(transmission, s, tubes);
  if (const auto settings = path_settings(transmission, s); settings && settings->order > 1)
    table.append(PathRows(transmission, s, *settings, tubes).table());
  return table;
}

}  // namespace tubefoot
