// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cpl_error.h>

#include <string>

#include "fuzz.hpp"

/// Collects GDAL's messages for our own messages, instead of printing them on the terminal.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  CPLSetErrorHandler([](CPLErr severity, CPLErrorNum, const char* text) {
    if (severity >= CE_Warning) tubefoot::fuzz::finding(std::string("GDAL speaks past the program: ") + text);
  });
  return 0;
}
