// SPDX-License-Identifier: GPL-3.0-or-later
#include "exchange/readers/kmall_scene.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <iterator>
#include <stdexcept>

#include "engine/scattering/beam_pattern.hpp"
#include "exchange/obj_mesh.hpp"
#include "exchange/readers/kmall_seabed.hpp"
#include "exchange/readers/scene_readers.hpp"
#include "files/checked_file.hpp"
#include "files/input_registry.hpp"
#include "files/shown.hpp"
#include "kmall/kmall_geometry.hpp"
#include "scene/rasters/georeference.hpp"
#include "sensors/kinds/scene_file.hpp"

// This file writes a survey line of a Kongsberg sonar as a scene. The height 0 is the water line. The origin
// of the local frame is the reference point of the vessel at the first ping.

namespace tubefoot {
namespace {

/// Width of the main lobe of a line array at -3 dB, times its length in wavelengths. 0.8859 without shading.
double main_lobe_width(double shading) {
  double within = 0, beyond = 1.2;
  constexpr int steps = 60;
  for (int step = 0; step < steps; ++step) {
    const double u = (within + beyond) / 2;
    (2 * std::pow(line_amplitude(u, shading), 2) > 1 ? within : beyond) = u;
  }
  return within + beyond;
}

class KmallSceneWriter {
 public:
  KmallSceneWriter(const KmallSurvey& survey, const KmallSceneOptions& options,
                   const std::filesystem::path& folder)
      : survey_(survey), options_(options), folder_(folder) {
    double first_s = survey.modes.front().pings.front().time_s;
    for (const KmallMode& mode : survey.modes) {
      first_s = std::min(first_s, mode.pings.front().time_s);
      last_s_ = std::max(last_s_, mode.pings.back().time_s);
    }
    start_s_ = std::floor(first_s);
    first_s_ = first_s;
    const KmallPing& first = survey.pings.front();
    frame_ = LocalFrame::at_lat_lon(first.latitude_deg, first.longitude_deg, 0);
    for (const KmallPing& ping : survey.pings)
      add_place({ping.time_s, ping.latitude_deg, ping.longitude_deg});
    for (const KmallPosition& position : survey.positions)
      if (position.time_s < first.time_s || position.time_s > survey.pings.back().time_s) add_place(position);
    std::ranges::stable_sort(places_, {}, &Place::time_s);
    report_.notes = survey.notes;
  }

  KmallSceneReport write() {
    fit_seabed();
    report_residuals();
    write_track();
    head();
    water();
    seabed();
    for (const KmallMode& mode : survey_.modes) sensor(mode);
    write_file(folder_ / "scene.toml", std::string_view(text_));
    return std::move(report_);
  }

 private:
  template <class... Values>
  void line(fmt::format_string<Values...> format, Values&&... values) {
    text_ += fmt::format(format, std::forward<Values>(values)...) + '\n';
  }

  void note(std::string text) { report_.notes.push_back(std::move(text)); }

  SourcePlace whole() const { return {survey_.soundings_file.string(), 0, 0}; }

  /// The reference point in the local frame, without its height.
  struct Place {
    double time_s;
    glm::dvec2 at_m;
  };

  void add_place(const KmallPosition& position) {
    places_.push_back(
        {position.time_s, frame_.from_lat_lon(position.latitude_deg, position.longitude_deg, 0, whole())});
  }

  /// Returns the reference point at a time. It is linear between places. Beyond them, it has the mean speed
  /// of the line.
  glm::dvec2 place_at(double time_s) const {
    const Place *a = &places_.front(), *b = &places_.back();
    if (!(b->time_s > a->time_s)) return a->at_m;
    if (time_s > a->time_s && time_s <= b->time_s) {
      b = &*std::ranges::lower_bound(places_, time_s, {}, &Place::time_s);
      a = std::prev(b);
    }
    return a->at_m + (time_s - a->time_s) / (b->time_s - a->time_s) * (b->at_m - a->at_m);
  }

  /// Soundings in the local frame, with heights above the water line.
  std::vector<glm::dvec3> soundings() const {
    std::vector<glm::dvec3> points;
    for (const KmallPing& ping : survey_.pings) {
      const glm::dvec2 reference = place_at(ping.time_s);
      const double heading = glm::radians(ping.heading_deg);
      const glm::dvec2 forward(std::sin(heading), std::cos(heading)), starboard(forward.y, -forward.x);
      for (const KmallSounding& s : ping.soundings)
        if (s.is_valid)
          points.emplace_back(reference + s.x_m * forward + s.y_m * starboard, ping.waterline_m - s.z_m);
    }
    return points;
  }

