// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace tubefoot {

/// Collects GDAL's messages on this thread while the object exists. It also silences HDF5 below GDAL, so
/// that nothing is printed outside of tubefoot's own messages.
class GdalMessages {
 public:
  GdalMessages();
  ~GdalMessages();
  GdalMessages(const GdalMessages&) = delete;
  GdalMessages& operator=(const GdalMessages&) = delete;

  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<std::string>& failures() const { return failures_; }
  /// Returns " (GDAL: first failure)", or an empty text.
  std::string in_brackets() const;

 private:
  std::vector<std::string> warnings_, failures_;
};

}  // namespace tubefoot
