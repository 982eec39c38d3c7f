// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sensors/formats/netcdf_stream.hpp"
#include "sensors/formats/sonar_netcdf.hpp"

namespace tubefoot {

/// A variable that grows with the pings, and the function that fills a ping's row.
struct SonarNetcdfColumn {
  std::string name;
  int group = 0, variable = 0;
  nc_type type = NC_FLOAT;
  std::size_t per_ping = 1;
  std::function<void(const SonarNetcdfPing&, std::vector<double>&)> append;
};

/// The growing part of a SONAR-netCDF4 file.
struct SonarNetcdfLayout {
  static constexpr std::size_t chunk_pings = 16;
  std::vector<SonarNetcdfColumn> columns;
  struct Place {
    int group = 0, variable = 0;
  };
  /// Finds the groups again after NetcdfStream::reopen.
  void find_groups(const NetcdfStream& stream);
  std::map<std::string, int> groups;  ///< id by full name
  std::vector<Place> times;           ///< the ping's time, uint64 ns
  Place backscatter;                  ///< (ping, beam, subbeam) of float lists
  std::optional<Place> imaginary{};   ///< the same for the imaginary part of complex beams
};

/// Defines all groups, types, dimensions and variables of the convention, and writes the variables that do
/// not depend on pings. Throws std::runtime_error.
SonarNetcdfLayout define_sonar_netcdf(const NetcdfStream& stream, const SonarNetcdfHeader& header);

}  // namespace tubefoot
