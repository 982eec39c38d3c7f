// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/description/sensor_description.hpp"

#include <stdexcept>

namespace tubefoot {

const SensorSection& SensorKeys::section() const {
  if (section_ == nullptr) throw std::logic_error("a sensor description has no kind");
  return *section_;
}

void SensorKeys::check(const std::type_info& requested) const {
  if (type_ == nullptr || *type_ != requested)
    throw std::logic_error("the keys of a sensor of kind '" + section().name() + "' have another type");
}

SensorFigures figures_of(const SensorDescription& sensor) { return sensor.kind.section().figures(sensor); }

}  // namespace tubefoot
