// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/transmission_ends.hpp"

#include "engine/visibility/looks.hpp"
#include "engine/visibility/part_label.hpp"

namespace tubefoot {

TransmissionEnds::TransmissionEnds(const Transmission& transmission, std::size_t sensor, bool weights)
    : transmission_(transmission) {
  const bool apart = transmission.has_separate_receiver();
  if (apart && transmission.scene().water->refracts()) {
    pair_.emplace(refracted_pair_of(transmission, weights));
    const ApparentPair& pair = pair_->apparent;
    pair_parent_.resize(pair.mesh.facets.size());
    const auto add = [&](const TubeSet& tubes, const ApparentSurface& surface_mesh,
                         const std::vector<FacetId>& origin) {
      for (std::size_t k = 0; k < origin.size(); ++k)
        pair_parent_[origin[k]] = surface_mesh.refined.parent[k];
      trees_.push_back(
          std::make_unique<SceneTree>(surface_mesh.refined.mesh, SceneTree::HeightFieldSearch::ignored));
      ends_.push_back({tubes, &surface_mesh.refined.mesh, trees_.back().get(), &surface_mesh.refined, nullptr,
                       &surface_mesh, origin});
    };
    add(pair_->transmit_tubes, pair.transmit, pair.transmit_origin);
    add(pair_->receive_tubes, pair.receive, pair.receive_origin);
    return;
  }
  if (weights && transmission.loaded_scene().has_surface_per_transmission())
    surface_mesh_.emplace(surface_mesh_of(transmission, true));
  const TransmissionSurface& surface_mesh = surface_mesh_ ? *surface_mesh_ : transmission.surface_mesh();
  const auto add = [&](TubeSet tubes) {
    ends_.push_back({std::move(tubes),
                     &surface_mesh.mesh(),
                     &surface_mesh.tree(),
                     surface_mesh.refined(),
                     surface_mesh.moved(),
                     surface_mesh.apparent(),
                     {},
                     surface_mesh.is_own() ? nullptr : &transmission.loaded_scene()});
  };
  add(apart ? transmission.tubes() : transmission.tubes_of(sensor));
  if (apart) add(transmission.receive_tubes(sensor));
}

FacetId TransmissionEnds::base_facet(FacetId shared) const {
  if (pair_)
    shared = pair_parent_[shared];
  else if (tx().refined != nullptr)
    shared = tx().refined->parent[shared];
  return transmission_.loaded_scene().base_number_of(shared);
}

std::unique_ptr<SensorModel> TransmissionEnds::model(std::size_t sensor) const {
  auto model =
      std::make_unique<SensorModel>(transmission_, TransmissionSurface(transmission_.loaded_scene()), sensor);
  model->model.material = shared_mesh().material;
  return model;
}

TransmissionEnds::Looks TransmissionEnds::look_from_all(bool open_water) const {
  VisibilityOptions options = transmission_.request().visibility;
  options.open_water = options.open_water || open_water;
  Looks looks;
  for (const TransmissionEnd& end : ends_) looks.push_back(look(*end.mesh, *end.tree, end.tubes, options));
  return looks;
}

FootprintSharer TransmissionEnds::sharer(const Looks& looks) const {
  const double unit_m = transmission_.scene().grid.unit_m();
  if (!pair_) return {*tx().mesh, {tx().tubes, looks[0]}, {rx().tubes, looks[1]}, unit_m};
  return {{tx().tubes, looks[0], tx().mesh, tx().name}, {rx().tubes, looks[1], rx().mesh, rx().name}, unit_m};
}

namespace {

/// Removes the footprints that lie outside of the interval of a divided record. The first and the last
/// interval keep those before and beyond the range gate, as an undivided record does.
void keep_interval(const Transmission& transmission, PathFootprints& seen) {
  const Sensor& sensor = transmission.sensor(transmission.first());
  const RangeSamples samples = sensor.samples(transmission.number()), &all = sensor.samples();
  const double first_m = samples.first_m, end_m = samples.border_m(samples.count),
               last_m = all.border_m(all.count);
  std::size_t kept = 0;
  std::vector<BistaticFacet>& bistatic = seen.history.bistatic;
  std::vector<Footprint>& footprints = seen.footprints.footprints;
  constexpr double rounding_m = 1e-9;
  for (std::size_t k = 0; k < footprints.size(); ++k) {
    const bool before = first_m > all.first_m && footprints[k].slant_range_max_m <= first_m + rounding_m,
               beyond = end_m < last_m - rounding_m && footprints[k].slant_range_min_m >= end_m - rounding_m;
    if (before || beyond) continue;
    footprints[kept] = footprints[k];
    seen.history.shared.facets[kept] = seen.history.shared.facets[k];
    if (!bistatic.empty()) bistatic[kept] = bistatic[k];
    seen.receive_tube[kept] = seen.receive_tube[k];
    seen.receive_distance_m[kept] = seen.receive_distance_m[k];
    ++kept;
  }
  footprints.resize(kept);
  seen.history.shared.facets.resize(kept);
  if (!bistatic.empty()) bistatic.resize(kept);
  seen.receive_tube.resize(kept);
  seen.receive_distance_m.resize(kept);
}

}  // namespace

TransmissionEnds::Seen TransmissionEnds::seen() const {
  const WorldGrid& grid = transmission_.scene().grid;
  const Looks looks = look_from_all(false);
  Seen seen;
  for (std::size_t k = 0; k < ends_.size(); ++k)
    seen.alone.push_back(history_of(*ends_[k].mesh, ends_[k].tubes, looks[k], grid.unit_m()));
  BistaticHistory both{tx().tubes, rx().tubes, grid.unit_m(), shared_by_all(sharer(looks))};
  if (pair_)
    both.bistatic = bistatic_facets(both.shared, pair_->apparent, grid, pair_->transmit_water,
                                    pair_->receive_water, pair_->absorption_db_per_m);
  seen.together = path_footprints(both);
  if (transmission_.pings().sensor->receiver_moves()) keep_interval(transmission_, seen.together);
  return seen;
}

BistaticAudit TransmissionEnds::audit(std::uint64_t label) const {
  const Looks looks = look_from_all(true);
  constexpr std::uint64_t of_rx = std::uint64_t{1} << 62;
  return {audit_tubes(*tx().mesh, tx().tubes, looks[0], label),
          audit_tubes(*rx().mesh, rx().tubes, looks[1], label_of_part(label, of_rx)),
          audit_shared(sharer(looks), label)};
}

}  // namespace tubefoot
