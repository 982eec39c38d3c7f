// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "arrays.hpp"
#include "bindings.hpp"
#include "files/atomic_output.hpp"
#include "picture.hpp"
#include "result.hpp"
#include "run_apart.hpp"
#include "sensors/products/echo_picture.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace {

Canvas draw(const NativeResult& result, std::size_t sensor,
            const std::optional<std::vector<std::size_t>>& pings, std::optional<std::size_t> ping) {
  const ReadRecording read = result.read ? recording_of(*result.read, sensor) : ReadRecording{};
  const Recording& all = result.read ? read.recording : result.recordings.at(sensor);
  if (!pings) return draw_echoes(all, ping, label_font());
  return draw_echoes(picked(all, *pings).recording, ping, label_font());
}

std::shared_ptr<NativePicture> picture(const NativeResult& result, std::size_t sensor,
                                       const std::optional<std::vector<std::size_t>>& pings,
                                       std::optional<std::size_t> ping, const std::string& title) {
  std::shared_ptr<NativePicture> made;
  RunWatch watch;
  run_apart(watch, py::none(), [&] {
    made = std::make_shared<NativePicture>(NativePicture{draw(result, sensor, pings, ping), title});
  });
  return made;
}

/// Returns an array (height, width, 3) of uint8.
py::array pixels(const NativePicture& self) {
  const std::span<const float> components = self.canvas.components();
  std::vector<std::uint8_t> bytes(components.size());
  std::ranges::transform(components, bytes.begin(), [](float c) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(c, 0.0f, 1.0f)));
  });
  return array_of(bytes, std::size_t(self.canvas.width()) * 3)
      .reshape({py::ssize_t(self.canvas.height()), py::ssize_t(self.canvas.width()), py::ssize_t(3)});
}

py::bytes png(const NativePicture& self) {
  const std::vector<unsigned char> bytes = self.canvas.screen_png(self.title);
  return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

}  // namespace

void bind_picture(py::module_& module) {
  py::class_<NativePicture, std::shared_ptr<NativePicture>>(module, "Picture")
      .def_readonly("title", &NativePicture::title)
      .def("pixels", &pixels)
      .def("png", &png)
      .def("write", [](const NativePicture& self, const std::string& file) {
        OutputFile output(file, {});
        self.canvas.write_png(output.path(), self.title);
        output.commit();
      });
  module.def("picture", &picture);
}

}  // namespace tubefoot::python
