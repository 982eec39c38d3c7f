// SPDX-License-Identifier: GPL-3.0-or-later

// Keys of a material for its scattering model (Lambert, GSAB, table, sediment; docs/environment.md) and for
// its smooth surface (docs/signals.md), with the conditions between them.

#include "scene/file/scene_file_scattering.hpp"

#include <algorithm>

#include "engine/scattering/sediment.hpp"

namespace tubefoot {
namespace {

struct ModelKeys {
  std::string_view model;
  std::vector<std::string_view> keys;
};
const std::vector<ModelKeys>& keys_of_models() {
  static const std::vector<ModelKeys> keys{{"lambert", {"lambert_db"}},
                                           {"gsab",
                                            {"specular_db", "specular_width_deg", "oblique_db",
                                             "oblique_exponent", "transition_db", "transition_width_deg"}},
                                           {"table", {"table_grazing_deg", "table_db", "table_file"}},
                                           {"sediment", {"sediment", "sediment_khz"}}};
  return keys;
}

void check_pair(const TomlTable& table, std::string_view one, std::string_view other) {
  if (table.has(one) && !table.has(other))
    throw InputError(table.place_of(one), fmt::format("'{}' needs the key '{}' as well", one, other));
  if (table.has(other) && !table.has(one))
    throw InputError(table.place_of(other), fmt::format("'{}' needs the key '{}' as well", other, one));
}

}  // namespace

std::vector<TomlField<MaterialDescription>> scattering_fields() {
  using M = MaterialDescription;
  // 10 log10(1 / pi), rounded down. Energy conservation requires pi mu <= 1 for Lambert's law.
  constexpr ValueRange lambert{
      .lo = -120, .hi = -4.9715, .if_above = "a surface cannot scatter more than it receives"};
  constexpr ValueRange level{.lo = -120, .hi = 40}, width{.lo = 0.1, .hi = 90}, exponent{.lo = 0, .hi = 10},
      table_level{.lo = -300, .hi = 100}, grazing{.lo = 0, .hi = 90, .lo_excluded = true};
  const auto& names = sediment_names();
  return {
      field("law", &M::model,
            {.meaning = "Scattering model. Each model has its own keys.",
             .choices = {"lambert", "gsab", "table", "sediment"}}),
      field("lambert_db", &M::lambert_db,
            {.meaning = "lambert: 10 log10 of mu, where 10 log10(mu sin^2(grazing angle)) is the "
                        "backscattering strength of Lambert's law. Energy conservation requires pi mu <= 1.",
             .ranges = {lambert}}),
      field("specular_db", &M::specular_db,
            {.meaning = "gsab: level A of the specular lobe. Needs `specular_width_deg`. Without this key, "
                        "there is no lobe.",
             .ranges = {level}}),
      field("specular_width_deg", &M::specular_width_deg,
            {.meaning = "gsab: width B of the specular lobe, in angle of incidence.", .ranges = {width}}),
      field("oblique_db", &M::oblique_db,
            {.meaning =
                 "gsab: level C of the Lambert-like component. Without this key, there is no such component.",
             .ranges = {level}}),
      field("oblique_exponent", &M::oblique_exponent,
            {.meaning =
                 "gsab: exponent D of the Lambert-like component. The value 2 corresponds to Lambert's law.",
             .ranges = {exponent},
             .default_value = "2"}),
      field("transition_db", &M::transition_db,
            {.meaning = "gsab: level E of the transition lobe between the two other components. Needs "
                        "`transition_width_deg`. Without this key, there is no lobe.",
             .ranges = {level}}),
      field("transition_width_deg", &M::transition_width_deg,
            {.meaning = "gsab: width F of the transition lobe, in angle of incidence.", .ranges = {width}}),
      field("table_grazing_deg", &M::table_grazing_deg,
            {.meaning = "table: grazing angles in increasing order.", .ranges = {grazing}}),
      field("table_db", &M::table_db,
            {.meaning = "table: backscattering strength at each angle of `table_grazing_deg`.",
             .ranges = {table_level}}),
      field("table_file", &M::table_file,
            {.meaning = "table: file with one row `grazing angle, level` per angle, instead of the two "
                        "arrays. It has at most 1000 rows, and lines that begin with # are comments."}),
      field("sediment", &M::sediment,
            {.meaning = "sediment: sediment type of the APL-UW tables.",
             .choices = {names.begin(), names.end()}}),
      field("sediment_khz", &M::sediment_khz,
            {.meaning = "sediment: frequency of the table, 20 or 300. tubefoot prints a warning if a sensor "
                        "has another frequency.",
             .ranges = {{.lo = 20, .hi = 300}}}),
      field("unbounded", &M::unbounded,
            {.meaning = "true: the scattered energy may exceed the incident energy. false: tubefoot rejects "
                        "such a material."})};
}

void check_scattering(const MaterialDescription& material, const TomlTable& table) {
  for (const ModelKeys& model : keys_of_models())
    for (const std::string_view key : model.keys)
      if (model.model != material.model && table.has(key))
        throw InputError(table.place_of(key),
                         fmt::format("'{}' belongs to law = \"{}\", but this material has law = \"{}\"", key,
                                     model.model, material.model));
  if (material.model == "gsab") {
    check_pair(table, "specular_db", "specular_width_deg");
    check_pair(table, "transition_db", "transition_width_deg");
    if (table.has("oblique_exponent") && !table.has("oblique_db"))
      throw InputError(table.place_of("oblique_exponent"),
                       "'oblique_exponent' needs the key 'oblique_db' as well");
    if (!material.specular_db && !material.oblique_db && !material.transition_db)
      throw InputError(table.place_of("law"),
                       "law = \"gsab\" needs 'specular_db', 'oblique_db' or 'transition_db'");
  }
  if (material.model == "table") {
    check_pair(table, "table_grazing_deg", "table_db");
    if (table.has("table_file") == table.has("table_db"))
      throw InputError(
          table.place_of(table.has("table_file") ? "table_file" : "law"),
          "law = \"table\" needs 'table_file', or 'table_grazing_deg' with 'table_db', but not both");
    if (material.table_db.size() != material.table_grazing_deg.size())
      throw InputError(table.place_of("table_db"),
                       fmt::format("'table_db' has {} levels for {} angles of 'table_grazing_deg'",
                                   material.table_db.size(), material.table_grazing_deg.size()));
    for (std::size_t k = 1; k < material.table_grazing_deg.size(); ++k)
      if (!(material.table_grazing_deg[k] > material.table_grazing_deg[k - 1]))
        throw InputError(table.place_of("table_grazing_deg"),
                         fmt::format("'table_grazing_deg' must increase: {} follows {}",
                                     material.table_grazing_deg[k], material.table_grazing_deg[k - 1]));
  }
  if (material.model == "sediment") {
    if (!material.sediment)
      throw InputError(table.place_of("law"), "law = \"sediment\" needs the key 'sediment'");
    if (material.sediment_khz != 20 && material.sediment_khz != 300)
      throw InputError(
          table.place_of("sediment_khz"),
          fmt::format("'sediment_khz' must be 20 or 300, not {}: there are tables for these two frequencies",
                      material.sediment_khz));
  }
}

std::vector<TomlField<MaterialDescription>> smooth_fields() {
  using M = MaterialDescription;
  constexpr ValueRange ratio{.lo = 0.01, .hi = 100}, attenuation{.lo = 0, .hi = 20};
  return {
      field("smooth", &M::smooth,
            {.meaning = "true: facets return a coherent amplitude instead of speckle to sensors of kind "
                        "array. The energies still follow `law`."}),
      field("reflection", &M::reflection,
            {.meaning = "Smooth materials: reflection coefficient of pressure, 1 for rigid and -1 for "
                        "pressure-release "
                        "surfaces. Give only one of `reflection`, `fluid` and `grain_size_phi`.",
             .ranges = {{.lo = -1, .hi = 1}}}),
      field(
          "fluid", &M::fluid,
          {.meaning =
               "Smooth materials: fluid half-space with this density and sound speed relative to water, and "
               "this attenuation in dB per wavelength.",
           .ranges = {ratio, ratio, attenuation}}),
      field("grain_size_phi", &M::grain_size_phi,
            {.meaning =
                 "Smooth materials: fluid seabed with this mean grain size in phi units (APL-UW TR 9407).",
             .ranges = {{.lo = -1, .hi = 9}}}),
      field("roughness_m", &M::roughness_m,
            {.meaning = "Smooth materials: standard deviation of the surface height. Roughness reduces the "
                        "coherent amplitude.",
             .ranges = {{.lo = 0, .hi = 10}}})};
}

void check_smooth(const MaterialDescription& material, const TomlTable& table) {
  std::string_view first;
  for (const std::string_view key : {"reflection", "fluid", "grain_size_phi", "roughness_m"}) {
    if (!table.has(key)) continue;
    if (!material.smooth)
      throw InputError(
          table.place_of(key),
          fmt::format("'{}' applies only with smooth = true: add smooth = true, or remove '{}'", key, key));
    if (key == "roughness_m") continue;
    if (!first.empty())
      throw InputError(
          table.place_of(key),
          fmt::format("'{}' and '{}' both define the reflection of the material: keep one of them", first,
                      key));
    first = key;
  }
}

}  // namespace tubefoot
