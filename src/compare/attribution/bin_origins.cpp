// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the facets that contribute energy to each bin of a ping, from the visible polygons of the tubes.
// Adds the kind of each bin (bin_kinds.hpp) and marks the bins without energy as shadow or open water.
#include "compare/attribution/bin_origins.hpp"

#include <algorithm>
#include <memory>
#include <tuple>

#include "engine/echo/echo.hpp"
#include "run/transmission_ends.hpp"

namespace tubefoot {
namespace {

constexpr double least_share_with_patterns = 1e-3;

class Origins {
 public:
  Origins(std::size_t sensor, const Sensor& kind)
      : index_(sensor), sensor_(kind), samples_(static_cast<std::size_t>(kind.samples().count)) {
    found_.kind.assign(sensor_.beams().size() * samples_, BinKind::interior);
  }

  void add(const Transmission& transmission) {
    const TransmissionEnds ends(transmission, index_);
    if (ends.are_two())
      add_two_ends(transmission, ends);
    else
      add_one_end(transmission);
  }

  BinOrigins finish() {
    std::vector<BinPart>& parts = found_.parts;
    std::ranges::sort(parts, {}, [](const BinPart& p) { return std::tuple(p.bin, p.facet); });
    std::size_t count = 0;
    for (const BinPart& part : parts) {
      BinPart* last = count > 0 ? &parts[count - 1] : nullptr;
      if (last != nullptr && last->bin == part.bin && last->facet == part.facet &&
          last->object == part.object && last->material == part.material)
        last->energy_j += part.energy_j;
      else
        parts[count++] = part;
    }
    parts.resize(count);
    std::ranges::sort(parts, {}, [](const BinPart& p) { return std::tuple(p.bin, -p.energy_j, p.facet); });
    std::ranges::stable_sort(found_.casters, {}, &BinPart::bin);
    mark_dark();
    return std::move(found_);
  }

 private:
  void add_one_end(const Transmission& transmission) {
    const History history = transmission.trace();
    const TransmissionSurface& surface_mesh = transmission.surface_mesh();
    SensorModel model = transmission.model(index_);
    model.patterns.baselines.clear();  // only the visibility from the transmitter matters here
    add_parts(
        transmission, history, {transmission.beams(index_), sensor_.beam_of_tube(transmission.number())},
        transmission.echo(history, index_, model.model), model.model, surface_mesh.mesh(),
        [&](std::size_t number) { return history.footprints.footprints[number].facet; },
        [&](FacetId facet) { return surface_mesh.base_facet(facet); });
    add_edges(transmission, history, surface_mesh.mesh(), glm::dvec3(0),
              [&](FacetId facet) { return surface_mesh.base_facet(facet); });
  }

  void add_two_ends(const Transmission& transmission, const TransmissionEnds& ends) {
    const TransmissionEnds::Seen all = ends.seen();
    const std::unique_ptr<SensorModel> model = ends.model(index_);
    model->patterns.baselines.clear();
    const std::vector<std::uint32_t> fans = sensor_.fan_of_tube(transmission.number());
    add_parts(
        transmission, all.together.history, transmission.beams_by_fans(index_, fans),
        transmission.echo(all.together.history, index_, model->model), model->model, ends.shared_mesh(),
        [&](std::size_t number) { return all.together.footprints.footprints[number].facet; },
        [&](FacetId facet) { return ends.base_facet(facet); });
    const WorldGrid& grid = transmission.scene().grid;
    add_edges(transmission, all.alone.back(), *ends.rx().mesh,
              grid.to_metres(ends.tx().tubes.apex) - grid.to_metres(ends.rx().tubes.apex),
              [&](FacetId facet) { return ends.base_facet(ends.rx().name_of(facet)); });
  }

  template <class FacetOf, class BaseOf>
  void add_parts(const Transmission& transmission, const CommonVisibility& visibility,
                 const ReceiveBeams& hearing, const Echo& echo, const EchoModel& model, const FacetMesh& mesh,
                 const FacetOf& facet_of, const BaseOf& base_of) {
    const std::vector<std::uint32_t>& beams = sensor_.beams_of_transmission(transmission.number());
    const std::size_t first = sensor_.first_sample(transmission.number());
    const double least = model.patterns != nullptr ? least_share_with_patterns : 0;
    for (const Contribution& c : contributions(visibility, hearing, transmission.samples(index_), model,
                                               transmission.request().binning, echo, least)) {
      const FacetId facet = facet_of(c.footprint);
      found_.parts.push_back({static_cast<std::uint32_t>(beams[c.beam] * samples_ + first + c.sample),
                              base_of(facet), mesh.component[facet], mesh.material[facet], c.energy_j});
    }
  }

  template <class BaseOf>
  void add_edges(const Transmission& transmission, const History& history, const FacetMesh& mesh,
                 glm::dvec3 other_end_m, const BaseOf& base_of) {
    const std::vector<std::uint32_t>& beams = sensor_.beams_of_transmission(transmission.number());
    const RangeSamples own = transmission.samples(index_);
    const std::size_t first = sensor_.first_sample(transmission.number()),
                      count = static_cast<std::size_t>(own.count);
    const BinEdges edges =
        edges_of_bins({history, mesh.component, sensor_.beam_of_tube(transmission.number()), beams.size(),
                       own, other_end_m, !sensor_.is_across_track()});
    for (std::size_t b = 0; b < beams.size(); ++b)
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t bin = beams[b] * samples_ + first + k;
        found_.kind[bin] = std::max(found_.kind[bin], edges.kind[b * count + k]);
        const FacetId facet = edges.caster[b * count + k];
        if (facet != BinEdges::no_caster)
          found_.casters.push_back({static_cast<std::uint32_t>(bin), base_of(facet), mesh.component[facet],
                                    mesh.material[facet], 0});
      }
  }

  /// Sets the kind of bins without parts.
  void mark_dark() {
    std::vector<bool> lit(found_.kind.size(), false);
    for (const BinPart& part : found_.parts) lit[part.bin] = true;
    for (std::size_t row = 0; row < found_.kind.size(); row += samples_) {
      bool before = false;
      for (std::size_t k = 0; k < samples_; ++k) {
        before = before || lit[row + k];
        if (!lit[row + k]) found_.kind[row + k] = before ? BinKind::shadow : BinKind::open_water;
      }
    }
  }

  std::size_t index_;
  const Sensor& sensor_;
  std::size_t samples_;
  BinOrigins found_;
};

}  // namespace

BinOrigins bin_origins(const Transmissions& transmissions, TransmissionsAround& around, std::size_t sensor,
                       std::size_t ping) {
  const Survey& survey = transmissions.survey();
  const Sensor& kind = *survey.sensors[sensor].sensor;
  const Transmissions& near = around.at(survey.sensor_set->transmissions_of(sensor), ping);
  Origins origins(sensor, kind);
  for (std::size_t number = 0; number < kind.transmissions(); ++number)
    origins.add(near.received_by(sensor, ping, number));
  return origins.finish();
}

}  // namespace tubefoot
