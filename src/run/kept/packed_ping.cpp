// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/kept/packed_ping.hpp"

#include <libdeflate.h>
#include <lz4.h>

#include <algorithm>
#include <bit>
#include <climits>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

namespace tubefoot {
namespace {

static_assert(std::is_trivially_copyable_v<PingCounts> && sizeof(PackedHead) == 32);

/// Bounds, if any, follow the energies.
constexpr int energy_and_bound = 2;
// Shorter runs of zeros are not worth the eight bytes that say where they are.
constexpr std::size_t least_zeros = 4;
// LZ4 counts in int.
constexpr std::size_t piece_bytes = std::size_t{1} << 30;

auto values_of(auto& values, std::size_t sensor, int which) {
  return which == 0 ? values.energy(sensor) : values.bound(sensor);
}

/// What comes before a ping's values, once they are no longer deflated.
struct Contents {
  PingCounts counts;
  std::uint64_t runs = 0, values = 0;
};

/// So many zeros, then so many values as they are.
struct Run {
  std::uint32_t zeros = 0, values = 0;
};

/// The longest that a group's Contents, runs and values can be: all runs have least_zeros before them but the
/// first of each sensor, and those that go on where a number of 32 bits ends.
std::size_t most_contents(const StoreLayout& layout, std::size_t group) {
  std::size_t runs = 0, values = 0;
  for (const std::size_t sensor : layout.groups[group].sensors) {
    const std::size_t cells = layout.sensors[sensor].cells;
    runs += cells / least_zeros + 2;
    values += cells;
  }
  const std::size_t of_one = runs * sizeof(Run) + values * sizeof(double);
  return sizeof(Contents) + (layout.with_bounds ? 2 * of_one : of_one);
}

bool is_zero(double value) { return std::bit_cast<std::uint64_t>(value) == 0; }

/// Runs of one sensor's values, and their values behind `kept`.
void split(std::span<const double> values, std::vector<Run>& runs, std::vector<double>& kept) {
  constexpr std::size_t most = UINT32_MAX;
  for (std::size_t at = 0; at < values.size();) {
    Run run;
    const std::size_t begin = at;
    while (at < values.size() && at - begin < most && is_zero(values[at])) ++at;
    run.zeros = static_cast<std::uint32_t>(at - begin);
    const std::size_t first = at;
    for (std::size_t zeros = 0; at < values.size() && at - first < most; ++at) {
      zeros = is_zero(values[at]) ? zeros + 1 : 0;
      if (zeros < least_zeros) continue;
      at -= zeros - 1;
      break;
    }
    run.values = static_cast<std::uint32_t>(at - first);
    kept.insert(kept.end(), values.begin() + std::ptrdiff_t(first), values.begin() + std::ptrdiff_t(at));
    runs.push_back(run);
  }
}

/// Bytes of equal weight side by side: exponents of neighbours are alike.
void shuffle(std::span<const double> values, char* out) {
  const std::size_t count = values.size();
  for (std::size_t k = 0; k < count; ++k) {
    const auto bits = std::bit_cast<std::uint64_t>(values[k]);
    for (std::size_t plane = 0; plane < sizeof(double); ++plane)
      out[plane * count + k] = static_cast<char>(bits >> (8 * plane));
  }
}

/// `in`: all `count` values, of which those from `first` on are wanted.
void unshuffle(const char* in, std::size_t count, std::size_t first, std::span<double> values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    std::uint64_t bits = 0;
    for (std::size_t plane = 0; plane < sizeof(double); ++plane)
      bits |= std::uint64_t{static_cast<unsigned char>(in[plane * count + first + k])} << (8 * plane);
    values[k] = std::bit_cast<double>(bits);
  }
}

/// The most bytes that contents of a size can be packed into.
std::size_t most_packed(std::size_t contents) {
  return sizeof(std::uint64_t) + (contents / piece_bytes + 1) * 2 * sizeof(std::uint32_t) + contents +
         contents / 128;
}

/// Zeros taken out, what is left hardly gets smaller by trying harder than LZ4 (docs/cluster.md): its length,
/// then pieces, each behind its packed length.
std::string packed_behind_head(std::string_view text) {
  std::string packed(sizeof(PackedHead) + most_packed(text.size()), '\0');
  char* at = packed.data() + sizeof(PackedHead);
  const auto put = [&](auto number) {
    std::memcpy(at, &number, sizeof number);
    at += sizeof number;
  };
  put(std::uint64_t{text.size()});
  for (; !text.empty(); text.remove_prefix(std::min(text.size(), piece_bytes))) {
    const auto piece = static_cast<int>(std::min(text.size(), piece_bytes));
    const int most = LZ4_compressBound(piece);
    const int bytes = LZ4_compress_default(text.data(), at + sizeof(std::uint32_t), piece, most);
    if (bytes <= 0) throw std::bad_alloc();
    put(static_cast<std::uint32_t>(bytes));
    at += bytes;
  }
  packed.resize(static_cast<std::size_t>(at - packed.data()));
  packed.shrink_to_fit();
  return packed;
}

/// What was packed, of at most `most` bytes: no more memory is taken, whatever the bytes claim.
struct Unpacked {
  std::unique_ptr<char[]> text;
  std::size_t size = 0;
};
Unpacked unpacked(std::string_view packed, std::size_t most) {
  const auto take = [&](auto& number) {
    if (packed.size() < sizeof number) throw DamagedPing("it ends before its end");
    std::memcpy(&number, packed.data(), sizeof number);
    packed.remove_prefix(sizeof number);
  };
  std::uint64_t size = 0;
  take(size);
  if (size > most) throw DamagedPing("it is too long");
  Unpacked made{std::unique_ptr<char[]>(new char[size]), size};  // make_unique would clear all of it
  for (std::size_t at = 0; at < size;) {
    const std::size_t piece = std::min<std::size_t>(size - at, piece_bytes);
    std::uint32_t bytes = 0;
    take(bytes);
    if (bytes > packed.size() || bytes > std::uint32_t{INT_MAX}) throw DamagedPing("it ends before its end");
    if (LZ4_decompress_safe(packed.data(), made.text.get() + at, static_cast<int>(bytes),
                            static_cast<int>(piece)) != static_cast<int>(piece))
      throw DamagedPing("it cannot be unpacked");
    packed.remove_prefix(bytes);
    at += piece;
  }
  if (!packed.empty()) throw DamagedPing("it is too long");
  return made;
}

std::uint32_t checksum_of(const PackedHead& head) {
  return libdeflate_crc32(0, &head, offsetof(PackedHead, head_checksum));
}

[[noreturn]] void damaged(const char* why) { throw DamagedPing(why); }

}  // namespace

