// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <string_view>

namespace tubefoot {

/// In place of an error that means that memory or threads have run out, in whichever words a library said so.
/// Empty for other errors.
std::string_view exhaustion_in_words(const std::exception& error);

/// For .preinit_array of a program: the loader calls it before the initializers of the libraries, some of
/// which start threads and do not look at what they are refused.
/// - Ends the program with a message and exit code 1 where a limit of addresses (`ulimit -v`) leaves less
/// than
///   they take.
/// - From then on an exception that nobody can catch, because a library throws it on a thread of its own or
///   before main(), ends the program in the same way if memory or threads have run out.
void before_libraries_start();

/// Once, as main() starts. Where the space of addresses is limited, threads share one heap, because each heap
/// of their own would take 64 MB of it.
void save_addresses();

}  // namespace tubefoot
