// SPDX-License-Identifier: GPL-3.0-or-later
// The sensor kind "didson": acoustic cameras such as DIDSON and ARIS. Defines their scene keys, checks,
// transmissions in firing cycles, the fit of an ARIS range gate, and their files.

#include "sensors/kinds/kind_didson.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>

#include "scene/file/sensor_presets.hpp"
#include "scene/file/sensor_ranges.hpp"
#include "scene/file/toml_reader.hpp"
#include "sensors/formats/aris_file.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/model/beam_angles.hpp"
#include "sensors/model/lens_beams.hpp"
#include "sensors/products/camera_files.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/received.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Acoustic camera: a fan of beams about the camera's up axis, each over the whole elevation. Beam 0 is the
/// port-most. A format that starts at starboard, such as DDF, reverses the order.
///
/// A frame has one transmission, or `cycles` of them. Cycle k has the beams k, k + cycles, k + 2 cycles, ...
/// Ideal beams use only their own sectors. With a receive pattern every transmission insonifies the whole
/// fan and its margins, and the beams of its cycle receive all of that.
class Didson : public Sensor {
 public:
  explicit Didson(const SensorDescription& description);

 private:
  /// Insonified and received sector, in angles about the camera's axes.
  struct Sector {
    std::vector<double> borders_rad;  ///< of the beams
    double half_width_rad, half_height_rad;
  };
  Transmission transmission_of(std::size_t cycle, const Sector& sector) const;
};

/// The two-way travel time to the end of the range gate, plus the overhead of an ARIS per transmission.
/// Range gates of cameras assume 1500 m/s.
double default_cycle_interval_s(const DidsonDescription& camera) {
  constexpr double nominal_sound_speed_m_s = 1500, overhead_s = 420e-6;
  return 2 * (camera.window_start_m + camera.window_length_m) / nominal_sound_speed_m_s + overhead_s;
}

void require_camera(const SensorDescription& description) {
  const auto& camera = description.kind.as<DidsonDescription>();
  require(camera.beams >= 1, description, "beams", camera.beams, "1 or more");
  require(camera.samples >= 1, description, "samples", camera.samples, "1 or more");
  require(camera.horizontal_deg > 0 && camera.horizontal_deg <= 360, description, "horizontal_deg",
          camera.horizontal_deg, "above 0 and at most 360");
  require(camera.vertical_deg > 0 && camera.vertical_deg < 180, description, "vertical_deg",
          camera.vertical_deg, "above 0 and below 180");
  for (const auto& transmit : {camera.transmit_horizontal_deg, camera.transmit_vertical_deg})
    require(!transmit || (*transmit > 0 && *transmit < 360), description, "transmit sector",
            transmit.value_or(0), "above 0 and below 360");
  require(camera.window_start_m >= 0, description, "window_start_m", camera.window_start_m, "0 or more");
  require(camera.window_length_m > 0, description, "window_length_m", camera.window_length_m, "above 0");
  require(camera.beam_centres == "even" || camera.beams == 48 || camera.beams == 96, description, "beams",
          camera.beams, "48 or 96 with beam_centres = \"lens\"");
  require(camera.receive_margin_deg >= 0 && camera.horizontal_deg + 2 * camera.receive_margin_deg <= 360,
          description, "receive_margin_deg", camera.receive_margin_deg,
          "0 or more, and at most 360 degrees together with horizontal_deg");
  require(camera.cycles >= 1 && camera.beams % camera.cycles == 0, description, "cycles", camera.cycles,
          "1 or more, a divisor of beams");
  require(camera.cycle_interval_s.value_or(0) >= 0, description, "cycle_interval_s",
          camera.cycle_interval_s.value_or(0), "0 or more");
  std::vector<int> order = camera.firing_order, all(static_cast<std::size_t>(camera.cycles));
  std::iota(all.begin(), all.end(), 0);
  std::sort(order.begin(), order.end());
  require(order.empty() || order == all, description, "firing_order", fmt::format("{}", camera.firing_order),
          "each cycle from 0 to cycles - 1 once");
  // The pattern over elevation is the same for every beam. Steering it to the beams would only count it once
  // for each.
  require(camera.transmit_steering != "beams" || description.transmit.angle != "elevation", description,
          "transmit_steering", "\"beams\"", "\"fan\" with transmit_pattern_angle = \"elevation\"");
}

