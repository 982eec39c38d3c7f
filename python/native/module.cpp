// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "files/input_error.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"

namespace py = pybind11;

namespace {

/// The exceptions are Python's own classes (tubefoot/_errors.py), so that they have a place and can be
/// pickled; their texts are those of the command line in Python's words.
void translate(std::exception_ptr raised) {
  const auto raise = [](const char* name, const char* text, const auto&... arguments) {
    const py::module_ errors = py::module_::import("tubefoot._errors");
    const py::object type = errors.attr(name);
    PyErr_SetObject(type.ptr(), type(errors.attr("in_python")(text), arguments...).ptr());
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
  module.def("nearest", [](const std::string& word, const std::vector<std::string>& candidates) {
    return std::string(tubefoot::nearest(word, candidates));
  });
  tubefoot::python::bind_scene(module);
  tubefoot::python::bind_shot(module);
  tubefoot::python::bind_run(module);
  tubefoot::python::bind_echo_file(module);
  tubefoot::python::bind_picture(module);
  tubefoot::python::bind_coverage(module);
  tubefoot::python::bind_study(module);
  tubefoot::python::bind_footprints(module);
  tubefoot::python::bind_signals(module);
}
