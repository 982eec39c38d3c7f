// SPDX-License-Identifier: GPL-3.0-or-later
// Writes files of fans across the track from signals: soundings with their picture, and complex beams as
// SONAR-netCDF4.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/formats/sonar_netcdf.hpp"
#include "sensors/formats/soundings_file.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/products/signal_makers.hpp"
#include "sensors/products/signal_soundings.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

constexpr Colour of_amplitude{0.35f, 0.85f, 0.95f}, of_phase{0.55f, 1.00f, 0.35f};

class SoundingsMaker : public SignalMaker {
 public:
  explicit SoundingsMaker(const SignalJob& job) : job_(job) {
    for (const std::string product : {"soundings.csv", "soundings.gpkg"})
      if (job.run.writes(product))
        tables_.push_back(std::make_unique<SoundingsFile>(job.new_file("-" + product), job.run.frame));
  }

  void add(std::size_t ping, const ElementSignals& one) override {
    const SignalSoundings found = signal_soundings(one, *job_.products.multibeam, job_.interpolator);
    std::vector<Sounding> best;
    for (std::size_t beam = 0; beam < found.amplitude.size(); ++beam)
      if (std::optional<Sounding> sounding = found.best(beam)) {
        sounding->ping = job_.number_of(ping);
        best.push_back(*sounding);
      }
    for (const auto& table : tables_) table->add(best);
    if (ping == job_.products.picture_ping && job_.run.draws("beams.png")) draw(ping, found);
  }
  void finish() override {
    for (const auto& table : tables_) table->finish();
  }

 private:
  void draw(std::size_t ping, const SignalSoundings& found) const {
    const std::size_t beams = found.amplitude.size(), count = static_cast<std::size_t>(found.ranges.count);
    std::vector<double> strength(beams * count);
    for (std::size_t beam = 0; beam < beams; ++beam)
      for (std::size_t k = 0; k < count; ++k)
        strength[k * beams + beam] =
            strength_of(found.beams[beam * count + k],
                        found.ranges.first_m + (static_cast<double>(k) + 0.5) * found.ranges.step_m);
    GridPage page;
    page.panels.push_back(level_panel("", std::move(strength), beams));
    GridPanel& panel = page.panels.back();
    const SignalFan& fan = job_.products.multibeam->fan;
    const double half_deg = degrees(fan.opening_rad) / 2,
                 border_deg = half_deg + half_deg / static_cast<double>(beams - 1);
    panel.across = {"angle from straight down, to starboard (degrees)", -border_deg, border_deg};
    panel.down = {"range (m)", found.ranges.first_m,
                  found.ranges.first_m + found.ranges.count * found.ranges.step_m};
    std::size_t phases = 0, all = 0;
    for (std::size_t beam = 0; beam < beams; ++beam)
      if (const std::optional<Sounding> best = found.best(beam)) {
        const bool by_phase = best->method == DetectionMethod::split_beam;
        ++all;
        phases += by_phase;
        panel.marks.push_back(
            {best->beam_angle_deg, best->slant_range_m, by_phase ? of_phase : of_amplitude});
      }
    page.title = fmt::format("{}   ping {}   {} beams", job_.products.name, job_.number_of(ping), beams);
    page.subtitle = job_.said_of_signals() + "; focused beams across the track";
    page.footer = fmt::format(
        "0 dB: strongest echo, spreading compensated; {} of {} soundings by amplitude (blue), {} by phase "
        "(green)",
        all - phases, beams, phases);
    job_.write(draw_grid_page(page, job_.font), "-beams.png", "beams and soundings of a ping");
  }

  const SignalJob& job_;
  std::vector<std::unique_ptr<SoundingsFile>> tables_;
};

