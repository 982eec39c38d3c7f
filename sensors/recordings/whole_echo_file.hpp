// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "sensors/recordings/echo_reader.hpp"

namespace tubefoot {

/// Any numeric variable of a file.
struct EchoVariable {
  std::string name;
  std::vector<std::string> dimensions;
  std::vector<std::size_t> shape;
  std::string units, long_name, flag_meanings;  ///< empty if the file has none
  std::vector<double> values;                   ///< unchecked: some may be NaN

  bool along(const std::vector<std::string>& names) const { return dimensions == names; }
};

/// A text or a number.
struct EchoAttribute {
  std::string name;
  std::variant<std::string, double> value;
};

/// All contents of an echo file, for inspection as the result of a run.
struct WholeEchoFile {
  /// Contents of a sensor's group in addition to its SensorEchoes.
  struct More {
    std::vector<EchoAttribute> attributes;
    std::vector<EchoVariable> variables;  ///< in the file's order
    /// Null if there is none.
    const EchoVariable* variable(const std::string& name) const;
    const EchoAttribute* attribute(const std::string& name) const;
  };
  EchoContents contents;
  std::vector<EchoAttribute> attributes;  ///< of the file; without those of a sensor in the root group
  std::vector<More> more;                 ///< by sensor
};

/// Reads a file as read_echo_file() does, and in addition all other numeric variables with dimensions. The
/// result also has all attributes that are a number or a text of at most 64 kB.
WholeEchoFile read_whole_echo_file(const std::filesystem::path& file);

}  // namespace tubefoot