  void fit_seabed() {
    // Soundings further from the plane are outliers, or the seabed is no plane.
    constexpr double most_deviations = 5;
    try {
      soundings_ = soundings();
      plane_ = fitted_plane(soundings_, most_deviations);
    } catch (const std::invalid_argument& error) {
      throw InputError(whole(), error.what());
    }
    note(fmt::format(
        "seabed: plane at {:.3f} m, slope {:.3f} degrees; {} soundings, {} outliers removed, rms residual "
        "{:.3f} m",
        plane_.centre_m.z, slope_deg(), plane_.used, plane_.removed, plane_.rms_m));
    if (plane_.is_narrow)
      note("the soundings are a narrow strip: the slope of the plane across the strip is set to 0");
    if (!(plane_.centre_m.z < 0))
      throw InputError(whole(), fmt::format("the soundings are above the water line: their mean height is "
                                            "{:.3f} m",
                                            plane_.centre_m.z));
    const auto removed = static_cast<double>(plane_.removed);
    constexpr double most_outliers = 0.1;
    if (options_.seabed == "plane" && removed > most_outliers * static_cast<double>(plane_.used))
      note(
          "the plane excludes more than a tenth of the soundings: '--seabed grid' may represent the seabed "
          "better");
  }

  void report_residuals() {
    const KmallResiduals residuals = residuals_of(survey_);
    if (residuals.soundings > 0)
      note(fmt::format(
          "soundings recomputed from travel times, angles, attitude and sound speeds: {} of them, median "
          "{:.4f} m from the positions of the file, 95 % within {:.4f} m",
          residuals.soundings, residuals.median_m, residuals.percentile_95_m));
  }

  double slope_deg() const {
    return glm::degrees(std::atan(std::hypot(plane_.slope_east, plane_.slope_north)));
  }

  /// Height of the reference point above the water line. The heave is that of the motion sensor.
  double height_m(const KmallMotion& motion) const {
    const glm::dvec3 arm = survey_.installation.motion_sensor.position_m;
    const double lever_m = (rotation_of(motion.roll_deg, motion.pitch_deg, 0) * arm).z - arm.z;
    return survey_.installation.waterline_m - (motion.heave_m - lever_m);
  }

  void write_track() {
    // The record of a ping lasts less than the time of its last sample.
    double longest_s = 0;
    for (const KmallMode& mode : survey_.modes)
      longest_s = std::max(longest_s, static_cast<double>(mode.end_sample) / mode.sample_rate_hz);
    constexpr double margin_s = 0.05;
    std::vector<double> times_s{first_s_ - margin_s};
    for (const KmallMotion& sample : survey_.motion)
      if (sample.time_s > first_s_ - margin_s && sample.time_s < last_s_ + longest_s)
        times_s.push_back(sample.time_s);
    if (const double end_s = last_s_ + longest_s; end_s > times_s.back()) times_s.push_back(end_s);
    std::string track =
        "# Reference point of the vessel. time_s: after start_utc of scene.toml\n"
        "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n";
    for (const double time_s : times_s) {
      // The ends may be beyond the attitude.
      const double known_s = std::clamp(time_s, survey_.motion.front().time_s - most_beyond_motion_s,
                                        survey_.motion.back().time_s + most_beyond_motion_s);
      const KmallMotion motion = *motion_at(survey_.motion, known_s);
      const glm::dvec2 place = place_at(time_s);
      track += fmt::format("{:.6f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}\n", time_s - start_s_, place.x,
                           place.y, height_m(motion), std::fmod(motion.heading_deg + 360, 360),
                           motion.pitch_deg, motion.roll_deg);
    }
    write_file(folder_ / "track.csv", std::string_view(track));
  }

  void head() {
    const KmallPing& first = survey_.pings.front();
    line("# Made by 'tubefoot import-scene' of the survey line {}.",
         shown_line(survey_.soundings_file.filename().string()));
    line("# Sonar: {}. Format: {}.", shown_line(survey_.installation.sonar),
         shown_line(survey_.installation.revision));
    line("# z = 0 is the water line. Comments name assumptions; docs/measured.md explains them.");
    line("title = \"survey line\"");
    line("\n[georeference]\norigin_lat_lon_deg = [{:.9f}, {:.9f}]", first.latitude_deg, first.longitude_deg);
    line("\n[run]\nstart_utc = \"{:%Y-%m-%dT%H:%M:%SZ}\"", fmt::gmtime(static_cast<std::time_t>(start_s_)));
    line("\n[trajectory]\nkind = \"waypoints\"\nfile = \"track.csv\"");
  }

