// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>

namespace tubefoot {

/// Has `write` make a file beside its place and then moves it there: an earlier one outlives a failure, and
/// no half one is seen. What is no ordinary file (/dev/stdout) is written as it is. Failures name `file`.
void replace_file(const std::filesystem::path& file,
                  const std::function<void(const std::filesystem::path&)>& write);

}  // namespace tubefoot
