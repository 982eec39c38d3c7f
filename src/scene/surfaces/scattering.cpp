// SPDX-License-Identifier: GPL-3.0-or-later

// Creates the scattering models of materials (docs/environment.md): GSAB, tables of angles and levels, and
// sediments. It checks that a model scatters no more energy than it receives.

#include "scene/surfaces/scattering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "engine/scattering/sediment.hpp"
#include "files/csv_file.hpp"
#include "files/input_registry.hpp"
#include "geometry/numbers/scalars.hpp"
#include "scene/description/scene_description.hpp"
#include "scene/surfaces/sea_surface.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t most_rows = 1000;

double from_db(double db) { return std::pow(10, db / 10); }

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

struct Table {
  std::vector<double> grazing_deg, strength_db;
};

/// Reads rows "grazing angle in degrees, level in dB". Blank lines and text from # on are left out.
Table read_table(const std::filesystem::path& file) {
  SourcePlace place{file.string(), 0, 0};
  InputFile input(file);
  std::istream& in = input.stream();
  Table table;
  for (std::string line; ++place.line, next_line(in, line, place);) {
    const std::string_view text = trimmed(line);
    if (text.empty() || text.starts_with('#')) continue;
    std::array<double, 2> row{};
    const std::size_t comma = text.find(',');
    const std::array<std::string_view, 2> cells{
        trimmed(text.substr(0, comma)),
        comma == text.npos ? std::string_view() : trimmed(text.substr(comma + 1))};
    for (std::size_t k = 0; k < 2; ++k) {
      const char* end = cells[k].data() + cells[k].size();
      const auto [rest, error] = std::from_chars(cells[k].data(), end, row[k]);
      if (error != std::errc() || rest != end || !std::isfinite(row[k]))
        throw InputError(
            place, fmt::format("the row is '{}', expected a grazing angle in degrees, a comma and a level in "
                               "dB",
                               text));
    }
    if (!(row[0] > 0 && row[0] <= 90))
      throw InputError(
          place, fmt::format("the grazing angle must be above 0 and at most 90 degrees, not {}", row[0]));
    if (!table.grazing_deg.empty() && !(row[0] > table.grazing_deg.back()))
      throw InputError(place, fmt::format("grazing angles must increase: {} follows {}", row[0],
                                          table.grazing_deg.back()));
    if (!(row[1] >= -300 && row[1] <= 100))
      throw InputError(place, fmt::format("the level must be from -300 to 100 dB, not {}", row[1]));
    if (table.grazing_deg.size() == most_rows)
      throw InputError(place, fmt::format("the table has more than {} rows: thin it out", most_rows));
    table.grazing_deg.push_back(row[0]);
    table.strength_db.push_back(row[1]);
  }
  if (in.bad()) throw InputError(place, "cannot be read to the end");
  if (table.grazing_deg.empty())
    throw InputError({file.string(), 0, 0},
                     "has no rows, expected a grazing angle in degrees and a level in dB per row");
  return table;
}

ScatteringModel::Gsab gsab_of(const MaterialDescription& m) {
  const auto level = [](const std::optional<double>& db) { return db ? from_db(*db) : 0.0; };
  return {.specular = level(m.specular_db),
          .specular_width_rad = m.specular_width_deg.value_or(1) * degree,
          .oblique = level(m.oblique_db),
          .oblique_exponent = m.oblique_exponent.value_or(2),
          .transition = level(m.transition_db),
          .transition_width_rad = m.transition_width_deg.value_or(1) * degree};
}

/// A key of a GSAB model.
struct GsabKey {
  ScatteringKey key;
  ScatteringDerivative::Gsab parameter;
  std::optional<double> MaterialDescription::*value;
};
constexpr std::array<GsabKey, 6> gsab_keys{
    {{{"specular_db", "dB"}, ScatteringDerivative::Gsab::specular, &MaterialDescription::specular_db},
     {{"specular_width_deg", "degrees"},
      ScatteringDerivative::Gsab::specular_width_rad,
      &MaterialDescription::specular_width_deg},
     {{"oblique_db", "dB"}, ScatteringDerivative::Gsab::oblique, &MaterialDescription::oblique_db},
     {{"oblique_exponent", ""},
      ScatteringDerivative::Gsab::oblique_exponent,
      &MaterialDescription::oblique_exponent},
     {{"transition_db", "dB"}, ScatteringDerivative::Gsab::transition, &MaterialDescription::transition_db},
     {{"transition_width_deg", "degrees"},
      ScatteringDerivative::Gsab::transition_width_rad,
      &MaterialDescription::transition_width_deg}}};

