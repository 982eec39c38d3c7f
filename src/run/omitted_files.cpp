// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/omitted_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"
#include "scene/description/scene_description.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

constexpr const char *echoes_file = "echoes.nc", *scene_picture_file = "scene.png", *labels = "labels.png";

/// The name of a product of a sensor: "fan-sonar.nc", "fan.xtf".
std::string file_of(const std::string& sensor, const std::string& product) {
  return sensor + (product.find('.') == std::string::npos ? "." : "-") + product;
}

std::vector<std::string> products_of(const SensorDescription& sensor) {
  std::vector<std::string> products = kind_of(sensor).products();
  products.emplace_back(labels);
  return products;
}

std::vector<std::string> names_between_commas(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    names.push_back(text.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return names;
}

[[noreturn]] void throw_unknown(const std::string& name, const SceneDescription& scene) {
  std::vector<std::string> known{echoes_file, scene_picture_file};
  const auto add = [&](const std::string& one) {
    if (std::ranges::find(known, one) == known.end()) known.push_back(one);
  };
  for (const SensorDescription& sensor : scene.sensors) std::ranges::for_each(products_of(sensor), add);
  const std::string list = fmt::format("{}", fmt::join(known, ", "));
  for (const SensorDescription& sensor : scene.sensors)
    for (const std::string& product : products_of(sensor)) add(file_of(sensor.name, product));
  const std::string_view meant = nearest(name, known);
  throw UsageError(
      fmt::format("--without '{}': this scene has no such product{}. Products: {}. The name of a sensor and "
                  "a hyphen, or a "
                  "dot where the product has none, select one sensor",
                  shown(name), meant.empty() ? "" : fmt::format(": did you mean '{}'?", meant), list));
}

/// Throws UsageError if an option has no effect because its results would be in omitted files only.
void require_place_of_results(const OmittedFiles& omitted, const SceneDescription& scene,
                              const RunOptions& options) {
  const char* option = options.reference ? "--reference" : options.gradient ? "--gradient" : nullptr;
  if (!omitted.echoes || option == nullptr) return;
  const bool has_signals = std::ranges::any_of(scene.sensors, [&](const SensorDescription& sensor) {
    return std::ranges::count(kind_of(sensor).products(), "signals.nc") > 0 &&
           !omitted.of(sensor.name).contains("signals.nc");
  });
  if (!has_signals)
    throw UsageError(fmt::format(
        "{} writes its results to echoes.nc, which --without omits: remove one of the two", option));
}

}  // namespace

OmittedFiles omitted_files(const SceneDescription& scene, const RunOptions& options) {
  OmittedFiles omitted;
  if (!options.without) return omitted;
  for (const std::string& name : names_between_commas(*options.without)) {
    bool known = false;
    const auto add = [&](const std::string& file) {
      known = true;
      if (std::ranges::find(omitted.names, file) == omitted.names.end()) omitted.names.push_back(file);
    };
    if (name == echoes_file) {
      omitted.echoes = true;
      add(name);
    }
    if (name == scene_picture_file) {
      omitted.scene_picture = true;
      add(name);
    }
    for (const SensorDescription& sensor : scene.sensors)
      for (const std::string& product : products_of(sensor)) {
        const std::string file = file_of(sensor.name, product);
        if (name != product && name != file) continue;
        omitted.products[sensor.name].insert(product);
        add(file);
      }
    if (!known) throw_unknown(name, scene);
  }
  require_place_of_results(omitted, scene, options);
  return omitted;
}

}  // namespace tubefoot
