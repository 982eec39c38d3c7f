// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/products/signal_files.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// The signals that a recording's elements received, on the axes of the vehicle. The recording must have
/// signals.
ElementSignals element_signals_of(const Recording& recording);

/// Writes the files of a recording's signals (write_signal_files()). Products that are impossible with these
/// numbers of pings and receivers are omitted, and `warnings` names them. A recording without signals, for
/// example one read from echoes.nc, has no files, and `warnings` says so. Throws InputError if memory does
/// not suffice.
std::vector<std::filesystem::path> write_array_files(const std::filesystem::path& folder,
                                                     const Recording& recording, const RunContext& run,
                                                     SignalProducts products,
                                                     std::vector<std::string>& warnings);
/// The omitted products, with reasons. Throws InputError if memory does not suffice for the rest.
std::vector<std::string> array_files_left_out(const Recording& recording, const RunContext& run,
                                              SignalProducts products);
WritingCost cost_of_array_files(const Recording& recording, const RunContext& run, SignalProducts products);

}  // namespace tubefoot
