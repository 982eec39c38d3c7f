// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/products/signal_files.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// What a recording's elements received, on the axes of the vehicle that carries them. The recording has
/// signals.
ElementSignals element_signals_of(const Recording& recording);

/// The files that become of a recording's signals (write_signal_files()), but for products that cannot be
/// made of so many pings and receivers, which `warnings` name. Of a recording without signals, as echoes.nc
/// gives one back, there are none, and `warnings` says so. Throws InputError where there is no memory for
/// them.
std::vector<std::filesystem::path> write_array_files(const std::filesystem::path& folder,
                                                     const Recording& recording, const RunContext& run,
                                                     SignalProducts products,
                                                     std::vector<std::string>& warnings);
/// Those products, and why. Throws InputError where there is no memory for the rest.
std::vector<std::string> array_files_left_out(const Recording& recording, const RunContext& run,
                                              SignalProducts products);
WritingCost cost_of_array_files(const Recording& recording, const RunContext& run, SignalProducts products);

}  // namespace tubefoot
