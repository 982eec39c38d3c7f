// SPDX-License-Identifier: GPL-3.0-or-later
// The sensor kind "imaging": forward-looking sonars. Defines their scene keys, beams, transmission and
// files. The beams are azimuth cells about the sensor's up axis, either equal or about listed angles.

#include "sensors/kinds/kind_imaging.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>

#include "scene/file/sensor_ranges.hpp"
#include "scene/file/toml_reader.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/model/beam_angles.hpp"
#include "sensors/model/fan_sector.hpp"
#include "sensors/model/lens_beams.hpp"
#include "sensors/model/range_window.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/received.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Imaging (forward-looking) sonar with any number of ideal rectangular beams. They are azimuth cells about
/// the sensor's up axis, each over the whole elevation. Beam 0 is the port-most.
class Imaging : public Sensor {
 public:
  /// Throws std::invalid_argument for an invalid sector, invalid ranges or invalid counts.
  explicit Imaging(const SensorDescription& description);
};

/// Angles of the beams' axes, for fans whose axes are not in the middle of equal cells.
std::vector<double> axes_rad(const ImagingDescription& fan) {
  if (!fan.beam_angles_deg.empty()) return radians_of(fan.beam_angles_deg);
  // The middles of equal cells on a straight line across the forward axis.
  const double edge = std::tan(radians(fan.horizontal_deg) / 2);
  return spread_angles_rad(fan.beams, std::atan(edge * (fan.beams - 1) / fan.beams), fan.spacing);
}

/// Checks a list of angles, or a spacing by distance.
void require_axes(const SensorDescription& description, const ImagingDescription& fan) {
  const auto& listed = fan.beam_angles_deg;
  require(listed.size() != 1, description, "beam_angles_deg", "one angle", "two or more");
  require(std::ranges::adjacent_find(listed, std::greater_equal()) == listed.end(), description,
          "beam_angles_deg", "unordered", "increasing");
  if (!listed.empty()) return;
  require(fan.beams >= 1, description, "beams", fan.beams, "1 or more");
  require(fan.horizontal_deg > 0 && fan.horizontal_deg <= 360, description, "horizontal_deg",
          fan.horizontal_deg, "above 0 and at most 360");
  if (fan.spacing == "angle") return;
  require(fan.horizontal_deg < 180, description, "horizontal_deg", fan.horizontal_deg,
          "below 180 with spacing = \"distance\"");
  require(fan.beams >= 2, description, "beams", fan.beams, "2 or more with spacing = \"distance\"");
}

Imaging::Imaging(const SensorDescription& description) : Sensor(description) {
  const auto& fan = description.kind.as<ImagingDescription>();
  require_axes(description, fan);
  require(fan.vertical_deg > 0 && fan.vertical_deg < 180, description, "vertical_deg", fan.vertical_deg,
          "above 0 and below 180");

  frequency_khz_ = fan.frequency_khz;
  samples_ = range_window(description, fan);
  const double half_height_rad = radians(fan.vertical_deg) / 2;
  SectorTubes sector;
  if (fan.spacing == "angle" && fan.beam_angles_deg.empty()) {
    const double half_width_rad = radians(fan.horizontal_deg) / 2;
    const double beam_width_rad = 2 * half_width_rad / fan.beams;
    for (int beam = 0; beam < fan.beams; ++beam)
      beams_.push_back(
          {-half_width_rad + (beam + 0.5) * beam_width_rad, 0, beam_width_rad, 2 * half_height_rad});
    sector =
        even_sector(fan.beams, half_width_rad, half_width_rad, half_height_rad, description.cone_tolerance);
  } else {
    const std::vector<double> axes = axes_rad(fan), borders = borders_between(axes);
    require(borders.back() - borders.front() <= 2 * std::numbers::pi, description, "beam_angles_deg",
            degrees(borders.back() - borders.front()), "at most 360 degrees");
    for (std::size_t beam = 0; beam < axes.size(); ++beam)
      beams_.push_back({axes[beam], 0, borders[beam + 1] - borders[beam], 2 * half_height_rad});
    sector = sector_between(borders, half_height_rad, description.cone_tolerance);
  }
  Transmission transmission;
  transmission.beams.resize(beams_.size());
  std::iota(transmission.beams.begin(), transmission.beams.end(), 0u);
  transmission.fans.push_back({0, static_cast<std::uint32_t>(beams_.size()),
                               static_cast<std::uint32_t>(sector.beam_of_tube.size()), forward_axis,
                               starboard_axis, up_axis});
  transmission.beam_of_tube = std::move(sector.beam_of_tube);
  transmission.sectors.push_back(std::move(sector.grid));
  transmissions_.push_back(std::move(transmission));
}

