// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "import/bags/sonar_messages.hpp"
#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// What was noticed, once each, with how many messages it is of.
class Notices {
 public:
  /// `text` may differ between messages; the first one's stays.
  void add(const std::string& kind, const std::string& text);
  std::vector<std::string> told(std::size_t messages) const;

 private:
  struct Notice {
    std::string kind, text;
    std::size_t messages = 0;
  };
  std::vector<Notice> notices_;
};

/// The picture that a message holds. Its time is the message's own; none where that is 0. Throws
/// MessageError where its fields do not agree, or there is no picture in it.
ForeignFrame frame_of(const ros::Message& message, Notices& notices);

}  // namespace tubefoot
