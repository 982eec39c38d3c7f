// SPDX-License-Identifier: GPL-3.0-or-later
// The sensor kind "scanning": mechanically scanning sonars, with one transmission per step of the head.
// Defines their scene keys, step times, transmissions and files.

#include "sensors/kinds/kind_scanning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "files/checked_file.hpp"
#include "geometry/steps/in_order.hpp"
#include "scene/file/sensor_ranges.hpp"
#include "scene/file/toml_reader.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/model/range_window.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/received.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Number of steps of a scan; empty unless it is a whole number.
std::optional<int> steps_of(const ScanningDescription& scan) {
  constexpr double most_steps = 4096, rounding = 1e-6;
  const double steps = scan.scan_deg / scan.step_deg, whole = std::round(steps);
  if (!(whole >= 1 && whole <= most_steps && std::abs(steps - whole) <= rounding * whole))
    return std::nullopt;
  return static_cast<int>(whole);
}

/// The two-way travel time to the last sample, and the time of a small motor for a step. A Ping360 needs 9 s
/// for 400 steps at a range of 2 m, and 35 s at 50 m.
double step_interval_s(const ScanningDescription& scan) {
  constexpr double nominal_sound_speed_m_s = 1500, motor_s = 0.02;
  return scan.step_interval_s.value_or(2 * scan.range_max_m / nominal_sound_speed_m_s + motor_s);
}

/// Direction of the head at a step, clockwise from forward, in whole multiples of step_deg as a stepper
/// motor counts. An odd number of steps is symmetric about forward. With an even number the first step is at
/// -scan_deg / 2. The last one is one step short of scan_deg / 2, where a whole turn would repeat the first.
double head_rad(const ScanningDescription& scan, int step, int steps) {
  return radians(scan.scan_deg * (step - steps / 2) / steps);
}

/// One beam about the sensor's up axis that starts at port and turns clockwise. Each step is a transmission
/// from the carrier's position at its time. Beam k is that of step k. Neighbours overlap if steps are
/// narrower than the beam.
class Scanning : public Sensor {
 public:
  /// Throws std::invalid_argument for an invalid scan or beam, invalid ranges or invalid counts.
  explicit Scanning(const SensorDescription& description);
};

Scanning::Scanning(const SensorDescription& description) : Sensor(description) {
  const auto& scan = description.kind.as<ScanningDescription>();
  require(scan.scan_deg > 0 && scan.scan_deg <= 360, description, "scan_deg", scan.scan_deg,
          "above 0 and at most 360");
  require(steps_of(scan).has_value(), description, "step_deg", scan.step_deg,
          "scan_deg divided by a whole number");
  require(scan.beam_horizontal_deg > 0 && scan.beam_horizontal_deg < 180, description, "beam_horizontal_deg",
          scan.beam_horizontal_deg, "above 0 and below 180");
  require(scan.beam_vertical_deg > 0 && scan.beam_vertical_deg < 180, description, "beam_vertical_deg",
          scan.beam_vertical_deg, "above 0 and below 180");
  require(scan.step_interval_s.value_or(0) >= 0, description, "step_interval_s",
          scan.step_interval_s.value_or(0), "0 or more");

  frequency_khz_ = scan.frequency_khz;
  samples_ = range_window(description, scan);
  const int steps = *steps_of(scan);
  const double half_width_rad = radians(scan.beam_horizontal_deg) / 2,
               half_height_rad = radians(scan.beam_vertical_deg) / 2;
  const int slices = slices_for(2 * half_width_rad, description.cone_tolerance);
  const double corner_rad =
      height_of_corners(half_height_rad, 2 * half_width_rad / slices, description.cone_tolerance);
  // Two rows above 90 degrees, so that no tube approaches a half space. The rays of such a tube would not
  // determine it.
  const int rows = half_height_rad > radians(45) ? 2 : 1;
  for (int step = 0; step < steps; ++step) {
    const double head = head_rad(scan, step, steps);
    beams_.push_back({head, 0, 2 * half_width_rad, 2 * half_height_rad});
    Transmission transmission;
    transmission.delay_s = step * step_interval_s(scan);
    transmission.beams = {static_cast<std::uint32_t>(step)};
    transmission.sectors.push_back({even_edges(head - half_width_rad, head + half_width_rad, slices),
                                    even_edges(-corner_rad, corner_rad, rows),
                                    glm::dmat3(forward_axis, starboard_axis, up_axis)});
    transmission.beam_of_tube.assign(static_cast<std::size_t>(slices * rows), 0u);
    // Direction of the head, and the horizontal direction across it.
    const glm::dvec3 ahead(std::sin(head), std::cos(head), 0), across(std::cos(head), -std::sin(head), 0);
    transmission.fans.push_back(
        {0, 1, static_cast<std::uint32_t>(transmission.beam_of_tube.size()), ahead, across, up_axis});
    transmissions_.push_back(std::move(transmission));
  }
}

