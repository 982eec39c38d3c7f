// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tubefoot {

/// A topic in one file: the messages of one name and one type.
struct BagTopic {
  std::string name, type;
  std::string format;      ///< serialization format, for example "cdr"
  std::string definition;  ///< definition of the type as in the file (ros2msg), or empty
  std::uint64_t messages = 0;
};

/// Position of a message, in terms that depend on the file format.
struct MessagePlace {
  std::int64_t time_ns = 0;  ///< time of recording
  std::uint64_t outer = 0, inner = 0, bytes = 0;
};

/// One file of a recording.
class MessageStore {
 public:
  virtual ~MessageStore() = default;
  virtual const std::vector<BagTopic>& topics() const = 0;
  /// Returns the messages of a topic of topics(), in any order. Messages of equal time keep the order of
  /// the file.
  virtual std::vector<MessagePlace> messages(std::size_t topic) = 0;
  /// Returns the bytes of a message, valid until the next call. Reading in the order of outer and inner is
  /// fastest. Throws InputError at the file.
  virtual std::span<const std::uint8_t> read(const MessagePlace& message) = 0;
};

}  // namespace tubefoot
