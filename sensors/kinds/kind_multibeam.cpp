// SPDX-License-Identifier: GPL-3.0-or-later
// The sensor kind "multibeam": a fan of beams across the track. Defines its scene keys, beams, transmission,
// bottom detection and files.

#include "sensors/kinds/kind_multibeam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>

#include "scene/file/sensor_ranges.hpp"
#include "scene/file/toml_reader.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/model/beam_angles.hpp"
#include "sensors/model/range_window.hpp"
#include "sensors/model/transmit_sectors.hpp"
#include "sensors/products/received.hpp"
#include "sensors/products/swath_files.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Multibeam echosounder with ideal rectangular beams: a fan across the track, about the along-track
/// (forward) axis. Beam 0 is the port-most, and the middle one of an odd number looks straight down. Each
/// beam is a sector of beam_across_deg by along_track_deg; the latter is the same at every angle.
class Multibeam : public Sensor {
 public:
  /// Throws std::invalid_argument for an invalid fan, invalid ranges or invalid counts.
  explicit Multibeam(const SensorDescription& description);

 private:
  /// `angles`: axes of all beams from straight down.
  Transmission transmission_of(const std::vector<double>& angles, const FanSector& sector) const;
  void add_separate_ends(Transmission& transmission, const std::vector<double>& angles,
                         const FanSector& sector, const glm::dmat3& frame, int slices) const;
};

constexpr double straight_down_rad = std::numbers::pi / 2;

/// Angles of the beams' axes from straight down.
std::vector<double> across_angles_rad(const MultibeamDescription& fan) {
  if (!fan.beam_angles_deg.empty()) return radians_of(fan.beam_angles_deg);
  return spread_angles_rad(fan.beams, radians(fan.swath_deg) / 2, fan.spacing);
}

SectorKeys sector_keys(const MultibeamDescription& fan) {
  return {fan.sector_edges_deg,
          {{"sector_frequencies_khz", &fan.sector_frequencies_khz},
           {"sector_tilts_deg", &fan.sector_tilts_deg},
           {"sector_delays_us", &fan.sector_delays_us},
           {"sector_pulse_lengths_us", &fan.sector_pulse_lengths_us},
           {"sector_absorptions_db_per_km", &fan.sector_absorptions_db_per_km}},
          fan.frequency_khz,
          fan.beam_across_deg,
          fan.along_track_deg};
}

/// Angles of the outermost axes.
struct Swath {
  double from_deg = 0, to_deg = 0;
  double outermost_deg() const { return std::max(std::abs(from_deg), std::abs(to_deg)); }
};
Swath swath_of(const MultibeamDescription& fan) {
  if (!fan.beam_angles_deg.empty()) return {fan.beam_angles_deg.front(), fan.beam_angles_deg.back()};
  if (fan.beams == 1) return {};
  return {-fan.swath_deg / 2, fan.swath_deg / 2};
}

/// True if each beam begins where the previous one ends. Neighbours then share their rays.
bool side_by_side(const MultibeamDescription& fan) {
  const auto is_a_beam = [&](double step_deg) {
    return std::abs(step_deg - fan.beam_across_deg) < 1e-9 * fan.beam_across_deg;
  };
  if (const auto& listed = fan.beam_angles_deg; !listed.empty()) {
    for (std::size_t k = 1; k < listed.size(); ++k)
      if (!is_a_beam(listed[k] - listed[k - 1])) return false;
    return true;
  }
  return fan.beams == 1 || (fan.spacing == "angle" && is_a_beam(fan.swath_deg / (fan.beams - 1)));
}

/// The axis of a beam at an angle from straight down, tilted towards forward.
BeamAxis tilted(BeamAxis beam, double across_rad, double tilt_rad) {
  if (tilt_rad == 0) return beam;
  const double level = std::cos(tilt_rad);
  beam.azimuth_rad = std::atan2(level * std::sin(across_rad), std::sin(tilt_rad));
  beam.elevation_rad = -std::asin(level * std::cos(across_rad));
  beam.tilt_rad = tilt_rad;
  return beam;
}

