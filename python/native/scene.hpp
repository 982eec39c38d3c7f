// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>

#include "run/survey.hpp"
#include "transmission.hpp"

namespace tubefoot::python {

/// A scene description, and the loaded scene after the first access.
class NativeScene {
 public:
  explicit NativeScene(SceneDescription description) : description_(std::move(description)) {}
  const SceneDescription& description() const { return description_; }
  /// Loads the scene at the first call. Throws as open_survey() does. The caller must not hold the
  /// interpreter lock.
  std::shared_ptr<const Survey> survey();

 private:
  SceneDescription description_;
  std::mutex mutex_;
  std::shared_ptr<const Survey> survey_;
};

}  // namespace tubefoot::python
