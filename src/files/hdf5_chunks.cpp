// SPDX-License-Identifier: GPL-3.0-or-later

// Compresses chunks of doubles (shuffle and deflate) outside of HDF5, so that threads can do it in
// parallel, and writes them into an HDF5 file. The shuffle transposes the bytes of eight values as an 8 x 8
// matrix.

#include "files/hdf5_chunks.hpp"

#include <fmt/format.h>
#include <libdeflate.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>

#include "files/checked_file.hpp"
#include "files/hdf5_handle.hpp"
#include "files/library_settings.hpp"

namespace tubefoot {

namespace {

constexpr std::size_t width = sizeof(double);
static_assert(std::endian::native == std::endian::little, "bytes of doubles as HDF5 files here have them");

/// Eight values as 8 x 8 bytes. transpose() makes byte k of word j byte j of word k, and is its own
/// inverse.
using Words = std::array<std::uint64_t, width>;
void transpose(Words& words) {
  const auto swap = [&](std::size_t a, std::size_t b, int bits, std::uint64_t mask) {
    const std::uint64_t differ = (words[a] >> bits ^ words[b]) & mask;
    words[b] ^= differ;
    words[a] ^= differ << bits;
  };
  for (const std::size_t k : {0, 1, 2, 3}) swap(k, k + 4, 32, 0x00000000ffffffff);
  for (const std::size_t k : {0, 1, 4, 5}) swap(k, k + 2, 16, 0x0000ffff0000ffff);
  for (const std::size_t k : {0, 2, 4, 6}) swap(k, k + 1, 8, 0x00ff00ff00ff00ff);
}

/// Returns whether all words are 0. Pings mostly consist of zeros, which need no transposition.
bool all_zero(const Words& words) {
  std::uint64_t bits = 0;
  for (const std::uint64_t word : words) bits |= word;
  return bits == 0;
}

/// Puts bytes of equal significance together, as HDF5's filter does.
void shuffle(std::span<const double> values, unsigned char* planes) {
  const std::size_t count = values.size(), whole = count / width * width;
  Words words;
  for (std::size_t first = 0; first < whole; first += width) {
    std::memcpy(words.data(), values.data() + first, sizeof words);
    if (!all_zero(words)) transpose(words);
    for (std::size_t plane = 0; plane < width; ++plane)
      std::memcpy(planes + plane * count + first, &words[plane], width);
  }
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  for (std::size_t k = whole; k < count; ++k)
    for (std::size_t plane = 0; plane < width; ++plane) planes[plane * count + k] = bytes[k * width + plane];
}

void unshuffle(const unsigned char* planes, std::span<double> values) {
  const std::size_t count = values.size(), whole = count / width * width;
  Words words;
  for (std::size_t first = 0; first < whole; first += width) {
    for (std::size_t plane = 0; plane < width; ++plane)
      std::memcpy(&words[plane], planes + plane * count + first, width);
    if (!all_zero(words)) transpose(words);
    std::memcpy(values.data() + first, words.data(), sizeof words);
  }
  auto* bytes = reinterpret_cast<unsigned char*>(values.data());
  for (std::size_t k = whole; k < count; ++k)
    for (std::size_t plane = 0; plane < width; ++plane) bytes[k * width + plane] = planes[plane * count + k];
}

/// Returns a name that cannot exist, because HDF5 rejects an image with the name of an existing file. A
/// file cannot lie below another file.
std::filesystem::path in_memory(const std::filesystem::path& path) { return path / "in-memory"; }

bool keeps_in_memory(hid_t access) {
  constexpr std::size_t grows_by = 1 << 20;
  constexpr hbool_t onto_the_disk = false;
  return H5Pset_fapl_core(access, grows_by, onto_the_disk) >= 0;
}

std::vector<unsigned char> image_of(hid_t file, const std::filesystem::path& path) {
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  std::vector<unsigned char> image(size > 0 ? static_cast<std::size_t>(size) : 0);
  if (image.empty() || H5Fget_file_image(file, image.data(), image.size()) != size)
    throw write_error(path, "cannot complete the file in memory");
  return image;
}

using Compressor = std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)>;
using Decompressor = std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>;

}  // namespace