/// Excess of a scan's duration over the time to the next scan of its line, if it is positive.
std::optional<double> overlap_s(const Recording& recording) {
  const Sensor& sensor = *recording.sensor;
  const double scan_s = static_cast<double>(sensor.firings()) *
                        step_interval_s(sensor.description().kind.as<ScanningDescription>());
  for (const PingSpan& line : recording.lines())
    for (std::size_t ping = line.first + 1; ping < line.end; ++ping)
      if (const double after_s = recording.ping_time_s[ping] - recording.ping_time_s[ping - 1];
          after_s < scan_s * (1 - 1e-9))
        return scan_s - after_s;
  return std::nullopt;
}

/// One row per step: its time, its direction, and the range of its strongest echo.
std::string steps_table(const Recording& recording, const std::optional<ReceiverOutput>& receiver_output) {
  const Sensor& sensor = *recording.sensor;
  const RangeSamples& samples = sensor.samples();
  std::string text = "ping,step,time_s,head_deg,loudest_range_m,loudest_energy_j\n";
  const auto lines_of = [&](std::size_t ping) {
    const PingEnergies kept = recording.energy_of(ping);
    const std::span<const double> ideal = kept;
    const std::vector<double> energy =
        receiver_output ? receiver_output->energy_of(ping) : std::vector<double>(ideal.begin(), ideal.end());
    std::string lines;
    for (std::size_t step = 0; step < sensor.firings(); ++step) {
      const std::span<const double> own = std::span(energy).subspan(
          step * static_cast<std::size_t>(samples.count), static_cast<std::size_t>(samples.count));
      const auto loudest = std::ranges::max_element(own);
      fmt::format_to(
          std::back_inserter(lines), "{},{},{:.9g},{:.9g},", ping, step,
          recording.ping_time_s[ping] + sensor.transmission_delay_s(sensor.first_transmission(step)),
          degrees(sensor.beams()[step].azimuth_rad));
      if (*loudest > 0)
        fmt::format_to(std::back_inserter(lines), "{:.9g},{:.9g}",
                       samples.first_m + (static_cast<double>(loudest - own.begin()) + 0.5) * samples.step_m,
                       *loudest);
      else
        lines += ',';
      lines += '\n';
    }
    return lines;
  };
  Steps steps("scans written to the table", recording.pings());
  in_order(steps, 0, recording.pings(), sizeof(double) * recording.cells(), lines_of,
           [&](std::size_t, const std::string& lines) { text += lines; });
  return text;
}