class ImagingKind : public SensorKind {
 public:
  ImagingKind() : SensorKind("imaging") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using I = ImagingDescription;
    section.kind<I>(
        "kind", name(), "Imaging (forward-looking) sonar with one fan of ideal rectangular beams.",
        {field("frequency_khz", &I::frequency_khz,
               {.meaning = "Frequency, which determines the absorption and the beam patterns.",
                .ranges = {frequency}}),
         field("beams", &I::beams,
               {.meaning = "Number of adjacent beams within `horizontal_deg`. Beam 0 is the port-most beam.",
                .ranges = {{.lo = 1, .hi = 4096}}}),
         field("horizontal_deg", &I::horizontal_deg,
               {.meaning = "One-way width of the whole fan.", .ranges = {sector(180, true)}}),
         field("vertical_deg", &I::vertical_deg,
               {.meaning = "One-way height of the fan.", .ranges = {sector(170, false)}}),
         field("spacing", &I::spacing,
               {.meaning = "angle: beams of equal width. distance: beam axes equidistant on a straight line "
                           "ahead, like pixels of a flat picture; borders lie midway between axes.",
                .choices = {"angle", "distance"}}),
         field("beam_angles_deg", &I::beam_angles_deg,
               {.meaning = "Two or more angles of beam axes from straight ahead, in increasing order and "
                           "positive to starboard. Replaces `beams`, `horizontal_deg` and `spacing`; borders "
                           "lie midway between axes.",
                .ranges = {{.lo = -179, .hi = 179}}}),
         field("samples", &I::samples,
               {.meaning = "Number of range bins of equal length.", .ranges = {range_samples}}),
         field("range_min_m", &I::range_min_m,
               {.meaning = "Slant range at which the first range bin begins.", .ranges = {range_start}}),
         field("range_max_m", &I::range_max_m,
               {.meaning = "Slant range at which the last range bin ends.", .ranges = {sonar_range}})});
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    const auto& fan = sensor.kind.as<ImagingDescription>();
    check_ranges(fan.range_min_m, fan.range_max_m, table);
    check_beam_angles(fan.beam_angles_deg, {"beams", "horizontal_deg", "spacing"}, table);
    if (fan.beam_angles_deg.size() == 1)
      throw InputError(table.place_of("beam_angles_deg"),
                       "'beam_angles_deg' needs two or more angles, because beams end midway between them: "
                       "for one beam, use beams = 1 and 'horizontal_deg'");
    if (fan.spacing == "distance" && fan.beams == 1)
      throw InputError(
          table.place_of("spacing"),
          "spacing = \"distance\" needs 'beams' of 2 or more: increase 'beams', or use spacing = \"angle\"");
  }
  bool looks_ahead() const override { return true; }
  SensorFigures figures(const SensorDescription& sensor) const override {
    const auto& fan = sensor.kind.as<ImagingDescription>();
    const std::vector<double>& listed = fan.beam_angles_deg;
    if (listed.empty())
      return range_figures(fan, fan.beams, std::min(fan.horizontal_deg / fan.beams, fan.vertical_deg));
    double narrowest_deg = fan.vertical_deg;
    for (std::size_t k = 1; k < listed.size(); ++k)
      narrowest_deg = std::min(narrowest_deg, listed[k] - listed[k - 1]);
    return range_figures(fan, static_cast<std::int64_t>(listed.size()), narrowest_deg);
  }

  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<Imaging>(sensor);
  }

  std::vector<std::string> products() const override { return fan_picture_products(); }
  std::vector<fs::path> write_products(const fs::path& folder, const Recording& recording,
                                       const RunContext& run,
                                       std::vector<std::string>& warnings) const override {
    return write_fan_pictures(folder, recording, receiver_output_of(recording, run), run.pictures,
                              PictureSettings::Which::all, warnings, run.omitted);
  }
  std::optional<SonarOutline> outline(const SensorDescription& sensor) const override {
    const auto& own = sensor.kind.as<ImagingDescription>();
    SonarOutline outline;
    outline.add("frequency_khz", own.frequency_khz).add("vertical_deg", own.vertical_deg);
    if (own.beam_angles_deg.empty())
      outline.add("beams", own.beams).add("horizontal_deg", own.horizontal_deg).add("spacing", own.spacing);
    else
      outline.add("beam_angles_deg", own.beam_angles_deg);
    outline.add_window(own);
    outline.even = own.beam_angles_deg.empty() && own.spacing == "angle";
    outline.vertical_deg = own.vertical_deg;
    return outline;
  }
  WritingCost writing_cost(const Recording& recording, const RunContext& run) const override {
    return cost_of_fan_pictures(recording, receiver_output_of(recording, run).has_value(), run.pictures,
                                PictureSettings::Which::all, run.omitted);
  }
};

}  // namespace

const SensorSection& ImagingDescription::kind() {
  static const ImagingKind kind;
  return kind;
}
const SensorSection& imaging_kind() { return ImagingDescription::kind(); }

}  // namespace tubefoot
