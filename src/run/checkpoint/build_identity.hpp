// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tubefoot {

/// What decides a result's bits beside scene and settings: the sources, the compiler and its flags, the
/// mathematical functions, the libraries that energies pass through, the byte order. Ranks work together, and
/// a kept run is gone on with, only where it is the same.
nlohmann::ordered_json build_identity();

/// The revision that it was built from, for people, with a mark for uncommitted changes; empty: from an
/// archive.
std::string build_revision();

/// What `theirs` has otherwise than `ours`, in words.
std::string difference_of_builds(const nlohmann::ordered_json& theirs, const nlohmann::ordered_json& ours);

/// What `--version` says below the version.
std::string build_in_words();

}  // namespace tubefoot
