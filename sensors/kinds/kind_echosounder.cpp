// SPDX-License-Identifier: GPL-3.0-or-later
// The sensor kind "echosounder": a single beam straight down. Defines its scene keys, its transmission, the
// detection of the bottom and its files (table, echogram, energies).

#include "sensors/kinds/kind_echosounder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "files/checked_file.hpp"
#include "geometry/steps/in_order.hpp"
#include "scene/file/sensor_ranges.hpp"
#include "scene/file/toml_reader.hpp"
#include "sensors/detection/bottom_detection.hpp"
#include "sensors/detection/sounding_place.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/model/range_window.hpp"
#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/echogram.hpp"
#include "sensors/pictures/image_file.hpp"
#include "sensors/products/noise_floor.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/received.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Single beam along the sensor's down axis, within a square sector. Transmitter and receiver each have a
/// pattern, by default a Gaussian of the beam's width about the axis.
class Echosounder : public Sensor {
 public:
  /// Throws std::invalid_argument for an invalid beam or sector, invalid ranges or invalid counts.
  explicit Echosounder(const SensorDescription& description);
};

SensorDescription with_beam(SensorDescription description) {
  const auto& sounder = description.kind.as<EchosounderDescription>();
  for (PatternDescription* pattern : {&description.transmit, &description.receive})
    if (pattern->pattern == "none") {
      pattern->pattern = "gaussian";
      pattern->angle = "off_axis";
      pattern->width_deg = sounder.beam_deg;
    }
  return description;
}

Echosounder::Echosounder(const SensorDescription& description) : Sensor(with_beam(description)) {
  const auto& sounder = description.kind.as<EchosounderDescription>();
  constexpr double widest_deg = 170;
  const double sector_deg = sounder.sector_deg.value_or(std::min(3 * sounder.beam_deg, widest_deg));
  require(sounder.beam_deg > 0 && sounder.beam_deg < 180, description, "beam_deg", sounder.beam_deg,
          "above 0 and below 180");
  require(sector_deg > 0 && sector_deg <= widest_deg, description, "sector_deg", sector_deg,
          "above 0 and at most 170");

  frequency_khz_ = sounder.frequency_khz;
  samples_ = range_window(description, sounder);
  across_track_ = true;
  beams_.push_back({0, -radians(90), radians(sounder.beam_deg), radians(sounder.beam_deg)});

  const double half_rad = radians(sector_deg) / 2;
  // The grid's azimuth points to starboard, and its elevation points forward. Above 90 degrees it has at
  // least two rows and two columns, so that no tube approaches a half space.
  const int cells = half_rad > radians(45) ? 2 : 1;
  const int slices = std::max(cells, slices_for(2 * half_rad, description.cone_tolerance));
  const double corner_rad = height_of_corners(half_rad, 2 * half_rad / slices, description.cone_tolerance);
  Transmission transmission;
  transmission.beams = {0};
  transmission.sectors.push_back({even_edges(-half_rad, half_rad, slices),
                                  even_edges(-corner_rad, corner_rad, cells),
                                  glm::dmat3(-up_axis, starboard_axis, forward_axis)});
  transmission.beam_of_tube.assign(static_cast<std::size_t>(slices * cells), 0u);
  transmission.fans.push_back({0, 1, static_cast<std::uint32_t>(transmission.beam_of_tube.size()), -up_axis,
                               starboard_axis, forward_axis});
  transmissions_.push_back(std::move(transmission));
}

DetectionRule rule_of(const EchosounderDescription& sounder) {
  DetectionRule rule;
  rule.method = detection_method_from_name(sounder.detection);
  rule.relative_db = sounder.detection_threshold_db;
  return rule;
}

/// Range of the bottom; NaN without a detection.
double range_of(const std::optional<Detection>& bottom) {
  return bottom ? bottom->range_m : std::numeric_limits<double>::quiet_NaN();
}

/// Text of a number; empty for a number that is not finite.
std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : ""; }

void append_line(std::string& text, const Recording& recording, const SoundingPlacer& placer,
                 std::size_t ping, const std::optional<Detection>& bottom) {
  const double altitude_m = ping < recording.altitude_m.size() ? recording.altitude_m[ping]
                                                               : std::numeric_limits<double>::quiet_NaN();
  fmt::format_to(std::back_inserter(text), "{},{:.9g},", recording.number_of(ping),
                 recording.ping_time_s[ping]);
  if (bottom) {
    const glm::dvec3 place = placer.place(recording.ping_pose[ping], {0, 0, -1}, bottom->range_m,
                                          recording.water_level_error_m(ping));
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}",
                   bottom->range_m, bottom->range_sigma_m, bottom->energy_j, bottom->quality, place.x,
                   place.y, place.z);
  } else {
    text += ",,,,,,";
  }
  const glm::dvec3 own = recording.ping_pose[ping].position_m;
  fmt::format_to(std::back_inserter(text), ",{:.9g},{:.9g},{:.9g},{},{}\n", own.x, own.y, own.z,
                 cell(altitude_m), bottom ? name_of(bottom->flags) : "none");
}