std::vector<unsigned char> packed_chunk(std::span<const double> values) {
  const std::unique_ptr<unsigned char[]> planes(new unsigned char[values.size_bytes()]);
  shuffle(values, planes.get());
  constexpr int level = 4;
  const Compressor compressor(libdeflate_alloc_compressor(level), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  const std::size_t most = libdeflate_zlib_compress_bound(compressor.get(), values.size_bytes());
  const std::unique_ptr<unsigned char[]> packed(
      new unsigned char[most]);  // a vector would initialise the bytes
  const std::size_t bytes =
      libdeflate_zlib_compress(compressor.get(), planes.get(), values.size_bytes(), packed.get(), most);
  return {packed.get(), packed.get() + bytes};
}

std::size_t most_packed_bytes(std::size_t values) {
  return libdeflate_zlib_compress_bound(nullptr, values * width);  // valid for any compressor
}

bool unpack_chunk(std::span<const unsigned char> packed, std::span<double> values) {
  const Decompressor decompressor(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  const std::unique_ptr<unsigned char[]> planes(new unsigned char[values.size_bytes()]);
  std::size_t taken = 0;
  constexpr std::size_t* all_of_it = nullptr;  // with a null pointer, fewer bytes than requested are an error
  if (libdeflate_zlib_decompress_ex(decompressor.get(), packed.data(), packed.size(), planes.get(),
                                    values.size_bytes(), &taken, all_of_it) != LIBDEFLATE_SUCCESS ||
      taken != packed.size())
    return false;
  unshuffle(planes.get(), values);
  return true;
}

std::vector<unsigned char> empty_hdf5_file(const std::filesystem::path& path) {
  const Hdf5Silence silence;
  keep_libraries_to_themselves();
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  constexpr unsigned ordered = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
  constexpr hbool_t with_times = false;  // equal contents then have equal bytes
  if (keeps_in_memory(access) && H5Pset_link_creation_order(creation, ordered) >= 0 &&
      H5Pset_attr_creation_order(creation, ordered) >= 0 &&
      H5Pset_obj_track_times(creation, with_times) >= 0) {
    const Hdf5Handle file(H5Fcreate(in_memory(path).c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose);
    if (file >= 0 && H5Fflush(file, H5F_SCOPE_LOCAL) >= 0) return image_of(file, path);
  }
  throw write_error(path, "HDF5 cannot create the file in memory: free some memory");
}

Hdf5Chunks::Hdf5Chunks(std::filesystem::path file) : path_(std::move(file)) {
  const Hdf5Silence silence;
  keep_libraries_to_themselves();
  file_ = std::make_unique<Hdf5Handle>(H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  if (*file_ < 0) throw write_error(path_, "HDF5 cannot reopen the file to add values");
}

Hdf5Chunks::Hdf5Chunks(std::filesystem::path file, std::span<const unsigned char> image)
    : path_(std::move(file)), in_memory_(true) {
  const Hdf5Silence silence;
  keep_libraries_to_themselves();
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (keeps_in_memory(access) && H5Pset_file_image(access, const_cast<unsigned char*>(image.data()),
                                                   image.size()) >= 0)  // HDF5 copies the bytes
    file_ = std::make_unique<Hdf5Handle>(H5Fopen(in_memory(path_).c_str(), H5F_ACC_RDWR, access), H5Fclose);
  if (!file_ || *file_ < 0)
    throw write_error(path_, "HDF5 cannot add values to the file in memory: free some memory");
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
  const hsize_t begin[H5S_MAX_RANK] = {ping};  // HDF5 reads as many elements as the variable has dimensions
  if (*opened < 0 ||
      H5Dwrite_chunk(*opened, H5P_DEFAULT, all_filters, begin, packed.size(), packed.data()) < 0)
    throw write_error(path_, fmt::format("cannot write ping {} of variable '{}'", ping, variable));
}

void Hdf5Chunks::close() {
  const Hdf5Silence silence;
  variables_.clear();
  if (H5Fflush(*file_, H5F_SCOPE_LOCAL) < 0) throw write_error(path_, "cannot complete the file");
  std::vector<unsigned char> image;
  if (in_memory_) image = image_of(*file_, path_);
  file_.reset();
  if (in_memory_) write_file(path_, image);
}

}  // namespace tubefoot
