// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/recordings/sensor_kind.hpp"

#include <variant>

namespace tubefoot {

std::string kind_of(const SensorDescription& sensor) {
  struct Name {
    const char* operator()(const DidsonDescription&) const { return "didson"; }
    const char* operator()(const SidescanDescription&) const { return "sidescan"; }
    const char* operator()(const MultibeamDescription&) const { return "multibeam"; }
    const char* operator()(const ImagingDescription&) const { return "imaging"; }
    const char* operator()(const EchosounderDescription&) const { return "echosounder"; }
    const char* operator()(const InterferometricDescription&) const { return "interferometric"; }
  };
  return std::visit(Name(), sensor.kind);
}

}  // namespace tubefoot
