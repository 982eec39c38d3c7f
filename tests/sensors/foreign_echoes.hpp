// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <netcdf.h>

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

// Another engine's echo file, written piece by piece with netCDF's own functions, so that any piece of it can
// be wrong.
namespace tubefoot {

struct ForeignVariable {
  std::vector<std::string> dimensions;
  std::optional<std::string> units;
  std::vector<double> values;  ///< empty: never written
  nc_type type = NC_DOUBLE;
  std::optional<double> fill = {};
};

struct ForeignGroup {
  std::vector<std::pair<std::string, std::size_t>> dimensions;
  std::map<std::string, ForeignVariable> variables;
  std::map<std::string, std::string> attributes;
};

/// The least that a comparison needs: two pings of three beams with four samples from 2 m on, 0.5 m apart;
/// energies 1e-9, 2e-9 and so on, every fifth 0.
inline ForeignGroup least_echoes() {
  ForeignGroup group;
  group.dimensions = {{"ping", 2}, {"beam", 3}, {"sample", 4}};
  std::vector<double> energies;
  for (int k = 0; k < 24; ++k) energies.push_back(k % 5 == 0 ? 0 : k * 1e-9);
  group.variables = {{"energy", {{"ping", "beam", "sample"}, "J", energies}},
                     {"slant_range", {{"sample"}, "m", {2, 2.5, 3, 3.5}}},
                     {"beam_azimuth", {{"beam"}, "degree", {-10, 0, 10}}}};
  return group;
}

namespace foreign {

inline void require(int status) {
  if (status != NC_NOERR) throw std::logic_error(nc_strerror(status));
}

inline void define(int id, const ForeignGroup& group) {
  for (const auto& [name, text] : group.attributes)
    require(nc_put_att_text(id, NC_GLOBAL, name.c_str(), text.size(), text.c_str()));
  std::map<std::string, int> dimensions;
  for (const auto& [name, length] : group.dimensions)
    require(nc_def_dim(id, name.c_str(), length, &dimensions[name]));
  for (const auto& [name, variable] : group.variables) {
    std::vector<int> ids;
    for (const std::string& dimension : variable.dimensions) ids.push_back(dimensions.at(dimension));
    int v = 0;
    require(nc_def_var(id, name.c_str(), variable.type, int(ids.size()), ids.data(), &v));
    if (variable.units)
      require(nc_put_att_text(id, v, "units", variable.units->size(), variable.units->c_str()));
    if (variable.fill) require(nc_put_att_double(id, v, "_FillValue", variable.type, 1, &*variable.fill));
    if (variable.values.empty() && !ids.empty()) {  // what is never written must not take room
      const std::vector<std::size_t> chunk(ids.size(), 1);
      nc_def_var_chunking(id, v, NC_CHUNKED, chunk.data());
    }
  }
}

inline void fill(int id, const ForeignGroup& group) {
  for (const auto& [name, variable] : group.variables) {
    if (variable.values.empty()) continue;
    int v = 0;
    require(nc_inq_varid(id, name.c_str(), &v));
    require(nc_put_var_double(id, v, variable.values.data()));
  }
}

}  // namespace foreign

/// Writes the root and groups by name; `mode` as for nc_create (NC_NETCDF4, or 0 for the classic format).
inline std::filesystem::path write_foreign(const std::filesystem::path& file, const ForeignGroup& root,
                                           const std::map<std::string, ForeignGroup>& groups = {},
                                           int mode = NC_NETCDF4) {
  int id = 0;
  foreign::require(nc_create(file.c_str(), NC_CLOBBER | mode, &id));
  foreign::define(id, root);
  for (const auto& [name, group] : groups) {
    int g = 0;
    foreign::require(nc_def_grp(id, name.c_str(), &g));
    foreign::define(g, group);
  }
  foreign::require(nc_enddef(id));
  foreign::fill(id, root);
  for (const auto& [name, group] : groups) {
    int g = 0;
    foreign::require(nc_inq_grp_ncid(id, name.c_str(), &g));
    foreign::fill(g, group);
  }
  foreign::require(nc_close(id));
  return file;
}

}  // namespace tubefoot
