// SPDX-License-Identifier: GPL-3.0-or-later
#include "kmall/kmall_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "files/shown.hpp"

namespace tubefoot {
namespace {

static_assert(std::endian::native == std::endian::little, "KMALL files are little-endian");

constexpr std::size_t header_bytes = 20, partition_bytes = 4, length_bytes = 4;

template <class T>
T value_at(const std::uint8_t* bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes + at, sizeof value);
  return value;
}

bool is_type(const std::string& type) {
  return type[0] == '#' && std::ranges::all_of(type.substr(1), [](char c) { return c >= 'A' && c <= 'Z'; });
}

/// Returns whether datagrams of this type may be divided into parts.
bool may_be_divided(const std::string& type) { return type == "#MRZ" || type == "#MWC"; }

}  // namespace

KmallFile::KmallFile(const std::filesystem::path& file) : file_(file) {
  const SourcePlace whole{file.string(), 0, 0};
  const std::uint64_t size = file_.size();
  std::size_t datagrams = 0;
  for (std::uint64_t at = 0; at < size;) {
    std::array<std::uint8_t, header_bytes + partition_bytes> head{};
    const std::uint64_t left = size - at;
    if (left < header_bytes + length_bytes)
      throw InputError(whole, at == 0
                                  ? fmt::format("is not a KMALL file: it has {} bytes, and a datagram has at "
                                                "least {}",
                                                size, header_bytes + length_bytes)
                                  : fmt::format("is truncated: {} bytes follow the last datagram, which ends "
                                                "at byte {}",
                                                left, at));
    read(at, std::span(head).first(header_bytes));
    const auto length = value_at<std::uint32_t>(head.data(), 0);
    const std::string type(reinterpret_cast<const char*>(head.data() + 4), 4);
    if (!is_type(type))
      throw InputError(
          whole, datagrams == 0
                     ? fmt::format("is not a KMALL file: a datagram such as #MRZ was expected, not "
                                   "'{}'",
                                   shown(type))
                     : fmt::format("is damaged: '{}' at byte {} is not the type of a datagram", shown(type),
                                   at + 4));
    if (length < header_bytes + length_bytes)
      throw InputError(whole, fmt::format("is damaged: datagram {} at byte {} has a length of {} bytes", type,
                                          at, length));
    if (length > left)
      throw InputError(whole,
                       fmt::format("is truncated: datagram {} at byte {} has {} bytes, but {} are left: copy "
                                   "the file again, or remove the last datagram",
                                   type, at, length, left));
    std::array<std::uint8_t, length_bytes> end{};
    read(at + length - length_bytes, end);
    if (value_at<std::uint32_t>(end.data(), 0) != length)
      throw InputError(
          whole, fmt::format("is damaged: datagram {} at byte {} does not end with its length", type, at));
    if (++datagrams > most_kmall_datagrams)
      throw InputError(whole,
                       fmt::format("has more than {} datagrams: divide the file", most_kmall_datagrams));
    KmallRecord record{type, head[8], 0, {}};
    record.time_s =
        value_at<std::uint32_t>(head.data(), 12) + 1e-9 * value_at<std::uint32_t>(head.data(), 16);
    record.parts = {{at + header_bytes, static_cast<std::uint32_t>(length - header_bytes - length_bytes)}};
    if (may_be_divided(type)) {
      if (record.parts[0].size < partition_bytes)
        throw InputError(whole, fmt::format("is damaged: datagram {} at byte {} has a length of {} bytes",
                                            type, at, length));
      read(at + header_bytes, std::span(head).subspan(header_bytes));
      record.parts[0].at += partition_bytes;
      record.parts[0].size -= static_cast<std::uint32_t>(partition_bytes);
      add_part(record, value_at<std::uint16_t>(head.data(), header_bytes),
               value_at<std::uint16_t>(head.data(), header_bytes + 2));
    } else {
      records_[type].push_back(std::move(record));
    }
    at += length;
  }
  if (datagrams == 0) throw InputError(whole, "is empty: expected a KMALL file");
  for (const char* type : {"#MRZ", "#MWC"}) drop_incomplete(type);
}

/// Parts of a record follow each other, numbered from 1, with the time of the first part.
void KmallFile::add_part(const KmallRecord& record, unsigned parts, unsigned part) {
  std::vector<KmallRecord>& of_type = records_[record.type];
  std::size_t& missing = missing_parts_[record.type];
  if (missing > 0 && of_type.back().time_s == record.time_s && part == of_type.back().parts.size() + 1 &&
      part - 1 + missing == parts) {
    of_type.back().parts.push_back(record.parts[0]);
    --missing;
    return;
  }
  drop_incomplete(record.type);
  if (part != 1 || parts == 0) {
    // Further parts of a datagram count once.
    const auto last = left_out_s_.find(record.type);
    if (last == left_out_s_.end() || last->second != record.time_s) ++incomplete_;
    left_out_s_[record.type] = record.time_s;
    return;
  }
  of_type.push_back(record);
  missing = parts - 1;
}

void KmallFile::drop_incomplete(const std::string& type) {
  if (std::size_t& missing = missing_parts_[type]; missing > 0) {
    left_out_s_[type] = records_[type].back().time_s;
    records_[type].pop_back();
    missing = 0;
    ++incomplete_;
  }
}

const std::vector<KmallRecord>& KmallFile::records(std::string_view type) const {
  static const std::vector<KmallRecord> none;
  const auto found = records_.find(type);
  return found == records_.end() ? none : found->second;
}

std::map<std::string, std::size_t> KmallFile::counts() const {
  std::map<std::string, std::size_t> counts;
  for (const auto& [type, records] : records_) counts[type] = records.size();
  return counts;
}

void KmallFile::read(std::uint64_t at, std::span<std::uint8_t> bytes) {
  std::istream& in = file_.stream();
  in.clear();
  in.seekg(static_cast<std::streamoff>(at));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (in.gcount() != static_cast<std::streamsize>(bytes.size()))
    throw InputError({path().string(), 0, 0},
                     fmt::format("cannot be read: {} bytes at byte {} are missing", bytes.size(), at));
}

std::vector<std::uint8_t> KmallFile::body(const KmallRecord& record) {
  std::size_t size = 0;
  for (const KmallRecord::Part& part : record.parts) size += part.size;
  if (size > most_kmall_record_bytes)
    throw error(record, fmt::format("has {} bytes: at most {} are supported", size, most_kmall_record_bytes));
  std::vector<std::uint8_t> bytes(size);
  std::size_t filled = 0;
  for (const KmallRecord::Part& part : record.parts) {
    read(part.at, std::span(bytes).subspan(filled, part.size));
    filled += part.size;
  }
  return bytes;
}

InputError KmallFile::error(const KmallRecord& record, const std::string& message) const {
  return {{path().string(), 0, 0},
          fmt::format("datagram {} at byte {}: {}", record.type,
                      record.parts[0].at - header_bytes - (may_be_divided(record.type) ? partition_bytes : 0),
                      message)};
}

}  // namespace tubefoot
