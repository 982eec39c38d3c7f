// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "import/bags/sonar_messages.hpp"
#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// Collects remarks about messages, each with the number of messages that it concerns.
class Notices {
 public:
  /// Counts a remark. `text` may differ between messages; the first text is kept.
  void add(const std::string& kind, const std::string& text);
  std::vector<std::string> told(std::size_t messages) const;

 private:
  struct Notice {
    std::string kind, text;
    std::size_t messages = 0;
  };
  std::vector<Notice> notices_;
};

/// Returns the picture of a message. Its time is that of the message, or none if that is 0. Throws
/// MessageError if fields contradict each other or the message contains no picture.
ForeignFrame frame_of(const ros::Message& message, Notices& notices);

}  // namespace tubefoot
