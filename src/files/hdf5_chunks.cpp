// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_chunks.hpp"

#include <fmt/format.h>
#include <libdeflate.h>

#include <cstring>
#include <new>

#include "files/checked_file.hpp"
#include "files/hdf5_handle.hpp"
#include "files/library_settings.hpp"

namespace tubefoot {

std::vector<unsigned char> packed_chunk(std::span<const double> values) {
  constexpr std::size_t width = sizeof(double);
  const std::size_t count = values.size();
  std::vector<unsigned char> shuffled(values.size_bytes());
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  for (std::size_t plane = 0; plane < width; ++plane)
    for (std::size_t k = 0; k < count; ++k) shuffled[plane * count + k] = bytes[k * width + plane];
  constexpr int level = 4;
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(level), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::vector<unsigned char> packed(libdeflate_zlib_compress_bound(compressor.get(), shuffled.size()));
  packed.resize(libdeflate_zlib_compress(compressor.get(), shuffled.data(), shuffled.size(), packed.data(),
                                         packed.size()));
  packed.shrink_to_fit();
  return packed;
}

Hdf5Chunks::Hdf5Chunks(std::filesystem::path file) : path_(std::move(file)) {
  const Hdf5Silence silence;
  keep_libraries_to_themselves();
  file_ = std::make_unique<Hdf5Handle>(H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  if (*file_ < 0) throw write_error(path_, "HDF5 cannot open it again to add values");
}

Hdf5Chunks::Hdf5Chunks(std::filesystem::path file, std::span<const unsigned char> image)
    : path_(std::move(file)), in_memory_(true) {
  const Hdf5Silence silence;
  keep_libraries_to_themselves();
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t grows_by = 1 << 20;
  constexpr hbool_t onto_the_disk = false;
  if (H5Pset_fapl_core(access, grows_by, onto_the_disk) >= 0 &&
      H5Pset_file_image(access, const_cast<unsigned char*>(image.data()), image.size()) >= 0)  // copies it
    file_ = std::make_unique<Hdf5Handle>(H5Fopen(path_.c_str(), H5F_ACC_RDWR, access), H5Fclose);
  if (!file_ || *file_ < 0)
    throw write_error(path_, "HDF5 cannot add values to it in memory, which may be short");
}

Hdf5Chunks::~Hdf5Chunks() {
  const Hdf5Silence silence;
  variables_.clear();
  file_.reset();
}

void Hdf5Chunks::write(const std::string& variable, std::size_t ping, std::span<const unsigned char> packed) {
  const Hdf5Silence silence;
  std::unique_ptr<Hdf5Handle>& opened = variables_[variable];
  if (!opened)
    opened = std::make_unique<Hdf5Handle>(H5Dopen2(*file_, variable.c_str(), H5P_DEFAULT), H5Dclose);
  constexpr std::uint32_t all_filters = 0;
  const hsize_t begin[H5S_MAX_RANK] = {ping};  // as many as the variable has dimensions are read
  if (*opened < 0 ||
      H5Dwrite_chunk(*opened, H5P_DEFAULT, all_filters, begin, packed.size(), packed.data()) < 0)
    throw write_error(path_, fmt::format("cannot write ping {} of variable '{}'", ping, variable));
}

void Hdf5Chunks::close() {
  const Hdf5Silence silence;
  variables_.clear();
  if (H5Fflush(*file_, H5F_SCOPE_LOCAL) < 0) throw write_error(path_, "cannot complete the file");
  std::vector<unsigned char> image;
  if (in_memory_) {
    const ssize_t size = H5Fget_file_image(*file_, nullptr, 0);
    image.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    if (image.empty() || H5Fget_file_image(*file_, image.data(), image.size()) != size)
      throw write_error(path_, "cannot complete the file in memory");
  }
  file_.reset();
  if (in_memory_) write_file(path_, image);
}

}  // namespace tubefoot
