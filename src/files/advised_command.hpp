// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tubefoot {

/// Returns a name in the syntax of a shell, with quotes where they are necessary.
std::string shell_word(const std::filesystem::path& file);

/// Returns the name of a file that does not exist yet, in the folder of `file`: "seabed.nc" gives
/// "seabed_new.tif", or "seabed_new2.tif" if the first exists.
std::filesystem::path new_file_beside(const std::filesystem::path& file, std::string_view extension,
                                      int first = 1);

/// Returns a command that a message advises, between backticks: `command` with its options, the file that
/// it reads and a new file that it writes. The command never writes into the user's file. The user replaces
/// words in capitals (EPSG:..., WEST). A test runs all advised commands.
std::string advised_command(std::string_view command, const std::filesystem::path& file,
                            std::string_view extension = ".tif");

/// Returns the same for ogr2ogr, which names the new file first.
std::string advised_ogr2ogr(std::string_view options, const std::filesystem::path& file);

}  // namespace tubefoot
