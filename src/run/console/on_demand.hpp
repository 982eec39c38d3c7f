// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <stdexcept>

namespace tubefoot {

/// Reports a library that cannot be loaded, with its file and its package.
struct LibraryMissing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A shared library that the program loads when it first calls one of its functions. The script
/// tools/on_demand writes such tables in assembly language, so that all members have 8 bytes.
struct LibraryOnDemand {
  /// A symbol of the library. If `bytes` is 0, it is a function, and `place` is the address to which its
  /// calls jump. Otherwise it is data of this size, constant after the initializer, and `place` is room for a
  /// copy.
  struct Symbol {
    const char* name;
    void* place;
    std::uint64_t bytes;
  };

  const char* file;             ///< name that the dynamic linker searches, such as "libgdal.so.32"
  const char* package;          ///< package that contains the file; empty if unknown
  const char* initializer;      ///< function that sets the variables of the library; empty if it needs none
  std::uint64_t address_bytes;  ///< address space that the library and its dependencies need at most
  std::uint64_t initializer_threads;  ///< threads that initializers start without a check
  const Symbol* symbols;
  std::uint64_t count;
  std::uint64_t is_loaded;
};

}  // namespace tubefoot

/// Loads the library unless it is loaded, and fills the places of all its symbols. Any thread may call it.
/// Throws LibraryMissing if there is no such library, if it lacks a symbol, or if its
/// initializer fails. Throws std::bad_alloc if its
/// addresses are not available, and std::system_error if its threads could not start.
/// Some functions of libraries are noexcept. The handler of std::terminate then reports the error
/// (run/console/exhausted.hpp).
extern "C" void tubefoot_load_on_demand(tubefoot::LibraryOnDemand* library);
