// SPDX-License-Identifier: GPL-3.0-or-later
// Reads NPZ archives, which are ZIP files of NPY files. It rejects archives that claim an impossible
// compression ratio or a too large decompressed size.
#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <memory>

#include "files/memory_at_hand.hpp"
#include "geometry/steps/stop.hpp"
#include "import/frames/npy_file.hpp"

namespace tubefoot {
namespace {

/// Largest compression ratio of deflate. An archive that claims a larger ratio is malicious.
constexpr std::uint64_t densest = 1032;
constexpr std::int64_t most_members = 10'000;
/// Limit of the decompressed size of all members: a base, and so many bytes per byte of the archive. The
/// limit is on the sum, because members may share compressed bytes.
constexpr std::uint64_t unpacked_base_bytes = std::uint64_t{5} << 28, unpacked_per_byte = 200;

struct CloseArchive {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct CloseMember {
  void operator()(zip_file_t* member) const { zip_fclose(member); }
};

std::string said(zip_error_t& error) {
  std::string words = zip_error_strerror(&error);
  zip_error_fini(&error);
  return words;
}

class Archive {
 public:
  Archive(std::string_view bytes, const SourcePlace& place) : place_(place) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
    if (!source) fail(said(error));
    archive_.reset(zip_open_from_source(source, ZIP_RDONLY, &error));
    if (!archive_) {
      zip_source_free(source);
      fail(said(error));
    }
    zip_error_fini(&error);
  }

  std::int64_t members() const { return zip_get_num_entries(archive_.get(), 0); }

  zip_stat_t member(std::int64_t index) const {
    zip_stat_t found;
    zip_stat_init(&found);
    if (zip_stat_index(archive_.get(), static_cast<zip_uint64_t>(index), 0, &found) != 0 ||
        !(found.valid & ZIP_STAT_NAME) || !(found.valid & ZIP_STAT_SIZE) ||
        !(found.valid & ZIP_STAT_COMP_SIZE))
      fail(zip_strerror(archive_.get()));
    if (found.size / densest > found.comp_size)
      fail(fmt::format("'{}' declares {} bytes in {} compressed bytes, which is impossible", found.name,
                       found.size, found.comp_size));
    return found;
  }

  /// Returns all bytes of a member. libzip checks the checksum when it reaches the end.
  std::string bytes_of(const zip_stat_t& member) const {
    require_memory(3.0 * static_cast<double>(member.size), place_,
                   fmt::format("the values of '{}'", member.name), "write fewer arrays per file");
    const std::unique_ptr<zip_file_t, CloseMember> file(zip_fopen_index(archive_.get(), member.index, 0));
    if (!file) fail(fmt::format("'{}': {}", member.name, zip_strerror(archive_.get())));
    std::string bytes(member.size, '\0');
    std::size_t have = 0;
    char one_more = 0;
    for (;;) {
      stop_if_wanted();
      constexpr std::size_t piece = std::size_t{1} << 20;
      char* to = have < bytes.size() ? &bytes[have] : &one_more;
      const zip_int64_t got =
          zip_fread(file.get(), to, have < bytes.size() ? std::min(bytes.size() - have, piece) : 1);
      if (got < 0) fail(fmt::format("'{}': {}", member.name, zip_file_strerror(file.get())));
      if (got == 0) break;
      have += static_cast<std::size_t>(got);
      if (have > bytes.size()) break;
    }
    if (have != bytes.size()) fail(fmt::format("'{}' does not have its declared length", member.name));
    return bytes;
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(
        place_,
        fmt::format(
            "cannot be read as NPZ: {}: the archive is cut off or damaged; write it again (numpy.savez)",
            why));
  }

 private:
  SourcePlace place_;
  std::unique_ptr<zip_t, CloseArchive> archive_;
};

}  // namespace

std::vector<NumberArray> read_npz(std::string_view bytes, const SourcePlace& place) {
  const Archive archive(bytes, place);
  if (archive.members() > most_members)
    archive.fail(fmt::format("it has {} members, more than {}", archive.members(), most_members));
  std::vector<NumberArray> arrays;
  double values = 0;
  std::uint64_t unpacked = 0;
  const std::uint64_t most_unpacked = unpacked_base_bytes + bytes.size() * unpacked_per_byte;
  for (std::int64_t index = 0; index < archive.members(); ++index) {
    unpacked += std::min<std::uint64_t>(archive.member(index).size, most_unpacked + 1);
    if (unpacked > most_unpacked)
      throw InputError(
          place, fmt::format("its members unpack to more than {} bytes in total, too many for its size: "
                             "write fewer arrays per file, or use numpy.savez without compression",
                             most_unpacked));
  }
  for (std::int64_t index = 0; index < archive.members(); ++index) {
    const zip_stat_t member = archive.member(index);
    std::string name = member.name;
    if (!name.ends_with(".npy")) continue;
    name.resize(name.size() - 4);
    arrays.push_back(read_npy(archive.bytes_of(member), {fmt::format("{}({}.npy)", place.file, name)}));
    arrays.back().name = name;
    values += static_cast<double>(arrays.back().values.size());
    require_memory(2 * sizeof(double) * values, place, "its arrays", "write fewer arrays per file");
  }
  if (arrays.empty()) throw InputError(place, "is an archive without NPY files");
  return arrays;
}

}  // namespace tubefoot
