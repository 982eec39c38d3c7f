// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_registry.hpp"

// This header declares the structure of Kongsberg KMALL files (.kmall and .kmwcd): a sequence of datagrams,
// each with a header, a body and its length. Source: Kongsberg, "EM datagrams on *.kmall format", revisions F
// to J.

namespace tubefoot {

/// Largest number of datagrams of a file, and largest number of bytes of a datagram with all its parts.
constexpr std::size_t most_kmall_datagrams = 20'000'000, most_kmall_record_bytes = std::size_t{1} << 28;

/// One datagram, or all partitions of a datagram that is divided.
struct KmallRecord {
  std::string type;  ///< for example "#MRZ"
  unsigned version = 0;
  double time_s = 0;  ///< since 1970
  struct Part {
    std::uint64_t at;    ///< offset of the body in the file
    std::uint32_t size;  ///< bytes of the body
  };
  std::vector<Part> parts;
};

/// The datagrams of a file. Bodies are read when they are requested, because files with water columns may
/// exceed the memory. Not thread-safe.
class KmallFile {
 public:
  /// Reads all headers. Throws InputError for a file that is not a KMALL file, is truncated, or contains no
  /// datagram. The message names the offset.
  explicit KmallFile(const std::filesystem::path& file);

  const std::filesystem::path& path() const { return file_.path(); }
  /// Returns the records of a type in the order of the file. A divided record has all its parts.
  const std::vector<KmallRecord>& records(std::string_view type) const;
  /// Returns the number of records of each type.
  std::map<std::string, std::size_t> counts() const;
  /// Returns the number of divided datagrams that lack a part, and which are therefore left out.
  std::size_t incomplete() const { return incomplete_; }
  /// Returns the body of a record. Throws InputError if reading fails.
  std::vector<std::uint8_t> body(const KmallRecord& record);
  /// Returns the error for a record of this file.
  InputError error(const KmallRecord& record, const std::string& message) const;

 private:
  void read(std::uint64_t at, std::span<std::uint8_t> bytes);
  void add_part(const KmallRecord& record, unsigned parts, unsigned part);
  void drop_incomplete(const std::string& type);

  InputFile file_;
  std::map<std::string, std::vector<KmallRecord>, std::less<>> records_;
  std::map<std::string, std::size_t> missing_parts_;  ///< of the last record of a type
  std::map<std::string, double> left_out_s_;          ///< time of the last record of a type that is left out
  std::size_t incomplete_ = 0;
};

}  // namespace tubefoot
