// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the sidescan products of signals, a waterfall and JSF files of complex samples from a beam abeam of
// each ping. Also draws interferograms: phases of two groups of receivers over pings.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "sensors/beamforming/beams.hpp"
#include "sensors/formats/jsf_file.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/phase_colour.hpp"
#include "sensors/products/signal_makers.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

JsfSubsystem subsystem_of(double frequency_hz) {
  constexpr double high_hz = 200e3, very_high_hz = 700e3;  // limits between the frequencies of their sonars:
                                                           // 120, 410, 850 kHz
  return frequency_hz < high_hz        ? JsfSubsystem::sidescan_low
         : frequency_hz < very_high_hz ? JsfSubsystem::sidescan_high
                                       : JsfSubsystem::sidescan_very_high;
}

class BeamsAbeam : public SignalMaker {
 public:
  explicit BeamsAbeam(const SignalJob& job)
      : job_(job),
        sidescan_(*job.products.sidescan),
        ranges_(ranges_of(job.signals.sampling, job.signals.sound_speed_m_s)) {
    using Sides = SignalSidescan::Sides;
    const double level = std::cos(sidescan_.depression_rad), down = -std::sin(sidescan_.depression_rad);
    if (sidescan_.sides != Sides::starboard) directions_.emplace_back(-level, 0, down);
    if (sidescan_.sides != Sides::port) directions_.emplace_back(level, 0, down);
    if (job.products.jsf) {
      // Number of whole samples since the transmission; the format has no fractions.
      const SignalSampling& sampling = job.signals.sampling;
      first_sample_ = std::llround(sampling.first_s * sampling.rate_hz);
      jsf_.emplace(job.new_file(".jsf"));
    }
  }

  void add(std::size_t ping, const ElementSignals& one) override {
    const std::vector<Complex> beams = focused_beams(
        one, directions_, weights_along(one.array, forward_axis, sidescan_.window), job_.interpolator);
    const std::size_t samples = one.samples();
    const auto range_m = [&](std::size_t k) {
      return ranges_.first_m + (static_cast<double>(k) + 0.5) * ranges_.step_m;
    };
    if (port()) {
      for (std::size_t k = samples; k-- > 0;) rows_.push_back(strength_of(beams[k], range_m(k)));
    }
    if (starboard())
      for (std::size_t k = 0; k < samples; ++k)
        rows_.push_back(strength_of(beams[beams.size() - samples + k], range_m(k)));
    if (!jsf_) return;
    for (std::size_t beam = 0; beam < directions_.size(); ++beam) {
      // Samples before the transmission contain no echo.
      const auto skipped = static_cast<std::size_t>(std::max<std::int64_t>(0, -first_sample_));
      if (skipped >= samples) continue;
      jsf_->add(jsf_ping(ping, one, directions_[beam].x > 0),
                std::span(beams).subspan(beam * samples + skipped, samples - skipped));
    }
  }

  void finish() override {
    if (jsf_) jsf_->finish();
    if (!job_.run.draws("sidescan.png")) return;
    const std::size_t columns = directions_.size() * static_cast<std::size_t>(ranges_.count),
                      pings = rows_.size() / columns;
    // Reverses the rows, so that the last ping is on top.
    std::vector<double> turned;
    turned.reserve(rows_.size());
    for (std::size_t ping = pings; ping-- > 0;)
      turned.insert(turned.end(), rows_.begin() + static_cast<std::ptrdiff_t>(ping * columns),
                    rows_.begin() + static_cast<std::ptrdiff_t>((ping + 1) * columns));
    GridPage page;
    page.panels.push_back(level_panel("", std::move(turned), columns));
    const double near_m = ranges_.first_m, far_m = ranges_.first_m + ranges_.count * ranges_.step_m;
    GridPanel& panel = page.panels.back();
    if (port() && starboard())
      panel.across = {"port   slant range (m), less " + fmt::format("{:.2f}", near_m) + " m   starboard",
                      near_m - far_m, far_m - near_m};
    else if (port())
      panel.across = {"slant range to port (m)", far_m, near_m};
    else
      panel.across = {"slant range to starboard (m)", near_m, far_m};
    const double first = job_.number_of(0);
    panel.down = {"ping", first + static_cast<double>(pings), first, true};
    page.title = fmt::format("{}   pings {} to {}   beams abeam", job_.products.name, job_.number_of(0),
                             job_.number_of(pings - 1));
    page.subtitle = fmt::format("{}; one focused beam {}, {:g} degrees down", job_.said_of_signals(),
                                port() && starboard() ? "to either side"
                                : port()              ? "to port"
                                                      : "to starboard",
                                std::round(10 * degrees(sidescan_.depression_rad)) / 10);
    page.footer = "0 dB: strongest echo; spreading compensated";
    job_.write(draw_grid_page(page, job_.font), "-sidescan.png", "beams abeam");
  }

 private:
  bool port() const { return directions_.front().x < 0; }
  bool starboard() const { return directions_.back().x > 0; }