/// Extent of a sector beyond its outermost beam at this angle, for a receive pattern that resolves beams. It
/// is three widths of the beam as steered (beam_across_deg / cosine). It is 0 for ideal beams, which receive
/// nothing from there.
double steered_margin_rad(const SensorDescription& description, double angle_rad) {
  if (!tells_beams_apart(description.receive, "azimuth")) return 0;
  constexpr double widths = 3;
  return widths * radians(description.kind.as<MultibeamDescription>().beam_across_deg) / std::cos(angle_rad);
}

/// Extent of the transmissions beyond the outermost beams of the fan on either side. It is the steered margin
/// of these beams, up to 1 degree short of the horizontal.
double lit_beyond_rad(const SensorDescription& description) {
  const auto& fan = description.kind.as<MultibeamDescription>();
  if (!tells_beams_apart(description.receive, "azimuth")) return 0;
  const double outermost_rad = radians(swath_of(fan).outermost_deg()),
               edge_rad = outermost_rad + radians(fan.beam_across_deg) / 2;
  constexpr double grazing_deg = 1;
  const double wanted_rad = steered_margin_rad(description, outermost_rad);
  return std::max(0.0, std::min(wanted_rad, radians(90 - grazing_deg) - edge_rad));
}

Multibeam::Multibeam(const SensorDescription& description) : Sensor(description) {
  const auto& fan = description.kind.as<MultibeamDescription>();
  require(fan.beams >= 1, description, "beams", fan.beams, "1 or more");
  require(fan.swath_deg > 0 && fan.swath_deg < 180, description, "swath_deg", fan.swath_deg,
          "above 0 and below 180");
  require(std::ranges::adjacent_find(fan.beam_angles_deg, std::greater_equal()) == fan.beam_angles_deg.end(),
          description, "beam_angles_deg", "unordered", "increasing");
  require(fan.beam_across_deg > 0 && 2 * swath_of(fan).outermost_deg() + fan.beam_across_deg <= 180,
          description, "beam_across_deg", fan.beam_across_deg,
          "above 0, and no beam may reach above the horizontal");
  require(fan.along_track_deg > 0 && fan.along_track_deg < 180, description, "along_track_deg",
          fan.along_track_deg, "above 0 and below 180");

  across_track_ = true;
  frequency_khz_ = fan.frequency_khz;
  samples_ = range_window(description, fan);

  const std::vector<double> angles = across_angles_rad(fan);
  if (const auto error = error_of_sectors(description, sector_keys(fan), angles))
    throw std::invalid_argument(fmt::format("sensor '{}': {}", description.name, error->what));
  const std::vector<FanSector> sectors = sectors_of(sector_keys(fan), angles);
  const double half_across_rad = radians(fan.beam_across_deg) / 2,
               half_along_rad = radians(fan.along_track_deg) / 2;
  for (const double angle : angles)
    beams_.push_back({std::copysign(radians(90), angle), std::abs(angle) - straight_down_rad,
                      2 * half_along_rad, 2 * half_across_rad});

  for (const FanSector& sector : sectors) {
    for (std::uint32_t beam = sector.first_beam; beam < sector.end_beam; ++beam) {
      beams_[beam] = tilted(beams_[beam], angles[beam], sector.properties.tilt_rad);
      beams_[beam].sector = static_cast<std::uint32_t>(transmissions_.size());
    }
    transmissions_.push_back(transmission_of(angles, sector));
    transmissions_.back().delay_s = sector.delay_s;
  }
  const auto is_stabilised = [&](const char* motion) {
    return std::ranges::find(fan.stabilisation, motion) != fan.stabilisation.end();
  };
  stabilisation_ = {is_stabilised("roll"), is_stabilised("pitch"), is_stabilised("yaw"),
                    fan.stabilisation_heading_s};
  if (differ_from_sensor(sectors, sector_keys(fan)))
    for (const FanSector& sector : sectors) transmit_sectors_.push_back(sector.properties);
}

