// SPDX-License-Identifier: GPL-3.0-or-later
// Writes netCDF-4 files through netCDF with reserved disk space: groups, dimensions, types, attributes and
// variables, with checked calls. Creation times are disabled, so that equal runs give equal files.

#include "sensors/formats/netcdf_stream.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "files/checked_file.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

namespace {

// HDF5 stores the time of day with every named type, so that equal runs give different files. The interface
// of netCDF has no option against it, but the defaults of HDF5 can be changed. HDF5 is a dependency of
// netCDF, not of this program; both symbols are looked up in the running program. Signature of HDF5 1.10:
// herr_t H5Pset_obj_track_times(hid_t, hbool_t).
void leave_out_type_times() {
  using SetTimes = int (*)(std::int64_t, bool);
  const auto set_times = reinterpret_cast<SetTimes>(dlsym(RTLD_DEFAULT, "H5Pset_obj_track_times"));
  const auto* defaults =
      static_cast<const std::int64_t*>(dlsym(RTLD_DEFAULT, "H5P_LST_DATATYPE_CREATE_ID_g"));
  if (set_times != nullptr && defaults != nullptr) set_times(*defaults, false);
}

}  // namespace

NetcdfStream::NetcdfStream(fs::path file) : file_(std::move(file)) {
  // Reserves space twice, because creating a file releases it.
  try {
    space_ = std::make_unique<ReservedSpace>(file_);
    space_->reserve(margin_bytes);
    check(nc_create(file_.c_str(), NC_NETCDF4 | NC_CLOBBER, &id_), "create the file");
    open_ = true;
    leave_out_type_times();
    space_->reserve(margin_bytes);
  } catch (...) {
    if (open_) nc_close(id_);
    if (space_) discard_file(file_);
    throw;
  }
}

NetcdfStream::NetcdfStream(fs::path file, Finished) : file_(std::move(file)) {
  try {
    space_ = std::make_unique<ReservedSpace>(file_);
    space_->reserve(margin_bytes);
    check(nc_open(file_.c_str(), NC_WRITE, &id_), "open the file again");
    open_ = true;
  } catch (...) {
    if (space_) discard_file(file_);
    throw;
  }
}

NetcdfStream::~NetcdfStream() {
  if (open_) nc_close(id_);
  space_.reset();
  if (!finished_) discard_file(file_);
}

void NetcdfStream::check(int status, const std::string& task) const {
  if (status != NC_NOERR) throw write_error(file_, fmt::format("cannot {}: {}", task, nc_strerror(status)));
}

void NetcdfStream::flush() { check(nc_sync(id_), "write the file"); }

void NetcdfStream::reopen() {
  space_->reserve(margin_bytes);
  open_ = false;
  check(nc_close(id_), "write the file");
  check(nc_open(file_.c_str(), NC_WRITE, &id_), "open the file again");
  open_ = true;
}

int NetcdfStream::group(const std::string& path) const {
  int group = id_;
  check(nc_inq_grp_full_ncid(id_, path.c_str(), &group), "find the group " + path);
  return group;
}

void NetcdfStream::finish() {
  space_->reserve(margin_bytes);
  open_ = false;
  check(nc_close(id_), "complete the file");
  space_.reset();
  finished_ = true;
}

void NetcdfGroup::check(int status, const char* task, const char* name) const {
  if (status != NC_NOERR) stream_->check(status, fmt::format("{} '{}'", task, name));
}

NetcdfGroup NetcdfGroup::group(const char* name) const {
  int id = 0;
  check(nc_def_grp(id_, name, &id), "define group", name);
  return {*stream_, id};
}

int NetcdfGroup::dimension(const char* name, std::size_t length) const {
  int dimension = 0;
  check(nc_def_dim(id_, name, length, &dimension), "define dimension", name);
  return dimension;
}

