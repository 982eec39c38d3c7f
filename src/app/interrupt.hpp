// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// While one lives, Ctrl-C (and SIGTERM) asks the run to stop instead of killing it, so that nothing
/// half-written is left behind; a second one kills.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  static bool requested();
  /// As if the user had asked.
  static void request();
};

/// Thrown out of a ping that is left unfinished because somebody wants to stop.
struct Interrupted {};

}  // namespace tubefoot
