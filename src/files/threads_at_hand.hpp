// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace tubefoot {

/// How many threads can run at once, the caller's among them: 1 to `wanted`. The first time for so many, it
/// starts them and ends them. Where the space of addresses is limited, threads get no more than half of what
/// is left of it.
int threads_at_hand(int wanted);

/// Throws std::system_error where so many more threads cannot be started at once, for a library that ends the
/// program then.
void require_threads(int count);

}  // namespace tubefoot
