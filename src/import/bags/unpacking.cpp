// SPDX-License-Identifier: GPL-3.0-or-later
// Decompresses zstd and lz4 frames piece by piece. Memory grows with the output, not with the sizes that
// headers claim.
#include "import/bags/unpacking.hpp"

#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "files/memory_at_hand.hpp"
#include "files/shown.hpp"
#include "geometry/steps/stop.hpp"
#include "import/bags/bag_limits.hpp"

namespace tubefoot {
namespace {

constexpr std::string_view smaller = "split the recording with ros2 bag convert";

[[noreturn]] void damaged(const SourcePlace& place, const std::string& what, std::string_view kind,
                          std::string_view reason) {
  throw InputError(place, fmt::format("{}: its {} data are damaged or cut off ({})", what, kind, reason));
}

/// Decompresses consecutive frames. `step` receives the remaining input and an output buffer and advances
/// both. It returns how much input the frame still expects, or 0 at its end.
template <class Step>
std::vector<std::uint8_t> unpack(std::span<const std::uint8_t> packed, std::uint64_t most,
                                 std::uint64_t expected, const SourcePlace& place, const std::string& what,
                                 std::string_view kind, const Step& step) {
  std::vector<std::uint8_t> unpacked;
  std::size_t filled = 0, wants = 1;
  const auto grow = [&] {
    constexpr std::uint64_t piece = std::uint64_t{1} << 20;
    if (filled >= most)
      throw InputError(place, fmt::format("{}: unpacks to more than {} bytes: {}", what, most, smaller));
    // The buffer is at most twice the output so far, whatever a header claims.
    const std::uint64_t size =
        std::min({most, expected, std::max<std::uint64_t>(piece, 2 * std::uint64_t{filled})});
    const std::uint64_t next = size > filled ? size : std::min<std::uint64_t>(most, filled + piece);
    require_memory(static_cast<double>(next) + static_cast<double>(filled), place, what,
                   std::string(smaller));
    unpacked.resize(next);
  };
  while (!packed.empty() || wants != 0) {
    stop_if_wanted();
    if (filled == unpacked.size()) grow();
    const std::size_t left_before = packed.size(), filled_before = filled;
    wants = step(packed, std::span(unpacked).subspan(filled), filled);
    if (wants != 0 && packed.size() == left_before && filled == filled_before)
      damaged(place, what, kind, "the data end too early");
  }
  unpacked.resize(filled);
  return unpacked;
}

std::vector<std::uint8_t> unpack_lz4(std::span<const std::uint8_t> packed, std::uint64_t size,
                                     const SourcePlace& place, const std::string& what) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(made,
                                                                             LZ4F_freeDecompressionContext);
  return unpack(packed, size + 1, size, place, what, "lz4",
                [&](std::span<const std::uint8_t>& in, std::span<std::uint8_t> out, std::size_t& filled) {
                  std::size_t taken = in.size(), put = out.size();
                  const std::size_t wants =
                      LZ4F_decompress(context.get(), out.data(), &put, in.data(), &taken, nullptr);
                  if (LZ4F_isError(wants) != 0) damaged(place, what, "lz4", LZ4F_getErrorName(wants));
                  in = in.subspan(taken);
                  filled += put;
                  return wants;
                });
}

}  // namespace

UnpackedBytes::UnpackedBytes(std::uint64_t packed)
    : most_(limits::unpacked_base_bytes +
            std::min(packed, limits::unpacked_bytes) * limits::unpacked_per_byte) {}

void UnpackedBytes::add(std::uint64_t bytes, const SourcePlace& place, const std::string& what) {
  if (bytes > left())
    throw InputError(
        place, fmt::format("{}: the compressed parts of the recording unpack to more than {} bytes in total, "
                           "too many for its size: write the recording again without compression",
                           what, most_));
  taken_ += bytes;
}

bool is_zstd(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t magic[] = {0x28, 0xb5, 0x2f, 0xfd};
  return bytes.size() >= sizeof magic && std::equal(std::begin(magic), std::end(magic), bytes.begin());
}

std::vector<std::uint8_t> unpack_zstd(std::span<const std::uint8_t> packed, std::uint64_t most,
                                      const SourcePlace& place, const std::string& what) {
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                             ZSTD_freeDStream);
  if (!stream) throw std::bad_alloc();
  const unsigned long long said = ZSTD_getFrameContentSize(packed.data(), packed.size());
  const std::uint64_t expected =
      said == ZSTD_CONTENTSIZE_UNKNOWN || said == ZSTD_CONTENTSIZE_ERROR ? most : std::uint64_t{said};
  if (expected > most)
    throw InputError(place, fmt::format("{}: unpacks to {} bytes, but at most {} are allowed: {}", what,
                                        expected, most, smaller));
  return unpack(packed, most, std::max<std::uint64_t>(expected, 1), place, what, "zstd",
                [&](std::span<const std::uint8_t>& in, std::span<std::uint8_t> out, std::size_t& filled) {
                  ZSTD_inBuffer from{in.data(), in.size(), 0};
                  ZSTD_outBuffer to{out.data(), out.size(), 0};
                  const std::size_t wants = ZSTD_decompressStream(stream.get(), &to, &from);
                  if (ZSTD_isError(wants) != 0) damaged(place, what, "zstd", ZSTD_getErrorName(wants));
                  in = in.subspan(from.pos);
                  filled += to.pos;
                  return wants;
                });
}

std::vector<std::uint8_t> unpack_chunk(std::string_view compression, std::span<const std::uint8_t> packed,
                                       std::uint64_t size, const SourcePlace& place,
                                       const std::string& what) {
  std::vector<std::uint8_t> unpacked;
  if (compression.empty())
    unpacked.assign(packed.begin(), packed.end());
  else if (compression == "zstd")
    unpacked = unpack_zstd(packed, size + 1, place, what);
  else if (compression == "lz4")
    unpacked = unpack_lz4(packed, size, place, what);
  else
    throw InputError(place, fmt::format("{}: is compressed with '{}', which tubefoot does not read: expected "
                                        "no compression, lz4 or zstd (mcap compress writes them)",
                                        what, shown_line(compression)));
  if (unpacked.size() != size)
    throw InputError(place,
                     fmt::format("{}: unpacks to {} bytes, but its header declares {}: it is damaged", what,
                                 unpacked.size() > size ? "more than " + std::to_string(size)
                                                        : std::to_string(unpacked.size()),
                                 size));
  return unpacked;
}

}  // namespace tubefoot
