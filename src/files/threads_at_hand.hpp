// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// Returns how many threads can run at once, including the caller: 1 to `wanted`. The first call for a
/// larger number starts and ends that many threads. If the address space is limited, threads get at most
/// half of the remaining space.
int threads_at_hand(int wanted);

/// Throws std::system_error if `count` further threads cannot be started at once. Call it before a library
/// that would end the program in this case.
void require_threads(int count);

}  // namespace tubefoot
