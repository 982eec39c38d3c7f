// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// The program. Returns its exit code: 0 done, 1 the run failed, 2 the input or the command line is wrong,
/// 3 `compare` found more error than was allowed.
int run_command_line(int argc, char** argv);

}  // namespace tubefoot
