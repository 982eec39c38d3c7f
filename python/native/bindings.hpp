// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

namespace tubefoot::python {

void bind_scene(pybind11::module_& module);
void bind_transmission(pybind11::module_& module);
void bind_run(pybind11::module_& module);
void bind_echo_file(pybind11::module_& module);
void bind_picture(pybind11::module_& module);
void bind_coverage(pybind11::module_& module);
void bind_study(pybind11::module_& module);
void bind_gradient(pybind11::module_& module);
void bind_footprints(pybind11::module_& module);
void bind_signals(pybind11::module_& module);

}  // namespace tubefoot::python
