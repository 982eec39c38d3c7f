// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/products/products.hpp"

namespace tubefoot {

/// Writes an acoustic camera's frames as its users' programs read them, and returns the file's name: a DIDSON
/// file <sensor>.ddf if the camera is no ARIS and has 48 or 96 beams of 512 samples over a window that
/// DIDSONs have codes for, else an ARIS file <sensor>.aris if it has 48, 64, 96 or 128 beams and a window in
/// whole microseconds; else nothing, and `warnings` says why neither.
///
/// Samples are levels as received (receiver_of), with one reference for the whole recording: the level that
/// one in a thousand of all echoes exceed is 255. The energies are read twice, ping by ping. Throws
/// std::runtime_error naming the file and what failed.
std::vector<std::filesystem::path> write_camera_files(const std::filesystem::path& folder,
                                                      const Recording& recording, const RunContext& run,
                                                      std::vector<std::string>& warnings);

/// Why there will be neither file, as far as that can be said before there are echoes.
std::vector<std::string> camera_files_left_out(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