Didson::Didson(const SensorDescription& description) : Sensor(description) {
  require_camera(description);
  const auto& camera = description.kind.as<DidsonDescription>();
  frequency_khz_ = camera.frequency_khz;
  samples_ = {camera.window_start_m, camera.window_length_m / camera.samples, camera.samples};

  const double half_vertical_rad = radians(camera.vertical_deg) / 2;
  Sector sector;
  if (camera.beam_centres == "lens") {
    const std::vector<double> centres = lens_beam_centres(camera.beams);
    sector.borders_rad = borders_between(centres);
    for (std::size_t b = 0; b < centres.size(); ++b)
      beams_.push_back(
          {centres[b], 0, sector.borders_rad[b + 1] - sector.borders_rad[b], 2 * half_vertical_rad});
  } else {
    const double half_horizontal_rad = radians(camera.horizontal_deg) / 2;
    const double beam_width_rad = 2 * half_horizontal_rad / camera.beams;
    sector.borders_rad = even_edges(-half_horizontal_rad, half_horizontal_rad, camera.beams);
    for (int beam = 0; beam < camera.beams; ++beam)
      beams_.push_back(
          {-half_horizontal_rad + (beam + 0.5) * beam_width_rad, 0, beam_width_rad, 2 * half_vertical_rad});
  }
  // An echo needs both sectors, so that only the part of the receive sector within the transmit sector has
  // tubes. Both sectors share apex and axes, and their intersection is one of angles.
  constexpr double whole_circle_deg = 360;
  sector.half_width_rad = radians(camera.transmit_horizontal_deg.value_or(whole_circle_deg)) / 2;
  sector.half_height_rad =
      radians(std::min(camera.transmit_vertical_deg.value_or(camera.vertical_deg), camera.vertical_deg)) / 2;

  const double interval_s = camera.cycle_interval_s.value_or(default_cycle_interval_s(camera));
  for (std::size_t place = 0; place < static_cast<std::size_t>(camera.cycles); ++place) {
    const std::size_t cycle =
        camera.firing_order.empty() ? place : static_cast<std::size_t>(camera.firing_order[place]);
    transmissions_.push_back(transmission_of(cycle, sector));
    transmissions_.back().delay_s = static_cast<double>(place) * interval_s;
  }
}

Sensor::Transmission Didson::transmission_of(std::size_t cycle, const Sector& sector) const {
  const auto& camera = description_.kind.as<DidsonDescription>();
  const bool receives_all = tells_beams_apart(description_.receive, "elevation");
  const auto cycles = static_cast<std::size_t>(camera.cycles);
  Transmission transmission;
  for (std::size_t beam = cycle; beam < beams_.size(); beam += cycles)
    transmission.beams.push_back(static_cast<std::uint32_t>(beam));

  // Two rows above 90 degrees, so that no tube approaches a half space. The rays of such a tube would not
  // determine it.
  const std::size_t rows = sector.half_height_rad > radians(45) ? 2 : 1;
  const double tolerance = description_.cone_tolerance;
  std::vector<double> heights;  // set when the width of the slices is known
  bool apart = true;
  /// Adds a cell of the fan. It continues the previous sector unless the cells are `apart`.
  const auto add = [&](double from, double to, std::uint32_t own) {
    from = std::max(from, -sector.half_width_rad);
    to = std::min(to, sector.half_width_rad);
    if (to - from < 1e-8) return;  // not insonified, or too narrow for integer rays to resolve its walls
    // Surfaces of constant elevation are cones, while tubes have planes. A wide cell therefore has several
    // slices (see slice_width_rad).
    const std::vector<double> edges = even_edges(from, to, slices_for(to - from, tolerance));
    if (apart)
      transmission.sectors.push_back({{from}, heights, glm::dmat3(forward_axis, starboard_axis, up_axis)});
    std::vector<double>& azimuths = transmission.sectors.back().azimuth_edges_rad;
    azimuths.insert(azimuths.end(), edges.begin() + 1, edges.end());
    transmission.beam_of_tube.insert(transmission.beam_of_tube.end(), rows * (edges.size() - 1), own);
    apart = false;
  };
  const std::vector<double>& borders = sector.borders_rad;
  const double margin_rad = receives_all ? radians(camera.receive_margin_deg) : 0;
  double widest_rad = 0;
  const auto widen = [&](double width_rad) {
    widest_rad = std::max(widest_rad, width_rad / slices_for(width_rad, tolerance));
  };
  for (std::size_t beam = 0; beam + 1 < borders.size(); ++beam) widen(borders[beam + 1] - borders[beam]);
  if (margin_rad > 0) widen(margin_rad);
  if (receives_all && cycles > 1) widen(2 * sector.half_width_rad);
  const double corner_rad = height_of_corners(sector.half_height_rad, widest_rad, tolerance);
  heights = even_edges(-corner_rad, corner_rad, static_cast<int>(rows));
  const auto last = static_cast<std::uint32_t>(transmission.beams.size() - 1);
  if (receives_all && cycles > 1) {
    // No beam has its own tube. The fan has the fewest slices that its walls permit, and each is assigned to
    // the beam with the nearest axis.
    const double from = std::max(borders.front() - margin_rad, -sector.half_width_rad),
                 to = std::min(borders.back() + margin_rad, sector.half_width_rad);
    const std::vector<double> edges = even_edges(from, to, slices_for(to - from, tolerance));
    for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
      const double middle = (edges[k] + edges[k + 1]) / 2;
      std::uint32_t nearest = 0;
      while (nearest < last && middle > (beams_[transmission.beams[nearest]].azimuth_rad +
                                         beams_[transmission.beams[nearest + 1]].azimuth_rad) /
                                            2)
        ++nearest;
      add(edges[k], edges[k + 1], nearest);
    }
  } else {
    if (margin_rad > 0) add(borders.front() - margin_rad, borders.front(), 0);
    for (std::uint32_t place = 0; place < transmission.beams.size(); ++place) {
      const std::size_t beam = transmission.beams[place];
      apart = apart || cycles > 1;
      add(borders[beam], borders[beam + 1], place);
    }
    if (margin_rad > 0) add(borders.back(), borders.back() + margin_rad, last);
  }
  const std::string steering = camera.transmit_steering.value_or(
      cycles > 1 && description_.transmit.angle != "elevation" ? "beams" : "fan");
  transmission.fans.push_back({0, last + 1, static_cast<std::uint32_t>(transmission.beam_of_tube.size()),
                               forward_axis, starboard_axis, up_axis, steering == "beams"});
  return transmission;
}

