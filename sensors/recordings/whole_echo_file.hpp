// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "sensors/recordings/echo_reader.hpp"

namespace tubefoot {

/// A variable of numbers, whatever it is of.
struct EchoVariable {
  std::string name;
  std::vector<std::string> dimensions;
  std::vector<std::size_t> shape;
  std::string units, long_name, flag_meanings;  ///< empty where the file does not say
  std::vector<double> values;                   ///< as they are: some may be no number

  bool along(const std::vector<std::string>& names) const { return dimensions == names; }
};

/// A text or a number.
struct EchoAttribute {
  std::string name;
  std::variant<std::string, double> value;
};

/// All of an echo file, to be looked at as what a run returned.
struct WholeEchoFile {
  /// What a file has of a sensor beside its SensorEchoes.
  struct More {
    std::vector<EchoAttribute> attributes;
    std::vector<EchoVariable> variables;  ///< in the file's order
    /// Null where there is none.
    const EchoVariable* variable(const std::string& name) const;
    const EchoAttribute* attribute(const std::string& name) const;
  };
  EchoContents contents;
  std::vector<EchoAttribute> attributes;  ///< of the file; of one whose sensor is its root, not the sensor's
  std::vector<More> more;                 ///< by sensor
};

/// As read_echo_file(), which this reads as well, with all other variables of numbers along dimensions and
/// all attributes that are a number or a text of at most 64 kB.
WholeEchoFile read_whole_echo_file(const std::filesystem::path& file);

}  // namespace tubefoot
