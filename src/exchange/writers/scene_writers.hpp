// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "exchange/exchanged_scene.hpp"

namespace tubefoot {

/// What was written into a folder.
struct WrittenScene {
  std::vector<std::string> files;  ///< names in the folder, the one to open first
  std::vector<std::string> notes;  ///< what this engine cannot have as it is, a line each
};

/// Writes the scene for an engine into a folder that is there, with README.txt, which says all that the
/// engine's own file cannot. Throws std::runtime_error where the disk refuses.
WrittenScene write_scene(ExchangeFormat format, const ExchangedScene& scene,
                         const std::filesystem::path& folder);

// One for each format, without README.txt.
WrittenScene write_obj_scene(const ExchangedScene& scene, const std::filesystem::path& folder);
WrittenScene write_gltf_scene(const ExchangedScene& scene, const std::filesystem::path& folder);
WrittenScene write_sdf_scene(const ExchangedScene& scene, const std::filesystem::path& folder);
WrittenScene write_stonefish_scene(const ExchangedScene& scene, const std::filesystem::path& folder);
WrittenScene write_holoocean_scene(const ExchangedScene& scene, const std::filesystem::path& folder);

/// How ours become theirs, in a few lines, for a comment in each file.
std::string axes_words(ExchangeFormat format);
/// One OBJ for each piece, in an engine's world axes. Returns their names.
std::vector<std::string> write_piece_meshes(ExchangeFormat format, const ExchangedScene& scene,
                                            const std::filesystem::path& folder);
/// A grey that shows how strongly a material scatters: 0.1 to 0.9.
double grey_of(const ExchangedMaterial& material);

}  // namespace tubefoot
