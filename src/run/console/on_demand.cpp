// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/console/on_demand.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <atomic>
#include <cstring>
#include <mutex>
#include <span>
#include <string>

#include "files/memory_at_hand.hpp"
#include "files/threads_at_hand.hpp"

namespace tubefoot {
namespace {

[[noreturn]] void fail(const LibraryOnDemand& library, const std::string& why) {
  const std::string remedy = *library.package == '\0'
                                 ? "install it, or build tubefoot again"
                                 : fmt::format("install the package {}", library.package);
  throw LibraryMissing(fmt::format("cannot load a shared library: {}: {}", why, remedy));
}

void* address_of(const char* name, void* handle, const LibraryOnDemand& library) {
  if (void* const address = dlsym(handle, name)) return address;
  fail(library, fmt::format("{} has no symbol {}, so it is another version than at the time of the build",
                            library.file, name));
}

}  // namespace
}  // namespace tubefoot

void tubefoot_load_on_demand(tubefoot::LibraryOnDemand* library) {
  using namespace tubefoot;
  // Recursive, because initializers of a library may call a function of another one.
  static std::recursive_mutex mutex;
  const std::lock_guard lock(mutex);
  if (library->is_loaded != 0) return;
  require_addresses(library->address_bytes);
  if (library->initializer_threads > 0) require_threads(static_cast<int>(library->initializer_threads));
  // Lazy, as if the program were linked with it. Local, so that the loader does not search libraries that are
  // loaded later in this one. The library is never closed, because its threads and its functions at exit
  // remain.
  void* const handle = dlopen(library->file, RTLD_LAZY | RTLD_LOCAL);
  if (handle == nullptr) fail(*library, dlerror());
  if (*library->initializer != '\0') {
    const auto initialize = reinterpret_cast<int (*)()>(address_of(library->initializer, handle, *library));
    if (initialize() < 0) fail(*library, fmt::format("{} of {} fails", library->initializer, library->file));
  }
  const std::span symbols(library->symbols, library->count);
  for (const auto& [name, place, bytes] : symbols)
    if (bytes > 0) std::memcpy(place, address_of(name, handle, *library), bytes);
  // Other threads jump through these places without a lock.
  for (const auto& [name, place, bytes] : symbols)
    if (bytes == 0) std::atomic_ref(*static_cast<void**>(place)).store(address_of(name, handle, *library));
  library->is_loaded = 1;
}