void write_exr_of(const fs::path& file, const Recording& recording, const std::vector<float>& energies) {
  const RangeSamples& samples = recording.sensor->samples();
  OIIO::ParamValueList attributes;
  attributes.attribute("sensor", recording.sensor->description().name);
  attributes.attribute("quantity", "received energy density [J/m^2] for a source of 1 J/sr at 1 m");
  attributes.attribute("rows", "pings, the first on top");
  attributes.attribute("columns", "range samples, the nearest first");
  attributes.attribute("slant_range_first_m", OIIO::TypeDesc::DOUBLE, 1, &samples.first_m);
  attributes.attribute("slant_range_step_m", OIIO::TypeDesc::DOUBLE, 1, &samples.step_m);
  write_exr(file, samples.count, static_cast<int>(recording.pings()), energies, attributes);
}

/// Contribution of a ping to the files.
struct ReceivedPing {
  std::vector<float> energies, received;
  double ideal_m = 0, range_m = 0;  ///< ranges of the bottom; NaN without one
  std::string line;
};

/// Writes the files of an echosounder and returns their names. The table <name>.csv has the detected bottom
/// of each ping. The picture <name>.png is an echogram of the received energies, and <name>.exr has the
/// energies (pings x samples, unscaled).
std::vector<fs::path> write_echosounder_files(const fs::path& folder, const Recording& recording,
                                              const RunContext& run, std::vector<std::string>& warnings) {
  check(recording);
  const bool table = run.writes("csv"), echogram = run.draws("png"), exr = run.draws("exr"),
             echogram_as_received = run.draws("received.png");
  if (!table && !echogram && !exr && !echogram_as_received) return {};
  const Sensor& sensor = *recording.sensor;
  const std::string stem = sensor.description().name;
  const DetectionRule rule = rule_of(sensor.description().kind.as<EchosounderDescription>());
  const std::optional<ReceiverOutput> receiver_output = receiver_output_of(recording, run);
  const std::vector<double> floor_j = noise_floor_j(recording, run);
  const SoundingPlacer placer(recording, run);
  std::vector<float> energies, received;
  std::vector<double> bottoms, ideal_bottoms;
  std::string csv =
      "ping,time_s,range_m,range_sigma_m,energy_j,quality,bottom_east_m,bottom_north_m,bottom_up_m,"
      "sensor_east_m,sensor_north_m,sensor_up_m,true_altitude_m,status\n";
  const auto sounded = [&](std::size_t ping) {
    const PingEnergies kept = recording.energy_of(ping);
    const std::span<const double> energy = kept;
    ReceivedPing made;
    made.energies.assign(energy.begin(), energy.end());
    made.ideal_m = range_of(detect_bottom(energy, sensor.samples(), rule));
    if (!table && !(receiver_output && echogram_as_received)) return made;
    std::vector<double> own = receiver_output ? receiver_output->energy_of(ping)
                                              : std::vector<double>(energy.begin(), energy.end());
    made.received.assign(own.begin(), own.end());
    for (std::size_t k = 0; k < own.size(); ++k)
      if (own[k] < floor_j[k]) own[k] = 0;
    const std::optional<Detection> bottom = detect_bottom(own, sensor.samples(), rule);
    made.range_m = range_of(bottom);
    append_line(made.line, recording, placer, ping, bottom);
    return made;
  };
  Steps steps("pings converted for echosounder files", recording.pings());
  in_order(steps, 0, recording.pings(), 2 * sizeof(float) * recording.cells(), sounded,
           [&](std::size_t, const ReceivedPing& made) {
             energies.insert(energies.end(), made.energies.begin(), made.energies.end());
             received.insert(received.end(), made.received.begin(), made.received.end());
             ideal_bottoms.push_back(made.ideal_m);
             bottoms.push_back(made.range_m);
             csv += made.line;
           });

  std::vector<fs::path> files;
  const auto new_file = [&](const char* ending) {
    files.emplace_back(stem + ending);
    return folder / files.back();
  };
  if (table) write_file(new_file(".csv"), csv);
  const bool draws = echogram || (receiver_output && echogram_as_received);
  const std::string font = draws ? font_for(stem, warnings) : std::string();
  if (echogram)
    draw_echogram(recording, energies, ideal_bottoms, font)
        .write_png(new_file(".png"), stem, run.pictures.bits);
  if (exr) write_exr_of(new_file(".exr"), recording, energies);
  if (receiver_output && echogram_as_received)
    draw_echogram(recording, received, bottoms, font, receiver_output->said)
        .write_png(new_file("-received.png"), stem, run.pictures.bits);
  return files;
}