  void water() {
    const KmallPing& ping = survey_.pings.front();
    const SoundSpeedProfile profile =
        profile_at(survey_, transducer_depth_m(survey_, ping), ping.sound_speed_m_s);
    // Rays do not pass deeper than the seabed.
    const double deepest_m = 1.2 * -plane_.centre_m.z + 1;
    double least = profile.at(0), largest = least;
    std::vector<ProfilePoint> points{{0, profile.at(0)}};
    for (const ProfilePoint& point : profile.points())
      if (point.depth_m > 0) points.push_back(point);
    for (const ProfilePoint& point : points)
      for (const double speed : {profile.at(std::min(point.depth_m, deepest_m)), profile.at(deepest_m)}) {
        least = std::min(least, speed);
        largest = std::max(largest, speed);
      }
    constexpr double isovelocity_m_s = 0.1;
    line("\n[water]");
    if (largest - least < isovelocity_m_s) {
      sound_speed_m_s_ = (least + largest) / 2;
      line("# The sound speed varies by {:.2f} m/s down to the seabed, so the water is isovelocity.",
           largest - least);
      line("sound_speed_m_s = {:.3f}", sound_speed_m_s_);
      sound_speed_m_s_ = std::round(sound_speed_m_s_ * 1000) / 1000;
    } else {
      std::string table = "depth_m,sound_speed_m_s\n";
      for (const ProfilePoint& point : points)
        table += fmt::format("{:.4f},{:.4f}\n", point.depth_m, point.sound_speed_m_s);
      write_file(folder_ / "profile.csv", std::string_view(table));
      line("# Measured at the transducer, and from there linear to the points of the profile below it.");
      line("profile = \"table\"\nprofile_file = \"profile.csv\"");
      sound_speed_m_s_ = profile.at(transducer_depth_m(survey_, ping));
    }
  }

  void seabed() {
    line("\n[[materials]]\nname = \"seabed\"");
    if (options_.material_table) {
      InputFile table(*options_.material_table);
      std::string bytes;
      table.for_each_piece([&](std::string_view piece) { bytes += piece; });
      write_file(folder_ / "material.csv", std::string_view(bytes));
      line("law = \"table\"\ntable_file = \"material.csv\"");
    } else {
      line("# Assumed: Lambert's law with its usual level. The recordings have no calibrated level.");
      line("lambert_db = -27");
    }
    // The sector reaches beyond the soundings.
    const double margin_m = std::max(1.0, 1.5 * -plane_.centre_m.z);
    if (options_.seabed == "plane") {
      const double downslope_deg =
          std::fmod(glm::degrees(std::atan2(-plane_.slope_east, -plane_.slope_north)) + 360, 360.0);
      const glm::dvec2 centre = (plane_.lo_m + plane_.hi_m) / 2.0;
      line("\n[[terrain]]\nkind = \"flat\"");
      line("# Fitted to {} soundings; {} outliers were removed; rms residual {:.3f} m.", plane_.used,
           plane_.removed, plane_.rms_m);
      line("width_m = {:.2f}\nlength_m = {:.2f}", plane_.hi_m.x - plane_.lo_m.x + 2 * margin_m,
           plane_.hi_m.y - plane_.lo_m.y + 2 * margin_m);
      line("centre_m = [{:.4f}, {:.4f}, {:.4f}]", centre.x, centre.y, plane_.height_m(centre));
      line("slope_deg = {:.5f}\nslope_heading_deg = {:.4f}", slope_deg(), downslope_deg);
    } else if (options_.seabed == "grid") {
      grid(margin_m);
    } else {
      line("\n[[terrain]]\nkind = \"raster\"\nfile = {}",
           toml_quoted(std::filesystem::absolute(options_.seabed).string()));
    }
  }

