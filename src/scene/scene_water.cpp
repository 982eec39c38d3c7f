// SPDX-License-Identifier: GPL-3.0-or-later

// Computes the sound-speed profile and the absorption of a scene's water, from formulas, tables or casts
// (sound_speed.hpp). A cast gives temperature and salinity as functions of depth.

#include "scene/scene_water.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "engine/water/absorption.hpp"
#include "engine/water/sound_speed.hpp"
#include "files/csv_file.hpp"

namespace tubefoot {
namespace {

double formula_speed_m_s(const WaterDescription& water, double temperature_c, double salinity_psu,
                         double depth_m) {
  return water.sound_speed_formula == "leroy"
             ? leroy_sound_speed_m_s(temperature_c, salinity_psu, depth_m, water.latitude_deg.value_or(45))
             : mackenzie_sound_speed_m_s(temperature_c, salinity_psu, depth_m);
}

double model_db_per_km(const WaterDescription& water, double frequency_khz, double temperature_c,
                       double salinity_psu, double depth_m) {
  if (water.absorption_db_per_km) return *water.absorption_db_per_km;
  return water.absorption_model == "ainslie-mccolm"
             ? ainslie_mccolm_absorption_db_per_km(frequency_khz, temperature_c, salinity_psu, depth_m,
                                                   water.ph)
             : francois_garrison_absorption_db_per_km(frequency_khz, temperature_c, salinity_psu, depth_m,
                                                      water.ph);
}

/// Throws InputError at the place of a value outside of [lo, hi].
void check(const CsvRow& row, std::size_t column, std::string_view name, double lo, double hi) {
  const double value = row.values[column];
  if (!(value >= lo && value <= hi))
    throw InputError(row.places[column], fmt::format("{} is {}, expected {:g} to {:g}", name, value, lo, hi));
}

void check_depth(const CsvRow& row, bool first, double depth_before_m) {
  check(row, 0, "depth_m", -100, 12000);
  constexpr double least_step_m = 1e-6;  // for smaller steps, the gradient is not a finite number
  if (!first && !(row.values[0] - depth_before_m >= least_step_m))
    throw InputError(row.places[0],
                     fmt::format("depth_m must increase: {} follows {}", row.values[0], depth_before_m));
}

}  // namespace

double absorption_db_per_km(const WaterDescription& water, double frequency_khz) {
  return model_db_per_km(water, frequency_khz, water.temperature_c, water.salinity_psu, water.depth_m);
}

SceneWater::SceneWater(const WaterDescription& description) : description_(description) {
  try {
    profile_ = SoundSpeedProfile(points());
    for (const ProfilePoint& p : profile_.points()) {
      if (!(p.sound_speed_m_s >= 100 && p.sound_speed_m_s <= 10000))
        throw std::invalid_argument(
            fmt::format("the profile \"{}\" gives {} m/s at a depth of {} m, expected 100 to 10000: change "
                        "its parameters "
                        "or 'profile_bottom_m'",
                        description_.profile, p.sound_speed_m_s, p.depth_m));
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(description_.place, error.what());
  }
}

bool SceneWater::has_same_speeds(const SceneWater& other) const {
  if (!refracts() && !other.refracts()) return profile_.at(0) == other.profile_.at(0);
  return surface_height_m() == other.surface_height_m() &&
         std::ranges::equal(profile_.points(), other.profile_.points(),
                            [](const ProfilePoint& a, const ProfilePoint& b) {
                              return a.depth_m == b.depth_m && a.sound_speed_m_s == b.sound_speed_m_s;
                            });
}

std::vector<ProfilePoint> SceneWater::read_table() const {
  constexpr std::array<std::string_view, 2> columns = {"depth_m", "sound_speed_m_s"};
  std::vector<ProfilePoint> points;
  read_csv(*description_.profile_file, columns, [&](const CsvRow& row) {
    check_depth(row, points.empty(), points.empty() ? 0 : points.back().depth_m);
    check(row, 1, columns[1], 1300, 1700);
    points.push_back({row.values[0], row.values[1]});
  });
  return points;
}

std::vector<ProfilePoint> SceneWater::read_cast() {
  constexpr std::array<std::string_view, 3> columns = {"depth_m", "temperature_c", "salinity_psu"};
  // Valid salinities of the formulas: Mackenzie 25 to 40, Leroy up to 42 (engine/water/sound_speed.hpp).
  const bool leroy = description_.sound_speed_formula == "leroy";
  std::vector<ProfilePoint> points;
  read_csv(*description_.profile_file, columns, [&](const CsvRow& row) {
    check_depth(row, points.empty(), points.empty() ? 0 : points.back().depth_m);
    check(row, 1, columns[1], -2, leroy ? 35 : 30);
    check(row, 2, columns[2], leroy ? 0 : 25, leroy ? 42 : 40);
    const double depth = row.values[0], t = row.values[1], s = row.values[2];
    cast_.push_back({depth, t, s});
    points.push_back({depth, formula_speed_m_s(description_, t, s, depth)});
  });
  return points;
}

std::vector<ProfilePoint> SceneWater::points() {
  const WaterDescription& w = description_;
  if (w.profile == "table" || w.profile == "cast") {
    std::vector<ProfilePoint> read = w.profile == "table" ? read_table() : read_cast();
    if (read.empty())
      throw InputError({w.profile_file->string(), 0, 0},
                       "has a header but no rows, expected at least one depth");
    return read;
  }
  if (w.profile == "constant") {
    return {{0, w.sound_speed_m_s ? *w.sound_speed_m_s
                                  : formula_speed_m_s(w, w.temperature_c, w.salinity_psu, w.depth_m)}};
  }
  const double c0 = *w.sound_speed_m_s, bottom = *w.profile_bottom_m;
  if (w.profile == "gradient") return {{0, c0}, {bottom, c0 + *w.gradient_per_s * bottom}};
  const auto speed = [&](double z) {
    return w.profile == "munk"
               ? munk_sound_speed_m_s(z, c0, w.munk_axis_m.value_or(1300), w.munk_scale_m.value_or(1300),
                                      w.munk_epsilon.value_or(0.00737))
               : n2_linear_sound_speed_m_s(z, c0, *w.gradient_per_s);
  };
  return w.profile_step_m ? sample_profile(speed, 0, bottom, *w.profile_step_m)
                          : sample_profile_within(speed, 0, bottom, w.profile_error_m_s.value_or(0.01));
}

WaterColumn SceneWater::column(double frequency_khz) const {
  WaterColumn column{profile_, {}};
  for (std::size_t layer = 0; layer < profile_.layers(); ++layer) {
    // The outermost layers use the values at the ends of the profile.
    const std::size_t last = profile_.points().size() - 1;
    const std::size_t above = layer == 0 ? 0 : layer - 1, below = std::min(layer, last);
    double t = description_.temperature_c, s = description_.salinity_psu;
    double depth = (profile_.points()[above].depth_m + profile_.points()[below].depth_m) / 2;
    if (description_.profile == "constant") depth = description_.depth_m;
    if (!cast_.empty()) {
      t = (cast_[above].temperature_c + cast_[below].temperature_c) / 2;
      s = (cast_[above].salinity_psu + cast_[below].salinity_psu) / 2;
    }
    column.absorption_db_per_m.push_back(model_db_per_km(description_, frequency_khz, t, s, depth) / 1000);
  }
  return column;
}

}  // namespace tubefoot
