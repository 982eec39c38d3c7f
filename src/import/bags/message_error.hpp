// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

namespace tubefoot {

/// The contents of a message do not match its type. Callers that know the file and the number of the
/// message convert it to an InputError.
struct MessageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace tubefoot