nc_type NetcdfGroup::enumeration(const char* name, std::initializer_list<Code> codes) const {
  nc_type type = 0;
  check(nc_def_enum(id_, NC_BYTE, name, &type), "define type", name);
  for (const Code& code : codes)
    check(nc_insert_enum(id_, type, code.name, &code.value), "define code", code.name);
  return type;
}

nc_type NetcdfGroup::float_list(const char* name) const {
  nc_type type = 0;
  check(nc_def_vlen(id_, name, NC_FLOAT, &type), "define type", name);
  return type;
}

void NetcdfGroup::attribute(int variable, const char* name, const std::string& text) const {
  check(nc_put_att_text(id_, variable, name, text.size(), text.c_str()), "write attribute", name);
}

void NetcdfGroup::attribute(int variable, const char* name, nc_type type,
                            const std::vector<double>& values) const {
  check(nc_put_att_double(id_, variable, name, type, values.size(), values.data()), "write attribute", name);
}

void NetcdfGroup::code_attribute(const char* name, nc_type enumeration, signed char code) const {
  check(nc_put_att(id_, NC_GLOBAL, name, enumeration, 1, &code), "write attribute", name);
}

int NetcdfGroup::define(const NetcdfVariable& row, std::size_t chunk_pings) const {
  int variable = 0;
  check(nc_def_var(id_, row.name, row.type, static_cast<int>(row.dimensions.size()), row.dimensions.data(),
                   &variable),
        "define variable", row.name);
  if (chunk_pings > 0) {
    std::vector<std::size_t> chunk{chunk_pings};
    for (std::size_t d = 1; d < row.dimensions.size(); ++d) {
      std::size_t length = 0;
      check(nc_inq_dimlen(id_, row.dimensions[d], &length), "read a dimension of", row.name);
      chunk.push_back(length);
    }
    check(nc_def_var_chunking(id_, variable, NC_CHUNKED, chunk.data()), "chunk variable", row.name);
  }
  if (row.type == NC_FLOAT) {
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    check(nc_def_var_fill(id_, variable, NC_FILL, &none), "define variable", row.name);
  }
  if (row.type == NC_DOUBLE) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    check(nc_def_var_fill(id_, variable, NC_FILL, &none), "define variable", row.name);
  }
  attribute(variable, "long_name", row.long_name);
  if (row.units) attribute(variable, "units", row.units);
  if (row.standard_name) attribute(variable, "standard_name", row.standard_name);
  if (!std::isnan(row.valid_max))
    attribute(variable, "valid_range", row.type, {row.valid_min, row.valid_max});
  else if (!std::isnan(row.valid_min))
    attribute(variable, "valid_min", row.type, {row.valid_min});
  return variable;
}

int NetcdfGroup::define_time(const char* name, int dimension, const char* long_name,
                             std::size_t chunk) const {
  const int variable = define(
      {name, NC_UINT64, {dimension}, "nanoseconds since 1970-01-01 00:00:00Z", long_name, "time"}, chunk);
  attribute(variable, "axis", "T");
  attribute(variable, "calendar", "gregorian");
  return variable;
}

void NetcdfGroup::put(const NetcdfVariable& row, const std::vector<double>& values) const {
  const int variable = define(row);
  if (row.type >= NC_FIRSTUSERTYPEID) {
    std::vector<signed char> codes(values.size());
    std::transform(values.begin(), values.end(), codes.begin(),
                   [](double value) { return static_cast<signed char>(value); });
    check(nc_put_var(id_, variable, codes.data()), "write variable", row.name);
  } else {
    check(nc_put_var_double(id_, variable, values.data()), "write variable", row.name);
  }
}

void NetcdfGroup::put_text(const char* name, int dimension, const char* long_name,
                           const std::vector<std::string>& values) const {
  const int variable = define({name, NC_STRING, {dimension}, nullptr, long_name});
  std::vector<const char*> texts;
  for (const std::string& value : values) texts.push_back(value.c_str());
  if (!texts.empty()) check(nc_put_var_string(id_, variable, texts.data()), "write variable", name);
}

}  // namespace tubefoot
