// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <span>
#include <type_traits>

#include "kmall/kmall_file.hpp"

namespace tubefoot {

/// Fields of the body of a record. Every access is checked against the end. Errors name the record.
class KmallFields {
 public:
  KmallFields(const KmallFile& file, const KmallRecord& record, std::span<const std::uint8_t> bytes)
      : file_(&file), record_(&record), bytes_(bytes) {}

  std::size_t size() const { return bytes_.size(); }
  std::span<const std::uint8_t> bytes() const { return bytes_; }

  /// Returns the field at an offset. A floating-point field must be finite.
  template <class T>
  T at(std::size_t offset) const {
    const T value = unchecked<T>(offset);
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(value))
        throw file_->error(*record_, fmt::format("contains a value that is not finite at byte {}", offset));
    return value;
  }
  /// Returns the field at an offset, which may be infinite or not a number.
  template <class T>
  T unchecked(std::size_t offset) const {
    if (offset + sizeof(T) > bytes_.size())
      throw file_->error(
          *record_, fmt::format("is too short: a field at byte {} of a part of {} bytes is missing", offset,
                                bytes_.size()));
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }
  /// Returns the field at an offset, or `otherwise` if the part ends before it, as in older revisions.
  template <class T>
  T at_or(std::size_t offset, T otherwise) const {
    return offset + sizeof(T) <= bytes_.size() ? at<T>(offset) : otherwise;
  }
  /// Returns the bytes from `offset` on.
  KmallFields part(std::size_t offset, std::size_t size) const {
    if (offset > bytes_.size() || size > bytes_.size() - offset)
      throw file_->error(*record_,
                         fmt::format("is too short: a part of {} bytes at byte {} exceeds its {} bytes", size,
                                     offset, bytes_.size()));
    return {*file_, *record_, bytes_.subspan(offset, size)};
  }
  KmallFields from(std::size_t offset) const {
    return part(offset, offset > bytes_.size() ? 1 : bytes_.size() - offset);
  }
  InputError error(const std::string& message) const { return file_->error(*record_, message); }

 private:
  const KmallFile* file_;
  const KmallRecord* record_;
  std::span<const std::uint8_t> bytes_;
};

/// Takes consecutive parts of a body, whose sizes the body states itself.
class KmallParts {
 public:
  explicit KmallParts(KmallFields body) : rest_(body) {}
  /// Takes a part that begins with its own size as a 16-bit number, and has at least `least` bytes.
  KmallFields sized(std::size_t least) {
    const std::size_t size = rest_.at<std::uint16_t>(0);
    return take(size, least);
  }
  KmallFields take(std::size_t size, std::size_t least = 0) {
    if (size < least)
      throw rest_.error(fmt::format("a part has {} bytes: expected at least {}", size, least));
    const KmallFields part = rest_.part(0, size);
    rest_ = rest_.from(size);
    return part;
  }
  const KmallFields& rest() const { return rest_; }

 private:
  KmallFields rest_;
};

}  // namespace tubefoot
