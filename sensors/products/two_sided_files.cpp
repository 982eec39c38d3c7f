// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the operator's files of a sonar with a beam to either side: XTF, a 16-bit waterfall, and a mosaic
// on the map. Amplitudes are as received, in uPa.

#include "sensors/products/two_sided_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <vector>

#include "geometry/steps/in_order.hpp"
#include "sensors/detection/sidescan_mosaic.hpp"
#include "sensors/formats/xtf_file.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/pictures/mosaic_picture.hpp"
#include "sensors/pictures/scanline_picture.hpp"
#include "sensors/products/line_files.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/two_sided_amplitudes.hpp"
#include "sensors/receiver/quantisation.hpp"
#include "sensors/recordings/navigation.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

double altitude_m(const Recording& recording, std::size_t ping) {
  return recording.altitude_m.empty() ? std::nan("") : recording.altitude_m[ping];
}

/// The XTF file of a recording. Its samples begin at range 0. Their number puts the last one at its range;
/// each sample is within half a sample of the range at which it was received.
class XtfRecord {
 public:
  XtfRecord(const fs::path& file, const Recording& recording, const RunContext& run,
            const TwoSidedWidths& widths, double full_scale_upa)
      : recording_(recording),
        before_(static_cast<std::size_t>(samples_before(recording))),
        file_(file, header(recording, run, widths, before_, full_scale_upa)),
        track_(recording, run) {}

  static double samples_before(const Recording& recording) {
    return std::round(recording.sensor->samples().first_m / recording.sensor->samples().step_m);
  }

  void add(std::size_t ping, std::span<const std::uint16_t> codes) {
    const RangeSamples& samples = recording_.sensor->samples();
    const auto count = static_cast<std::size_t>(samples.count);
    const NavigationFix& fix = track_.of(ping);
    const PoseAngles& angles = fix.lie;
    const glm::dvec3& at = fix.place.lon_lat_height;
    const double time_s = fix.unix_time_s, height_m = at.z;

    file_.add_attitude({time_s, angles.heading_deg, angles.pitch_deg, angles.roll_deg, 0});
    file_.add_navigation({time_s, at.x, at.y, height_m});
    XtfSidescanPing record;
    record.place.unix_time_s = time_s;
    record.place.ping_number = recording_.number_of(ping);
    record.place.x = at.x;
    record.place.y = at.y;
    record.place.heading_deg = angles.heading_deg;
    record.place.pitch_deg = angles.pitch_deg;
    record.place.roll_deg = angles.roll_deg;
    record.place.depth_m = -height_m;
    const double altitude = altitude_m(recording_, ping);
    record.place.altitude_m = std::isnan(altitude) ? 0 : altitude;
    record.place.speed_m_s = fix.speed_m_s;
    record.slant_range_m = samples.first_m + samples.count * samples.step_m;
    port_.assign(before_, 0);
    starboard_.assign(before_, 0);
    port_.insert(port_.end(), codes.begin(), codes.begin() + samples.count);
    starboard_.insert(starboard_.end(), codes.begin() + samples.count,
                      codes.begin() + static_cast<std::ptrdiff_t>(2 * count));
    record.port = port_;
    record.starboard = starboard_;
    file_.add_sidescan_ping(record);
  }

  void finish() { file_.finish(); }

 private:
  static XtfHeader header(const Recording& recording, const RunContext& run, const TwoSidedWidths& widths,
                          std::size_t before, double full_scale_upa) {
    const SensorDescription& sensor = recording.sensor->description();
    XtfChannel channel;
    channel.frequency_khz = recording.sensor->frequency_khz();
    channel.along_track_width_deg = widths.along_track_deg;
    channel.across_track_width_deg = widths.across_track_deg;
    channel.tilt_deg = degrees(-recording.sensor->beams().front().elevation_rad);
    channel.starboard_m = sensor.lever_arm_m[0];
    channel.forward_m = sensor.lever_arm_m[1];
    channel.down_m = -sensor.lever_arm_m[2];
    XtfHeader header;
    header.sonar_name = sensor.name.substr(0, 15);
    header.note = fmt::format("full scale {:.6g} uPa, seed {}", full_scale_upa, run.seed).substr(0, 63);
    header.sonar_type = 44;
    header.sound_speed_m_s = recording.sound_speed_m_s;
    header.sidescan = XtfSidescan{
        channel, channel,
        static_cast<std::uint32_t>(before) + static_cast<std::uint32_t>(recording.sensor->samples().count),
        sensor.signal.tvg_spreading.has_value()};
    return header;
  }

