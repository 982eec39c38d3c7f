// SPDX-License-Identifier: GPL-3.0-or-later
// Compares a table of target strengths with a CSV file, direction by direction.
#include "strength/strength_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "engine/signal/target_strength.hpp"
#include "files/csv_file.hpp"
#include "files/input_error.hpp"

namespace tubefoot {
namespace {

/// Returns the index of the value that differs by at most `tolerance`. The values increase.
std::optional<std::size_t> index_of(const std::vector<double>& values, double value, double tolerance) {
  const auto at = std::lower_bound(values.begin(), values.end(), value - tolerance);
  if (at == values.end() || *at > value + tolerance) return std::nullopt;
  return static_cast<std::size_t>(at - values.begin());
}

/// Returns the number at the share `part` of sorted numbers. It is one of them, because numbers can be
/// infinite.
double quantile(const std::vector<double>& sorted, double part) {
  return sorted[static_cast<std::size_t>(std::lround(part * static_cast<double>(sorted.size() - 1)))];
}

}  // namespace

StrengthComparison read_comparison(const std::filesystem::path& file, const StrengthRequest& request) {
  constexpr std::array<std::string_view, 3> columns{"azimuth_deg", "frequency_hz", "target_strength_db"};
  constexpr std::array<std::string_view, 1> optional_columns{"elevation_deg"};
  constexpr double angle_tolerance = 1e-6, frequency_tolerance = 1e-9;
  const std::size_t azimuths = request.azimuths_deg.size(), frequencies = request.frequencies_hz.size();
  StrengthComparison comparison{file.filename().string(),
                                std::vector<double>(request.elevations_deg.size() * azimuths * frequencies,
                                                    std::numeric_limits<double>::quiet_NaN())};
  bool found = false;
  read_csv(file, columns, optional_columns, [&](const CsvRow& row) {
    const double hertz = row.values[1], elevation = std::isnan(row.values[3]) ? 0 : row.values[3];
    const auto f = index_of(request.frequencies_hz, hertz, hertz * frequency_tolerance);
    const auto e = index_of(request.elevations_deg, elevation, angle_tolerance);
    if (!f || !e) return;
    // A request can contain the same direction as -180 and 180 degrees, or as 0 and 360.
    const double azimuth = std::remainder(row.values[0], 360);
    for (const double turn : {-360.0, 0.0, 360.0}) {
      const auto a = index_of(request.azimuths_deg, azimuth + turn, angle_tolerance);
      if (!a) continue;
      double& value = comparison.strength_db[(*e * azimuths + *a) * frequencies + *f];
      if (!std::isnan(value))
        throw InputError(
            row.places[0],
            fmt::format("second value for elevation {:g}, azimuth {:g} and {:g} Hz: expected one "
                        "row per direction and frequency; remove one of the rows",
                        elevation, row.values[0], hertz));
      value = row.values[2];
      found = true;
    }
  });
  if (!found)
    throw InputError({file.string(), 0, 0},
                     "no row has a requested direction and frequency: expected rows for some of them; set "
                     "--azimuths, --elevations and --frequencies as in the file");
  return comparison;
}

double difference_db(const StrengthTable& table, std::size_t elevation, std::size_t azimuth,
                     std::size_t frequency) {
  if (!table.comparison) return std::numeric_limits<double>::quiet_NaN();
  return target_strength_db(table.at(elevation, azimuth, frequency)) -
         table.comparison->strength_db[table.index(elevation, azimuth, frequency)];
}

std::vector<StrengthDifference> differences_of(const StrengthTable& table) {
  const StrengthRequest& request = table.request;
  std::vector<StrengthDifference> differences;
  for (std::size_t f = 0; f < request.frequencies_hz.size(); ++f) {
    StrengthDifference& difference = differences.emplace_back();
    difference.frequency_hz = request.frequencies_hz[f];
    std::vector<double> sizes;
    double ours = 0, others = 0;
    for (std::size_t e = 0; e < request.elevations_deg.size(); ++e)
      for (std::size_t a = 0; a < request.azimuths_deg.size(); ++a) {
        const double size = std::abs(difference_db(table, e, a, f));
        if (std::isnan(size)) continue;
        ours += std::norm(table.at(e, a, f));
        others += std::pow(10, table.comparison->strength_db[table.index(e, a, f)] / 10);
        if (sizes.empty() || size > difference.largest_db) {
          difference.largest_db = size;
          difference.largest_elevation = e;
          difference.largest_azimuth = a;
        }
        sizes.push_back(size);
      }
    difference.directions = sizes.size();
    if (sizes.empty()) continue;
    std::ranges::sort(sizes);
    difference.median_db = quantile(sizes, 0.5);
    difference.ninth_decile_db = quantile(sizes, 0.9);
    difference.mean_db = 10 * std::log10(ours / others);
  }
  return differences;
}

std::string in_words(const std::vector<StrengthDifference>& differences, const StrengthTable& table) {
  if (!table.comparison) return {};
  std::string words;
  for (const StrengthDifference& d : differences)
    words += d.directions == 0
                 ? fmt::format("difference     {:g} Hz: the file has no value\n", d.frequency_hz)
                 : fmt::format(
                       "difference     {:g} Hz: {} directions, median {:.2f} dB, 90 % below {:.2f} dB, "
                       "largest {:.2f} dB at elevation {:g}, azimuth {:g}; mean cross-section "
                       "{:+.2f} dB\n",
                       d.frequency_hz, d.directions, d.median_db, d.ninth_decile_db, d.largest_db,
                       table.request.elevations_deg[d.largest_elevation],
                       table.request.azimuths_deg[d.largest_azimuth], d.mean_db);
  return words;
}

}  // namespace tubefoot
