// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/kept/ping_store.hpp"
#include "run/survey.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot::python {

/// A finished run: everything that its arrays point into.
struct NativeResult {
  std::shared_ptr<Survey> survey;
  std::shared_ptr<PingStore> store;
  std::vector<Recording> recordings;
  Provenance provenance;
  std::string statistics;  ///< JSON
  std::vector<std::string> warnings;
};

}  // namespace tubefoot::python
