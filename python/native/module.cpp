// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include "bindings.hpp"
#include "files/input_error.hpp"
#include "files/usage_error.hpp"

namespace py = pybind11;

namespace {

/// The exceptions are Python's own classes (tubefoot/_errors.py), so that they have a place and can be
/// pickled.
void translate(std::exception_ptr raised) {
  const auto raise = [](const char* name, const auto&... arguments) {
    const py::object type = py::module_::import("tubefoot._errors").attr(name);
    PyErr_SetObject(type.ptr(), type(arguments...).ptr());
  };
  try {
    std::rethrow_exception(raised);
  } catch (const tubefoot::InputError& error) {
    raise("InputError", error.what(), error.place.file, error.place.line, error.place.column);
  } catch (const tubefoot::UsageError& error) {
    raise("UsageError", error.what());
  }
}

}  // namespace

PYBIND11_MODULE(_native, module) {
  module.doc() = "What tubefoot's Python functions call: see the package.";
  module.attr("version") = TUBEFOOT_VERSION;
  py::register_exception_translator(&translate);
  tubefoot::python::bind_scene(module);
  tubefoot::python::bind_shot(module);
  tubefoot::python::bind_run(module);
  tubefoot::python::bind_study(module);
  tubefoot::python::bind_footprints(module);
}