SonarNetcdfHeader header_of(const SignalJob& job) {
  const ElementSignals& signals = job.signals;
  const SignalFan& fan = *fan_of_complex_beams(job.products);
  SonarNetcdfHeader header;
  header.title = job.run.title.empty() ? job.products.name : job.run.title;
  header.summary =
      "Simulated. Complex beams of an array, matched filtered and focused at every range. The reference "
      "point is that of the vehicle.";
  header.keywords = "multibeam, simulation, complex samples";
  header.date_created =
      fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", fmt::gmtime(static_cast<std::time_t>(job.run.start_unix_s)));
  header.history = header.date_created + " tubefoot: simulated";
  header.sonar_manufacturer = "simulated";
  header.sonar_model = job.products.name;
  header.platform_name = "vehicle";
  header.platform_type = "simulated";
  header.beams = fan.beams;
  header.frequency_hz = signals.waveform.centre_hz();
  header.bandwidth_hz = std::max(std::abs(signals.waveform.stop_hz - signals.waveform.start_hz),
                                 1 / signals.waveform.duration_s);
  header.pulse_length_s = signals.waveform.duration_s;
  header.sound_speed_m_s = signals.sound_speed_m_s;
  const double width_deg = degrees(
      2 * std::asin(half_lobe_sine(signals, weights_along(signals.array, starboard_axis, fan.window))));
  header.receive_width_across_deg = width_deg;
  header.transducer_offset_m = {phase_centre_m(signals.array).y, phase_centre_m(signals.array).x,
                                -phase_centre_m(signals.array).z};
  header.complex_beams = true;
  if (signals.waveform.start_hz != signals.waveform.stop_hz) {
    header.chirp_start_hz = signals.waveform.start_hz;
    header.chirp_stop_hz = signals.waveform.stop_hz;
  }
  return header;
}

class ComplexBeams : public SignalMaker {
 public:
  explicit ComplexBeams(const SignalJob& job)
      : job_(job),
        fan_(*fan_of_complex_beams(job.products)),
        file_(job.new_file("-sonar.nc"), header_of(job)) {}

  void add(std::size_t ping, const ElementSignals& one) override {
    const std::vector<Complex> beams = focused_beams(one, fan_, job_.interpolator);
    const NavigationFix& fix = job_.fixes[ping];
    SonarNetcdfPing said;
    said.unix_time_ns = std::llround(fix.unix_time_s * 1e9);
    if (job_.on_earth()) {
      said.longitude_deg = fix.place.lon_lat_height.x;
      said.latitude_deg = fix.place.lon_lat_height.y;
    }
    const double above_water_m = fix.place.lon_lat_height.z;
    said.height_m = above_water_m;
    said.heading_deg = fix.lie.heading_deg;
    said.pitch_deg = fix.lie.pitch_deg;
    said.roll_deg = fix.lie.roll_deg;
    said.waterline_below_reference_m = above_water_m;
    said.transducer_depth_m = -above_water_m;
    said.sound_speed_m_s = one.sound_speed_m_s;
    said.sample_interval_s = 1 / one.sampling.rate_hz;
    said.blanking_interval_s = std::max(0.0, one.sampling.first_s);
    // Samples before the transmission contain no echo.
    const auto skipped = static_cast<std::size_t>(std::clamp(
        std::ceil(-one.sampling.first_s * one.sampling.rate_hz), 0.0, static_cast<double>(one.samples())));
    said.detections.resize(fan_.beams);
    const std::vector<double> angles = fan_.angles_rad();
    for (std::size_t beam = 0; beam < fan_.beams; ++beam) {
      said.across_angle_deg.push_back(degrees(angles[beam]));
      said.detections[beam].beam_angle_deg = degrees(angles[beam]);
      const auto values = std::span(beams).subspan(beam * one.samples() + skipped, one.samples() - skipped);
      said.backscatter.emplace_back(values.begin(), values.end());
    }
    file_.add(said);
  }
  void finish() override { file_.finish(); }

 private:
  const SignalJob& job_;
  const SignalFan& fan_;
  SonarNetcdfFile file_;
};

}  // namespace

std::unique_ptr<SignalMaker> make_soundings(const SignalJob& job) {
  return std::make_unique<SoundingsMaker>(job);
}
std::unique_ptr<SignalMaker> make_complex_beams(const SignalJob& job) {
  return std::make_unique<ComplexBeams>(job);
}

}  // namespace tubefoot
