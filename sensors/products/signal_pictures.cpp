// SPDX-License-Identifier: GPL-3.0-or-later
// Draws pictures of signals: levels and phases of the elements, beams of a fan, and synthetic apertures next
// to real ones.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sensors/model/angles.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/fan_page.hpp"
#include "sensors/pictures/phase_colour.hpp"
#include "sensors/products/signal_makers.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

/// Panel of phases, with brightness by strength. `values`: [row][column].
GridPanel phase_panel(std::string title, std::vector<Complex> values, std::size_t columns) {
  double largest[] = {0.0};
  for (const Complex& value : values) largest[0] = std::max(largest[0], std::norm(value));
  GridPanel panel;
  panel.title = std::move(title);
  panel.columns = columns;
  panel.rows = values.size() / columns;
  panel.legend = GridPanel::Legend::phase;
  panel.colour = [scale = DecibelScale(largest), values = std::move(values), columns](PixelSpan across,
                                                                                      PixelSpan down) {
    Complex sum = 0;
    double power = 0;
    for (std::size_t row = down.first; row < down.end; ++row)
      for (std::size_t column = across.first; column < across.end; ++column) {
        sum += values[row * columns + column];
        power += std::norm(values[row * columns + column]);
      }
    const auto cells = static_cast<double>((down.end - down.first) * (across.end - across.first));
    return power > 0 ? phase_colour(std::arg(sum), scale.level(power / cells)) : palette.no_echo;
  };
  return panel;
}

class FanPicture : public SignalMaker {
 public:
  explicit FanPicture(const SignalJob& job) : job_(job), fan_(*job.products.fan) {}

  bool wants(std::size_t ping) const override { return ping == job_.products.picture_ping; }
  void add(std::size_t ping, const ElementSignals& one) override {
    const RangeSamples ranges = ranges_of(one.sampling, one.sound_speed_m_s);
    const std::vector<Complex> beams = focused_beams(one, fan_, job_.interpolator);
    std::vector<double> strength(beams.size());
    for (std::size_t k = 0; k < beams.size(); ++k)
      strength[k] = strength_of(
          beams[k], ranges.first_m + (static_cast<double>(k % one.samples()) + 0.5) * ranges.step_m);
    const double largest[] = {*std::ranges::max_element(strength)};
    const bool across = fan_.plane == SignalFan::Plane::across_track;
    const FanPage page(CameraFan(fan_.angles_rad(), ranges, 1400, 920),
                       across ? FanPage::Towards::down : FanPage::Towards::up);
    job_.write(
        page.draw({fmt::format("{}   ping {}   {} beams {}", job_.products.name, job_.number_of(ping),
                               fan_.beams, across ? "across the track" : "ahead"),
                   fmt::format("{}; beams over {:g} degrees{}, focused", job_.said_of_signals(),
                               std::round(10 * degrees(fan_.opening_rad)) / 10,
                               across ? std::string()
                                      : fmt::format(", {:g} degrees down",
                                                    std::round(10 * degrees(fan_.depression_rad)) / 10)),
                   "0 dB: strongest echo; spreading compensated"},
                  {strength, {}}, DecibelScale(largest), job_.font),
        "-fan.png", "beams of a ping");
  }
  void finish() override {}

 private:
  const SignalJob& job_;
  const SignalFan& fan_;
};

std::string weighed_by(const ApertureWindow& window) {
  switch (window.law) {
    case ApertureWindow::Law::uniform:
      return "uniform window";
    case ApertureWindow::Law::hann:
      return "Hann window";
    case ApertureWindow::Law::hamming:
      return "Hamming window";
    case ApertureWindow::Law::taylor:
      return fmt::format("Taylor window, {:g} dB", window.side_lobe_db);
    case ApertureWindow::Law::chebyshev:
      return fmt::format("Chebyshev window, {:g} dB", window.side_lobe_db);
  }
  return {};
}

GridPanel map_panel(std::string title, const std::vector<Complex>& picture, const PixelPlane& plane) {
  // Rows go up the page.
  std::vector<double> strength;
  for (std::size_t row = plane.rows; row-- > 0;)
    for (std::size_t column = 0; column < plane.columns; ++column)
      strength.push_back(std::norm(picture[row * plane.columns + column]));
  GridPanel panel = level_panel(std::move(title), std::move(strength), plane.columns);
  const double across_m = glm::length(plane.column_step_m), up_m = glm::length(plane.row_step_m);
  // Along an axis of the frame the coordinate is that axis. In other directions it is the distance from the
  // first pixel.
  const auto axis = [&](glm::dvec3 step, double length_m, std::size_t count) {
    GridPanel::Axis named{"m", -length_m / 2, (static_cast<double>(count) - 0.5) * length_m};
    const char* names[] = {"east (m)", "north (m)", "up (m)"};
    for (int k = 0; k < 3; ++k)
      if (std::abs(step[k]) > (1 - 1e-12) * length_m) {
        named = {names[k], plane.first_m[k] - step[k] / 2,
                 plane.first_m[k] + (static_cast<double>(count) - 0.5) * step[k]};
      }
    return named;
  };
  panel.across = axis(plane.column_step_m, across_m, plane.columns);
  panel.down = axis(plane.row_step_m, up_m, plane.rows);
  std::swap(panel.down.first, panel.down.last);
  panel.equal_scales = true;
  return panel;
}

}  // namespace

