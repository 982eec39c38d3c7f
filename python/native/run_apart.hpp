// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <functional>

#include "run/console/progress.hpp"

namespace tubefoot::python {

/// Does `work` on a thread of its own, without the interpreter's lock, while this thread looks for signals
/// and tells `progress` (None, or called with the pings finished and all pings). Ctrl-C, and whatever
/// `progress` throws, stops the work (geometry/steps/stop.hpp) and is raised once it has ended. Else throws
/// what the work throws. `look` is called with the lock as well, now and then and at the end, and may throw
/// as `progress` may.
void run_apart(
    RunWatch& watch, const pybind11::object& progress, const std::function<void()>& work,
    const std::function<void()>& look = [] {});

}  // namespace tubefoot::python
