// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/gdal_messages.hpp"

#include <cpl_error.h>
#include <dlfcn.h>
#include <fmt/core.h>

#include <cstdint>

namespace tubefoot {
namespace {

// HDF5, which GDAL's BAG and netCDF drivers use, prints its error stack to stderr by default, separately in
// each thread. Only GDAL depends on HDF5 here, so that the function is looked up in the running program
// instead of linked. Its signature in HDF5 1.10 and later is: herr_t H5Eset_auto2(hid_t stack, H5E_auto2_t
// function, void* data).
void silence_hdf5() {
  using SetAuto = int (*)(std::int64_t, void*, void*);
  const auto set_auto = reinterpret_cast<SetAuto>(dlsym(RTLD_DEFAULT, "H5Eset_auto2"));
  constexpr std::int64_t kDefaultStack = 0;
  if (set_auto != nullptr) set_auto(kDefaultStack, nullptr, nullptr);
}

}  // namespace

// The data of the handler is the object itself, which is never moved or copied.
GdalMessages::GdalMessages() {
  const auto handler = [](CPLErr severity, CPLErrorNum, const char* text) {
    auto* self = static_cast<GdalMessages*>(CPLGetErrorHandlerUserData());
    if (severity == CE_Warning) self->warnings_.emplace_back(text);
    if (severity == CE_Failure || severity == CE_Fatal) self->failures_.emplace_back(text);
  };
  CPLPushErrorHandlerEx(handler, this);
  silence_hdf5();
}

GdalMessages::~GdalMessages() { CPLPopErrorHandler(); }

std::string GdalMessages::in_brackets() const {
  return failures_.empty() ? std::string() : fmt::format(" (GDAL: {})", failures_.front());
}

}  // namespace tubefoot