  JsfPing jsf_ping(std::size_t ping, const ElementSignals& one, bool starboard) const {
    const NavigationFix& fix = job_.fixes[ping];
    JsfPing said;
    said.subsystem = subsystem_of(one.waveform.centre_hz());
    said.starboard = starboard;
    said.number = job_.number_of(ping);
    said.unix_time_s = fix.unix_time_s;
    said.degrees = job_.on_earth();
    const glm::dvec3 position = one.motion.ping_pose(0).position_m;
    said.x = said.degrees ? fix.place.lon_lat_height.x : position.x;
    said.y = said.degrees ? fix.place.lon_lat_height.y : position.y;
    said.heading_deg = fix.lie.heading_deg;
    said.pitch_deg = fix.lie.pitch_deg;
    said.roll_deg = fix.lie.roll_deg;
    if (const double depth_m = -fix.place.lon_lat_height.z; depth_m >= 0) said.depth_m = depth_m;
    said.sound_speed_m_s = one.sound_speed_m_s;
    said.start_hz = one.waveform.start_hz;
    said.stop_hz = one.waveform.stop_hz;
    said.sweep_s = one.waveform.duration_s;
    said.mixer_hz = one.sampling.baseband_hz;
    said.sample_interval_s = 1 / one.sampling.rate_hz;
    said.first_sample = static_cast<std::uint32_t>(std::max<std::int64_t>(0, first_sample_));
    return said;
  }

  const SignalJob& job_;
  const SignalSidescan& sidescan_;
  RangeSamples ranges_;
  std::vector<glm::dvec3> directions_;  ///< port first
  std::vector<double> rows_;            ///< [ping][sample], port's far end first
  std::int64_t first_sample_ = 0;
  std::optional<JsfFile> jsf_;
};

/// Products of two groups of receivers, averaged over a cell.
struct PhaseCell {
  Complex cross = 0;
  double upper = 0, lower = 0;
};

class Interferogram : public SignalMaker {
 public:
  explicit Interferogram(const SignalJob& job)
      : job_(job),
        requested_(*job.products.interferogram),
        columns_(job.signals.samples() / requested_.looks_range),
        cells_(columns_ * (job.signals.pings() / requested_.looks_pings)) {}

  bool wants(std::size_t ping) const override {
    return (ping / requested_.looks_pings + 1) * columns_ <= cells_.size();
  }
  void add(std::size_t ping, const ElementSignals& one) override {
    const std::vector<Complex> upper = beam(one, requested_.upper), lower = beam(one, requested_.lower);
    for (std::size_t k = 0; k < columns_ * requested_.looks_range; ++k) {
      PhaseCell& cell = cells_[ping / requested_.looks_pings * columns_ + k / requested_.looks_range];
      cell.cross += upper[k] * std::conj(lower[k]);
      cell.upper += std::norm(upper[k]);
      cell.lower += std::norm(lower[k]);
    }
  }

  void finish() override {
    if (!job_.run.draws("interferogram.png")) return;
    const RangeSamples ranges = ranges_of(job_.signals.sampling, job_.signals.sound_speed_m_s);
    GridPage page;
    for (const bool of_phase : {true, false}) {
      GridPanel panel;
      panel.title = of_phase ? "phase (brightness: coherence)" : "coherence";
      panel.columns = columns_;
      panel.rows = cells_.size() / columns_;
      panel.legend = of_phase ? GridPanel::Legend::phase : GridPanel::Legend::coherence;
      panel.colour = [this, of_phase, rows = panel.rows](PixelSpan across, PixelSpan down) {
        PhaseCell sum;  // the last ping is on top
        for (std::size_t row = rows - down.end; row < rows - down.first; ++row)
          for (std::size_t column = across.first; column < across.end; ++column) {
            const PhaseCell& cell = cells_[row * columns_ + column];
            sum.cross += cell.cross;
            sum.upper += cell.upper;
            sum.lower += cell.lower;
          }
        const double both = std::sqrt(sum.upper * sum.lower),
                     coherence = both > 0 ? std::abs(sum.cross) / both : 0;
        return of_phase ? phase_colour(std::arg(sum.cross), coherence) : DecibelScale::at_level(coherence);
      };
      const double near_m = ranges.first_m,
                   length_m = static_cast<double>(columns_ * requested_.looks_range) * ranges.step_m;
      panel.across = {"slant range (m)", near_m, near_m + length_m};
      const double first = job_.number_of(0),
                   pings = static_cast<double>(panel.rows * requested_.looks_pings);
      panel.down = {"ping", first + pings, first};
      page.panels.push_back(std::move(panel));
    }
    page.title = fmt::format("{}   phase between two groups of receivers", job_.products.name);
    page.subtitle = fmt::format("{}; {} and {} receivers; a cell has {} samples x {} pings",
                                job_.said_of_signals(), requested_.upper.size(), requested_.lower.size(),
                                requested_.looks_range, requested_.looks_pings);
    page.footer =
        "phase and magnitude of the normalised mean product of the first signal with the conjugate of the "
        "second";
    job_.write(draw_grid_page(page, job_.font), "-interferogram.png", "phase between receivers");
  }

 private:
  /// Each group's beam refers to its own phase centre, so that the phase difference between the groups
  /// remains.
  std::vector<Complex> beam(const ElementSignals& one, const std::vector<std::size_t>& receivers) const {
    const ElementSignals some = of_receivers(one, receivers);
    return delay_and_sum(some, 0, {{requested_.direction}, {}, phase_centre_m(some.array), false},
                         job_.interpolator);
  }

  const SignalJob& job_;
  const SignalInterferogram& requested_;
  std::size_t columns_;
  std::vector<PhaseCell> cells_;  ///< [pings of a cell][samples of a cell]
};

}  // namespace

std::unique_ptr<SignalMaker> make_sidescan(const SignalJob& job) { return std::make_unique<BeamsAbeam>(job); }
std::unique_ptr<SignalMaker> make_interferogram(const SignalJob& job) {
  return std::make_unique<Interferogram>(job);
}

}  // namespace tubefoot
