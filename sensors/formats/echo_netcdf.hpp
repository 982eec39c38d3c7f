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

/// A netCDF-4 file of echoes under construction. Every call is checked. netCDF writes definitions and small
/// variables in memory, because netCDF and HDF5 crash if a disk rejects a write. Values of pings follow,
/// packed by all threads. They are in memory up to 16 MB, and in reserved disk space (ReservedSpace) above.
/// netCDF can open the finished file to change it. Throws std::runtime_error that names the file and the
/// failed operation.
class EchoNetcdf {
 public:
  explicit EchoNetcdf(std::filesystem::path path);
  /// Removes a file that was not closed.
  ~EchoNetcdf();
  EchoNetcdf(const EchoNetcdf&) = delete;
  EchoNetcdf& operator=(const EchoNetcdf&) = delete;

  EchoGroup root();
  /// Ends the definitions; everything except the values of pings must be written. `bytes_of_values` is the
  /// size of these values.
  Hdf5Chunks& chunks(std::size_t bytes_of_values);
  void close();

 private:
  friend class EchoGroup;
  void check(int status, const std::string& task) const;
  void discard();

  std::filesystem::path path_;
  std::optional<ReservedSpace> space_;
  std::optional<Hdf5Chunks> chunks_;
  int id_ = 0;
  bool defining_ = false, finished_ = false;
};

/// One group (or the root) of the file. All variables are defined before small ones are written.
class EchoGroup {
 public:
  EchoGroup group(const std::string& name);
  int dimension(const std::string& name, std::size_t length);

  void attribute(const std::string& name, const std::string& text);
  void attribute(const std::string& name, double value);
  void attribute(int variable, const char* name, const std::string& text);
  void attribute(int variable, const char* name, double value);

  /// A float64 variable without values. Without `units` it has no such attribute.
  int define(const std::string& name, const std::vector<int>& dimensions, const std::string& units,
             const std::string& long_name);
  /// A float64 variable; write() writes its values.
  int variable(const std::string& name, const std::vector<int>& dimensions, const std::string& units,
               const std::string& long_name, std::vector<double> values);
  /// Stores the values of this variable as chunks, which packed_chunk() compresses.
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

/// A variable over ping, beam and sample. Its values are written ping by ping as chunks of packed_chunk().
struct PingVariable {
  std::string name;
  std::function<std::vector<unsigned char>(std::size_t ping)> chunk;
};

/// Writes the variables of all pings. All threads request chunks, which are written in order; each variable
/// has `cells` values per ping. `group` is a full name with its "/". Calls `done` after each ping.
void write_pings(Hdf5Chunks& file, const std::string& group, const std::vector<PingVariable>& variables,
                 std::size_t pings, std::size_t cells, const std::function<void(std::size_t ping)>& done);

}  // namespace tubefoot
