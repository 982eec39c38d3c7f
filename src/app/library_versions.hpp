// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace tubefoot {

/// The libraries that results do not hang on, or only by their version's promise, a line each: what
/// `--version` says below the build (run/checkpoint/build_identity.hpp has those that decide bits). As they
/// are at hand now, where a library tells; else as it was compiled.
std::string library_versions();

}  // namespace tubefoot
