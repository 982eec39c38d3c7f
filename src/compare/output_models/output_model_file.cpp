// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/output_models/output_model_file.hpp"

#include <toml++/toml.h>

#include "files/input_registry.hpp"
#include "files/limits.hpp"
#include "scene/file/toml_reader.hpp"
#include "scene/file/toml_text.hpp"

namespace tubefoot {
namespace {

constexpr ValueRange positive{.lo = 0, .lo_excluded = true}, any_db{.lo = -400, .hi = 400};

void check_step(const OutputModelStep& step, const TomlTable& table) {
  if (const auto* clamp = std::get_if<ClampStep>(&step.kind); clamp && !(clamp->low < clamp->high))
    throw InputError(table.place_of("high"), "'high' must be above 'low'");
  if (const auto* level = std::get_if<DecibelStep>(&step.kind); level && !(level->low_db < level->high_db))
    throw InputError(table.place_of("high_db"), "'high_db' must be above 'low_db'");
  if (const auto* blur = std::get_if<BlurStep>(&step.kind); blur && blur->size % 2 == 0)
    throw InputError(table.place_of("size"), "'size' must be odd, so that the kernel has a centre");
}

const TomlSection<OutputModelStep>& step_section() {
  static const auto section =
      TomlSection<OutputModelStep>("[[steps]]", "Step of the output model.")
          .kind<MeanStep>("step", "mean",
                          "Mean strength: energy per solid angle of the visible surfaces in the bin.",
                          {field("least_share", &MeanStep::least_share, {.ranges = {{.lo = 0, .hi = 1}}})})
          .kind<CountStep>("step", "count", "Expected number of uniform samples in the bin.",
                           {field("points_per_sr", &CountStep::points_per_sr, {.ranges = {positive}})})
          .kind<RangeLawStep>(
              "step", "range-law", "Factor that depends on range.",
              {field("exponent", &RangeLawStep::exponent, {.ranges = {{.lo = -10, .hi = 10}}}),
               field("absorption_db_per_km", &RangeLawStep::absorption_db_per_km,
                     {.ranges = {{.lo = -100000, .hi = 100000}}})})
          .kind<AmplitudeStep>("step", "amplitude", "Square root.", {})
          .kind<DecibelStep>("step", "decibel", "Level in decibels, mapped to 0 to 1.",
                             {field("low_db", &DecibelStep::low_db, {.ranges = {any_db}}),
                              field("high_db", &DecibelStep::high_db, {.ranges = {any_db}})})
          .kind<BlurStep>("step", "blur", "Gaussian blur.",
                          {field("beams", &BlurStep::beams, {.ranges = {{.lo = 0, .hi = 100}}}),
                           field("samples", &BlurStep::samples, {.ranges = {{.lo = 0, .hi = 100}}}),
                           field("size", &BlurStep::size, {.ranges = {{.lo = 1, .hi = 501}}})})
          .kind<NormaliseStep>("step", "normalise", "Division by the largest value or by the sum.",
                               {field("by", &NormaliseStep::by, {.choices = {"largest", "sum"}}),
                                field("over", &NormaliseStep::over, {.choices = {"image", "row", "beam"}})})
          .kind<ClampStep>("step", "clamp", "Limits of the value.",
                           {field("low", &ClampStep::low, {.ranges = {{.lo = 0}}}),
                            field("high", &ClampStep::high, {.ranges = {positive}})})
          .kind<QuantiseStep>("step", "quantise", "Rounding to uniform levels.",
                              {field("bits", &QuantiseStep::bits, {.ranges = {{.lo = 1, .hi = 24}}}),
                               field("full", &QuantiseStep::full, {.ranges = {positive}})})
          .kind<GainStep>("step", "gain", "Constant factor.",
                          {field("factor", &GainStep::factor, {.ranges = {positive}})})
          .check(check_step);
  return section;
}

const TomlSection<OutputModel>& output_model_section() {
  static const auto section =
      TomlSection<OutputModel>("", "Output model.")
          .keys({field("title", &OutputModel::title), field("solid_angles", &OutputModel::solid_angles),
                 field("solid_angle_strength_db", &OutputModel::solid_angle_strength_db,
                       {.ranges = {{.lo = -120, .hi = 40}}})})
          .tables("steps", &OutputModel::steps, step_section());
  return section;
}

}  // namespace

OutputModel read_output_model(const std::filesystem::path& file) {
  const SourcePlace place{file.string()};
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(place, "there is no such file");
  const std::string text = read_whole(file, place, limits::scene_file_bytes, "an output model (TOML text)");
  TomlSource source{file, {}, {}};
  const toml::table root = parse_toml(text, source);
  OutputModel output_model = output_model_section().read({&root, place, &source}, source);
  if (output_model.steps.empty())
    throw InputError(place,
                     "the output model has no [[steps]]: add a step, or compare without an output model");
  return output_model;
}

std::vector<SceneKey> output_model_keys() {
  std::vector<SceneKey> keys;
  for (const TomlKey& key : output_model_section().all_keys()) keys.push_back(key);
  for (const TomlKey& key : step_section().all_keys()) keys.push_back(key);
  return keys;
}

}  // namespace tubefoot
