// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "sensors/recordings/recording.hpp"
#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// Writes signals.nc (netCDF-4, docs/files-signals.md): complex pressures by ping, receiver and sample, with
/// all that ElementSignals has. Pings are packed by all threads and written in order; equal signals give
/// equal bytes. Throws std::invalid_argument as check() does and for a ping of more than 512 MB,
/// std::runtime_error naming the file and what failed.
void write_signals(const std::filesystem::path& file, const ElementSignals& signals,
                   const Provenance& provenance = {});

/// Reads one, tubefoot's own or a stranger's. Of a file whose time factor is exp(+i omega t) the conjugate is
/// taken. Throws InputError naming file and variable, what was found, what was expected and what to do.
ElementSignals read_signals(const std::filesystem::path& file);

}  // namespace tubefoot
