// SPDX-License-Identifier: GPL-3.0-or-later
// The sensor kind "array": one transmitter and many receivers whose signals are recorded with phase. Defines
// its scene keys, checks, transmission, samples in a given water, and products (fan, sidescan, multibeam,
// aperture, interferogram).

#include "sensors/kinds/kind_array.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "scene/file/sensor_ranges.hpp"
#include "scene/file/toml_reader.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/products/array_files.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

TransmitWaveform waveform_of(const SensorDescription& sensor) {
  const auto& own = sensor.kind.as<ArrayDescription>();
  constexpr double hz = 1000, s = 1e-6;
  return linear_chirp(hz * (own.frequency_khz - own.bandwidth_khz / 2),
                      hz * (own.frequency_khz + own.bandwidth_khz / 2),
                      s * sensor.signal.pulse_length_us.value_or(0), own.pulse_taper);
}

/// Complex samples per second.
double sampling_hz(const SensorDescription& sensor) {
  const auto& own = sensor.kind.as<ArrayDescription>();
  if (own.sampling_frequency_khz) return 1000 * *own.sampling_frequency_khz;
  constexpr double room = 1.25;  // margin for the interpolation between samples
  const FrequencyBand band = band_of(waveform_of(sensor));
  return room * (band.high_hz - band.low_hz);
}

SignalSampling sampling_of(const SensorDescription& sensor) {
  const auto& own = sensor.kind.as<ArrayDescription>();
  return {1000 * own.baseband_khz.value_or(own.frequency_khz), sampling_hz(sensor),
          2 * own.range_min_m / own.sound_speed_m_s, static_cast<std::size_t>(own.samples)};
}

/// A sonar of one transmitter and many receivers that records the signals of its elements. For tubes and
/// energies it has a single beam, the insonified sector. Its range samples are the times of the signals'
/// samples.
class Array : public Sensor {
 public:
  /// Throws std::invalid_argument for an invalid sonar, and for a description without
  /// SensorKind::in_water().
  explicit Array(const SensorDescription& description);

 private:
  Transmission transmission() const;
};

Array::Array(const SensorDescription& description) : Sensor(description) {
  const auto& own = description.kind.as<ArrayDescription>();
  require(own.sound_speed_m_s > 0 && own.samples >= 1, description, "samples", own.samples,
          "the number of whole samples in the range gate, as in_water() computes it");
  require(own.horizontal_deg > 0 && own.horizontal_deg < 180, description, "horizontal_deg",
          own.horizontal_deg, "above 0 and below 180");
  require(own.vertical_deg > 0 && own.vertical_deg < 180, description, "vertical_deg", own.vertical_deg,
          "above 0 and below 180");
  frequency_khz_ = own.frequency_khz;
  samples_ = {own.range_min_m, (own.range_max_m - own.range_min_m) / own.samples, own.samples};
  beams_.push_back({0, 0, radians(own.horizontal_deg), radians(own.vertical_deg)});
  SignalModel& model = signals_.emplace();
  for (const auto& [x, y, z] : own.receivers_m) model.array.receivers_m.emplace_back(x, y, z);
  model.waveform = waveform_of(description);
  model.sampling = sampling_of(description);
  model.stop_and_hop = description.stop_and_hop;
  model.own_views = own.own_views;
  model.tolerance = own.signal_tolerance;
  check_sampled(model.waveform, model.sampling);
  transmissions_.push_back(transmission());
}

Sensor::Transmission Array::transmission() const {
  const BeamAxis& beam = beams_.front();
  const double half_width_rad = beam.azimuth_width_rad / 2, half_height_rad = beam.elevation_width_rad / 2,
               tolerance = description_.cone_tolerance;
  const int slices = slices_for(2 * half_width_rad, tolerance);
  const double corner_rad = height_of_corners(half_height_rad, 2 * half_width_rad / slices, tolerance);
  // Two rows above 90 degrees, so that no tube approaches a half space. The rays of such a tube would not
  // determine it.
  const int rows = half_height_rad > radians(45) ? 2 : 1;
  Transmission made;
  made.beams = {0};
  made.sectors.push_back({even_edges(-half_width_rad, half_width_rad, slices),
                          even_edges(-corner_rad, corner_rad, rows),
                          glm::dmat3(forward_axis, starboard_axis, up_axis)});
  made.beam_of_tube.assign(static_cast<std::size_t>(slices * rows), 0);
  made.fans.push_back(
      {0, 1, static_cast<std::uint32_t>(slices * rows), forward_axis, starboard_axis, up_axis});
  return made;
}

bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// Number of pixels of an aperture's image from one border to the other.
double pixels_between(double from_m, double to_m, const ArrayDescription& own) {
  return std::max(1.0, std::round((to_m - from_m) / own.pixel_m));
}

/// Rejects keys that none of the requested products reads.
void check_products(const ArrayDescription& own, const TomlTable& table) {
  const auto needs = [&](std::initializer_list<const char*> keys, const std::vector<const char*>& any,
                         const char* list) {
    if (std::ranges::any_of(any, [&](const char* name) { return has(own.products, name); })) return;
    for (const char* key : keys)
      if (table.has(key))
        throw InputError(
            table.place_of(key),
            fmt::format("'{}' applies only with products = [\"{}\"]{}: add this product, or remove the key",
                        key, fmt::join(any, "\"] or [\""), list));
  };
  needs({"beams", "beams_deg"}, {"fan", "multibeam"}, "");
  needs({"beams_depression_deg"}, {"fan", "sidescan"}, "");
  needs({"beam_window"}, {"fan", "multibeam", "sidescan"}, "");
  needs({"range_window"}, {"fan", "multibeam", "sidescan", "aperture", "interferogram"}, "");
  needs({"beams_plane"}, {"fan"}, "");
  needs({"sides"}, {"sidescan", "interferogram"}, "");
  if (own.sides == "both" && !has(own.products, "sidescan"))
    throw InputError(table.place_of("sides"),
                     "an interferogram has beams on one side only: set sides = \"port\" or \"starboard\"");
  needs({"picture_m", "picture_up_m", "pixel_m", "half_beam_deg", "ping_window"}, {"aperture"}, "");
  needs({"upper", "lower", "looks_range", "looks_pings"}, {"interferogram"}, "");
  if (has(own.products, "aperture") && !own.picture_m)
    throw InputError(
        table.place_of("products"),
        "\"aperture\" needs 'picture_m', the area of the picture: [east, north, east, north] of two corners");
  if (own.picture_m &&
      !((*own.picture_m)[2] > (*own.picture_m)[0] && (*own.picture_m)[3] > (*own.picture_m)[1]))
    throw InputError(table.place_of("picture_m"),
                     "'picture_m' must be [east, north, east, north] with the south-west corner first");
  if (own.picture_m) {
    const auto& [west, south, east, north] = *own.picture_m;
    const double columns = pixels_between(west, east, own), rows = pixels_between(south, north, own);
    if (!(columns >= 2 && rows >= 2 && columns * rows <= SignalAperture::most_pixels))
      throw InputError(
          table.place_of(table.has("pixel_m") ? "pixel_m" : "picture_m"),
          fmt::format("'picture_m' and 'pixel_m' give {:.6g} x {:.6g} pixels, but the picture must have 2 x "
                      "2 or more, and {} at most in total: choose pixels of another size, or another area",
                      columns, rows, SignalAperture::most_pixels));
  }
  if (has(own.products, "interferogram") && (own.upper.empty() || own.lower.empty()))
    throw InputError(table.place_of("products"),
                     "\"interferogram\" needs 'upper' and 'lower', the receiver numbers of two groups");
  if (has(own.products, "interferogram") && own.upper == own.lower)
    throw InputError(table.place_of("lower"),
                     "'upper' and 'lower' have the same receivers, so the phase is 0 everywhere: choose "
                     "different receivers");
  if (has(own.formats, "jsf") && !has(own.products, "sidescan"))
    throw InputError(table.place_of("formats"),
                     "\"jsf\" needs the beams of a sidescan: add products = [\"sidescan\"]");
  const bool fan_across = has(own.products, "fan") && own.beams_plane == "across_track";
  if (has(own.formats, "sonar_netcdf") && !fan_across && !has(own.products, "multibeam"))
    throw InputError(table.place_of("formats"),
                     "\"sonar_netcdf\" needs beams across the track: add products = [\"multibeam\"], or "
                     "[\"fan\"] with beams_plane = \"across_track\"");
}

constexpr std::size_t most_receivers = 4096;
constexpr double most_samples = 65536;  // per ping

