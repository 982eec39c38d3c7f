// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tubefoot {

/// A name as a shell reads it, quoted where it has to be.
std::string shell_word(const std::filesystem::path& file);

/// A name beside `file` at which there is nothing yet: "seabed.nc" gives "seabed_new.tif", or
/// "seabed_new2.tif" where the first is taken.
std::filesystem::path new_file_beside(const std::filesystem::path& file, std::string_view extension,
                                      int first = 1);

/// A command that messages advise, between backticks: `command` with its options, then the file that it reads
/// and a new one that it writes. It never writes into the user's own file. Words in capitals (EPSG:..., WEST)
/// are for the user to fill in. A test runs all of them as they stand.
std::string advised_command(std::string_view command, const std::filesystem::path& file,
                            std::string_view extension = ".tif");

/// The same of ogr2ogr, which names the new file first.
std::string advised_ogr2ogr(std::string_view options, const std::filesystem::path& file);

}  // namespace tubefoot
