// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/products/signal_products.hpp"
#include "sensors/recordings/run_context.hpp"
#include "sensors/recordings/writing_cost.hpp"

namespace tubefoot {

/// Writes the files and pictures of signals with phase (docs/output-files.md). Returns the files' names,
/// relative to `folder`, which must exist:
/// - <name>-signals.nc;
/// - <name>-signals.png: levels and phases of the elements;
/// - <name>-fan.png: beams of a ping by range and angle;
/// - <name>-sidescan.png: a waterfall of beams abeam, and <name>.jsf of them;
/// - <name>-beams.png, <name>-soundings.csv and .gpkg: of a fan across the track;
/// - <name>-aperture.png: a synthetic aperture and the real one, on one map;
/// - <name>-interferogram.png: phases and coherence of two groups of receivers;
/// - <name>-sonar.nc: complex beams as SONAR-netCDF4.
/// Pings are compressed one by one, except for a synthetic aperture, which needs all of them. Signals that
/// are 0 have no pictures, and `warnings` says so. Throws std::invalid_argument as both check() functions
/// do, and std::runtime_error that names the file and the failed operation. `recorded`, if not null, has the
/// same pressures with the geometry and the sound speed that the software of the sonar assumes. All files
/// except <name>-signals.nc are made of it.
std::vector<std::filesystem::path> write_signal_files(const std::filesystem::path& folder,
                                                      const ElementSignals& signals,
                                                      const SignalProducts& products, const RunContext& run,
                                                      std::vector<std::string>& warnings,
                                                      const ElementSignals* recorded = nullptr);

/// Names of these products (SensorKind::products()).
std::vector<std::string> signal_file_products();

/// The products that are necessary for the files that a run does not omit.
SignalProducts without_omitted(SignalProducts products, const OmittedProducts& omitted);

/// Approximate cost of these files. `omitted`: see RunContext.
WritingCost cost_of_signal_files(const SignalProducts& products, const SignalCounts& counts,
                                 const PictureSettings& settings, const OmittedProducts& omitted = {});
/// Upper bound of the memory in bytes, in addition to the signals themselves.
double memory_of_signal_files(const SignalProducts& products, const SignalCounts& counts);

}  // namespace tubefoot
