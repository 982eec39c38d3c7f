// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tubefoot {

/// Returns the error of all writers: "FILE: cannot write the file: No space left on device". FILE is the
/// final name, also while the file is still in a staging folder (final_name() of staging.hpp).
std::runtime_error write_error(const std::filesystem::path& file, const std::string& what);
/// Returns the error of a system call that failed with this errno.
std::runtime_error write_error(const std::filesystem::path& file, int cause);

/// Writes a whole file. Throws write_error(), also if the disk becomes full with the last block. It removes
/// a file that could not be completed.
///
/// Use this function for data that is encoded in memory, because some encoding libraries do not handle a
/// full disk. OpenImageIO 2.4 ignores the result of closing a file. HDF5 1.10 keeps a file that it could
/// not close and crashes at program exit. Data too large for memory is streamed (StreamedFile,
/// ReservedSpace).
void write_file(const std::filesystem::path& file, std::span<const unsigned char> bytes);
void write_file(const std::filesystem::path& file, std::string_view text);

/// Removes a file that was not completed. It never removes a device or a link to one.
void discard_file(const std::filesystem::path& file);

}  // namespace tubefoot
