// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/water_targets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <map>
#include <set>
#include <span>
#include <string>

#include "files/csv_file.hpp"
#include "scene/water_target_places.hpp"

// This file converts the description of targets in the water to targets on the grid. It reads the tables of
// target strengths that `tubefoot strength` writes.

namespace tubefoot {
namespace {

/// A table of cross-sections while it is read. The rows may be in any order.
class StrengthRows {
 public:
  explicit StrengthRows(const std::filesystem::path& file) : whole_{file.string(), 0, 0} {}

  /// Adds a row with the first three values elevation, azimuth and frequency.
  void add(const CsvRow& row, double cross_section, const SourcePlace& value_place) {
    const Key key{row.values[0], row.values[1], row.values[2]};
    if (!(std::abs(key[0]) <= 90))
      throw InputError(row.places[0], fmt::format("elevation_deg is {}: expected -90 to 90", key[0]));
    if (!(std::abs(key[1]) <= 720))
      throw InputError(row.places[1], fmt::format("azimuth_deg is {}: expected -720 to 720", key[1]));
    if (!(key[2] > 0))
      throw InputError(row.places[2], fmt::format("frequency_hz is {}: expected a number above 0", key[2]));
    if (!(cross_section <= 1e12))
      throw InputError(value_place, fmt::format("the cross-section is {:.3g} m2: expected at most 1e12 m2",
                                                cross_section));
    if (!rows_.emplace(key, cross_section).second)
      throw InputError(row.places[0],
                       fmt::format("elevation {} deg, azimuth {} deg and frequency {} Hz appear "
                                   "twice: expected one row for each combination",
                                   key[0], key[1], key[2]));
    for (std::size_t k = 0; k < 3; ++k) axes_[k].insert(key[k]);
  }

  /// Returns the table. Throws InputError unless each combination of the three columns has a row.
  std::shared_ptr<const StrengthOverDirection> table() const {
    if (rows_.empty()) throw InputError(whole_, "has a header but no row: expected at least one row");
    std::vector<double> cross_sections;
    cross_sections.reserve(rows_.size());
    for (const double elevation : axes_[0])
      for (const double azimuth : axes_[1])
        for (const double frequency : axes_[2]) {
          const auto row = rows_.find({elevation, azimuth, frequency});
          if (row == rows_.end())
            throw InputError(whole_, fmt::format("has no row for elevation {} deg, azimuth {} deg and "
                                                 "frequency {} Hz: expected all combinations of the three "
                                                 "columns",
                                                 elevation, azimuth, frequency));
          cross_sections.push_back(row->second);
        }
    const auto axis = [&](std::size_t k) { return std::vector<double>(axes_[k].begin(), axes_[k].end()); };
    try {
      return std::make_shared<const StrengthOverDirection>(axis(0), axis(1), axis(2),
                                                           std::move(cross_sections));
    } catch (const std::invalid_argument& error) {
      throw InputError(whole_, error.what());
    }
  }

 private:
  using Key = std::array<double, 3>;  // elevation, azimuth, frequency

  SourcePlace whole_;
  std::map<Key, double> rows_;
  std::array<std::set<double>, 3> axes_;
};

/// Reads a table of target strengths that `tubefoot strength` writes, or one without lengths. The length is
/// preferred, because the target strength of a length of 0 is minus infinity.
std::shared_ptr<const StrengthOverDirection> read_strengths(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 4> with_strength{"elevation_deg", "azimuth_deg", "frequency_hz",
                                                          "target_strength_db"};
  constexpr std::array<std::string_view, 2> lengths{"length_re_m", "length_im_m"};
  bool has_lengths = true;
  StrengthRows by_length(file);
  read_csv(file, std::span(with_strength).first(3), lengths, [&](const CsvRow& row) {
    const double re = row.values[3], im = row.values[4];
    has_lengths = has_lengths && !std::isnan(re) && !std::isnan(im);
    if (has_lengths) by_length.add(row, re * re + im * im, row.places[3]);
  });
  if (has_lengths) return by_length.table();
  StrengthRows by_level(file);
  read_csv(file, with_strength,
           [&](const CsvRow& row) { by_level.add(row, cross_section_m2(row.values[3]), row.places[3]); });
  return by_level.table();
}

/// Hash of a text (Fowler, Noll, Vo: FNV-1a), the same on all machines.
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

}  // namespace

bool has_water_targets(const SceneDescription& description) {
  return !description.targets.empty() || !description.target_populations.empty();
}

std::shared_ptr<const WaterTargets> load_water_targets(const Scene& scene) {
  const SceneDescription& d = scene.description;
  auto made = std::make_shared<WaterTargets>();
  for (const WaterTargetDescription& described : d.targets) {
    WaterTarget& target = made->single.emplace_back();
    target.at = scene.grid.snap(position_of(described, scene.frame));
    if (described.strength.file)
      target.table = read_strengths(*described.strength.file);
    else
      target.cross_section_m2 = cross_section_m2(described.strength.target_strength_db.value_or(0));
    target.attitude =
        attitude_from_angles(glm::radians(described.heading_deg), glm::radians(described.pitch_deg),
                             glm::radians(described.roll_deg));
  }
  for (const TargetPopulationDescription& described : d.target_populations) {
    const Extent extent = extent_of(described, sea_surface_height_m(d));
    made->populations.push_back({extent.lo_m, extent.hi_m, described.density_per_m3,
                                 described.strength.target_strength_db.value_or(0),
                                 described.strength_spread_db, described.seed ^ hash_of(described.name)});
  }
  return made;
}

}  // namespace tubefoot