  const Recording& recording_;
  std::size_t before_;  ///< samples from range 0 to the first received one
  XtfFile file_;
  NavigationTrack track_;
  std::vector<std::uint16_t> port_, starboard_;
};

/// Reason why a recording has no XTF file; empty if it has one.
std::optional<std::string> why_no_xtf(const Recording& recording, const RunContext& run) {
  const auto without = [&](const std::string& why) {
    return fmt::format("{}.xtf is not written: {}", recording.sensor->description().name, why);
  };
  if (!run.frame.is_georeferenced())
    return without("XTF contains longitude and latitude: add [georeference] to the scene");
  constexpr double most_before = 1e6;
  if (XtfRecord::samples_before(recording) > most_before)
    return without(
        fmt::format("the samples of an XTF file begin at range 0, so it would need more than {:.0f} empty "
                    "samples: reduce range_min_m, or increase the length of range bins",
                    most_before));
  constexpr double end_s = 4294967295;  // its clocks have 32 bits of seconds
  const auto [first_s, last_s] =
      std::minmax_element(recording.ping_time_s.begin(), recording.ping_time_s.end());
  if (run.start_unix_s + *first_s < 0 || run.start_unix_s + *last_s >= end_s)
    return without("its dates must be from 1970 to 2106: change start_utc or first_ping_s");
  return std::nullopt;
}

/// A ping in the form of the files.
struct CodedPing {
  std::vector<std::uint16_t> xtf;  ///< [port, starboard][sample]
  std::vector<std::uint16_t> row;  ///< from the far end of port to the far end of starboard
  std::optional<CellSums> mapped;
};

std::vector<std::uint16_t> codes_of(std::span<const float> amplitudes, const Quantiser& quantiser) {
  std::vector<std::uint16_t> codes(amplitudes.size());
  std::ranges::transform(amplitudes, codes.begin(), [&](float amplitude) {
    return quantiser.code(std::isnan(amplitude) ? 0 : amplitude);
  });
  return codes;
}

OIIO::ImageSpec waterfall_spec(const Recording& recording, double white_upa) {
  OIIO::ImageSpec spec(1, 1, 1, OIIO::TypeDesc::UINT16);
  spec.attribute("ImageDescription",
                 fmt::format("{}: amplitude, 65535 is {:.6g} uPa and more; rows: pings, first ping on top; "
                             "columns: port samples, farthest first, then starboard samples, nearest first",
                             recording.sensor->description().name, white_upa));
  return spec;
}

/// True if a ping has a position on the map: the seabed lies below it, and it has a heading. A vertical
/// forward axis has no heading.
bool is_on_the_map(const Recording& recording, std::size_t ping) {
  constexpr double upright = 1e-3;
  const glm::dvec3 forward = recording.ping_pose[ping].attitude * glm::dvec3(0, 1, 0);
  return !std::isnan(altitude_m(recording, ping)) && std::hypot(forward.x, forward.y) > upright;
}

/// Contribution of a ping of a line to the map; empty if it has no position there.
std::optional<CellSums> mapped(const Recording& recording, const PingSpan& line, std::size_t ping,
                               std::span<const float> amplitudes, double cell_m) {
  if (!is_on_the_map(recording, ping)) return std::nullopt;
  const RangeSamples& samples = recording.sensor->samples();
  const auto count = static_cast<std::size_t>(samples.count);
  const auto neighbour = [&](std::size_t other) {
    return is_on_the_map(recording, other) ? &recording.ping_pose[other] : nullptr;
  };
  return sums_on_map({recording.ping_pose[ping], altitude_m(recording, ping), samples.first_m, samples.step_m,
                      amplitudes.first(count), amplitudes.last(count)},
                     ping > line.first ? neighbour(ping - 1) : nullptr,
                     ping + 1 < line.end ? neighbour(ping + 1) : nullptr, cell_m);
}

/// A mosaic, and the number of omitted pings.
struct Map {
  std::string name;
  CellMeans cells;
  std::size_t pings = 0, left_out = 0;

