// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/sensor.hpp"

namespace tubefoot {

/// All pings of one sensor, as they are written.
struct Recording {
  const Sensor* sensor = nullptr;
  std::vector<double> ping_time_s;
  std::vector<Pose> ping_pose;   ///< of the sensor
  std::vector<double> energy;    ///< [ping][beam][sample], J for a source of 1 J/sr at 1 m
  double sound_speed_m_s = 0;
  double absorption_db_per_km = 0;
};

/// Where a recording comes from; written as global attributes.
struct Provenance {
  std::string title, scene_hash, engine, arithmetic, version;
};

/// Writes echoes.nc (netCDF-4, docs/echo-file.md). One recording: variables in the root group. Several: one group
/// per sensor, named after it. Throws std::runtime_error naming the file and what failed.
void write_echoes(const std::filesystem::path& file, const std::vector<Recording>& recordings,
                  const Provenance& provenance);

/// Writes the pictures of a recording into `folder` and returns their file names, PNG (16 bit, for looking at,
/// logarithmic) and EXR (32-bit float, for measuring, linear energy).
/// Cameras: <sensor>-<ping>.png in true fan geometry with a range and angle frame, and <sensor>-<ping>.exr
/// (beams x samples, unscaled). Sidescan: <sensor>.png waterfall, one row a ping, port left, and <sensor>.exr.
std::vector<std::filesystem::path> write_pictures(const std::filesystem::path& folder, const Recording& recording);

}  // namespace tubefoot
