// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/signals/element_signals.hpp"

namespace tubefoot::python {

/// What elements receive: what arrays in Python point into.
struct NativeSignals {
  ElementSignals signals;
};

}  // namespace tubefoot::python
