// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/products/received.hpp"

namespace tubefoot {

/// Writes an acoustic camera's frames in the format of its users' programs, and returns the file's name. A
/// camera that is no ARIS gets a DIDSON file <sensor>.ddf if it has 48 or 96 beams of 512 samples. Its range
/// gate must have codes of a DIDSON. Otherwise the result is an ARIS file <sensor>.aris if the camera has
/// 48, 64, 96 or 128 beams and a range gate in whole microseconds. If neither is possible, nothing is
/// written, and `warnings` has the reasons.
///
/// Samples are levels as received (receiver_of), with one reference for the whole recording. Code 255 is the
/// level that one in a thousand of all echoes exceed. The energies are read twice, ping by ping. Throws
/// std::runtime_error that names the file and the failed operation.
std::vector<std::filesystem::path> write_camera_files(const std::filesystem::path& folder,
                                                      const Recording& recording, const RunContext& run,
                                                      std::vector<std::string>& warnings);

/// Names of these products (SensorKind::products()).
std::vector<std::string> camera_file_products();

/// True if one of the files is possible and not omitted.
bool has_camera_file(const Recording& recording, const RunContext& run);

/// Reasons for the absence of both files, as far as they are known before echoes exist.
std::vector<std::string> camera_files_left_out(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
