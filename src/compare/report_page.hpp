// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace tubefoot {

/// Contents of the page of a comparison.
struct ReportContents {
  const nlohmann::ordered_json& figures;  ///< as in `compare --json`, with `diagnosis` of each sensor
  std::vector<unsigned char> png;         ///< picture of reference, candidate and their ratio
  std::string caption;
  std::vector<std::string> files;  ///< descriptions of the compared files, one line each
  std::string command;             ///< command that makes the page again
};

/// Returns one self-contained HTML page: findings, pictures, figures, and the command that repeats the
/// comparison.
std::string report_page(const ReportContents& contents);

/// Base64 encoding of RFC 4648.
std::string base64(const std::vector<unsigned char>& bytes);

}  // namespace tubefoot