Sensor::Transmission Multibeam::transmission_of(const std::vector<double>& angles,
                                                const FanSector& sector) const {
  const SensorDescription& description = description_;
  const auto& fan = description.kind.as<MultibeamDescription>();
  const double half_across_rad = radians(fan.beam_across_deg) / 2,
               half_along_rad = radians(fan.along_track_deg) / 2;
  const std::uint32_t first = sector.first_beam, end = sector.end_beam, beams = end - first;
  // The grid's azimuth is the angle from straight down to starboard, and its elevation is the angle towards
  // forward.
  const glm::dmat3 frame(-up_axis, starboard_axis, forward_axis);
  const int slices = slices_for(2 * half_across_rad, description.cone_tolerance);
  const auto corner_rad = [&](double cone_rad) {
    return std::copysign(
        height_of_corners(std::abs(cone_rad), 2 * half_across_rad / slices, description.cone_tolerance),
        cone_rad);
  };
  const std::vector<double> along_rad{corner_rad(sector.properties.tilt_rad - half_along_rad),
                                      corner_rad(sector.properties.tilt_rad + half_along_rad)};
  Transmission transmission;
  const auto append = [&](std::span<const double> edges) {
    std::vector<double>& all = transmission.sectors.back().azimuth_edges_rad;
    all.insert(all.end(), edges.begin() + (all.empty() ? 0 : 1), edges.end());
  };
  const auto cut = [&](double from, double to, int parts) { append(even_edges(from, to, parts)); };
  const auto name = [&](std::uint32_t beam, int parts) {
    transmission.beam_of_tube.insert(transmission.beam_of_tube.end(), static_cast<std::size_t>(parts), beam);
  };
  const bool receives_all = tells_beams_apart(description.receive, "azimuth");
  const double fan_from = angles.front() - half_across_rad, fan_to = angles.back() + half_across_rad,
               fan_margin_rad = lit_beyond_rad(description);
  const double from = angles[first] - half_across_rad, to = angles[end - 1] + half_across_rad;
  // The margins end at those of the whole fan.
  const double port_rad = first == 0 ? fan_margin_rad
                                     : std::min(steered_margin_rad(description, angles[first]),
                                                from - (fan_from - fan_margin_rad)),
               starboard_rad = end == angles.size()
                                   ? fan_margin_rad
                                   : std::min(steered_margin_rad(description, angles[end - 1]),
                                              fan_to + fan_margin_rad - to);
  const auto parts_of = [&](double margin_rad) {
    return margin_rad > 0 ? slices_for(margin_rad, description.cone_tolerance) : 0;
  };
  const std::uint32_t last = beams - 1;
  if (receives_all || side_by_side(fan)) transmission.sectors.push_back({{}, along_rad, frame});
  if (const int parts = parts_of(port_rad); parts > 0) {
    cut(from - port_rad, from, parts);
    name(0, parts);
  }
  if (side_by_side(fan)) {
    // The edges are those of the whole fan, so that the beams of several sectors equal those of one.
    const std::vector<double> edges = even_edges(fan_from, fan_to, static_cast<int>(angles.size()) * slices);
    const auto all = static_cast<std::size_t>(slices);
    append(std::span(edges).subspan(first * all, beams * all + 1));
    for (std::uint32_t beam = 0; beam <= last; ++beam) name(beam, slices);
  } else if (receives_all) {
    // No beam has its own tube, and overlapping beams must not receive one twice. The fan is cut midway
    // between the axes.
    for (std::uint32_t beam = 0; beam <= last; ++beam) {
      const std::size_t k = first + beam;
      const double begin = beam == 0 ? from : (angles[k - 1] + angles[k]) / 2,
                   stop = beam == last ? to : (angles[k] + angles[k + 1]) / 2;
      cut(begin, stop, slices_for(stop - begin, description.cone_tolerance));
      name(beam, slices_for(stop - begin, description.cone_tolerance));
    }
  } else {
    for (std::uint32_t beam = 0; beam <= last; ++beam) {
      const double angle = angles[first + beam];
      transmission.sectors.push_back(
          {even_edges(angle - half_across_rad, angle + half_across_rad, slices), along_rad, frame});
      name(beam, slices);
    }
  }
  if (const int parts = parts_of(starboard_rad); parts > 0) {
    cut(to, to + starboard_rad, parts);
    name(last, parts);
  }
  add_separate_ends(transmission, angles, sector, frame, slices);
  transmission.beams.resize(beams);
  std::iota(transmission.beams.begin(), transmission.beams.end(), first);
  const double tilt_rad = sector.properties.tilt_rad;
  const glm::dvec3 axis =
      tilt_rad == 0 ? -up_axis : std::sin(tilt_rad) * forward_axis - std::cos(tilt_rad) * up_axis;
  transmission.fans.push_back({0, beams, static_cast<std::uint32_t>(transmission.beam_of_tube.size()), axis,
                               forward_axis, starboard_axis});
  return transmission;
}

