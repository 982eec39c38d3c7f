// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A netCDF-4 file that grows on the disk, its groups, and the definition of its variables from the tables of
// a convention. All disk space is reserved before HDF5 writes into it.

#include <netcdf.h>

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "files/reserved_space.hpp"

namespace tubefoot {

/// A netCDF-4 file that grows on the disk. All space is reserved before HDF5 writes into it (ReservedSpace).
class NetcdfStream {
 public:
  /// Space for the definitions of a file, and for the data that HDF5 keeps in memory until it is closed.
  static constexpr std::uintmax_t margin_bytes = 4 << 20;

  /// Throws std::runtime_error with the file's name and the reason.
  explicit NetcdfStream(std::filesystem::path file);
  /// Opens an existing file to add to it.
  struct Finished {};
  NetcdfStream(std::filesystem::path file, Finished);
  /// Removes an unfinished file.
  ~NetcdfStream();
  NetcdfStream(const NetcdfStream&) = delete;
  NetcdfStream& operator=(const NetcdfStream&) = delete;

  int id() const { return id_; }
  /// Call this function before `bytes` are written; the count should be generous.
  void reserve(std::uintmax_t bytes) { space_->reserve(bytes + margin_bytes); }
  /// Passes all written data to the system.
  void flush();
  /// Closes the file and opens it again, which frees HDF5's memory for it. Groups get new ids.
  void reopen();
  /// The id of a group by its full name.
  int group(const std::string& path) const;
  /// Closes the file.
  void finish();
  /// Throws std::runtime_error unless `status` is NC_NOERR.
  void check(int status, const std::string& task) const;

 private:
  std::filesystem::path file_;
  std::unique_ptr<ReservedSpace> space_;
  int id_ = 0;
  bool open_ = false, finished_ = false;
};

/// A variable with all data of its row in a convention's tables.
struct NetcdfVariable {
  const char* name;
  nc_type type;
  std::vector<int> dimensions;
  const char* units;  ///< nullptr: none
  std::string long_name;
  const char* standard_name = nullptr;
  double valid_min = std::numeric_limits<double>::quiet_NaN();  ///< with valid_max: valid_range
  double valid_max = std::numeric_limits<double>::quiet_NaN();
};

/// A group under construction.
class NetcdfGroup {
 public:
  NetcdfGroup(const NetcdfStream& stream, int id) : stream_(&stream), id_(id) {}

  int id() const { return id_; }
  NetcdfGroup group(const char* name) const;
  int dimension(const char* name, std::size_t length) const;
  struct Code {
    const char* name;
    signed char value;
  };
  nc_type enumeration(const char* name, std::initializer_list<Code> codes) const;
  nc_type float_list(const char* name) const;

  void attribute(const char* name, const std::string& text) const { attribute(NC_GLOBAL, name, text); }
  void attribute(int variable, const char* name, const std::string& text) const;
  void attribute(int variable, const char* name, nc_type type, const std::vector<double>& values) const;
  void code_attribute(const char* name, nc_type enumeration, signed char code) const;

  /// Defines a variable. Floats get NaN as _FillValue. Variables of unlimited length get chunks of
  /// `chunk_pings` along their first dimension.
  int define(const NetcdfVariable& variable, std::size_t chunk_pings = 0) const;
  /// Defines a time in ns since 1970, with its attributes.
  int define_time(const char* name, int dimension, const char* long_name, std::size_t chunk) const;
  /// A float, integer or enumeration variable with its values.
  void put(const NetcdfVariable& variable, const std::vector<double>& values) const;
  void put_text(const char* name, int dimension, const char* long_name,
                const std::vector<std::string>& values) const;

 private:
  void check(int status, const char* task, const char* name) const;
  const NetcdfStream* stream_;
  int id_;
};

}  // namespace tubefoot
