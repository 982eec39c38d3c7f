// SPDX-License-Identifier: GPL-3.0-or-later
#include "transmission.hpp"

#include <fmt/format.h>

#include "files/usage_error.hpp"
#include "run/abilities.hpp"
#include "run/tiles_in_view.hpp"

namespace tubefoot::python {
namespace {

/// Returns the request for an existing transmission that can be traced separately. Removes the function
/// that computes echoes, because it might refer to the transmission and form a cycle.
RunRequest checked(const Survey& survey, RunRequest request, const ReceivedTransmission& which) {
  const SensorPings& pings = survey.sensors.at(which.sensor);
  const std::string& name = pings.sensor->description().name;
  if (which.ping >= pings.times_s.size())
    throw UsageError(
        fmt::format("ping {}: sensor '{}' has pings 0 to {}", which.ping, name, pings.times_s.size() - 1));
  if (which.transmission >= pings.sensor->transmissions())
    throw UsageError(fmt::format("transmission {}: a ping of sensor '{}' has transmissions 0 to {}",
                                 which.transmission, name, pings.sensor->transmissions() - 1));
  request.own_engine.reset();
  require_able(survey, request, Feature::transmission, which.sensor);
  return request;
}

Survey around(const Survey& survey, const RunRequest& request, const ReceivedTransmission& which) {
  if (!survey.loaded_scene->is_tiled()) return survey;
  return survey_around(Transmissions(survey, request), survey.sensor_set->transmissions_of(which.sensor),
                       which.ping);
}

}  // namespace

NativeTransmission::NativeTransmission(const Survey& survey, const RunRequest& request,
                                       ReceivedTransmission which)
    : which_(which),
      transmissions_(around(survey, checked(survey, request, which), which), checked(survey, request, which)),
      transmission_(transmissions_.received_by(which.sensor, which.ping, which.transmission)),
      ends_(transmission_, which.sensor) {}

const std::vector<glm::dvec3>& NativeTransmission::vertices_m() const {
  if (ends_.tx().refined == nullptr && survey().loaded_scene->moving == nullptr)
    return survey().loaded_scene->vertices_m();
  std::call_once(vertices_made_, [this] {
    const auto& vertices = ends_.tx().mesh->vertices;
    vertices_m_.reserve(vertices.size());
    for (const GridPoint& p : vertices) vertices_m_.push_back(survey().scene.grid.to_metres(p));
  });
  return vertices_m_;
}

std::shared_ptr<NativeHistory> NativeTransmission::trace() const {
  if (ends_.are_two()) {
    PathFootprints seen = ends_.seen().together;
    return std::make_shared<NativeHistory>(NativeHistory{shared_from_this(), std::move(seen.footprints),
                                                         std::move(seen.receive_tube),
                                                         std::move(seen.receive_distance_m)});
  }
  NativeHistory history{shared_from_this(), transmission_.trace(tubes()).footprints, {}, {}};
  for (const Footprint& footprint : history.footprints.footprints) {
    history.receive_tube.push_back(footprint.tube);
    history.receive_distance_m.push_back(footprint.plane_distance_m);
  }
  return std::make_shared<NativeHistory>(std::move(history));
}

}  // namespace tubefoot::python