  void grid(double margin_m) {
    constexpr double cell_of_depth = 0.025, most_nodes = 9e5;
    const glm::dvec2 size = plane_.hi_m - plane_.lo_m + 2 * margin_m;
    const double cell_m = options_.cell_m.value_or(
        std::max(cell_of_depth * -plane_.centre_m.z, std::sqrt(size.x * size.y / most_nodes)));
    try {
      constexpr double outlier_of_depth = 0.05;
      const SeabedGrid grid =
          seabed_grid(soundings_, plane_, cell_m, margin_m, outlier_of_depth * -plane_.centre_m.z);
      ObjMesh mesh(
          folder_ / "seabed.obj",
          "Made by 'tubefoot import-scene'. Medians of soundings. Units: metres. Axes: east, north, up.");
      mesh.object("seabed", {}, grid.points_m, grid.triangles);
      mesh.close();
      line("\n[[objects]]\nname = \"seabed\"\nshape = \"mesh\"\nfile = \"seabed.obj\"");
      line(
          "# Medians of the soundings in cells of {:.3f} m; rms residual {:.3f} m; {} of {} nodes are "
          "interpolated.",
          cell_m, grid.rms_m, grid.filled, grid.points_m.size());
      note(fmt::format(
          "seabed: grid of {} nodes, cells of {:.3f} m, {} outliers removed, rms residual {:.3f} m",
          grid.points_m.size(), cell_m, grid.removed, grid.rms_m));
    } catch (const std::invalid_argument& error) {
      throw InputError(whole(), error.what());
    }
  }

  /// Returns an array of TOML, with at most ten values per line.
  static std::string list(const std::vector<double>& values, int decimals) {
    constexpr std::size_t per_line = 10;
    std::string text;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const char* const separator = k == 0 ? "" : k % per_line == 0 ? ",\n  " : ", ";
      text += fmt::format("{}{:.{}f}", separator, values[k] + 0.0, decimals);
    }
    return "[" + text + "]";
  }

  /// Returns one value per sector.
  template <class Value>
  static std::vector<double> by_sector(const KmallMode& mode, Value value) {
    std::vector<double> values;
    for (const KmallSector& sector : mode.sectors) values.push_back(value(sector));
    return values;
  }

  void sensor(const KmallMode& mode) {
    const KmallMounting& transmitter = *survey_.installation.transmitters.at(mode.transmitter);
    const KmallMounting& receiver = *survey_.installation.receivers.at(mode.receiver);
    const auto arm = [](glm::dvec3 a) { return fmt::format("[{:.4f}, {:.4f}, {:.4f}]", a.y, a.x, -a.z); };
    const std::vector<double> frequencies_khz =
        by_sector(mode, [](const KmallSector& s) { return s.frequency_hz / 1000; });
    double mean_khz = 0, mean_level_db = 0;
    for (const KmallSector& sector : mode.sectors) {
      mean_khz += sector.frequency_hz / 1000 / static_cast<double>(mode.sectors.size());
      mean_level_db += sector.source_level_db / static_cast<double>(mode.sectors.size());
    }
    line("\n[[sensors]]\nname = \"{}\"\nkind = \"multibeam\"", mode.name);
    line("frequency_khz = {:.3f}", mean_khz);
    std::vector<double> times_s;
    for (const KmallModePing& ping : mode.pings) times_s.push_back(ping.time_s - start_s_);
    line("ping_times_s = {}", list(times_s, 6));
    line("lever_arm_m = {}", arm(arm_of(transmitter)));
    line("receiver_arm_m = {}", arm(arm_of(receiver)));
    line("# Mounting of the receiver. Its roll is 0 here, because angles of beams are from the vertical.");
    line("yaw_deg = {:.4f}\ntilt_deg = {:.4f}", std::remainder(receiver.heading_deg, 360.0),
         -receiver.pitch_deg);
    line("stabilisation = [\"roll\"]");
    line("beam_angles_deg = {}", list(mode.beam_angles_deg, 4));
    line("sector_edges_deg = {}", list(mode.sector_edges_deg, 3));
    line("sector_frequencies_khz = {}", list(frequencies_khz, 3));
    // A transmitter that is mounted backwards has the opposite forward axis.
    const double along = std::cos(glm::radians(transmitter.heading_deg - receiver.heading_deg)) < 0 ? -1 : 1;
    line("sector_tilts_deg = {}",
         list(by_sector(mode, [&](const KmallSector& s) { return along * s.tilt_deg; }), 4));
    line("sector_delays_us = {}",
         list(by_sector(mode, [](const KmallSector& s) { return 1e6 * s.delay_s; }), 1));
    line("sector_pulse_lengths_us = {}",
         list(by_sector(mode, [](const KmallSector& s) { return 1e6 * s.effective_pulse_s; }), 2));
    line("sector_absorptions_db_per_km = {}", list(mode.absorptions_db_per_km, 3));
    line("source_level_db = {:.2f}", mean_level_db);
    apertures(mode);
    ranges(mode);
    ++report_.sensors;
    report_.pings += mode.pings.size();
  }

