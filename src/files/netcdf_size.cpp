// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/netcdf_size.hpp"

#include <algorithm>
#include <istream>
#include <limits>
#include <vector>

#include "files/input_registry.hpp"

// Computes the minimum size of a netCDF classic file from its header. The layout follows "NetCDF Classic
// Format Specification" (Unidata) and is big-endian. Counts and lengths have 32 bits (64 in CDF-5). Offsets
// have 32 bits (64 in CDF-2 and 5). Names and values are padded to 4 bytes.
namespace tubefoot {
namespace {

constexpr std::uint64_t kNonsense = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kMostElements =
    1u << 14;  // largest number of elements of a list; an invalid header then cannot take much memory or time

class Header {
 public:
  Header(std::istream& in, int version) : in_(in), version_(version) {}

  std::uint64_t file_size() {
    const std::uint64_t records = count();
    read_dimensions();
    skip_attributes();
    std::uint64_t end = 0, record_begin = kNonsense, record_bytes = 0;
    for (std::uint64_t n = list(); n > 0 && in_; --n) {
      skip_name();
      bool is_record = false;
      std::uint64_t elements = 1;
      for (std::uint64_t k = bounded(count()); k > 0 && in_; --k) {
        const std::uint64_t dimension = count();
        if (dimension >= dimensions_.size()) return kNonsense;
        is_record = is_record || dimensions_[dimension] == 0;
        if (dimensions_[dimension] != 0 &&
            __builtin_mul_overflow(elements, dimensions_[dimension], &elements))
          return kNonsense;
      }
      skip_attributes();
      std::uint64_t bytes = 0;
      if (__builtin_mul_overflow(elements, type_bytes(number(4)), &bytes) || bytes > kNonsense / 4)
        return kNonsense;
      count();  // vsize is redundant, and truncated to 32 bits for large variables
      const std::uint64_t begin = number(version_ == 1 ? 4 : 8);
      if (is_record) {
        record_begin = std::min(record_begin, begin);
        record_bytes += bytes;
      } else {
        if (begin > kNonsense / 4) return kNonsense;
        end = std::max(end, begin + bytes);
      }
    }
    if (!in_) return kNonsense;
    const bool streaming =
        records == (version_ == 5 ? kNonsense : 0xffffffffu);  // the number of records is unknown
    if (record_bytes > 0 && records > 0 && !streaming) {
      std::uint64_t all = 0;
      if (__builtin_mul_overflow(records, record_bytes, &all) ||
          __builtin_add_overflow(all, record_begin, &all))
        return kNonsense;
      end = std::max(end, all);
    }
    return end;
  }

 private:
  std::uint64_t number(int bytes) {
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) value = value << 8 | static_cast<unsigned char>(in_.get());
    return value;
  }
  std::uint64_t count() { return number(version_ == 5 ? 8 : 4); }

  std::uint64_t bounded(std::uint64_t n) {
    if (n > kMostElements) in_.setstate(std::ios::failbit);
    return n;
  }
  // Reads the tag of a list and returns its number of elements.
  std::uint64_t list() {
    number(4);
    return bounded(count());
  }
  void skip_padded(std::uint64_t bytes) { in_.ignore(static_cast<std::streamsize>((bytes + 3) / 4 * 4)); }
  void skip_name() { skip_padded(bounded(count())); }

  static std::uint64_t type_bytes(std::uint64_t type) {
    constexpr std::uint64_t kBytes[] = {0, 1, 1, 2, 4, 4,
                                        8, 1, 2, 4, 8, 8};  // byte, char, short, int, float, double, ...
    return type < std::size(kBytes) ? kBytes[type] : 0;
  }

  void read_dimensions() {
    for (std::uint64_t n = list(); n > 0 && in_; --n) {
      skip_name();
      dimensions_.push_back(count());
    }
  }
  void skip_attributes() {
    for (std::uint64_t n = list(); n > 0 && in_; --n) {
      skip_name();
      const std::uint64_t type = number(4);
      skip_padded(bounded(count()) * type_bytes(type));
    }
  }

  std::istream& in_;
  int version_;
  std::vector<std::uint64_t> dimensions_;
};

}  // namespace

std::optional<std::uint64_t> netcdf_classic_size(const std::filesystem::path& file) {
  InputFile input(file);
  std::istream& in = input.stream();
  char magic[4] = {};
  in.read(magic, sizeof magic);
  if (!in || magic[0] != 'C' || magic[1] != 'D' || magic[2] != 'F') return std::nullopt;
  if (magic[3] != 1 && magic[3] != 2 && magic[3] != 5) return std::nullopt;
  return Header(in, magic[3]).file_size();
}

void refuse_short_netcdf(const SourcePlace& place) {
  std::error_code error;
  if (const auto needed = netcdf_classic_size(place.file);
      needed && std::filesystem::file_size(place.file, error) < *needed)
    throw InputError(place,
                     "is cut off or damaged: its netCDF header describes more data than the file holds");
}

}  // namespace tubefoot
