// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "run/own_engine.hpp"

namespace tubefoot::python {

/// Returns an engine that calls `function` with a Transmission. The function returns a float64 array of
/// shape (beams of the transmission, samples), or (4, beams, samples) for two receivers. The Python package
/// checks shape and values. The engine can be called with or without the interpreter lock.
std::shared_ptr<const OwnEngine> own_engine(const std::string& name, const pybind11::object& function);

}  // namespace tubefoot::python
