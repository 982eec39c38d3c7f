// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/in_water.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "files/input_error.hpp"
#include "scene/file/sensor_presets.hpp"
#include "sensors/formats/aris_file.hpp"

namespace tubefoot {
namespace {

void sample_at_frequency(SensorDescription& description, SidescanDescription& fan, double sound_speed_m_s) {
  const double step_m = sound_speed_m_s / (2000 * *fan.sampling_frequency_khz);
  const double whole = std::floor((fan.range_max_m - fan.range_min_m) / step_m * (1 + 1e-12));
  constexpr double most = 65536;
  if (!(whole >= 1 && whole <= most))
    throw InputError(
        description.place,
        fmt::format(
            "sensor '{}': at sampling_frequency_khz = {} and {:.1f} m/s a sample is {:.4g} m long, and "
            "range_min_m to range_max_m hold {:.0f} of them: choose 1 to {:.0f}",
            description.name, *fan.sampling_frequency_khz, sound_speed_m_s, step_m, whole, most));
  fan.samples = static_cast<int>(whole);
  fan.range_max_m = fan.range_min_m + whole * step_m;
  fan.sampling_frequency_khz.reset();
}

/// Whether the scene leaves the window to the preset, for which any water's is as good.
bool has_window_of_preset(const SensorDescription& description, const DidsonDescription& camera) {
  const std::string own = fmt::format("window_start_m = {}\nwindow_length_m = {}\n", camera.window_start_m,
                                      camera.window_length_m);
  return std::ranges::any_of(sensor_presets(), [&](const SensorPreset& preset) {
    return preset.name == description.preset && std::string_view(preset.text).find(own) != std::string::npos;
  });
}

void fit_aris_window(const SensorDescription& description, DidsonDescription& camera, double sound_speed_m_s,
                     std::vector<std::string>* notes) {
  const std::optional<ArisWindow> window =
      nearest_aris_window(camera.window_start_m, camera.window_length_m, camera.samples, sound_speed_m_s);
  if (!window) return;  // what no ARIS has is left to whoever writes its file to say
  const double start_m = window->start_m(sound_speed_m_s),
               length_m = window->length_m(sound_speed_m_s, camera.samples), end_m = start_m + length_m,
               asked_end_m = camera.window_start_m + camera.window_length_m,
               half_sample_m = length_m / camera.samples / 2;
  if (notes != nullptr && !has_window_of_preset(description, camera) &&
      (std::abs(start_m - camera.window_start_m) > half_sample_m ||
       std::abs(end_m - asked_end_m) > half_sample_m))
    notes->push_back(fmt::format(
        "sensor '{}' is an ARIS, which counts its window in whole microseconds: at {:.2f} m/s it goes from "
        "{:.4f} to {:.4f} m ({} us, then {} samples of {} us), not from {:.4f} to {:.4f} m",
        description.name, sound_speed_m_s, start_m, end_m, window->start_delay_us, camera.samples,
        window->sample_period_us, camera.window_start_m, asked_end_m));
  camera.window_start_m = start_m;
  camera.window_length_m = length_m;
}

}  // namespace

SensorDescription in_water(SensorDescription description, double sound_speed_m_s,
                           std::vector<std::string>* notes) {
  if (auto* fan = std::get_if<SidescanDescription>(&description.kind); fan && fan->sampling_frequency_khz)
    sample_at_frequency(description, *fan, sound_speed_m_s);
  if (auto* camera = std::get_if<DidsonDescription>(&description.kind); camera && is_aris(description))
    fit_aris_window(description, *camera, sound_speed_m_s, notes);
  return description;
}

}  // namespace tubefoot