/// Adds the sectors of a transmitter whose receiver is separate, and of both ends if the receiver moves
/// during a ping. Beams that overlap are cut midway between their axes. If the receiver moves, gaps between
/// beams are filled up to the same angles.
void Multibeam::add_separate_ends(Transmission& transmission, const std::vector<double>& angles,
                                  const FanSector& sector, const glm::dmat3& frame, int slices) const {
  const auto& fan = description_.kind.as<MultibeamDescription>();
  const double half_across_rad = radians(fan.beam_across_deg) / 2, tilt_rad = sector.properties.tilt_rad;
  transmission.axis = {(angles[sector.first_beam] + angles[sector.end_beam - 1]) / 2, tilt_rad};
  const double corner_rad = height_of_corners(radians(fan.receive_along_track_deg) / 2,
                                              2 * half_across_rad / slices, description_.cone_tolerance);
  transmission.moving_sectors = transmission.sectors;
  for (AngularGrid& grid : transmission.moving_sectors)
    grid.elevation_edges_rad = {tilt_rad - corner_rad, tilt_rad + corner_rad};
  transmission.moving_transmitter_sectors = transmission.transmitter_sectors = transmission.sectors;
  if (transmission.sectors.size() == 1) return;
  for (std::uint32_t beam = sector.first_beam; beam < sector.end_beam; ++beam) {
    const double from = angles[beam] - half_across_rad, to = angles[beam] + half_across_rad,
                 begin = beam > sector.first_beam ? (angles[beam - 1] + angles[beam]) / 2 : from,
                 end = beam + 1 < sector.end_beam ? (angles[beam] + angles[beam + 1]) / 2 : to;
    const std::uint32_t k = beam - sector.first_beam;
    const auto cell = [&](double first, double last) {
      return AngularGrid{even_edges(first, last, slices), transmission.sectors.front().elevation_edges_rad,
                         frame};
    };
    transmission.transmitter_sectors[k] = cell(std::max(from, begin), std::min(to, end));
    transmission.moving_transmitter_sectors[k] = cell(begin, end);
  }
}

bool is_like_8101(const MultibeamDescription& fan) {
  return fan.stabilisation.empty() &&
         !differ_from_sensor(sectors_of(sector_keys(fan), across_angles_rad(fan)), sector_keys(fan)) &&
         fan.frequency_khz == 240 && fan.beam_angles_deg.empty() && fan.beams == 101 &&
         fan.swath_deg == 150 && fan.spacing == "angle" && fan.along_track_deg == 1.5 &&
         fan.range_max_m < 65535;
}

