// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "compare/output_models/output_model.hpp"
#include "scene/file/scene_file_keys.hpp"

namespace tubefoot {

/// An output model file (docs/engine-validation.md).
struct OutputModel {
  SourcePlace place;
  std::string title;
  /// Echoes of the scene in which every material has the strength cos^1 of the angle of incidence. Their
  /// energies are solid angles divided by r^2. `solid_angle_strength_db` is that strength.
  std::optional<std::filesystem::path> solid_angles;
  double solid_angle_strength_db = 0;
  std::vector<OutputModelStep> steps;
};

/// Throws InputError at the line of the error.
OutputModel read_output_model(const std::filesystem::path& file);

/// Returns every key of the file, for the test of the documentation.
std::vector<SceneKey> output_model_keys();

}  // namespace tubefoot
