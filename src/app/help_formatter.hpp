// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace tubefoot {

/// Prints the help of commands. An option shows its names and either its choices ("tube|ray") or a
/// placeholder ("FOLDER"). Descriptions are wrapped to 100 columns.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
};

}  // namespace tubefoot