  void apertures(const KmallMode& mode) {
    // Length of the transmitter from the widths that the file states, or from the nominal width.
    double length_m = 0, widest_rad = 0;
    for (const KmallSector& sector : mode.sectors) {
      const double width_rad = glm::radians(sector.beam_width_along_deg > 0 ? sector.beam_width_along_deg
                                                                            : mode.transmit_width_deg);
      if (!(width_rad > 0) || !(sector.frequency_hz > 0))
        throw InputError(whole(), fmt::format("{}: a sector has no beam width or no frequency", mode.name));
      const double wavelength_m = sound_speed_m_s_ / sector.frequency_hz;
      // Length for a main lobe of the width 1 in wavelengths per length.
      length_m += wavelength_m / width_rad / static_cast<double>(mode.sectors.size());
      widest_rad = std::max(widest_rad, width_rad);
    }
    const double ratio = mode.transmit_width_deg > 0 && mode.receive_width_deg > 0
                             ? mode.receive_width_deg / mode.transmit_width_deg
                             : 1;
    const double shading = options_.receive_shading;
    line(
        "# Assumed: line arrays, the transmitter without shading. Lengths follow from the widths at -3 dB of "
        "the file: for");
    line(
        "# the transmitter those of the sectors, for the receiver in the ratio of the nominal widths of "
        "both.");
    line("transmit_pattern = \"line\"\ntransmit_aperture_m = {:.4f}", main_lobe_width(0) * length_m);
    line("receive_pattern = \"line\"\nreceive_pattern_angle = \"elevation\"\nreceive_aperture_m = {:.4f}",
         main_lobe_width(shading) * length_m / ratio);
    if (shading > 0) line("receive_shading = {}", shading);
    constexpr double side_lobes = 5, widest_deg = 30;
    line("beam_across_deg = {:.4f}\nalong_track_deg = {:.3f}", glm::degrees(widest_rad * ratio),
         std::min(widest_deg, side_lobes * glm::degrees(widest_rad)));
  }

  void ranges(const KmallMode& mode) {
    const double step_m = sound_speed_m_s_ / (2 * mode.sample_rate_hz);
    constexpr double nearest_m = 0.2;
    const std::size_t first = std::max(
        {mode.first_sample, std::size_t{1}, static_cast<std::size_t>(std::ceil(nearest_m / step_m))});
    if (mode.end_sample <= first)
      throw InputError(whole(), fmt::format("{}: no beam has samples beyond {} m", mode.name, nearest_m));
    const double begin_m = (static_cast<double>(first) - 0.5) * step_m;
    line("# Bin k is centred at the travel time of sample k + {}, at {:.3f} samples per second.", first,
         mode.sample_rate_hz);
    line("range_min_m = {:.9f}\nrange_max_m = {:.9f}\nsamples = {}", begin_m,
         begin_m + static_cast<double>(mode.end_sample - first) * step_m, mode.end_sample - first);
  }

  const KmallSurvey& survey_;
  const KmallSceneOptions& options_;
  const std::filesystem::path& folder_;
  LocalFrame frame_;
  std::vector<Place> places_;  ///< of the reference point, in order of time
  double start_s_ = 0, first_s_ = 0, last_s_ = 0, sound_speed_m_s_ = 1500;
  FittedPlane plane_;
  std::vector<glm::dvec3> soundings_;
  std::string text_;
  KmallSceneReport report_;
};

}  // namespace

KmallSceneReport write_kmall_scene(const KmallSurvey& survey, const KmallSceneOptions& options,
                                   const std::filesystem::path& folder) {
  KmallSceneReport report = KmallSceneWriter(survey, options, folder).write();
  try {
    read_scene_file(folder / "scene.toml");
  } catch (const InputError& error) {
    // The temporary folder is deleted; its name would mean nothing to the user.
    std::string why = error.what();
    if (const std::size_t name = why.find("scene.toml"); name != std::string::npos) why = why.substr(name);
    throw InputError({survey.soundings_file.string(), 0, 0}, "the survey line does not form a scene: " + why);
  }
  return report;
}

}  // namespace tubefoot
