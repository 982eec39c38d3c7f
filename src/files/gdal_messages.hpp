// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace tubefoot {

/// Collects what GDAL has to say while it lives, on this thread, and keeps HDF5 under it quiet, so that
/// nothing is printed past the program.
class GdalMessages {
 public:
  GdalMessages();
  ~GdalMessages();
  GdalMessages(const GdalMessages&) = delete;
  GdalMessages& operator=(const GdalMessages&) = delete;

  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<std::string>& failures() const { return failures_; }
  /// " (GDAL: first failure)", or nothing.
  std::string in_brackets() const;

 private:
  std::vector<std::string> warnings_, failures_;
};

}  // namespace tubefoot
