// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tubefoot {

/// Prints the help of commands. An option shows its names and either its choices ("tube|ray") or a
/// placeholder ("FOLDER"). Descriptions are wrapped to 100 columns.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  /// CLI11 separates groups by two blank lines. This formatter uses one.
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override;
};

}  // namespace tubefoot
