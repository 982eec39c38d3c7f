// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Runs the program and returns its exit code: 0 for success, 1 if the run fails, 2 for invalid input or an
/// invalid command line. The code is 3 if the error that `compare` measures exceeds the limit.
int run_command_line(int argc, char** argv);

}  // namespace tubefoot
