// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tubefoot {

class Hdf5Handle;

/// A chunk's values as HDF5's filters shuffle and deflate make them of it: bytes of equal weight side by
/// side, then a zlib stream. The same bytes on any thread. Throws std::bad_alloc.
std::vector<unsigned char> packed_chunk(std::span<const double> values);
/// The most bytes that a chunk of so many values can be packed into.
std::size_t most_packed_bytes(std::size_t values);
/// The values of a packed chunk; whether it is one of exactly so many. Throws std::bad_alloc.
bool unpack_chunk(std::span<const unsigned char> packed, std::span<double> values);

/// The bytes of an HDF5 file without variables. Its root keeps the order in which they are made: netCDF opens
/// no other file for writing (nc_create_mem() makes such files). `path` is the name in errors. Throws
/// std::runtime_error.
std::vector<unsigned char> empty_hdf5_file(const std::filesystem::path& path);

/// An HDF5 file (netCDF-4) that is finished but for the values of compressed variables: their chunks are
/// written as they were packed, by other threads, say. Throws std::runtime_error naming the file and what
/// failed.
class Hdf5Chunks {
 public:
  /// On the disk, where all space that they take must have been reserved (ReservedSpace).
  explicit Hdf5Chunks(std::filesystem::path file);
  /// In memory: the bytes of a file of this name, which is written as it is closed.
  Hdf5Chunks(std::filesystem::path file, std::span<const unsigned char> image);
  ~Hdf5Chunks();
  Hdf5Chunks(const Hdf5Chunks&) = delete;
  Hdf5Chunks& operator=(const Hdf5Chunks&) = delete;

  /// Of the variable of this full name ("/camera/energy"), shuffled and deflated: the chunk that begins at
  /// [ping][0][0]...
  void write(const std::string& variable, std::size_t ping, std::span<const unsigned char> packed);
  void close();

 private:
  std::filesystem::path path_;
  bool in_memory_ = false;
  std::unique_ptr<Hdf5Handle> file_;
  std::map<std::string, std::unique_ptr<Hdf5Handle>> variables_;
};

}  // namespace tubefoot
