// SPDX-License-Identifier: GPL-3.0-or-later
#include "own_echo.hpp"

#include <pybind11/numpy.h>

#include <algorithm>
#include <stdexcept>

#include "transmission.hpp"

namespace tubefoot::python {
namespace py = pybind11;

std::shared_ptr<const OwnEngine> own_engine(const std::string& name, const py::object& function) {
  // Threads that do not hold the interpreter lock create and release engines.
  const py::gil_scoped_acquire outer;
  const std::shared_ptr<py::object> held(new py::object(function), [](py::object* object) {
    const py::gil_scoped_acquire inner;
    delete object;
  });
  return std::make_shared<const OwnEngine>(
      OwnEngine{name, [held](const Transmission& received, std::size_t sensor, std::span<double> energy) {
                  const auto transmission = std::make_shared<NativeTransmission>(
                      received.survey(), received.request(),
                      ReceivedTransmission{sensor, received.ping(), received.number()});
                  const py::gil_scoped_acquire lock;
                  using Energies = py::array_t<double, py::array::c_style | py::array::forcecast>;
                  const auto values = (*held)(transmission).cast<Energies>();
                  if (std::size_t(values.size()) != energy.size())
                    throw std::length_error(
                        "the number of energies of a custom engine differs from that of the transmission");
                  std::copy_n(values.data(), energy.size(), energy.begin());
                }});
}

}  // namespace tubefoot::python
