// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "compare/output_models/output_model.hpp"
#include "scene/file/scene_file_keys.hpp"

namespace tubefoot {

/// A output model file (docs/output models.md).
struct OutputModel {
  SourcePlace place;
  std::string title;
  /// Echoes of the scene with every material's strength cos^1 of incidence, whose energies are solid angles
  /// over r^2; and that strength.
  std::optional<std::filesystem::path> solid_angles;
  double solid_angle_strength_db = 0;
  std::vector<OutputModelStep> steps;
};

/// Throws InputError at the line of what is wrong.
OutputModel read_output_model(const std::filesystem::path& file);

/// Every key of it, for the documentation's test.
std::vector<SceneKey> output_model_keys();

}  // namespace tubefoot
