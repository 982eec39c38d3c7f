// SPDX-License-Identifier: GPL-3.0-or-later
// The sensor kind "sidescan": two fans about the along-track axis, port and starboard. Defines its scene
// keys, samples at a sampling frequency, transmission, outline and files.

#include "sensors/kinds/kind_sidescan.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "scene/file/sensor_ranges.hpp"
#include "scene/file/toml_reader.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/model/range_window.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/received.hpp"
#include "sensors/products/two_sided_files.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Permitted values of both limits of a sidescan's fan. A joint check keeps the fan narrower than 170
/// degrees.
constexpr ValueRange depression{.lo = -80, .hi = 90, .if_below = too_wide, .if_above = "90 is straight down"};

/// Converts the sampling frequency f into samples of length c / (2 f). Their number is the largest whole
/// number in the range gate.
void sample_at_frequency(SensorDescription& description, SidescanDescription& fan, double sound_speed_m_s) {
  const double step_m = sound_speed_m_s / (2000 * *fan.sampling_frequency_khz);
  const double whole = std::floor((fan.range_max_m - fan.range_min_m) / step_m * (1 + 1e-12));
  constexpr double most = 65536;
  if (!(whole >= 1 && whole <= most))
    throw InputError(
        description.place,
        fmt::format(
            "sensor '{}': at sampling_frequency_khz = {} and {:.1f} m/s a range bin has a length of {:.4g} "
            "m, and range_min_m to range_max_m contain {:.0f} range bins: choose 1 to {:.0f} range bins",
            description.name, *fan.sampling_frequency_khz, sound_speed_m_s, step_m, whole, most));
  fan.samples = static_cast<int>(whole);
  fan.range_max_m = fan.range_min_m + whole * step_m;
  fan.sampling_frequency_khz.reset();
}

class SidescanKind : public SensorKind {
 public:
  SidescanKind() : SensorKind("sidescan") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using S = SidescanDescription;
    std::vector<TomlField<S>> fields = sidescan_fields();
    fields.push_back(field("axis_depression_deg", &S::axis_depression_deg,
                           {.meaning = "Depression angle of the axis of the transmit and receive patterns.",
                            .ranges = {depression},
                            .default_value = "centre of the fan"}));
    fields.push_back(field("sampling_frequency_khz", &S::sampling_frequency_khz,
                           {.meaning = "Sampling frequency f, instead of `samples`. A range bin is c / (2 f) "
                                       "long, and the last bin ends at or before `range_max_m`.",
                            .ranges = {{.lo = 0, .hi = 100000, .lo_excluded = true}}}));
    section.kind<S>("kind", name(),
                    "Sidescan sonar with two fans abeam of the track. Beam 0 looks to port, beam 1 to "
                    "starboard. Beams are ideal and rectangular.",
                    fields);
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    const auto& fan = sensor.kind.as<SidescanDescription>();
    check_sidescan(fan, table);
    if (table.has("samples") && table.has("sampling_frequency_khz")) {
      throw InputError(table.place_of("sampling_frequency_khz"),
                       "'samples' and 'sampling_frequency_khz' both determine the length of range bins: "
                       "remove one of them");
    }
    if (fan.axis_depression_deg && sensor.transmit.pattern == "none" && sensor.receive.pattern == "none")
      throw InputError(table.place_of("axis_depression_deg"),
                       "'axis_depression_deg' needs a pattern: add transmit_pattern or receive_pattern, or "
                       "remove the key");
    check_ranges(fan.range_min_m, fan.range_max_m, table);
  }
  SensorFigures figures(const SensorDescription& sensor) const override {
    return sidescan_figures(sensor.kind.as<SidescanDescription>());
  }

  SensorDescription in_water(SensorDescription sensor, double sound_speed_m_s,
                             std::vector<std::string>*) const override {
    if (sensor.kind.as<SidescanDescription>().sampling_frequency_khz)
      sample_at_frequency(sensor, sensor.kind.edit<SidescanDescription>(), sound_speed_m_s);
    return sensor;
  }
  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<Sidescan>(sensor);
  }

  std::vector<std::string> products() const override {
    std::vector<std::string> names = two_sided_picture_products();
    std::ranges::copy(two_sided_file_products(), std::back_inserter(names));
    return names;
  }
  std::vector<fs::path> write_products(const fs::path& folder, const Recording& recording,
                                       const RunContext& run,
                                       std::vector<std::string>& warnings) const override {
    const auto& fan = recording.sensor->description().kind.as<SidescanDescription>();
    std::vector<fs::path> files = write_two_sided_pictures(
        folder, recording, receiver_output_of(recording, run), run.pictures, warnings, run.omitted);
    append(files, write_two_sided_files(
                      folder, recording, run,
                      {fan.along_track_deg, fan.depression_max_deg - fan.depression_min_deg}, warnings));
    return files;
  }
  std::optional<SonarOutline> outline(const SensorDescription& sensor) const override {
    return sidescan_outline(sensor.kind.as<SidescanDescription>());
  }
  WritingCost writing_cost(const Recording& recording, const RunContext& run) const override {
    WritingCost cost = cost_of_two_sided_pictures(recording, receiver_output_of(recording, run).has_value(),
                                                  run.pictures, run.omitted);
    constexpr double received_s = 5e-8, code_bytes = 4, amplitude_bytes = 4;  // during output
    if (writes_two_sided_files(recording, run))
      cost += cost_by_cells(recording, received_s, code_bytes + amplitude_bytes);
    return cost;
  }
  std::vector<std::string> files_left_out(const Recording& recording, const RunContext& run) const override {
    return two_sided_files_left_out(recording, run);
  }
};

}  // namespace

