// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <fstream>

#include "fuzz.hpp"

// Watches a file that inputs name as a part of a coordinate reference system, and that no library may open.
namespace tubefoot::fuzz {

/// While an object lives, opening the file is a finding. Seeds name this file (tests/fuzz/seeds).
class NamedFile {
 public:
  static constexpr const char* name = "/tmp/tubefoot-fuzz-named";

  NamedFile() { forget(); }
  ~NamedFile() {
    if (forget()) finding(std::string("an input had ") + name + " opened");
  }
  NamedFile(const NamedFile&) = delete;
  NamedFile& operator=(const NamedFile&) = delete;

 private:
  /// Returns whether the file was opened since the last call.
  static bool forget() {
    static const int watch = [] {
      std::ofstream(name) << "named\n";
      const int made = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
      if (made < 0 || inotify_add_watch(made, name, IN_OPEN) < 0) finding("no watch of the named file");
      return made;
    }();
    alignas(inotify_event) std::array<char, 4096> events;
    bool opened = false;
    while (read(watch, events.data(), events.size()) > 0) opened = true;
    return opened;
  }
};

}  // namespace tubefoot::fuzz
