// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tubefoot {

/// What a file of a recording has under one name and of one type.
struct BagTopic {
  std::string name, type;
  std::string format;      ///< of its messages: "cdr"
  std::string definition;  ///< of the type, as the file has it (ros2msg); else empty
  std::uint64_t messages = 0;
};

/// A message of a file; where it is, the file knows.
struct MessagePlace {
  std::int64_t time_ns = 0;  ///< when it was recorded
  std::uint64_t outer = 0, inner = 0, bytes = 0;
};

/// One file of a recording.
class MessageStore {
 public:
  virtual ~MessageStore() = default;
  virtual const std::vector<BagTopic>& topics() const = 0;
  /// Of a topic of topics(), in no order but, where times are equal, that of the file.
  virtual std::vector<MessagePlace> messages(std::size_t topic) = 0;
  /// Its bytes, until the next is asked for: cheapest in the order of outer and inner. Throws InputError at
  /// the file.
  virtual std::span<const std::uint8_t> read(const MessagePlace& message) = 0;
};

}  // namespace tubefoot