  void add(const std::optional<CellSums>& ping) {
    ++pings;
    if (ping)
      cells.add(*ping);
    else
      ++left_out;
  }
};

/// True if all pings of a line cover the same strip of the seabed, which has no area. The sensor is then at
/// rest between them, or there is one ping.
bool at_rest(const Recording& recording, const PingSpan& line) {
  const RangeSamples& samples = recording.sensor->samples();
  const double far_m = samples.first_m + samples.count * samples.step_m;
  constexpr double still_m = 1e-6;
  for (std::size_t ping = line.first + 1; ping < line.end; ++ping) {
    const Pose &before = recording.ping_pose[ping - 1], &pose = recording.ping_pose[ping];
    const glm::dvec3 forward(0, 1, 0);
    if (glm::distance(before.position_m, pose.position_m) +
            far_m * glm::distance(before.attitude * forward, pose.attitude * forward) >
        still_m)
      return false;
  }
  return true;
}

std::string no_mosaic_at_rest(const std::string& name, std::size_t pings) {
  return fmt::format(
      "{}-mosaic.tif is not written: {} only a line on the seabed, which has no area. A mosaic needs a "
      "sensor that moves or turns between pings; the waterfall shows all received echoes",
      name, pings == 1 ? "one ping covers" : "the sensor is at rest, so its pings cover");
}

/// Reason why a recording has no mosaic, as far as its poses determine it.
std::optional<std::string> why_no_mosaic(const Recording& recording) {
  const auto rests = [&](const PingSpan& line) { return at_rest(recording, line); };
  if (recording.ping_pose.empty() || !std::ranges::all_of(recording.lines(), rests)) return std::nullopt;
  return no_mosaic_at_rest(recording.sensor->description().name, recording.pings());
}

/// Writes <name>-mosaic.tif and .png. If nothing lies on the seabed, it writes nothing and adds a warning.
std::vector<fs::path> write_map(const fs::path& folder, const Recording& recording, const RunContext& run,
                                const Map& map, std::vector<std::string>& warnings) {
  const fs::path file = map.name + "-mosaic.tif", picture = map.name + "-mosaic.png";
  if (map.left_out > 0)
    warnings.push_back(
        fmt::format("{}: {} of {} pings are omitted, because there is no seabed straight below the sensor, "
                    "or because the sensor has no heading",
                    file.string(), map.left_out, map.pings));
  if (map.cells.empty()) {
    warnings.push_back(
        fmt::format("{} is not written, because no echo came from the seabed on either side of the sonar",
                    file.string()));
    return {};
  }
  std::vector<fs::path> files;
  if (run.writes("mosaic.tif")) {
    write_cells(folder / file, map.cells, run.frame, "Backscatter", "uPa");
    files.push_back(file);
  }
  if (run.draws("mosaic.png")) {
    draw_mosaic(map.cells, recording.sensor->description().signal.display_gain_db,
                fmt::format("{}   mosaic, cells of {:g} m", map.name, map.cells.cell_m()), label_font())
        .write_png(folder / picture, map.name, run.pictures.bits);
    files.push_back(picture);
  }
  return files;
}

/// Files that a recording will have, and the reasons for the absence of others that are not omitted.
struct TwoSidedChoice {
  bool xtf = false, waterfall = false, map = false;
  std::vector<std::string> left_out;

  bool is_empty() const { return !xtf && !waterfall && !map; }
};

TwoSidedChoice choice_of(const Recording& recording, const RunContext& run) {
  TwoSidedChoice choice{
      run.writes("xtf"), run.draws("waterfall.png"), run.writes("mosaic.tif") || run.draws("mosaic.png"), {}};
  const auto leave_out = [&](bool& wanted, const std::optional<std::string>& why) {
    if (!wanted || !why) return;
    wanted = false;
    choice.left_out.push_back(*why);
  };
  leave_out(choice.xtf, why_no_xtf(recording, run));
  leave_out(choice.map, why_no_mosaic(recording));
  return choice;
}

}  // namespace

