// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "files/hdf5_chunks.hpp"
#include "files/reserved_space.hpp"

namespace tubefoot {

class EchoGroup;

/// A netCDF-4 file of echoes under construction, every call checked. What defines it and small variables are
/// written by netCDF; then values of pings, packed by all threads. It is made on the disk, in space that is
/// set aside for it before HDF5 writes anything (ReservedSpace says why): netCDF makes files in memory
/// without the creation order of their variables, and opens no such file to change it. Throws
/// std::runtime_error naming the file and what failed.
class EchoNetcdf {
 public:
  /// `small_bytes`: of all variables but those over pings, beams and samples.
  EchoNetcdf(std::filesystem::path path, std::size_t small_bytes);
  /// Removes what was not closed.
  ~EchoNetcdf();
  EchoNetcdf(const EchoNetcdf&) = delete;
  EchoNetcdf& operator=(const EchoNetcdf&) = delete;

  EchoGroup root();
  /// All is defined and written but the values of pings, which are of so many bytes.
  Hdf5Chunks& chunks(std::size_t bytes_of_values);
  void close();

 private:
  friend class EchoGroup;
  void check(int status, const std::string& task) const;
  void reserve(std::size_t bytes_of_values);
  void discard();

  std::filesystem::path path_;
  std::optional<ReservedSpace> space_;
  std::optional<Hdf5Chunks> chunks_;
  int id_ = 0;
  bool defining_ = false, finished_ = false;
};

/// One group (or the root) of it: all variables are defined first, then small ones written.
class EchoGroup {
 public:
  EchoGroup group(const std::string& name);
  int dimension(const std::string& name, std::size_t length);

  void attribute(const std::string& name, const std::string& text);
  void attribute(const std::string& name, double value);
  void attribute(int variable, const char* name, const std::string& text);

  /// A float64 variable without values; without `units` it says nothing of them.
  int define(const std::string& name, const std::vector<int>& dimensions, const std::string& units,
             const std::string& long_name);
  /// A float64 variable; its values are written by write().
  int variable(const std::string& name, const std::vector<int>& dimensions, const std::string& units,
               const std::string& long_name, std::vector<double> values);
  /// Values of this variable will be chunks: packed_chunk() says how they are compressed.
  void chunk(int variable, const std::string& name, const std::vector<std::size_t>& lengths);
  void write();

 private:
  friend class EchoNetcdf;
  EchoGroup(const EchoNetcdf& file, int id) : file_(&file), id_(id) {}
  void check(int status, const char* task, const std::string& name) const;

  struct Pending {
    std::string name;
    int id;
    std::vector<double> values;
  };
  const EchoNetcdf* file_;
  int id_;
  std::vector<Pending> pending_;
};

/// A variable over ping, beam and sample, whose values are written ping by ping, as packed_chunk() packs
/// them.
struct PingVariable {
  std::string name;
  std::function<std::vector<unsigned char>(std::size_t ping)> chunk;
};

/// Asked for by all threads, written in order, each variable `cells` values a ping; `group` is a full name
/// with its "/". After each ping `done` is told of it.
void write_pings(Hdf5Chunks& file, const std::string& group, const std::vector<PingVariable>& variables,
                 std::size_t pings, std::size_t cells, const std::function<void(std::size_t ping)>& done);

}  // namespace tubefoot
