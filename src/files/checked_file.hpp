// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>

namespace tubefoot {

/// Writes a whole file. Throws std::runtime_error with the file's name and the system's reason, a disk that
/// fills up with the last block included; a file that could not be completed is taken away.
///
/// For what is encoded in memory, because the libraries that encode it do not survive a full disk:
/// OpenImageIO 2.4 does not look at what closing a file returns, and HDF5 1.10 keeps the file that it could
/// not close and crashes when the program ends. What is too long for that is streamed (StreamedFile,
/// ReservedSpace).
void write_file(const std::filesystem::path& file, std::span<const unsigned char> bytes);

}  // namespace tubefoot
