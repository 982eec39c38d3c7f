// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace tubefoot {

/// What a page of a comparison is made of.
struct ReportContents {
  const nlohmann::ordered_json& figures;  ///< as `compare --json`, with `diagnosis` of each sensor
  std::vector<unsigned char> png;         ///< of reference, candidate and their ratio
  std::string caption;
  std::vector<std::string> files;  ///< what was compared: a line each
  std::string command;             ///< that makes the page again
};

/// One self-contained page (HTML): findings, pictures, figures, how to repeat it.
std::string report_page(const ReportContents& contents);

/// RFC 4648.
std::string base64(const std::vector<unsigned char>& bytes);

}  // namespace tubefoot
