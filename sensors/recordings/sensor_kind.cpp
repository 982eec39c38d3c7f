// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {

SensorDescription SensorKind::in_water(SensorDescription sensor, double, std::vector<std::string>*) const {
  return sensor;
}

std::vector<std::string> SensorKind::files_left_out(const Recording&, const RunContext&) const { return {}; }

std::vector<std::string> SensorKind::products() const { return {}; }

std::optional<SonarOutline> SensorKind::outline(const SensorDescription&) const { return std::nullopt; }
WritingCost SensorKind::writing_cost(const Recording&, const RunContext&) const { return {}; }

const SensorKind& kind_of(const SensorDescription& sensor) {
  return dynamic_cast<const SensorKind&>(sensor.kind.section());
}

SensorDescription in_water(const SensorDescription& sensor, double sound_speed_m_s,
                           std::vector<std::string>* notes) {
  return kind_of(sensor).in_water(sensor, sound_speed_m_s, notes);
}

std::unique_ptr<Sensor> make_sensor(const SensorDescription& description) {
  std::unique_ptr<Sensor> made = kind_of(description).model(description);
  made->refuse_narrow();
  return made;
}

}  // namespace tubefoot
