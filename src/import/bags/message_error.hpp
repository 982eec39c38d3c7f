// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

namespace tubefoot {

/// A message does not hold what its type says. Whoever knows which message of which file it is makes an
/// InputError of it.
struct MessageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace tubefoot
