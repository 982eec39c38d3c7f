// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <vector>

namespace tubefoot::python {

/// Returns a read-only array over memory of `owner`, which the array keeps alive.
template <class T>
pybind11::array view(const T* first, std::vector<pybind11::ssize_t> shape,
                     std::vector<pybind11::ssize_t> strides, const pybind11::handle& owner) {
  namespace py = pybind11;
  if (first == nullptr) return py::array_t<T>(shape);  // an array without elements
  py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), first, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// Returns a view of one member of every element of a vector. If the member is an array of `width` values
/// of T, the shape is (n, width).
template <class T, class S, class Member>
pybind11::array view_of(const std::vector<S>& elements, Member S::*member, const pybind11::handle& owner,
                        std::size_t width = 1) {
  const auto* first = elements.empty() ? nullptr : reinterpret_cast<const T*>(&(elements.front().*member));
  std::vector<pybind11::ssize_t> shape{pybind11::ssize_t(elements.size())}, strides{sizeof(S)};
  if (width > 1) {
    shape.push_back(pybind11::ssize_t(width));
    strides.push_back(sizeof(T));
  }
  return view(first, std::move(shape), std::move(strides), owner);
}

/// Returns a view of the elements of a vector, each of which consists of `width` values of type T.
template <class T, class S>
pybind11::array view_of(const std::vector<S>& elements, const pybind11::handle& owner,
                        std::size_t width = 1) {
  static_assert(sizeof(S) % sizeof(T) == 0);
  const auto* first = elements.empty() ? nullptr : reinterpret_cast<const T*>(elements.data());
  std::vector<pybind11::ssize_t> shape{pybind11::ssize_t(elements.size())}, strides{sizeof(S)};
  if (width > 1) {
    shape.push_back(pybind11::ssize_t(width));
    strides.push_back(sizeof(T));
  }
  return view(first, std::move(shape), std::move(strides), owner);
}

/// Returns a copy.
template <class T>
pybind11::array_t<T> array_of(const std::vector<T>& values) {
  return pybind11::array_t<T>(pybind11::ssize_t(values.size()), values.data());
}

/// Returns a copy of shape (n, width).
template <class T>
pybind11::array array_of(const std::vector<T>& values, std::size_t width) {
  const std::vector<pybind11::ssize_t> shape{pybind11::ssize_t(values.size() / width),
                                             pybind11::ssize_t(width)};
  return pybind11::array_t<T>(shape, values.data());
}

}  // namespace tubefoot::python
