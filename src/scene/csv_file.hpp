// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "scene/input_error.hpp"

namespace tubefoot {

/// One row of a CSV file: the values of the wanted columns, in the order they were asked for, all finite.
struct CsvRow {
  std::span<const double> values;
  std::span<const SourcePlace> places;  ///< of each value
};

/// Reads numbers from a CSV file: a header line that names `columns`, in any order (further columns are
/// ignored), then rows, each handed to `take`. Blank lines and lines that start with # are skipped. Returns
/// the number of rows. Throws InputError "file:line:column: ...".
std::size_t read_csv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                     const std::function<void(const CsvRow&)>& take);

}  // namespace tubefoot
