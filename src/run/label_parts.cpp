// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/label_parts.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "engine/scattering/pattern_levels.hpp"
#include "run/transmission_images.hpp"

// This file adds the labels of each contribution to a transmission. It repeats the integrals of the energies
// with the echo models of LabelModels, one per channel (labels.hpp).

namespace tubefoot {
namespace {

/// Returns the owners by part of a surface that several rays reach.
std::vector<std::uint16_t> owners_of_parts(const LabelChannels& labels, const ApparentSurface& surface_mesh) {
  std::vector<std::uint16_t> owners(surface_mesh.part_material.size());
  for (const RayOfPart& ray : surface_mesh.several)
    owners[ray.part] =
        labels.owner(surface_mesh.refined.mesh.component[ray.seen], surface_mesh.part_material[ray.part]);
  return owners;
}

void add(const std::vector<double>& more, std::vector<double>& all) {
  all.resize(more.size(), 0);
  std::ranges::transform(all, more, all.begin(), std::plus<>());
}

}  // namespace

void add_labels(const Transmission& transmission, std::size_t s, const EchoModel& model,
                const FacetMesh& mesh, const CommonVisibility& visibility, PingSums& sums) {
  if (transmission.labels() == nullptr) return;
  LabelModels(transmission, s, model, mesh).add(sums, [&](const EchoModel& one) {
    return transmission.echo(visibility, s, one).energy;
  });
}

void add_labels(const Transmission& transmission, std::size_t s, const TransmissionSurface& surface_mesh,
                const FacetMesh& mesh, const CommonVisibility& visibility, PingSums& sums) {
  if (transmission.labels() == nullptr) return;
  const SensorModel model(transmission, surface_mesh, s);
  add_labels(transmission, s, model.model, mesh, visibility, sums);
}

void add_labels_of_mixed_eigenrays(const Transmission& transmission, std::size_t s, const EchoModel& model,
                                   const ApparentSurface& surface_mesh, const CommonVisibility& visibility,
                                   PingSums& sums) {
  if (transmission.labels() == nullptr) return;
  LabelModels(transmission, s, model, owners_of_parts(*transmission.labels(), surface_mesh))
      .add(sums, [&](const EchoModel& one) { return transmission.echo(visibility, s, one).energy; });
}

void add_labels_of_receiver_pair(const Transmission& transmission, std::size_t s, std::uint32_t fan,
                                 const EchoModel& model, const FacetMesh& mesh,
                                 const ReceiverPairHistory& history, const ReceiverBaseline& receiver_pair,
                                 PingSums& sums) {
  if (transmission.labels() == nullptr) return;
  const ReceiverPairHistory upper{history.transmit,
                                  history.upper,
                                  history.lower,
                                  history.by_upper,
                                  {},
                                  history.middle_m,
                                  history.bistatic_upper,
                                  {}};
  LabelModels(transmission, s, model, mesh).add(sums, [&](const EchoModel& one) {
    return row_of_fan(
        transmission, s, fan,
        integrate_receiver_pair_echo(upper, receiver_pair, fan, fan, transmission.samples(s), one).upper_j);
  });
}

void add_labels_of_receiver_pair(const Transmission& transmission, std::size_t s, std::uint32_t fan,
                                 const FacetMesh& mesh, const BistaticHistory& history, PingSums& sums) {
  if (transmission.labels() == nullptr) return;
  const SensorModel model(transmission, TransmissionSurface(transmission.loaded_scene()), s);
  const std::size_t tubes = history.receive.tubes.size();
  const BeamPatterns patterns = patterns_of_fan(model.patterns, fan, tubes);
  EchoModel own = model.model;
  own.patterns = &patterns;
  const std::vector<std::uint32_t> only_beam(tubes, 0);
  LabelModels(transmission, s, own, mesh).add(sums, [&](const EchoModel& one) {
    return row_of_fan(transmission, s, fan,
                      integrate_echo(history, {1, only_beam}, transmission.samples(s), one).energy);
  });
}

void add_labels_of_paths(const Transmission& transmission, std::size_t s, const FacetMesh& mesh,
                         const EchoModel& model, PathSettings settings, PingSums& sums,
                         const PathRows& rows_of) {
  if (transmission.labels() == nullptr) return;
  const LabelledSurface seabed(transmission, mesh);
  const LabelModels models(transmission, s, model, mesh);
  const EchoModel whole = models.whole();
  settings.reference_tolerance.reset();
  settings.mirrors.reflection = seabed.reflection;
  settings.before = &whole;
  settings.arrivals = false;
  std::vector<double> least_received;
  if (const auto level_db = transmission.labels()->label_level_db(); level_db && model.patterns != nullptr)
    least_received = receive_gains_below_peak(*model.patterns, *level_db);
  models.add(sums, [&](const EchoModel& one) {
    PathSettings of_one = settings;
    if (one.patterns != nullptr && !one.patterns->least.empty()) of_one.least_received = least_received;
    return rows_of(seabed.mesh(), one, of_one);
  });
  settings.arrivals = true;
  settings.scatterings = 1;
  sums.add_to_channel(transmission, s, "labels", transmission.labels()->unscattered(),
                      rows_of(seabed.mesh(), models.silent(), settings));
}

std::vector<double> wanted_orders(const Transmission& transmission, const PathEcho& paths) {
  std::vector<double> all(paths.by_order.front().energy.size());
  for (std::size_t order = 0; order < paths.by_order.size(); ++order)
    if (is_order_wanted(transmission.scene(), order)) add(paths.by_order[order].energy, all);
  return all;
}

std::vector<double> wanted_orders(const Transmission& transmission, const ReceiverPairPathEcho& paths) {
  std::vector<double> all(paths.by_order.front().upper_j.size());
  for (std::size_t order = 0; order < paths.by_order.size(); ++order)
    if (is_order_wanted(transmission.scene(), order)) add(paths.by_order[order].upper_j, all);
  return all;
}

std::vector<double> row_of_fan(const Transmission& transmission, std::size_t s, std::uint32_t fan,
                               const std::vector<double>& samples) {
  std::vector<double> rows(std::size_t(transmission.beams(s)) * samples.size());
  std::ranges::copy(samples, rows.begin() + std::ptrdiff_t(fan * samples.size()));
  return rows;
}

}  // namespace tubefoot