class EchosounderKind : public SensorKind {
 public:
  EchosounderKind() : SensorKind("echosounder") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using E = EchosounderDescription;
    section.kind<E>(
        "kind", name(),
        "Single-beam echosounder that looks straight down. By default, both patterns are Gaussian functions "
        "of the angle from the axis with the width `beam_deg`.",
        {field("frequency_khz", &E::frequency_khz,
               {.meaning = "Frequency, which determines the absorption and the beam patterns.",
                .ranges = {frequency}}),
         field("beam_deg", &E::beam_deg,
               {.meaning = "Full one-way width of the beam at -3 dB.", .ranges = {sector(90, false)}}),
         field("sector_deg", &E::sector_deg,
               {.meaning = "Angular width of the square sector about the axis. The sonar receives nothing "
                           "from outside this sector.",
                .ranges = {sector(170, false)},
                .default_value = "3 times beam_deg, at most 170"}),
         field("samples", &E::samples,
               {.meaning = "Number of range bins of equal length.", .ranges = {range_samples}}),
         field("range_min_m", &E::range_min_m,
               {.meaning = "Slant range at which the first range bin begins.", .ranges = {range_start}}),
         field("range_max_m", &E::range_max_m,
               {.meaning = "Slant range at which the last range bin ends.", .ranges = {sonar_range}}),
         field("detection", &E::detection,
               {.meaning = "Method that computes the bottom range of a beam. first_return: first bin above "
                           "the threshold. energy_centroid: energy-weighted mean range of one echo. maximum: "
                           "peak of a parabola through the strongest bins.",
                .choices = {"first_return", "energy_centroid", "maximum"}}),
         field("detection_threshold_db", &E::detection_threshold_db,
               {.meaning = "Threshold of detection, relative to the strongest range bin of the beam. Weaker "
                           "bins are ignored.",
                .ranges = {{.lo = -300, .hi = 0}}})});
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    const auto& sounder = sensor.kind.as<EchosounderDescription>();
    check_ranges(sounder.range_min_m, sounder.range_max_m, table);
  }
  SensorFigures figures(const SensorDescription& sensor) const override {
    const auto& sounder = sensor.kind.as<EchosounderDescription>();
    return range_figures(sounder, 1, sounder.beam_deg);
  }

  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<Echosounder>(sensor);
  }

  std::vector<std::string> products() const override { return {"csv", "png", "exr", "received.png"}; }
  std::vector<fs::path> write_products(const fs::path& folder, const Recording& recording,
                                       const RunContext& run,
                                       std::vector<std::string>& warnings) const override {
    return write_echosounder_files(folder, recording, run, warnings);
  }
  std::optional<SonarOutline> outline(const SensorDescription& sensor) const override {
    const auto& own = sensor.kind.as<EchosounderDescription>();
    SonarOutline outline;
    outline.add("frequency_khz", own.frequency_khz).add("beam_deg", own.beam_deg);
    if (own.sector_deg) outline.add("sector_deg", *own.sector_deg);
    outline.add_window(own);
    outline.looks_down = true;
    outline.vertical_deg = own.beam_deg;
    return outline;
  }
  WritingCost writing_cost(const Recording& recording, const RunContext& run) const override {
    constexpr double sounding_s = 1.1e-7, echogram_s = 0.25, exr_cell_s = 4e-8, energy_bytes = 4;
    WritingCost cost;
    const bool echograms = run.draws("png") || run.draws("received.png");
    if (run.writes("csv") || echograms || run.draws("exr")) cost += cost_by_cells(recording, sounding_s, 0);
    if (echograms) cost += {echogram_s, 0, 0};
    if (run.draws("exr")) cost += cost_by_cells(recording, exr_cell_s, energy_bytes);
    return cost;
  }
};

}  // namespace

const SensorSection& EchosounderDescription::kind() {
  static const EchosounderKind kind;
  return kind;
}
const SensorSection& echosounder_kind() { return EchosounderDescription::kind(); }

}  // namespace tubefoot
