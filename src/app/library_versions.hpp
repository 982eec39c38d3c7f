// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace tubefoot {

/// Returns one line per library on which results do not depend, or depend only through its documented
/// version. `--version` prints these lines below the build. run/checkpoint/build_identity.hpp lists the
/// libraries that determine bits of the results. The version is that of the loaded library if the library
/// reports it, otherwise that at compile time.
std::string library_versions();

}  // namespace tubefoot