double mosaic_cell_m(const Recording& recording) {
  const RangeSamples& samples = recording.sensor->samples();
  const double length_m = recording.track_length_m(), spacing_m = recording.ping_spacing_m();
  const double swath_m = 2 * (samples.first_m + samples.count * samples.step_m);
  constexpr double most_cells = 4e6;
  const double wanted = std::max({spacing_m, 3 * samples.step_m, std::sqrt(length_m * swath_m / most_cells)});
  return tick_step(wanted, 1);
}

std::vector<std::string> two_sided_files_left_out(const Recording& recording, const RunContext& run) {
  return choice_of(recording, run).left_out;
}

std::vector<std::string> two_sided_file_products() {
  return {"xtf", "waterfall.png", "mosaic.tif", "mosaic.png"};
}

bool writes_two_sided_files(const Recording& recording, const RunContext& run) {
  return !choice_of(recording, run).is_empty();
}

std::vector<fs::path> write_two_sided_files(const fs::path& folder, const Recording& recording,
                                            const RunContext& run, const TwoSidedWidths& widths,
                                            std::vector<std::string>& warnings) {
  const std::string& name = recording.sensor->description().name;
  const fs::path waterfall = name + "-waterfall.png";
  const TwoSidedChoice choice = choice_of(recording, run);
  warnings.insert(warnings.end(), choice.left_out.begin(), choice.left_out.end());
  if (choice.is_empty()) return {};
  const TwoSidedAmplitudes amplitudes(recording, run, folder / waterfall, choice.map);
  const Quantiser all = Quantiser::xtf_amplitude(amplitudes.largest_upa()),
                  visible = Quantiser::xtf_amplitude(amplitudes.white_upa());
  std::optional<ScanlinePicture> picture;
  if (choice.waterfall)
    picture.emplace(folder / waterfall, static_cast<int>(recording.cells()),
                    static_cast<int>(recording.pings()), waterfall_spec(recording, amplitudes.white_upa()));
  const double cell_m = mosaic_cell_m(recording);
  Map whole{name, CellMeans(cell_m)};
  std::vector<fs::path> files, maps;
  const std::vector<PingSpan> lines = recording.lines();
  const std::vector<std::string> names = line_names(recording);
  Steps steps("pings converted for sidescan files", recording.pings());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const std::string& of_line = names[k];
    std::optional<XtfRecord> xtf;
    if (choice.xtf)
      xtf.emplace(folder / (of_line + ".xtf"), recording, run, widths, amplitudes.largest_upa());
    Map map{of_line, CellMeans(cell_m)};
    const auto coded = [&](std::size_t ping) {
      const std::vector<float> receiver_output = amplitudes.of(ping);
      CodedPing made;
      if (xtf) made.xtf = codes_of(receiver_output, all);
      if (picture) {
        made.row = codes_of(receiver_output, visible);
        std::ranges::reverse(made.row.begin(),
                             made.row.begin() + static_cast<std::ptrdiff_t>(receiver_output.size() / 2));
      }
      if (choice.map) made.mapped = mapped(recording, lines[k], ping, receiver_output, cell_m);
      return made;
    };
    constexpr std::size_t bytes_a_cell = 2 * sizeof(std::uint16_t) + 2 * sizeof(CellSum);
    in_order(
        steps, lines[k].first, lines[k].end, bytes_a_cell * recording.cells(), coded,
        [&](std::size_t ping, const CodedPing& made) {
          if (xtf) xtf->add(ping, made.xtf);
        },
        [&](std::size_t, const CodedPing& made) {
          if (picture) picture->add_row(made.row.data());
        },
        [&](std::size_t, const CodedPing& made) {
          if (choice.map) whole.add(made.mapped);
        },
        [&](std::size_t, const CodedPing& made) {
          if (choice.map && lines.size() > 1) map.add(made.mapped);
        });
    if (xtf) {
      xtf->finish();
      files.emplace_back(of_line + ".xtf");
    }
    if (lines.size() == 1 || !choice.map) continue;
    if (at_rest(recording, lines[k]))
      warnings.push_back(no_mosaic_at_rest(of_line, lines[k].end - lines[k].first));
    else
      append(maps, write_map(folder, recording, run, map, warnings));
  }
  if (picture) {
    picture->finish();
    files.push_back(waterfall);
  }
  if (choice.map) append(files, write_map(folder, recording, run, whole, warnings));
  append(files, maps);
  return files;
}

}  // namespace tubefoot