class ArrayKind : public SensorKind {
 public:
  ArrayKind() : SensorKind("array") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using A = ArrayDescription;
    constexpr ValueRange kilohertz{.lo = 0, .hi = 10000}, above_0{.lo = 0, .hi = 10000, .lo_excluded = true},
        share{.lo = 0, .hi = 1}, place{.lo = -1000, .hi = 1000}, anywhere{.lo = -1e7, .hi = 1e7},
        element{.lo = 0, .hi = most_receivers - 1}, looks{.lo = 1, .hi = 1024};
    const std::vector<std::string> windows{"uniform", "hann", "hamming", "taylor", "chebyshev"},
        smooth_windows{"uniform", "hann", "hamming", "taylor"};
    section.kind<A>(
        "kind", name(),
        "Receiver array that records signals with phase. Needs `pulse_length_us`. Receiver positions are "
        "relative to `receiver_arm_m` or, without this key, to the transmitter.",
        {field("frequency_khz", &A::frequency_khz,
               {.meaning = "Centre frequency of the pulse.", .ranges = {frequency}}),
         field("bandwidth_khz", &A::bandwidth_khz,
               {.meaning = "Bandwidth of the linear sweep over the pulse, from low to high frequency. 0: a "
                           "pulse of one frequency.",
                .ranges = {kilohertz}}),
         field("pulse_taper", &A::pulse_taper,
               {.meaning = "Share of the pulse length that the two raised-cosine flanks occupy. 0: "
                           "rectangle. 1: Hann window.",
                .ranges = {share}}),
         field("sampling_frequency_khz", &A::sampling_frequency_khz,
               {.meaning = "Rate of the complex samples. They represent frequencies up to half of this rate "
                           "below and above `baseband_khz`.",
                .ranges = {above_0},
                .default_value = "1.25 times the bandwidth of the pulse"}),
         field("baseband_khz", &A::baseband_khz,
               {.meaning = "Mixing frequency of the sonar.",
                .ranges = {above_0},
                .default_value = "value of frequency_khz"}),
         field("range_min_m", &A::range_min_m,
               {.meaning = "Half of the two-way path length at the first sample.", .ranges = {range_start}}),
         field("range_max_m", &A::range_max_m,
               {.meaning = "Half of the two-way path length at the end of the last sample. tubefoot rounds "
                           "the range gate to whole samples.",
                .ranges = {sonar_range}}),
         field(
             "horizontal_deg", &A::horizontal_deg,
             {.meaning = "Width of the transmitted and received sector about the forward axis of the sensor.",
              .ranges = {sector(180, true)}}),
         field("vertical_deg", &A::vertical_deg,
               {.meaning = "Height of the transmitted and received sector.", .ranges = {sector(170, false)}}),
         field("receivers", &A::receivers,
               {.meaning = "Number of receivers on a line, centred on the receiver position.",
                .ranges = {{.lo = 1, .hi = most_receivers}}}),
         field("receiver_spacing_m", &A::receiver_spacing_m,
               {.meaning = "Step from each receiver to the next: starboard, forward, up.",
                .ranges = {place},
                .default_value = "half a wavelength to starboard"}),
         field("receivers_m", &A::receivers_m,
               {.meaning = "Position of each receiver (starboard, forward, up), instead of `receivers` and "
                           "`receiver_spacing_m`. At most 4096 receivers.",
                .ranges = {place}}),
         field("own_sights", &A::own_views,
               {.meaning = "true: the signal of a receiver comes from the surface that is visible from both "
                           "the transmitter and this receiver. false: the signals of all receivers come from "
                           "the surface that is visible from the transmitter (and from `receiver_arm_m`)."}),
         field("signal_tolerance", &A::signal_tolerance,
               {.meaning = "Approximate error of the signals, relative to their incoherent level (the sum of "
                           "the energies of all echoes).",
                .ranges = {{.lo = 1e-8, .hi = 0.1}}}),
         field("products", &A::products,
               {.meaning = "Products that tubefoot computes from the signals, in addition to signals.nc.",
                .choices = {"fan", "sidescan", "multibeam", "aperture", "interferogram"}}),
         field("formats", &A::formats,
               {.meaning = "jsf: sidescan beams as EdgeTech complex samples. sonar_netcdf: beams of the fan, "
                           "or else of the multibeam, as SONAR-netCDF4.",
                .choices = {"jsf", "sonar_netcdf"}}),
         field("beams", &A::beams,
               {.meaning = "Number of beams of a fan or a multibeam.", .ranges = {{.lo = 2, .hi = 4096}}}),
         field("beams_deg", &A::beams_deg,
               {.meaning = "Angle between the axes of the outermost beams.", .ranges = {sector(180, true)}}),
         field(
             "beams_depression_deg", &A::beams_depression_deg,
             {.meaning = "Depression angle of the beams of a forward fan or a sidescan.", .ranges = {pitch}}),
         field("beams_plane", &A::beams_plane,
               {.meaning = "Plane of the beams of a fan, relative to the axes of the carrier.",
                .choices = {"forward", "across_track"}}),
         field("sides", &A::sides,
               {.meaning = "Sides of a sidescan. For an interferogram, the side of its beams.",
                .choices = {"port", "starboard", "both"}}),
         field("beam_window", &A::beam_window,
               {.meaning = "Weighting window across the receivers. An aperture always uses uniform weights.",
                .choices = windows}),
         field("range_window", &A::range_window,
               {.meaning = "Weighting window across the band of a chirp.", .choices = smooth_windows}),
         field("ping_window", &A::ping_window,
               {.meaning = "Weighting window across the pings of an aperture.", .choices = windows}),
         field("picture_m", &A::picture_m,
               {.meaning = "Area of the picture of an aperture: east and north of the south-west corner, "
                           "then of the north-east corner.",
                .ranges = {anywhere}}),
         field("picture_up_m", &A::picture_up_m,
               {.meaning = "Height of the horizontal plane of the picture.", .ranges = {anywhere}}),
         field("pixel_m", &A::pixel_m,
               {.meaning = "Side of the pixels of the picture.", .ranges = {{.lo = 1e-4, .hi = 1000}}}),
         field("half_beam_deg", &A::half_beam_deg,
               {.meaning = "Largest angle from abeam at which a ping contributes to a pixel of an aperture. "
                           "Default: all pings contribute.",
                .ranges = {{.lo = 0, .hi = 90, .lo_excluded = true}}}),
         field("upper", &A::upper,
               {.meaning = "Receivers of the first group of an interferogram, counted from 0.",
                .ranges = {element}}),
         field("lower", &A::lower,
               {.meaning = "Receivers of the second group of an interferogram, counted from 0.",
                .ranges = {element}}),
         field("looks_range", &A::looks_range,
               {.meaning = "Number of samples that are averaged for each cell of an interferogram.",
                .ranges = {looks}}),
         field("looks_pings", &A::looks_pings,
               {.meaning = "Number of pings that are averaged for each cell of an interferogram, at most the "
                           "number of all pings.",
                .ranges = {looks}})});
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    const auto& own = sensor.kind.as<ArrayDescription>();
    check_ranges(own.range_min_m, own.range_max_m, table);
    if (!sensor.signal.pulse_length_us)
      throw InputError(table.place_of("kind"),
                       "kind = \"array\" needs the length of the transmitted pulse: add 'pulse_length_us'");
    for (const char* key :
         {"source_level_db", "noise_level_db", "speckle", "speckle_looks", "speckle_shape", "tvg_spreading",
          "tvg_absorption_db_per_km", "tvg_gain_db", "tvg_fixed_below_m", "display_gain_db",
          "quantisation_bits", "quantisation_bottom_db", "quantisation_top_db", "motion_step_beams"})
      if (table.has(key))
        throw InputError(
            table.place_of(key),
            fmt::format(
                "'{}' applies to sonars that record energies, but an array records signals: remove the key",
                key));
    for (const char* key : {"receivers", "receiver_spacing_m"})
      if (!own.receivers_m.empty() && table.has(key))
        throw InputError(
            table.place_of(key),
            fmt::format("'receivers_m' already gives the receiver positions: remove '{}', or 'receivers_m'",
                        key));
    if (sensor.look_at_m && (sensor.receiver_arm_m || !sensor.stop_and_hop))
      throw InputError(table.place_of("look_at_m"),
                       "'look_at_m' needs an array with a single position that stands still during "
                       "reception: remove 'look_at_m', or 'receiver_arm_m' and stop_and_hop = false");
    if (own.receivers_m.size() > most_receivers)
      throw InputError(table.place_of("receivers_m"),
                       fmt::format("'receivers_m' has {} positions, but must have {} at most",
                                   own.receivers_m.size(), most_receivers));
    if (own.bandwidth_khz >= 2 * own.frequency_khz)
      throw InputError(place_of_pair(table, "frequency_khz", "bandwidth_khz"),
                       fmt::format("a band with the width 'bandwidth_khz' ({}) around 'frequency_khz' ({}) "
                                   "reaches below 0 Hz: reduce the bandwidth, or increase the frequency",
                                   own.bandwidth_khz, own.frequency_khz));
    try {
      tubefoot::check(waveform_of(sensor));
    } catch (const std::invalid_argument& error) {
      throw InputError(table.place_of("pulse_length_us"), error.what());
    }
    // The exact number of samples depends on the sound speed of the water: in_water() checks it.
    if (const double samples = (own.range_max_m - own.range_min_m) / figures(sensor).sample_m;
        samples > 2 * most_samples)
      throw InputError(
          place_of_pair(table, "range_max_m", "sampling_frequency_khz"),
          fmt::format("range_min_m to range_max_m contain about {:.3g} samples at {:.6g} kHz, but the limit "
                      "is {:.0f}: shorten the range gate, or reduce the sampling frequency",
                      samples, sampling_hz(sensor) / 1000, most_samples));
    check_products(own, table);
  }
  bool looks_ahead() const override { return true; }
  bool receives_phases() const override { return true; }
  SensorFigures figures(const SensorDescription& sensor) const override {
    const auto& own = sensor.kind.as<ArrayDescription>();
    SensorFigures figures;
    figures.frequency_khz = own.frequency_khz;
    constexpr double about_m_s = 1500;
    figures.sample_m =
        (own.sound_speed_m_s > 0 ? own.sound_speed_m_s : about_m_s) / (2 * sampling_hz(sensor));
    figures.samples = static_cast<std::int64_t>((own.range_max_m - own.range_min_m) / figures.sample_m);
    figures.beam_deg = std::min(own.horizontal_deg, own.vertical_deg);
    figures.farthest_m = own.range_max_m;
    return figures;
  }

  /// The sound speed gives the length of a sample, and the range gate contains a whole number of samples.
  SensorDescription in_water(SensorDescription sensor, double sound_speed_m_s,
                             std::vector<std::string>*) const override {
    auto& own = sensor.kind.edit<ArrayDescription>();
    own.sound_speed_m_s = sound_speed_m_s;
    const double rate_hz = sampling_hz(sensor), step_m = sound_speed_m_s / (2 * rate_hz),
                 whole = std::floor((own.range_max_m - own.range_min_m) / step_m * (1 + 1e-12));
    const auto fail = [&](const std::string& what) {
      throw InputError(sensor.place, fmt::format("sensor '{}': {}", sensor.name, what));
    };
    if (!(whole >= 1 && whole <= most_samples))
      fail(
          fmt::format("at {:.6g} complex samples per second and {:.1f} m/s a sample has a length of {:.4g} "
                      "m, and range_min_m to range_max_m contain {:.0f} samples: choose 1 to {:.0f} samples",
                      rate_hz, sound_speed_m_s, step_m, whole, most_samples));
    const double receivers = static_cast<double>(
        own.receivers_m.empty() ? static_cast<std::size_t>(own.receivers) : own.receivers_m.size());
    constexpr double most_bytes = 512e6;  // per ping in signals.nc
    if (16 * whole * receivers > most_bytes)
      fail(
          fmt::format("a ping of {:.0f} receivers and {:.0f} samples takes {:.3g} MB, but the limit is 512 "
                      "MB: record fewer samples, or divide the receivers among several sensors",
                      receivers, whole, 16e-6 * whole * receivers));
    own.samples = static_cast<int>(whole);
    own.range_max_m = own.range_min_m + whole * step_m;
    if (own.receivers_m.empty()) {
      const double wavelength_m = sound_speed_m_s / (1000 * own.frequency_khz);
      const auto [x, y, z] = own.receiver_spacing_m.value_or(std::array{wavelength_m / 2, 0.0, 0.0});
      for (const glm::dvec3 place :
           line_array(static_cast<std::size_t>(own.receivers), {x, y, z}).receivers_m)
        own.receivers_m.push_back({place.x, place.y, place.z});
    }
    for (const std::vector<int>& group : {own.upper, own.lower})
      for (const int number : group)
        if (static_cast<std::size_t>(number) >= own.receivers_m.size())
          fail(fmt::format("there is no receiver {} for the interferogram: receivers are 0 to {}", number,
                           own.receivers_m.size() - 1));
    try {
      check_sampled(waveform_of(sensor), sampling_of(sensor));
    } catch (const std::invalid_argument& error) {
      fail(error.what());
    }
    return sensor;
  }
  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<Array>(sensor);
  }

  std::vector<std::string> products() const override { return signal_file_products(); }
  std::vector<fs::path> write_products(const fs::path& folder, const Recording& recording,
                                       const RunContext& run,
                                       std::vector<std::string>& warnings) const override {
    return write_array_files(folder, recording, run, products_of(recording.sensor->description()), warnings);
  }
  WritingCost writing_cost(const Recording& recording, const RunContext& run) const override {
    return cost_of_array_files(recording, run, products_of(recording.sensor->description()));
  }
  std::vector<std::string> files_left_out(const Recording& recording, const RunContext& run) const override {
    return array_files_left_out(recording, run, products_of(recording.sensor->description()));
  }

 private:
  static SignalProducts products_of(const SensorDescription& sensor);
};

