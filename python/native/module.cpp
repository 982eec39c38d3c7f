// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <string>

#include "bindings.hpp"
#include "files/absolute_path.hpp"
#include "files/input_error.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"

namespace py = pybind11;

namespace {

/// Raises C++ exceptions as the classes of tubefoot/_errors.py. These classes are defined in Python, so
/// that they have a source place and can be pickled. Their texts are those of the command line in the terms
/// of Python.
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
  } catch (const std::filesystem::filesystem_error& error) {
    raise("UsageError", tubefoot::message_of(error).c_str());
  }
}

/// Replaces the constructor function of a class.
PyObject* made_by_functions_alone(PyTypeObject* type, PyObject*, PyObject*) {
  PyErr_Format(PyExc_TypeError, "%.200s: only functions of tubefoot create objects of this class",
               type->tp_name);
  return nullptr;
}

/// Prevents Python from creating objects of the classes of the module without contents, and from changing the
/// class of an object. The next function that receives such an object would get uninitialised memory from
/// pybind11. The library pybind11 itself creates objects without the function that is replaced here.
void close_classes(const py::module_& module) {
  for (const auto& [name, item] : py::dict(module.attr("__dict__"))) {
    if (!PyType_Check(item.ptr())) continue;
    auto* type = reinterpret_cast<PyTypeObject*>(item.ptr());
    const std::string called = type->tp_name;
    const py::cpp_function refuse([called](const py::args&, const py::kwargs&) {
      throw py::type_error(called + ": only functions of tubefoot create objects of this class");
    });
    item.attr("__new__") = py::staticmethod(refuse);
    // Also covers calls of __new__ of a base class, because Python compares this function with that of the
    // base.
    type->tp_new = made_by_functions_alone;
#if PY_VERSION_HEX >= 0x030A0000
    type->tp_flags |= Py_TPFLAGS_IMMUTABLETYPE;
#endif
    PyType_Modified(type);
  }
}

}  // namespace

PYBIND11_MODULE(_native, module) {
  module.doc() = "Native functions of the package tubefoot. Use the package instead.";
  module.attr("version") = TUBEFOOT_VERSION;
  py::register_exception_translator(&translate);
  module.def("nearest", [](const std::string& word, const std::vector<std::string>& candidates) {
    return std::string(tubefoot::nearest(word, candidates));
  });
  module.def("absolute_path", [](const std::string& file) { return tubefoot::absolute_path(file).string(); });
  tubefoot::python::bind_scene(module);
  tubefoot::python::bind_transmission(module);
  tubefoot::python::bind_run(module);
  tubefoot::python::bind_echo_file(module);
  tubefoot::python::bind_picture(module);
  tubefoot::python::bind_coverage(module);
  tubefoot::python::bind_study(module);
  tubefoot::python::bind_gradient(module);
  tubefoot::python::bind_footprints(module);
  tubefoot::python::bind_signals(module);
  close_classes(module);
}
