// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tubefoot {

/// Returns everything except scene and settings that determines the bits of a result. The entries are the
/// sources, the compiler and its flags, the mathematical functions, the libraries that process energies, and
/// the byte order. Ranks work together only if their build identities are equal. A run continues a
/// checkpoint only if the identity is equal.
nlohmann::ordered_json build_identity();

/// Returns the source revision of the build for people to read, with a mark for uncommitted changes. The
/// text is empty if the sources came from an archive.
std::string build_revision();

/// Returns a text that lists the entries in which `theirs` differs from `ours`.
std::string difference_of_builds(const nlohmann::ordered_json& theirs, const nlohmann::ordered_json& ours);

/// Returns the text that `--version` prints below the version.
std::string build_in_words();

}  // namespace tubefoot
