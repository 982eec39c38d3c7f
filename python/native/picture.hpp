// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/pictures/canvas.hpp"

namespace tubefoot::python {

/// A drawn picture and its title.
struct NativePicture {
  Canvas canvas;
  std::string title;
};

}  // namespace tubefoot::python
