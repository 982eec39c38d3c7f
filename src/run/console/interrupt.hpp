// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Installs the signal handlers of the program, once, at its start. A signal that is ignored at the start
/// (nohup) stays ignored.
/// * SIGINT (Ctrl-C), SIGTERM, SIGHUP (a closed terminal) and SIGXCPU (`ulimit -t`) request that all work
/// stops (stop_wanted() of geometry/steps/stop.hpp). A later SIGINT or SIGTERM ends the program immediately.
/// The system may repeat SIGHUP and SIGXCPU on its own, so that a repetition of these has no effect. After 5
/// s the program ends without a second signal, because a waiting library or system call does not check the
/// request.
/// * SIGPIPE and SIGXFSZ (`ulimit -f`) are ignored, because a failed write reports its own error.
/// * SIGQUIT keeps its default action, which ends the program with a core dump.
void take_signals();

}  // namespace tubefoot
