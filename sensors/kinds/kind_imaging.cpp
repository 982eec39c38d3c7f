// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/kinds/kind_imaging.hpp"

#include <numeric>
#include <utility>

#include "scene/file/sensor_ranges.hpp"
#include "scene/file/toml_reader.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/model/fan_sector.hpp"
#include "sensors/model/range_window.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/received.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Imaging (forward-looking) sonar with any number of ideal rectangular beams: equal azimuth cells about the
/// sensor's up axis, each over the whole elevation. Beam 0 is the port-most.
class Imaging : public Sensor {
 public:
  /// Throws std::invalid_argument for a sector, ranges or counts that make no sonar.
  explicit Imaging(const SensorDescription& description);
};

Imaging::Imaging(const SensorDescription& description) : Sensor(description) {
  const auto& fan = description.kind.as<ImagingDescription>();
  require(fan.beams >= 1, description, "beams", fan.beams, "1 or more");
  require(fan.horizontal_deg > 0 && fan.horizontal_deg <= 360, description, "horizontal_deg",
          fan.horizontal_deg, "above 0 and at most 360");
  require(fan.vertical_deg > 0 && fan.vertical_deg < 180, description, "vertical_deg", fan.vertical_deg,
          "above 0 and below 180");

  frequency_khz_ = fan.frequency_khz;
  samples_ = range_window(description, fan);
  const double half_width_rad = radians(fan.horizontal_deg) / 2;
  const double half_height_rad = radians(fan.vertical_deg) / 2;
  const double beam_width_rad = 2 * half_width_rad / fan.beams;
  for (int beam = 0; beam < fan.beams; ++beam)
    beams_.push_back(
        {-half_width_rad + (beam + 0.5) * beam_width_rad, 0, beam_width_rad, 2 * half_height_rad});

  SectorTubes sector =
      even_sector(fan.beams, half_width_rad, half_width_rad, half_height_rad, description.cone_tolerance);
  Shot shot;
  shot.beams.resize(beams_.size());
  std::iota(shot.beams.begin(), shot.beams.end(), 0u);
  shot.fans.push_back({0, static_cast<std::uint32_t>(beams_.size()),
                       static_cast<std::uint32_t>(sector.beam_of_tube.size()), forward_axis, starboard_axis,
                       up_axis});
  shot.beam_of_tube = std::move(sector.beam_of_tube);
  shot.sectors.push_back(std::move(sector.grid));
  shots_.push_back(std::move(shot));
}

class ImagingKind : public SensorKind {
 public:
  ImagingKind() : SensorKind("imaging") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using I = ImagingDescription;
    section.kind<I>("kind", name(),
                    {field("frequency_khz", &I::frequency_khz, {.ranges = {frequency}}),
                     field("beams", &I::beams, {.ranges = {{.lo = 1, .hi = 4096}}}),
                     field("horizontal_deg", &I::horizontal_deg, {.ranges = {sector(180, true)}}),
                     field("vertical_deg", &I::vertical_deg, {.ranges = {sector(170, false)}}),
                     field("samples", &I::samples, {.ranges = {range_samples}}),
                     field("range_min_m", &I::range_min_m, {.ranges = {range_start}}),
                     field("range_max_m", &I::range_max_m, {.ranges = {sonar_range}})});
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    const auto& fan = sensor.kind.as<ImagingDescription>();
    check_ranges(fan.range_min_m, fan.range_max_m, table);
  }
  bool looks_ahead() const override { return true; }
  SensorFigures figures(const SensorDescription& sensor) const override {
    const auto& fan = sensor.kind.as<ImagingDescription>();
    return range_figures(fan, fan.beams, std::min(fan.horizontal_deg / fan.beams, fan.vertical_deg));
  }

  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<Imaging>(sensor);
  }

  std::vector<fs::path> write_products(const fs::path& folder, const Recording& recording,
                                       const RunContext& run,
                                       std::vector<std::string>& warnings) const override {
    return write_fan_pictures(folder, recording, heard_by(recording, run), false, warnings);
  }
};

}  // namespace

const SensorSection& ImagingDescription::kind() {
  static const ImagingKind kind;
  return kind;
}
const SensorSection& imaging_kind() { return ImagingDescription::kind(); }

}  // namespace tubefoot
