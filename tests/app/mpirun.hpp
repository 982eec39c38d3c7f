// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace tubefoot {

/// What is put before a command so that so many ranks of this machine run it, whoever starts it.
inline std::vector<std::string> mpirun(int ranks) {
  return {TUBEFOOT_MPIRUN,
          "--allow-run-as-root",
          "--oversubscribe",
          "--bind-to",
          "none",
          "--mca",
          "btl",
          "self,vader",
          "--mca",
          "oob_tcp_if_include",
          "lo",
          "-n",
          std::to_string(ranks)};
}

}  // namespace tubefoot
