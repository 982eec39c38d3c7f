// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "sensors/recordings/recording.hpp"
#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// Writes signals.nc (netCDF-4, docs/output-files.md): complex pressures by ping, receiver and sample, with
/// all data of ElementSignals. All threads pack pings, which are written in order; equal signals give equal
/// bytes. Throws std::invalid_argument as check() does and for a ping of more than 512 MB. Throws
/// std::runtime_error that names the file and the failed operation.
void write_signals(const std::filesystem::path& file, const ElementSignals& signals,
                   const Provenance& provenance = {});

/// Reads a file of tubefoot or of another program. If the file's time factor is exp(+i omega t), the result
/// is the conjugate. Throws InputError that names file and variable, the value found, the expected value and
/// a remedy.
ElementSignals read_signals(const std::filesystem::path& file);

}  // namespace tubefoot