class ScanningKind : public SensorKind {
 public:
  ScanningKind() : SensorKind("scanning") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using S = ScanningDescription;
    constexpr ValueRange scan{.lo = 0, .hi = 360, .lo_excluded = true};
    section.kind<S>(
        "kind", name(),
        "Mechanical scanning sonar, whose single beam turns from port to starboard. A ping is a scan with "
        "one transmission per step.",
        {field("frequency_khz", &S::frequency_khz,
               {.meaning = "Frequency, which determines the absorption and the beam patterns.",
                .ranges = {frequency}}),
         field("scan_deg", &S::scan_deg,
               {.meaning = "Width of the sector that a scan covers, centred straight ahead. The directions "
                           "of the beam are whole multiples of `step_deg`.",
                .ranges = {scan}}),
         field("step_deg", &S::step_deg,
               {.meaning = "Angle between transmissions. `scan_deg` is a whole multiple of this angle, with "
                           "at most 4096 steps.",
                .ranges = {scan}}),
         field("beam_horizontal_deg", &S::beam_horizontal_deg,
               {.meaning = "One-way width of the beam. Beams wider than a step overlap. With patterns: width "
                           "of the transmitted and received sector.",
                .ranges = {sector(90, false)}}),
         field("beam_vertical_deg", &S::beam_vertical_deg,
               {.meaning = "One-way height of the beam.", .ranges = {sector(170, false)}}),
         field("step_interval_s", &S::step_interval_s,
               {.meaning = "Time between transmissions. Default: twice `range_max_m` divided by 1500 m/s, "
                           "plus 20 ms to turn the head.",
                .ranges = {{.lo = 0, .hi = 1000}},
                .default_value = "computed from range_max_m"}),
         field("samples", &S::samples,
               {.meaning = "Number of range bins of equal length.", .ranges = {range_samples}}),
         field("range_min_m", &S::range_min_m,
               {.meaning = "Slant range at which the first range bin begins.", .ranges = {range_start}}),
         field("range_max_m", &S::range_max_m,
               {.meaning = "Slant range at which the last range bin ends.", .ranges = {sonar_range}})});
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    const auto& scan = sensor.kind.as<ScanningDescription>();
    check_ranges(scan.range_min_m, scan.range_max_m, table);
    const std::optional<int> steps = steps_of(scan);
    if (!steps)
      throw InputError(place_of_pair(table, "scan_deg", "step_deg"),
                       fmt::format("'scan_deg' ({}) must be a whole multiple of 'step_deg' ({}) and at most "
                                   "4096 steps, but it is {:.6g} steps",
                                   scan.scan_deg, scan.step_deg, scan.scan_deg / scan.step_deg));
    const double scan_s = *steps * step_interval_s(scan);
    const double interval_s = sensor.shortest_interval_s();
    if (sensor.has_several_pings() && scan_s > interval_s * (1 + 1e-9))
      throw InputError(
          sensor.ping_times_s.empty() ? place_of_pair(table, "pings", "ping_interval_s")
                                      : table.place_of("ping_times_s"),
          fmt::format("a ping is a scan of {} steps, which takes {:.6g} s, so {} "
                      "must be this time or more, not {:g}",
                      *steps, scan_s,
                      sensor.ping_times_s.empty() ? "'ping_interval_s'" : "the intervals of 'ping_times_s'",
                      interval_s));
  }
  bool looks_ahead() const override { return true; }
  SensorFigures figures(const SensorDescription& sensor) const override {
    const auto& scan = sensor.kind.as<ScanningDescription>();
    const int steps = steps_of(scan).value_or(1);
    SensorFigures figures =
        range_figures(scan, steps, std::min(scan.beam_horizontal_deg, scan.beam_vertical_deg));
    figures.transmissions = steps;
    return figures;
  }

  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<Scanning>(sensor);
  }

  std::vector<std::string> products() const override {
    std::vector<std::string> names = fan_picture_products();
    names.emplace_back("steps.csv");
    return names;
  }
  std::vector<fs::path> write_products(const fs::path& folder, const Recording& recording,
                                       const RunContext& run,
                                       std::vector<std::string>& warnings) const override {
    if (const std::optional<double> too_soon_s = overlap_s(recording))
      warnings.push_back(fmt::format(
          "'{}' begins scans {:.6g} s before the previous scan ends: increase 'ping_interval_s' by this time",
          recording.sensor->description().name, *too_soon_s));
    const std::optional<ReceiverOutput> receiver_output = receiver_output_of(recording, run);
    std::vector<fs::path> files = write_fan_pictures(folder, recording, receiver_output, run.pictures,
                                                     PictureSettings::Which::all, warnings, run.omitted);
    if (!run.writes("steps.csv")) return files;
    files.emplace_back(recording.sensor->description().name + "-steps.csv");
    write_file(folder / files.back(), steps_table(recording, receiver_output));
    return files;
  }
  std::optional<SonarOutline> outline(const SensorDescription& sensor) const override {
    const auto& own = sensor.kind.as<ScanningDescription>();
    SonarOutline outline;
    outline.add("frequency_khz", own.frequency_khz)
        .add("scan_deg", own.scan_deg)
        .add("step_deg", own.step_deg);
    outline.add("beam_horizontal_deg", own.beam_horizontal_deg)
        .add("beam_vertical_deg", own.beam_vertical_deg);
    if (own.step_interval_s) outline.add("step_interval_s", *own.step_interval_s);
    outline.add_window(own);
    outline.shape = SonarOutline::Shape::turning;
    outline.scan_deg = own.scan_deg;
    outline.step_deg = own.step_deg;
    outline.vertical_deg = own.beam_vertical_deg;
    return outline;
  }
  WritingCost writing_cost(const Recording& recording, const RunContext& run) const override {
    return cost_of_fan_pictures(recording, receiver_output_of(recording, run).has_value(), run.pictures,
                                PictureSettings::Which::all, run.omitted);
  }
};

}  // namespace

const SensorSection& ScanningDescription::kind() {
  static const ScanningKind kind;
  return kind;
}
const SensorSection& scanning_kind() { return ScanningDescription::kind(); }

}  // namespace tubefoot
