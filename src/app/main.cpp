// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command_line.hpp"
#include "run/console/exhausted.hpp"

#ifndef TUBEFOOT_SANITIZED  // sanitizers use this section for their own initializer
namespace {

void before_libraries(int, char**, char**) { tubefoot::before_libraries_start(); }
__attribute__((section(".preinit_array"), used)) void (*call_before_libraries)(int, char**,
                                                                               char**) = before_libraries;

}  // namespace
#endif

int main(int argc, char** argv) { return tubefoot::run_command_line(argc, argv); }
