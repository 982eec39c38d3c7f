// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <string_view>

namespace tubefoot {

/// Returns a message to print instead of an error that means that memory or threads are exhausted, whichever
/// library reports it. Empty for other errors.
std::string_view exhaustion_in_words(const std::exception& error);

/// Hook for .preinit_array of a program. The loader calls it before the initializers of the libraries, some
/// of which start threads without checking for errors.
/// * If the address space (`ulimit -v`) is too small for the libraries, this function ends the program with a
/// message and exit code 1.
/// * From then on, an uncaught exception ends the program with a message if memory or threads are exhausted
/// or a library is missing. A library may throw on its own thread or before main(). A function that is
/// noexcept may be the first one to need a library on demand.
void before_libraries_start();

/// Call once at the start of main(). The heap keeps up to 128 MB of freed memory for the next ping. Pages
/// that the system takes back and gives again cost time. If the address space is limited, all threads share
/// one heap, because a heap of its own takes 64 MB of address space per thread.
void configure_heap();

}  // namespace tubefoot
