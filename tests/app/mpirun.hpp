// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace tubefoot {

/// What is put before a command so that so many ranks of this machine run it, whoever starts it.
inline std::vector<std::string> mpirun(int ranks) {
  return {TUBEFOOT_MPIRUN, "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "--mca", "btl",
          "self,vader", "--mca", "oob_tcp_if_include", "lo",
#ifdef TUBEFOOT_SANITIZED
          // Open MPI unloads its plugins, so that what they do not give back has no name to hush it by.
          "-x", "ASAN_OPTIONS=detect_leaks=0",
#endif
          "-n", std::to_string(ranks)};
}

}  // namespace tubefoot
