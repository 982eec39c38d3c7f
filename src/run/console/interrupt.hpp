// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// What signals do to the program, set once, as it starts. What it finds ignored (nohup) stays so.
/// - SIGINT (Ctrl-C), SIGTERM, SIGHUP (a closed terminal) and SIGXCPU (`ulimit -t`) ask all work to stop
///   (stop_wanted() of geometry/steps/stop.hpp); SIGINT or SIGTERM after that ends the program where it
///   stands. A closed terminal and a used up limit come more than once of themselves: they do not count
///   twice. After 5 s the program ends where it stands without a second signal, because a library or a call
///   of the system that waits does not look at the request.
/// - SIGPIPE and SIGXFSZ (`ulimit -f`) are ignored: a write that fails says so.
/// - SIGQUIT is left alone: it is for who wants the program dead, and a core of it.
void take_signals();

}  // namespace tubefoot
