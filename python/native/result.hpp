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

/// A finished run, or an echo file that was read. It owns the memory of its arrays.
struct NativeResult {
  // For a run:
  std::shared_ptr<const Survey> survey;
  std::shared_ptr<PingStore> store;
  std::vector<Recording> recordings;
  std::vector<LabelRecording> label_recordings;  ///< empty unless requested
  Provenance provenance;
  // For an echo file:
  std::shared_ptr<const WholeEchoFile> read;  ///< null for a run
  // For both:
  std::string statistics;  ///< JSON
  std::vector<std::string> warnings;
};

/// Returns the contents of a result as if read from an echo file with the name `called`.
std::shared_ptr<const EchoContents> contents_of(const NativeResult& result, const std::string& called);

/// Returns the variables of a sensor in an echo file by name. read_attributes() returns the dimensions,
/// units and meaning of those that SensorEchoes lacks.
pybind11::dict read_arrays(const pybind11::object& result, std::size_t sensor);
pybind11::dict read_attributes(const NativeResult& result, std::size_t sensor);
/// Returns the labels of the energies if the file has them, with names as in `flag_meanings`; otherwise
/// None.
pybind11::object read_labels(const pybind11::object& result, std::size_t sensor);
pybind11::dict dimensions_of(const NativeResult& result, std::size_t sensor);

}  // namespace tubefoot::python
