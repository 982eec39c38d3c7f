// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sensors/recordings/recording.hpp"

// Files of surveys, one per survey line.
namespace tubefoot {

/// Names of such files without extension, by line. It is the sensor's name, followed with several lines by
/// `-line-01` and so on.
std::vector<std::string> line_names(const Recording& recording);

/// The files of one format, each constructed from a path and a header, one per line of the survey. Pings
/// come in order, so that one file is open at a time. The format removes an unfinished file.
template <class File, class Header>
class LineFiles {
 public:
  /// `headers`: by line.
  LineFiles(const std::filesystem::path& folder, const char* ending, const Recording& recording,
            std::vector<Header> headers)
      : lines_(recording.lines()), headers_(std::move(headers)) {
    for (const std::string& name : line_names(recording)) {
      names_.emplace_back(name + ending);
      paths_.push_back(folder / names_.back());
    }
  }

  const std::vector<std::filesystem::path>& names() const { return names_; }
  bool is_first_of_its_line(std::size_t ping) const { return lines_[line_of(ping)].first == ping; }
  /// The line of a ping.
  std::size_t line_of(std::size_t ping) const {
    const auto after =
        std::upper_bound(lines_.begin(), lines_.end(), ping,
                         [](std::size_t one, const PingSpan& line) { return one < line.first; });
    return static_cast<std::size_t>(after - lines_.begin()) - 1;
  }
  /// The file to which a ping is added.
  File& of(std::size_t ping) {
    if (const std::size_t line = line_of(ping); !file_ || line != open_line_) {
      finish();
      file_.emplace(paths_[line], headers_[line]);
      open_line_ = line;
    }
    return *file_;
  }
  void finish() {
    if (file_) file_->finish();
    file_.reset();
  }

 private:
  std::vector<PingSpan> lines_;
  std::vector<Header> headers_;
  std::vector<std::filesystem::path> names_, paths_;
  std::optional<File> file_;
  std::size_t open_line_ = 0;
};

}  // namespace tubefoot