/// Checks the keys for beams and cycles of an acoustic camera.
void check_keys(const SensorDescription& sensor, const TomlTable& table) {
  const auto& camera = sensor.kind.as<DidsonDescription>();
  const auto fail = [&](const char* key, const std::string& what) {
    throw InputError(table.place_of(key), what);
  };
  if (camera.beam_centres == "lens") {
    if (camera.beams != 48 && camera.beams != 96)
      fail("beams", fmt::format("beam_centres = \"lens\" is available for 48 or 96 beams, not for {}: use "
                                "one of these numbers, or \"even\"",
                                camera.beams));
    if (table.has("horizontal_deg"))
      fail("horizontal_deg",
           "beam_centres = \"lens\" determines the width of the fan: remove 'horizontal_deg', or use "
           "\"even\"");
  }
  if (camera.beams % camera.cycles != 0)
    fail("cycles", fmt::format("the number of beams ({}) must be a multiple of 'cycles' ({})", camera.beams,
                               camera.cycles));
  for (const char* key : {"cycle_interval_s", "firing_order"})
    if (table.has(key) && camera.cycles == 1)
      fail(key,
           fmt::format(
               "'{}' needs 'cycles' of 2 or more, because with one cycle all beams transmit at the same time",
               key));
  std::vector<int> order = camera.firing_order;
  std::ranges::sort(order);
  for (std::size_t k = 0; k < order.size(); ++k)
    if (order.size() != static_cast<std::size_t>(camera.cycles) || order[k] != static_cast<int>(k))
      fail("firing_order",
           fmt::format("'firing_order' must contain each cycle from 0 to {} once", camera.cycles - 1));
  if (table.has("receive_margin_deg") && !tells_beams_apart(sensor.receive, "elevation"))
    fail("receive_margin_deg",
         "'receive_margin_deg' needs a 'receive_pattern' across the beams, because beams without a pattern, "
         "or with a pattern in \"elevation\", receive nothing beyond their edges: add such a pattern, or "
         "remove the key");
  if (!table.has("transmit_steering")) return;
  if (sensor.transmit.pattern == "none")
    fail("transmit_steering",
         "'transmit_steering' needs a 'transmit_pattern': add a pattern, or remove the key");
  if (camera.transmit_steering == "beams" && sensor.transmit.angle == "elevation")
    fail("transmit_steering",
         "a pattern in \"elevation\" is the same for all beams of the fan and therefore needs "
         "transmit_steering = \"fan\"");
}

