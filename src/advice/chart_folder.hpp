// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "study/work_precision.hpp"

namespace tubefoot {

/// Relative bound of the reference of a chart.
constexpr double chart_reference_tolerance = 1e-7;

/// Returns a sentence on the measurement of a chart; `program` is HTML.
std::string chart_origin(const std::string& program, const std::string& pings, int repeats);

/// Writes index.html, chart.csv and the diagrams of each scene. Throws std::runtime_error, which names the
/// file.
void write_chart(const std::filesystem::path& folder, std::span<const Trial> trials,
                 const std::string& origin);

}  // namespace tubefoot
