// SPDX-License-Identifier: GPL-3.0-or-later
#include "shot.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/sight/tube_engine.hpp"
#include "files/usage_error.hpp"
#include "run/abilities.hpp"
#include "run/settings.hpp"

namespace tubefoot::python {
namespace {

const SharedShots& group_of(const Survey& survey, const HeardShot& which) {
  const SensorPings& pings = survey.sensors.at(which.sensor);
  const std::string& name = pings.sensor->description().name;
  if (which.ping >= pings.times_s.size())
    throw UsageError(
        fmt::format("ping {}: sensor '{}' has pings 0 to {}", which.ping, name, pings.times_s.size() - 1));
  if (which.shot >= pings.sensor->shots())
    throw UsageError(fmt::format("shot {}: a ping of sensor '{}' has shots 0 to {}", which.shot, name,
                                 pings.sensor->shots() - 1));
  require_able(survey, {Feature::shot}, which.sensor);
  return *std::ranges::find_if(survey.shots, [&](const SharedShots& group) {
    return std::ranges::find(group.sensors, which.sensor) != group.sensors.end();
  });
}

}  // namespace

NativeShot::NativeShot(std::shared_ptr<const Survey> survey, HeardShot which,
                       std::shared_ptr<SharedVertices> vertices)
    : survey_(std::move(survey)),
      which_(which),
      ground_(ground_of(*survey_, group_of(*survey_, which), which.ping, which.shot)),
      tubes_(sensor().tubes(pose(), survey_->scene.grid, which.shot)),
      vertices_(ground_.is_own() ? std::make_shared<SharedVertices>() : std::move(vertices)) {}

const std::vector<glm::dvec3>& NativeShot::vertices_m() const {
  std::call_once(vertices_->once, [this] {
    const auto& vertices = ground_.mesh().vertices;
    vertices_->points_m.reserve(vertices.size());
    for (const GridPoint& p : vertices) vertices_->points_m.push_back(survey_->scene.grid.to_metres(p));
  });
  return vertices_->points_m;
}

std::shared_ptr<NativeHistory> NativeShot::trace() const {
  const Scene& scene = survey_->scene;
  const TubeEngine engine(ground_.mesh(), ground_.tree(), scene.grid.unit_m(),
                          options_of(scene.description.run));
  return std::make_shared<NativeHistory>(NativeHistory{shared_from_this(), engine.trace(tubes_)});
}

}  // namespace tubefoot::python
