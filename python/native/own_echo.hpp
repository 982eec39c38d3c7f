// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "run/own_engine.hpp"

namespace tubefoot::python {

/// An engine that calls `function` with a Transmission and takes the float64 array that it returns, of shape
/// (beams of the transmission, samples), or (4, beams, samples) with two receivers. The package has seen to
/// shape and values. Callable with or without the interpreter's lock.
std::shared_ptr<const OwnEngine> own_engine(const std::string& name, const pybind11::object& function);

}  // namespace tubefoot::python
