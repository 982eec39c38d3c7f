// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <functional>

#include "run/console/progress.hpp"

namespace tubefoot::python {

/// Executes `work` on a separate thread without the interpreter lock. Meanwhile this thread checks for
/// signals and calls `progress` (None, or called with the numbers of finished and of all pings).
///
/// Ctrl-C, or an exception of `progress`, stops the work (geometry/steps/stop.hpp) and is raised after its
/// end. Otherwise the function throws the exception of the work. It also calls `look` with the lock held,
/// repeatedly and at the end. `look` may throw as `progress` may.
void run_apart(
    RunWatch& watch, const pybind11::object& progress, const std::function<void()>& work,
    const std::function<void()>& look = [] {});

}  // namespace tubefoot::python