SwathSettings settings_of(const Recording& recording) {
  const SensorDescription& sensor = recording.sensor->description();
  const auto& fan = sensor.kind.as<MultibeamDescription>();
  SwathSettings settings;
  settings.rule.method = detection_method_from_name(fan.detection);
  settings.rule.relative_db = fan.detection_threshold_db;
  settings.grid_cell_m = fan.grid_cell_m;
  settings.receive_across_deg = fan.beam_across_deg;
  settings.along_track_deg = fan.along_track_deg;
  settings.fan_deg = swath_of(fan).to_deg - swath_of(fan).from_deg + fan.beam_across_deg;
  settings.transmit_across_deg = settings.fan_deg + 2 * degrees(lit_beyond_rad(sensor));
  settings.range_max_m = fan.range_max_m;
  settings.receive_along_deg =
      recording.sensor->receiver_moves() ? fan.receive_along_track_deg : fan.along_track_deg;
  // Readers of RESON 8101 packets know the angles of the beams.
  settings.is_like_8101 =
      is_like_8101(fan) && !recording.sensor->receiver_moves() && recording.steering_ratio == 1;
  return settings;
}

class MultibeamKind : public SensorKind {
 public:
  MultibeamKind() : SensorKind("multibeam") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using M = MultibeamDescription;
    section.kind<M>(
        "kind", name(),
        "Multibeam echosounder with a fan of ideal rectangular beams across the track. Beam 0 is the "
        "port-most beam.",
        {field("frequency_khz", &M::frequency_khz,
               {.meaning = "Frequency, which determines the absorption.", .ranges = {frequency}}),
         field("beams", &M::beams,
               {.meaning = "Number of beams. A single beam points straight down.",
                .ranges = {{.lo = 1, .hi = 4096}}}),
         field("swath_deg", &M::swath_deg,
               {.meaning = "Angle between the axes of the outermost beams.", .ranges = {sector(180, true)}}),
         field("spacing", &M::spacing,
               {.meaning = "angle: equal angles between beams (equiangular). distance: equal distances "
                           "between beams on a level seabed (equidistant).",
                .choices = {"angle", "distance"}}),
         field("beam_angles_deg", &M::beam_angles_deg,
               {.meaning = "Angles of the beams from straight down, in increasing order and positive to "
                           "starboard. Replaces `beams`, `swath_deg` and `spacing`.",
                .ranges = {{.lo = -89, .hi = 89}}}),
         field("beam_across_deg", &M::beam_across_deg,
               {.meaning = "One-way width of a beam across the track.", .ranges = {sector(90, false)}}),
         field("along_track_deg", &M::along_track_deg,
               {.meaning = "One-way width of a beam along the track.", .ranges = {sector(90, false)}}),
         field("sector_edges_deg", &M::sector_edges_deg,
               {.meaning = "Edges of the transmit sectors, from straight down, in increasing order and "
                           "positive to starboard: one more than sectors. A beam belongs to the sector that "
                           "contains its axis. Absent: one sector.",
                .ranges = {{.lo = -90, .hi = 90}}}),
         field("sector_frequencies_khz", &M::sector_frequencies_khz,
               {.meaning = "Centre frequency per transmit sector. Absent: `frequency_khz`.",
                .ranges = {frequency}}),
         field("sector_tilts_deg", &M::sector_tilts_deg,
               {.meaning = "Angle per transmit sector between its axis and the plane across the track, "
                           "positive forward. Absent: 0.",
                .ranges = {{.lo = -90, .hi = 90}}}),
         field("sector_delays_us", &M::sector_delays_us,
               {.meaning = "Time per transmit sector from the start of the ping to its transmission. Absent: "
                           "0.",
                .ranges = {{.lo = 0, .hi = 1e7}}}),
         field("sector_pulse_lengths_us", &M::sector_pulse_lengths_us,
               {.meaning = "Pulse length per transmit sector. Absent: `pulse_length_us`.",
                .ranges = {{.lo = 0, .hi = 100000, .lo_excluded = true}}}),
         field("sector_absorptions_db_per_km", &M::sector_absorptions_db_per_km,
               {.meaning = "One-way absorption per transmit sector. Absent: that of the water at the "
                           "frequency of the sector.",
                .ranges = {{.lo = 0, .hi = 100000}}}),
         field("receive_along_track_deg", &M::receive_along_track_deg,
               {.meaning = "With stop_and_hop = false: width of the receive beams along the track.",
                .ranges = {sector(90, false)}}),
         field("stabilisation", &M::stabilisation,
               {.meaning = "Motions of the carrier against which the beams are steered.",
                .choices = {"roll", "pitch", "yaw"}}),
         field("stabilisation_heading_s", &M::stabilisation_heading_s,
               {.meaning = "With yaw stabilisation: duration of the mean heading, half before and half after "
                           "the transmission.",
                .ranges = {{.lo = 0, .hi = 3600}}}),
         field("samples", &M::samples,
               {.meaning = "Number of range bins of equal length.", .ranges = {range_samples}}),
         field("range_min_m", &M::range_min_m,
               {.meaning = "Slant range at which the first range bin begins.", .ranges = {range_start}}),
         field("range_max_m", &M::range_max_m,
               {.meaning = "Slant range at which the last range bin ends.", .ranges = {sonar_range}}),
         field("detection", &M::detection,
               {.meaning = "Method that computes the bottom range of a beam. first_return: first bin above "
                           "the threshold. energy_centroid: energy-weighted mean range of one echo. maximum: "
                           "peak of a parabola through the strongest bins.",
                .choices = {"first_return", "energy_centroid", "maximum"}}),
         field("detection_threshold_db", &M::detection_threshold_db,
               {.meaning = "Threshold of detection, relative to the strongest range bin of the beam. Weaker "
                           "bins are ignored.",
                .ranges = {{.lo = -300, .hi = 0}}}),
         field(
             "grid_cell_m", &M::grid_cell_m,
             {.meaning = "Cell size of the depth grid. 0: computed from depth, beam width and ping spacing.",
              .ranges = {{.lo = 0, .hi = 100000}}})});
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    const auto& fan = sensor.kind.as<MultibeamDescription>();
    check_beam_angles(fan.beam_angles_deg, {"beams", "swath_deg", "spacing"}, table);
    if (2 * swath_of(fan).outermost_deg() + fan.beam_across_deg > 180 && !fan.beam_angles_deg.empty())
      throw InputError(
          place_of_pair(table, "beam_angles_deg", "beam_across_deg"),
          fmt::format("a beam at {} degrees with a width of {} degrees reaches above the horizontal",
                      swath_of(fan).outermost_deg(), fan.beam_across_deg));
    if (fan.beam_angles_deg.empty() && fan.beams > 1 && fan.swath_deg + fan.beam_across_deg > 180) {
      throw InputError(
          place_of_pair(table, "swath_deg", "beam_across_deg"),
          fmt::format("'swath_deg' ({}) and 'beam_across_deg' ({}) together must be at most 180: "
                      "the outermost beams reach above the horizontal",
                      fan.swath_deg, fan.beam_across_deg));
    }
    check_ranges(fan.range_min_m, fan.range_max_m, table);
    const struct {
      const char* key;
      bool takes;
      const char* wanted;
    } rules[] = {
        {"receive_along_track_deg", !sensor.stop_and_hop, "stop_and_hop = false"},
        {"stabilisation_heading_s", std::ranges::find(fan.stabilisation, "yaw") != fan.stabilisation.end(),
         "stabilisation = [\"yaw\"]"},
    };
    constexpr double largest_yaw_deg = 30;
    if (!fan.stabilisation.empty() &&
        std::abs(std::sin(radians(sensor.yaw_deg))) > std::sin(radians(largest_yaw_deg)))
      throw InputError(place_of_pair(table, "stabilisation", "yaw_deg"),
                       fmt::format("beams can be stabilised only if the sonar is mounted along the track: "
                                   "'yaw_deg' is {:g}, expected a value within {:g} degrees of 0 or 180",
                                   sensor.yaw_deg, largest_yaw_deg));
    for (const auto& [key, takes, wanted] : rules)
      if (table.has(key) && !takes)
        throw InputError(table.place_of(key),
                         fmt::format("'{}' needs {}: add it, or remove the key", key, wanted));
    if (const auto error = error_of_sectors(sensor, sector_keys(fan), across_angles_rad(fan)))
      throw InputError(table.place_of(error->key), error->what);
  }
  SensorFigures figures(const SensorDescription& sensor) const override {
    const auto& fan = sensor.kind.as<MultibeamDescription>();
    const auto listed = static_cast<std::int64_t>(fan.beam_angles_deg.size());
    SensorFigures figures = range_figures(fan, listed > 0 ? listed : fan.beams,
                                          std::min(fan.beam_across_deg, fan.along_track_deg));
    if (!fan.sector_edges_deg.empty())
      figures.transmissions = static_cast<std::int64_t>(fan.sector_edges_deg.size()) - 1;
    return figures;
  }

  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<Multibeam>(sensor);
  }

  std::vector<std::string> products() const override { return swath_products(); }
  std::vector<fs::path> write_products(const fs::path& folder, const Recording& recording,
                                       const RunContext& run,
                                       std::vector<std::string>& warnings) const override {
    return write_swath_files(folder, recording, run, settings_of(recording), warnings);
  }
  std::optional<SonarOutline> outline(const SensorDescription& sensor) const override {
    const auto& own = sensor.kind.as<MultibeamDescription>();
    SonarOutline outline;
    outline.add("frequency_khz", own.frequency_khz);
    if (own.beam_angles_deg.empty())
      outline.add("beams", own.beams).add("swath_deg", own.swath_deg).add("spacing", own.spacing);
    else
      outline.add("beam_angles_deg", own.beam_angles_deg);
    if (!own.sector_edges_deg.empty()) outline.add("sector_edges_deg", own.sector_edges_deg);
    for (const auto& [key, values] : sector_keys(own).lists)
      if (!values->empty()) outline.add(key, *values);
    outline.add("beam_across_deg", own.beam_across_deg)
        .add("along_track_deg", own.along_track_deg)
        .add_window(own);
    outline.looks_down = true;
    outline.even = own.beam_angles_deg.empty() && own.spacing == "angle";
    outline.vertical_deg = own.along_track_deg;
    return outline;
  }
  WritingCost writing_cost(const Recording& recording, const RunContext& run) const override {
    constexpr double detecting_s = 3e-9, sounding_s = 2.2e-5, sounding_bytes = 600, depth_pictures_s = 0.3,
                     depth_pictures_bytes = 5e5;
    if (std::ranges::none_of(products(), [&](const std::string& product) { return run.writes(product); }))
      return {};
    const bool all_samples = run.frame.is_georeferenced() && run.writes("sonar.nc");
    WritingCost cost = cost_by_cells(recording, detecting_s, all_samples ? 2 : 0);
    const auto soundings = static_cast<double>(recording.pings() * recording.sensor->beams().size());
    cost += {sounding_s * soundings, 0, sounding_bytes * soundings};
    if (run.draws("depth.png") || run.draws("depth-ideal.png"))
      cost += {depth_pictures_s, 0, depth_pictures_bytes};
    return cost;
  }
  std::vector<std::string> files_left_out(const Recording& recording, const RunContext& run) const override {
    return swath_files_left_out(recording, run);
  }
};

}  // namespace

const SensorSection& MultibeamDescription::kind() {
  static const MultibeamKind kind;
  return kind;
}
const SensorSection& multibeam_kind() { return MultibeamDescription::kind(); }

}  // namespace tubefoot
