// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>

#include "run/survey.hpp"
#include "transmission.hpp"

namespace tubefoot::python {

/// A described scene, and, once somebody looks at it, the loaded one.
class NativeScene {
 public:
  explicit NativeScene(SceneDescription description) : description_(std::move(description)) {}
  const SceneDescription& description() const { return description_; }
  /// Loaded at the first call. Throws as open_survey(). Not to be called with the interpreter's lock held.
  std::shared_ptr<const Survey> survey();

 private:
  SceneDescription description_;
  std::mutex mutex_;
  std::shared_ptr<const Survey> survey_;
};

}  // namespace tubefoot::python
