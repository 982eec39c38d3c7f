// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tubefoot {

/// A file of numbers that a glTF is read with.
struct GltfBuffer {
  std::string uri;             ///< as the glTF names it
  std::filesystem::path file;  ///< in the glTF's folder or below it
};

/// The buffers of a glTF (JSON or binary) that are files of their own, as it names them. Pictures are none:
/// they are not read. Throws InputError for a glTF that needs what is not read (another version, compressed
/// or deformed meshes), and for a buffer that is not there, or not in the glTF's folder or below it.
std::vector<GltfBuffer> gltf_buffers(const std::filesystem::path& gltf);

}  // namespace tubefoot