ScatteringModel make_model(const MaterialDescription& m) {
  if (m.model == "gsab") return ScatteringModel::gsab(gsab_of(m));
  if (m.model == "sediment")
    return ScatteringModel::table(sediment_grazing_deg,
                                  sediment_backscatter(*m.sediment, m.sediment_khz).strength_db);
  if (!m.table_file) return ScatteringModel::table(m.table_grazing_deg, m.table_db);
  const Table table = read_table(*m.table_file);
  return ScatteringModel::table(table.grazing_deg, table.strength_db);
}

}  // namespace

std::vector<std::shared_ptr<const ScatteringModel>> load_scattering(const SceneDescription& scene,
                                                                    std::vector<std::string>& warnings) {
  std::vector<std::shared_ptr<const ScatteringModel>> models;
  for (const MaterialDescription& m : scene.materials) {
    const double mirrored = m.specular_loss_db ? from_db(-*m.specular_loss_db) : 0;
    if (m.model == "lambert") {
      models.emplace_back();
      if (const double returned = std::numbers::pi * from_db(m.lambert_db) + mirrored; returned > 1 + 1e-9)
        warnings.push_back(fmt::format(
            "material '{}' scatters and mirrors {:.3g} times the energy that it receives, which 'unbounded' "
            "allows",
            m.name, returned));
      continue;
    }
    try {
      models.push_back(std::make_shared<const ScatteringModel>(
          m.model == sea_surface_model ? sea_surface_scattering(scene, warnings) : make_model(m)));
    } catch (const std::invalid_argument& e) {
      throw InputError(m.place, fmt::format("material '{}': {}", m.name, e.what()));
    }
    // The model of the sea surface is measured for transmitter and receiver at one place. Its albedo follows
    // from the rule for separate receivers, which does not apply to narrow specular lobes.
    if (m.model == sea_surface_model) continue;
    const ScatteringModel::Albedo most = models.back()->largest_albedo();
    if (most.value + mirrored > 1 + 1e-9) {
      const std::string what = fmt::format(
          "material '{}' {} {:.3g} times the energy that it receives at a grazing angle of {:.3g} degrees",
          m.name, mirrored > 0 ? "scatters and mirrors" : "scatters", most.value + mirrored,
          most.grazing_rad / degree);
      if (!m.unbounded)
        throw InputError(m.place, what + ": reduce its levels, or set unbounded = true if this is intended");
      warnings.push_back(what + ", which 'unbounded' allows");
    }
    if (m.model != "sediment") continue;
    for (const SensorDescription& sensor : scene.sensors)
      if (const double frequency_khz = figures_of(sensor).frequency_khz,
          ratio = frequency_khz / m.sediment_khz;
          ratio > sediment_frequency_ratio || ratio < 1 / sediment_frequency_ratio)
        warnings.push_back(fmt::format(
            "material '{}' uses the table of '{}' at {:g} kHz, but sensor '{}' works at {:g} kHz: the table "
            "is meant for {:.3g} to {:.3g} kHz",
            m.name, *m.sediment, m.sediment_khz, sensor.name, frequency_khz,
            m.sediment_khz / sediment_frequency_ratio, m.sediment_khz * sediment_frequency_ratio));
  }
  return models;
}

std::vector<ScatteringKey> scattering_keys(const MaterialDescription& m) {
  std::vector<ScatteringKey> keys;
  if (m.model == "gsab")
    for (const GsabKey& of : gsab_keys)
      if (m.*of.value || (of.key.name == "oblique_exponent" && m.oblique_db)) keys.push_back(of.key);
  if (m.model == "table" && !m.table_file)
    keys = {{"table_db", "dB", true}, {"table_grazing_deg", "degrees", true}};
  return keys;
}

ScatteringDerivative scattering_derivative(const MaterialDescription& m, std::string_view key,
                                           std::size_t number) {
  if (key == "table_db") return ScatteringDerivative::table_strength(m.table_grazing_deg, m.table_db, number);
  if (key == "table_grazing_deg")
    return ScatteringDerivative::table_angle(m.table_grazing_deg, m.table_db, number);
  const auto found = std::ranges::find(gsab_keys, key, [](const GsabKey& of) { return of.key.name; });
  if (found == gsab_keys.end())
    throw std::invalid_argument(fmt::format("material '{}' has no derivative by '{}'", m.name, key));
  const double level = from_db((m.*found->value).value_or(0));
  const double scale = found->key.unit == "dB"        ? level * std::numbers::ln10 / 10
                       : found->key.unit == "degrees" ? degree
                                                      : 1;
  return ScatteringDerivative::gsab(gsab_of(m), found->parameter).scaled(scale);
}

}  // namespace tubefoot
