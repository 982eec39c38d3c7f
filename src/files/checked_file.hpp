// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tubefoot {

/// What all say that write: "FILE: cannot write the file: No space left on device". FILE is the name that it
/// will have, where it is still being written in another place (final_name() of staging.hpp).
std::runtime_error write_error(const std::filesystem::path& file, const std::string& what);
/// Of a call to the system that failed with this errno.
std::runtime_error write_error(const std::filesystem::path& file, int cause);

/// Writes a whole file. Throws write_error(), a disk that fills up with the last block included; a file that
/// could not be completed is taken away.
///
/// For what is encoded in memory, because the libraries that encode it do not survive a full disk:
/// OpenImageIO 2.4 does not look at what closing a file returns, and HDF5 1.10 keeps the file that it could
/// not close and crashes when the program ends. What is too long for that is streamed (StreamedFile,
/// ReservedSpace).
void write_file(const std::filesystem::path& file, std::span<const unsigned char> bytes);
void write_file(const std::filesystem::path& file, std::string_view text);

/// Takes away a file that was not completed: never a device, nor a link to one.
void discard_file(const std::filesystem::path& file);

}  // namespace tubefoot
