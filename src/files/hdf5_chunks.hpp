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

/// Compresses the values of a chunk as the HDF5 filters shuffle and deflate do. Shuffling puts bytes of
/// equal significance together, and the result is a zlib stream. It has the same bytes on any thread.
/// Throws std::bad_alloc.
std::vector<unsigned char> packed_chunk(std::span<const double> values);
/// Returns the largest compressed size in bytes of a chunk with this number of values.
std::size_t most_packed_bytes(std::size_t values);
/// Decompresses the values of a chunk. Returns whether the chunk has exactly `values.size()` values. Throws
/// std::bad_alloc.
bool unpack_chunk(std::span<const unsigned char> packed, std::span<double> values);

/// Returns the bytes of an HDF5 file without variables. Its root group tracks the creation order, because
/// netCDF opens no other file for writing (nc_create_mem() makes such files). `path` is the name in errors.
/// Throws std::runtime_error.
std::vector<unsigned char> empty_hdf5_file(const std::filesystem::path& path);

/// An HDF5 file (netCDF-4) that is complete except for the values of compressed variables. The class writes
/// their chunks in compressed form, for example as other threads compressed them. Throws std::runtime_error
/// that names the file and the failed operation.
class Hdf5Chunks {
 public:
  /// Opens a file on disk. All space for the chunks must be reserved before (ReservedSpace).
  explicit Hdf5Chunks(std::filesystem::path file);
  /// Opens a file in memory from its bytes. close() writes it under this name.
  Hdf5Chunks(std::filesystem::path file, std::span<const unsigned char> image);
  ~Hdf5Chunks();
  Hdf5Chunks(const Hdf5Chunks&) = delete;
  Hdf5Chunks& operator=(const Hdf5Chunks&) = delete;

  /// Writes the chunk that begins at [ping][0][0]... of a variable with this full name ("/camera/energy").
  /// The chunk is shuffled and deflated.
  void write(const std::string& variable, std::size_t ping, std::span<const unsigned char> packed);
  void close();

 private:
  std::filesystem::path path_;
  bool in_memory_ = false;
  std::unique_ptr<Hdf5Handle> file_;
  std::map<std::string, std::unique_ptr<Hdf5Handle>> variables_;
};

}  // namespace tubefoot