ApertureWindow window_named(const std::string& name) {
  using Law = ApertureWindow::Law;
  ApertureWindow window;
  window.law = name == "hann"        ? Law::hann
               : name == "hamming"   ? Law::hamming
               : name == "taylor"    ? Law::taylor
               : name == "chebyshev" ? Law::chebyshev
                                     : Law::uniform;
  return window;
}

SignalProducts ArrayKind::products_of(const SensorDescription& sensor) {
  const auto& own = sensor.kind.as<ArrayDescription>();
  const ApertureWindow window = window_named(own.beam_window);
  const double depression_rad = radians(own.beams_depression_deg);
  SignalProducts products;
  products.name = sensor.name;
  products.range_window = window_named(own.range_window);
  if (has(own.products, "fan"))
    products.fan =
        SignalFan{own.beams_plane == "forward" ? SignalFan::Plane::forward : SignalFan::Plane::across_track,
                  static_cast<std::size_t>(own.beams), radians(own.beams_deg), depression_rad, window};
  if (has(own.products, "sidescan"))
    products.sidescan = SignalSidescan{own.sides == "port"        ? SignalSidescan::Sides::port
                                       : own.sides == "starboard" ? SignalSidescan::Sides::starboard
                                                                  : SignalSidescan::Sides::both,
                                       depression_rad, window};
  if (has(own.products, "multibeam")) {
    products.multibeam.emplace();
    products.multibeam->fan = {SignalFan::Plane::across_track, static_cast<std::size_t>(own.beams),
                               radians(own.beams_deg), 0, window};
  }
  if (has(own.products, "aperture")) {
    const auto& [west, south, east, north] = *own.picture_m;
    SignalAperture& aperture = products.aperture.emplace();
    aperture.plane = {{west + own.pixel_m / 2, south + own.pixel_m / 2, own.picture_up_m},
                      {own.pixel_m, 0, 0},
                      {0, own.pixel_m, 0},
                      static_cast<std::size_t>(pixels_between(west, east, own)),
                      static_cast<std::size_t>(pixels_between(south, north, own))};
    aperture.ping_window = window_named(own.ping_window);
    if (own.half_beam_deg) aperture.half_beam_rad = radians(*own.half_beam_deg);
  }
  if (has(own.products, "interferogram")) {
    SignalInterferogram& interferogram = products.interferogram.emplace();
    interferogram.upper.assign(own.upper.begin(), own.upper.end());
    interferogram.lower.assign(own.lower.begin(), own.lower.end());
    interferogram.looks_range = static_cast<std::size_t>(own.looks_range);
    interferogram.looks_pings = static_cast<std::size_t>(own.looks_pings);
    if (own.sides == "port") interferogram.direction = -starboard_axis;
  }
  products.jsf = has(own.formats, "jsf");
  products.sonar_netcdf = has(own.formats, "sonar_netcdf");
  return products;
}

}  // namespace

const SensorSection& ArrayDescription::kind() {
  static const ArrayKind kind;
  return kind;
}
const SensorSection& array_kind() { return ArrayDescription::kind(); }

}  // namespace tubefoot