/// True if the range gate is that of a preset, so that it suits any water.
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
  if (!window) return;  // the writer of the ARIS file reports a range gate that no ARIS has
  const double start_m = window->start_m(sound_speed_m_s),
               length_m = window->length_m(sound_speed_m_s, camera.samples), end_m = start_m + length_m,
               requested_end_m = camera.window_start_m + camera.window_length_m,
               half_sample_m = length_m / camera.samples / 2;
  if (notes != nullptr && !has_window_of_preset(description, camera) &&
      (std::abs(start_m - camera.window_start_m) > half_sample_m ||
       std::abs(end_m - requested_end_m) > half_sample_m))
    notes->push_back(fmt::format(
        "sensor '{}' is an ARIS, whose range gate consists of whole microseconds: at {:.2f} m/s it extends "
        "from {:.4f} to {:.4f} m ({} us, then {} samples of {} us), not from {:.4f} to {:.4f} m",
        description.name, sound_speed_m_s, start_m, end_m, window->start_delay_us, camera.samples,
        window->sample_period_us, camera.window_start_m, requested_end_m));
  camera.window_start_m = start_m;
  camera.window_length_m = length_m;
}

class DidsonKind : public SensorKind {
 public:
  DidsonKind() : SensorKind("didson") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using D = DidsonDescription;
    section.kind<D>(
        "kind", name(),
        "Acoustic camera with one forward-looking fan of beams. Without patterns, the beams are ideal and "
        "rectangular.",
        {field("frequency_khz", &D::frequency_khz,
               {.meaning = "Frequency, which determines the absorption.", .ranges = {frequency}}),
         field("beams", &D::beams,
               {.meaning = "Number of adjacent beams. Beam 0 is the port-most beam.",
                .ranges = {{.lo = 1, .hi = 4096}}}),
         field(
             "beam_centres", &D::beam_centres,
             {.meaning = "even: beams of equal width within `horizontal_deg`. lens: the 48 or 96 beams of a "
                         "DIDSON lens, without `horizontal_deg`; borders lie midway between beam centres.",
              .choices = {"even", "lens"}}),
         field("horizontal_deg", &D::horizontal_deg,
               {.meaning = "One-way width of the whole fan.", .ranges = {sector(180, true)}}),
         field("vertical_deg", &D::vertical_deg,
               {.meaning = "One-way height of the fan.", .ranges = {sector(170, false)}}),
         field("transmit_horizontal_deg", &D::transmit_horizontal_deg,
               {.meaning = "Width of the transmitted sector about the axis of the fan. Only parts of beams "
                           "within this sector contribute.",
                .ranges = {sector(180, true)},
                .default_value = "value of horizontal_deg"}),
         field("transmit_vertical_deg", &D::transmit_vertical_deg,
               {.meaning = "Height of the transmitted sector.",
                .ranges = {sector(170, false)},
                .default_value = "value of vertical_deg"}),
         field("receive_margin_deg", &D::receive_margin_deg,
               {.meaning = "With a receive pattern: margin by which the transmitted and received sector "
                           "extends beyond the outermost beams.",
                .ranges = {{.lo = 0, .hi = 10}}}),
         field("cycles", &D::cycles,
               {.meaning = "Number of transmissions per frame, a divisor of `beams`. Beam b belongs to cycle "
                           "b mod `cycles`; the beams of a cycle transmit and receive simultaneously.",
                .ranges = {{.lo = 1, .hi = 4096}}}),
         field("cycle_interval_s", &D::cycle_interval_s,
               {.meaning = "Time between cycles. Default: twice the range at the end of the range gate, "
                           "divided by 1500 m/s, plus 420 us.",
                .ranges = {{.lo = 0, .hi = 1000}},
                .default_value = "computed from the range gate"}),
         field("firing_order", &D::firing_order,
               {.meaning = "Order in which the cycles transmit. Each cycle occurs once.",
                .ranges = {{.lo = 0, .hi = 4095}},
                .default_value = "in increasing order"}),
         field("transmit_steering", &D::transmit_steering,
               {.meaning = "beams: one transmit pattern per beam of the cycle, steered to the beam axis; the "
                           "transmitted powers are added. fan: one pattern at the centre of the fan. "
                           "Patterns in elevation require fan.",
                .choices = {"fan", "beams"},
                .default_value = "beams if there are several cycles, else fan"}),
         field("samples", &D::samples,
               {.meaning = "Number of range bins of equal length.", .ranges = {range_samples}}),
         field("window_start_m", &D::window_start_m,
               {.meaning = "Slant range at which the first range bin begins.", .ranges = {range_start}}),
         field("window_length_m", &D::window_length_m,
               {.meaning = "Length of the range gate.", .ranges = {sonar_range}}),
         field("pictures", &D::pictures,
               {.meaning = "all: a picture per ping. sequence: only the contact sheet of up to 20 pings, "
                           "which tubefoot always writes if there are several pings.",
                .choices = {"all", "sequence"}})});
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    check_keys(sensor, table);
  }
  bool looks_ahead() const override { return true; }
  SensorFigures figures(const SensorDescription& sensor) const override {
    const auto& camera = sensor.kind.as<DidsonDescription>();
    SensorFigures figures;
    figures.frequency_khz = camera.frequency_khz;
    figures.beams = camera.beams;
    figures.samples = camera.samples;
    figures.transmissions = camera.cycles;
    figures.sample_m = camera.window_length_m / camera.samples;
    figures.beam_deg = std::min(camera.horizontal_deg / camera.beams, camera.vertical_deg);
    figures.farthest_m = camera.window_start_m + camera.window_length_m;
    return figures;
  }

  /// Replaces the range gate of an ARIS by the nearest one that the instrument has. An ARIS counts whole
  /// microseconds to the first sample and between samples. A note reports a change by more than half a
  /// sample.
  SensorDescription in_water(SensorDescription sensor, double sound_speed_m_s,
                             std::vector<std::string>* notes) const override {
    if (is_aris(sensor))
      fit_aris_window(sensor, sensor.kind.edit<DidsonDescription>(), sound_speed_m_s, notes);
    return sensor;
  }
  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<Didson>(sensor);
  }

  std::vector<std::string> products() const override {
    std::vector<std::string> names = fan_picture_products();
    std::ranges::copy(camera_file_products(), std::back_inserter(names));
    return names;
  }
  std::vector<fs::path> write_products(const fs::path& folder, const Recording& recording,
                                       const RunContext& run,
                                       std::vector<std::string>& warnings) const override {
    using Which = PictureSettings::Which;
    const std::string& scene_says = recording.sensor->description().kind.as<DidsonDescription>().pictures;
    std::vector<fs::path> files =
        write_fan_pictures(folder, recording, receiver_output_of(recording, run), run.pictures,
                           scene_says == "sequence" ? Which::sequence : Which::all, warnings, run.omitted);
    append(files, write_camera_files(folder, recording, run, warnings));
    return files;
  }
  std::optional<SonarOutline> outline(const SensorDescription& sensor) const override {
    const auto& own = sensor.kind.as<DidsonDescription>();
    SonarOutline outline;
    outline.add("frequency_khz", own.frequency_khz)
        .add("beams", own.beams)
        .add("beam_centres", own.beam_centres);
    if (own.beam_centres == "even") outline.add("horizontal_deg", own.horizontal_deg);
    outline.add("vertical_deg", own.vertical_deg).add("samples", own.samples);
    outline.add("window_start_m", own.window_start_m).add("window_length_m", own.window_length_m);
    if (own.transmit_horizontal_deg) outline.add("transmit_horizontal_deg", *own.transmit_horizontal_deg);
    if (own.transmit_vertical_deg) outline.add("transmit_vertical_deg", *own.transmit_vertical_deg);
    outline.narrowly_lit = own.transmit_horizontal_deg || own.transmit_vertical_deg;
    outline.even = own.beam_centres == "even";
    outline.vertical_deg = own.vertical_deg;
    return outline;
  }
  WritingCost writing_cost(const Recording& recording, const RunContext& run) const override {
    using Which = PictureSettings::Which;
    const bool sheet_alone =
        recording.sensor->description().kind.as<DidsonDescription>().pictures == "sequence";
    WritingCost cost =
        cost_of_fan_pictures(recording, receiver_output_of(recording, run).has_value(), run.pictures,
                             sheet_alone ? Which::sequence : Which::all, run.omitted);
    constexpr double code_s = 2e-7;
    if (has_camera_file(recording, run)) cost += cost_by_cells(recording, code_s, 1);
    return cost;
  }
  std::vector<std::string> files_left_out(const Recording& recording, const RunContext& run) const override {
    return camera_files_left_out(recording, run);
  }
};

}  // namespace

const SensorSection& DidsonDescription::kind() {
  static const DidsonKind kind;
  return kind;
}
const SensorSection& didson_kind() { return DidsonDescription::kind(); }

}  // namespace tubefoot