SonarOutline sidescan_outline(const SidescanDescription& own) {
  SonarOutline outline;
  outline.kind = "sidescan";
  outline.add("frequency_khz", own.frequency_khz).add("along_track_deg", own.along_track_deg);
  outline.add("depression_min_deg", own.depression_min_deg).add("depression_max_deg", own.depression_max_deg);
  outline.add_window(own);
  outline.shape = SonarOutline::Shape::two_sides;
  outline.looks_down = true;
  outline.along_track_deg = own.along_track_deg;
  outline.vertical_deg = own.depression_max_deg - own.depression_min_deg;
  outline.depression_deg = (own.depression_min_deg + own.depression_max_deg) / 2;
  return outline;
}

std::vector<TomlField<SidescanDescription>> sidescan_fields() {
  using S = SidescanDescription;
  return {field("frequency_khz", &S::frequency_khz,
                {.meaning = "Frequency, which determines the absorption.", .ranges = {frequency}}),
          field("along_track_deg", &S::along_track_deg,
                {.meaning = "One-way width of the ideal rectangular beam along the track.",
                 .ranges = {sector(90, false)}}),
          field("depression_min_deg", &S::depression_min_deg,
                {.meaning = "Depression angle of the upper limit of each fan.", .ranges = {depression}}),
          field("depression_max_deg", &S::depression_max_deg,
                {.meaning = "Depression angle of the lower limit of each fan. 90: straight down.",
                 .ranges = {depression}}),
          field("samples", &S::samples,
                {.meaning = "Number of range bins of equal length.", .ranges = {range_samples}}),
          field("range_min_m", &S::range_min_m,
                {.meaning = "Slant range at which the first range bin begins.", .ranges = {range_start}}),
          field("range_max_m", &S::range_max_m,
                {.meaning = "Slant range at which the last range bin ends.", .ranges = {sonar_range}})};
}

void check_sidescan(const SidescanDescription& fan, const TomlTable& table) {
  if (fan.depression_min_deg >= fan.depression_max_deg) {
    throw InputError(place_of_pair(table, "depression_min_deg", "depression_max_deg"),
                     fmt::format("'depression_min_deg' ({}) must be less than 'depression_max_deg' ({}): {}",
                                 fan.depression_min_deg, fan.depression_max_deg, no_width));
  }
}

SensorFigures sidescan_figures(const SidescanDescription& fan) {
  constexpr double usual_sound_speed_m_s = 1500;
  SensorFigures figures = range_figures(fan, 2, fan.along_track_deg);
  if (fan.sampling_frequency_khz)
    figures.sample_m = usual_sound_speed_m_s / (2000 * *fan.sampling_frequency_khz);
  return figures;
}

Sidescan::Sidescan(const SensorDescription& description)
    : Sidescan(description, description.kind.as<SidescanDescription>()) {}

Sidescan::Sidescan(const SensorDescription& description, const SidescanDescription& fan)
    : Sensor(description) {
  require(fan.along_track_deg > 0 && fan.along_track_deg < 180, description, "along_track_deg",
          fan.along_track_deg, "above 0 and below 180");
  require(fan.depression_min_deg >= -90 && fan.depression_min_deg < fan.depression_max_deg, description,
          "depression_min_deg", fan.depression_min_deg, "-90 or more and below depression_max_deg");
  require(fan.depression_max_deg <= 90, description, "depression_max_deg", fan.depression_max_deg,
          "at most 90, because otherwise the port and starboard fans would overlap");

  if (fan.sampling_frequency_khz)
    throw std::invalid_argument(fmt::format(
        "sensor '{}': the range bins cannot be computed from 'sampling_frequency_khz' without a sound speed",
        description.name));

  frequency_khz_ = fan.frequency_khz;
  samples_ = range_window(description, fan);

  const double shallow_rad = radians(fan.depression_min_deg), steep_rad = radians(fan.depression_max_deg);
  const double half_width_rad = radians(fan.along_track_deg) / 2;
  const double axis_rad =
      fan.axis_depression_deg ? radians(*fan.axis_depression_deg) : (shallow_rad + steep_rad) / 2;
  const int slices = slices_for(steep_rad - shallow_rad, description.cone_tolerance);
  const double corner_rad =
      height_of_corners(half_width_rad, (steep_rad - shallow_rad) / slices, description.cone_tolerance);
  Transmission transmission;
  transmission.beams = {0, 1};
  for (const double side : {-1.0, 1.0}) {
    beams_.push_back({side * radians(90), -axis_rad, 2 * half_width_rad, steep_rad - shallow_rad});
    // The grid's azimuth is the depression angle: 0 is horizontal to the side, 90 degrees is straight down.
    transmission.sectors.push_back({even_edges(shallow_rad, steep_rad, slices),
                                    {-corner_rad, corner_rad},
                                    glm::dmat3(side * starboard_axis, -up_axis, forward_axis)});
    transmission.beam_of_tube.insert(transmission.beam_of_tube.end(), static_cast<std::size_t>(slices),
                                     side < 0 ? 0u : 1u);
    const glm::dvec3 axis = std::cos(axis_rad) * side * starboard_axis - std::sin(axis_rad) * up_axis;
    const glm::dvec3 across = std::sin(axis_rad) * side * starboard_axis + std::cos(axis_rad) * up_axis;
    const auto beam = static_cast<std::uint32_t>(beams_.size());
    transmission.fans.push_back({beam - 1, beam, static_cast<std::uint32_t>(transmission.beam_of_tube.size()),
                                 axis, forward_axis, across});
  }
  transmissions_.push_back(std::move(transmission));
}

const SensorSection& SidescanDescription::kind() {
  static const SidescanKind kind;
  return kind;
}
const SensorSection& sidescan_kind() { return SidescanDescription::kind(); }

}  // namespace tubefoot