std::unique_ptr<SignalMaker> make_fan_picture(const SignalJob& job) {
  return std::make_unique<FanPicture>(job);
}

void write_elements_picture(const SignalJob& job) {
  const ElementSignals& signals = job.signals;
  // The columns are the elements of a ping. If there are more pings than receivers, the columns are the
  // pings instead.
  const bool over_pings = signals.pings() > signals.receivers();
  const std::size_t columns = over_pings ? signals.pings() : signals.receivers();
  std::vector<Complex> values(columns * signals.samples());
  std::vector<double> powers(values.size());
  for (std::size_t column = 0; column < columns; ++column) {
    const auto channel =
        over_pings ? signals.channel(column, 0) : signals.channel(job.products.picture_ping, column);
    for (std::size_t k = 0; k < signals.samples(); ++k) {
      values[k * columns + column] = channel[k];
      powers[k * columns + column] = std::norm(channel[k]);
    }
  }
  const RangeSamples ranges = ranges_of(signals.sampling, signals.sound_speed_m_s);
  GridPage page;
  page.title = over_pings ? fmt::format("{}   receiver 0   pings {} to {}", job.products.name,
                                        job.number_of(0), job.number_of(signals.pings() - 1))
                          : fmt::format("{}   ping {}   {} receivers", job.products.name,
                                        job.number_of(job.products.picture_ping), columns);
  page.subtitle = fmt::format("{}; complex baseband around {:g} kHz{}", job.said_of_signals(),
                              signals.sampling.baseband_hz / 1000,
                              signals.matched_filtered ? ", compressed" : ", as received");
  page.footer = "0 dB: largest level; the brightness of phases shows their level";
  page.panels.push_back(level_panel("level", std::move(powers), columns));
  page.panels.push_back(phase_panel("phase", std::move(values), columns));
  for (GridPanel& panel : page.panels) {
    panel.across = {over_pings ? "ping" : "receiver", 0, static_cast<double>(columns), true};
    if (over_pings) {
      panel.across.first += job.number_of(0);
      panel.across.last += job.number_of(0);
    }
    panel.down = {"c t / 2 (m)", ranges.first_m, ranges.first_m + ranges.count * ranges.step_m};
  }
  job.write(draw_grid_page(page, job.font), "-signals.png", "levels and phases of the elements");
}

void write_aperture_picture(const SignalJob& job, const ElementSignals& compressed) {
  const SignalAperture& aperture = *job.products.aperture;
  BackProjection how;
  if (aperture.ping_window.law != ApertureWindow::Law::uniform)
    how.ping_weights = window_weights(aperture.ping_window, compressed.pings());
  how.receiver_weights = weights_along(compressed.array, forward_axis, aperture.receiver_window);
  how.half_beam_rad = aperture.half_beam_rad;
  GridPage page;
  const std::vector<Complex> focused = back_projected(compressed, aperture.plane, job.interpolator, how);
  how.ping_weights.clear();
  how.nearest_abeam_only = true;
  const std::vector<Complex> real = back_projected(compressed, aperture.plane, job.interpolator, how);
  page.panels.push_back(map_panel("synthetic aperture", focused, aperture.plane));
  page.panels.push_back(
      map_panel("real aperture: each pixel from the ping nearest to abeam", real, aperture.plane));
  page.title = fmt::format("{}   {} pings", job.products.name, compressed.pings());
  page.subtitle =
      fmt::format("{}; {} x {} pixels of {:g} x {:g} m; {} over the pings", job.said_of_signals(),
                  aperture.plane.columns, aperture.plane.rows, glm::length(aperture.plane.column_step_m),
                  glm::length(aperture.plane.row_step_m), weighed_by(aperture.ping_window));
  page.footer = "0 dB: strongest echo of each picture; spreading compensated";
  job.write(draw_grid_page(page, job.font), "-aperture.png", "synthetic and real aperture");
}

}  // namespace tubefoot