std::string packed_ping(const StoreLayout& layout, const PingUnit& unit, const PingCounts& counts,
                        const PingValues& values) {
  std::vector<Run> runs;
  std::vector<double> kept;
  for (const std::size_t sensor : layout.groups[unit.group].sensors)
    for (int which = 0; which < energy_and_bound; ++which)
      split(values_of(values, sensor, which), runs, kept);
  const Contents contents{counts, runs.size(), kept.size()};
  const std::size_t runs_bytes = runs.size() * sizeof(Run);
  std::string text(sizeof contents + runs_bytes + kept.size() * sizeof(double), '\0');
  std::memcpy(text.data(), &contents, sizeof contents);
  if (!runs.empty()) std::memcpy(text.data() + sizeof contents, runs.data(), runs_bytes);
  shuffle(kept, text.data() + sizeof contents + runs_bytes);

  std::string packed = packed_behind_head(text);
  PackedHead head{unit};
  const std::string_view body = std::string_view(packed).substr(sizeof head);
  head.bytes = body.size();
  head.values_checksum = libdeflate_crc32(0, body.data(), body.size());
  head.head_checksum = checksum_of(head);
  std::memcpy(packed.data(), &head, sizeof head);
  return packed;
}

PackedHead head_of_packed(std::string_view bytes, const StoreLayout& layout) {
  PackedHead head;
  if (bytes.size() < sizeof head) damaged("it is cut short");
  std::memcpy(&head, bytes.data(), sizeof head);
  if (head.head_checksum != checksum_of(head)) damaged("its head is damaged");
  if (head.unit.group >= layout.groups.size() || head.unit.ping >= layout.groups[head.unit.group].pings)
    damaged("it is a ping of another run");
  if (head.bytes > most_packed(most_contents(layout, head.unit.group))) damaged("it is too long");
  return head;
}

bool belongs_to(const PackedHead& head, std::string_view values) {
  return values.size() == head.bytes &&
         head.values_checksum == libdeflate_crc32(0, values.data(), values.size());
}

PingCounts unpack_ping(std::string_view packed, const StoreLayout& layout, PingValues& values) {
  const PackedHead head = head_of_packed(packed, layout);
  const std::string_view body = packed.substr(sizeof head);
  if (!belongs_to(head, body)) damaged("its values are damaged");
  const Unpacked all = unpacked(body, most_contents(layout, head.unit.group));
  Contents contents;
  if (all.size < sizeof contents) damaged("it is too short");
  std::memcpy(&contents, all.text.get(), sizeof contents);
  const std::size_t left = all.size - sizeof contents;
  if (contents.runs > left / sizeof(Run) || contents.values > left / sizeof(double) ||
      contents.runs * sizeof(Run) + contents.values * sizeof(double) != left)
    damaged("its length is another");
  const char* const runs = all.text.get() + sizeof contents;
  const char* const packed_values = runs + contents.runs * sizeof(Run);
  std::size_t next = 0, taken = 0;
  values.clear(layout, head.unit.group);
  for (const std::size_t sensor : layout.groups[head.unit.group].sensors)
    for (int which = 0; which < energy_and_bound; ++which) {
      std::span<double> to = values_of(values, sensor, which);
      while (!to.empty()) {
        Run run;
        if (next == contents.runs) damaged("it ends before its end");
        std::memcpy(&run, runs + sizeof run * next++, sizeof run);
        if (run.zeros > to.size() || run.values > to.size() - run.zeros ||
            run.values > contents.values - taken || (run.zeros == 0 && run.values == 0))
          damaged("it has other values");
        unshuffle(packed_values, contents.values, taken, to.subspan(run.zeros, run.values));
        taken += run.values;
        to = to.subspan(std::size_t{run.zeros} + run.values);
      }
    }
  if (next != contents.runs || taken != contents.values) damaged("it has more values");
  return contents.counts;
}

}  // namespace tubefoot
