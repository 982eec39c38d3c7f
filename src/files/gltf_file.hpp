// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tubefoot {

/// A separate file with the numbers of a glTF.
struct GltfBuffer {
  std::string uri;             ///< URI in the glTF
  std::filesystem::path file;  ///< a file in the glTF's folder or below it
};

/// Returns the buffers of a glTF (JSON or binary) that are separate files. Pictures are not included,
/// because they are not read. Throws InputError if a buffer does not exist or lies outside of the glTF's
/// folder. The same holds for a glTF that needs unsupported features (another version, compressed or
/// deformed meshes).
std::vector<GltfBuffer> gltf_buffers(const std::filesystem::path& gltf);

}  // namespace tubefoot
