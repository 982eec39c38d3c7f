// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/signals/element_signals.hpp"

namespace tubefoot::python {

/// Signals of elements. They own the memory of arrays in Python.
struct NativeSignals {
  ElementSignals signals;
};

}  // namespace tubefoot::python
