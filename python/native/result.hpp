// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/checkpoint/ping_store.hpp"
#include "run/survey.hpp"
#include "sensors/recordings/label_recording.hpp"
#include "sensors/recordings/read_recording.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot::python {

/// A finished run, or what one wrote, read back: everything that its arrays point into.
struct NativeResult {
  // Of a run:
  std::shared_ptr<const Survey> survey;
  std::shared_ptr<PingStore> store;
  std::vector<Recording> recordings;
  std::vector<LabelRecording> label_recordings;  ///< none unless asked for
  Provenance provenance;
  // Of an echo file:
  std::shared_ptr<const WholeEchoFile> read;  ///< null: of a run
  // Of both:
  std::string statistics;  ///< JSON
  std::vector<std::string> warnings;
};

/// What of a result is compared, as an echo file of it would say, which is called `called`.
std::shared_ptr<const EchoContents> contents_of(const NativeResult& result, const std::string& called);

/// What an echo file has of a sensor: every variable by its name, and what it says of each of those that
/// SensorEchoes does not know: dimensions, units and meaning.
pybind11::dict read_arrays(const pybind11::object& result, std::size_t sensor);
pybind11::dict read_attributes(const NativeResult& result, std::size_t sensor);
/// Whose each energy is, of a file that says so; names as `flag_meanings` has them. Else None.
pybind11::object read_labels(const pybind11::object& result, std::size_t sensor);
pybind11::dict dimensions_of(const NativeResult& result, std::size_t sensor);

}  // namespace tubefoot::python
