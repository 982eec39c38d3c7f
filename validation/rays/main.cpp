// SPDX-License-Identifier: GPL-3.0-or-later
// tubefoot_rays [PAGE]: compares the acoustic rays of tubefoot with published figures of independent ray
// codes, as a table. The exit code is 1 if a difference exceeds the error that the steps of that code
// explain.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/water/eigenray.hpp"
#include "engine/water/ray_trace.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

struct Figure {
  std::string water, what;
  double ours = 0, published = 0;
  int digits = 0;  ///< published digits after the decimal point
  const char* code = "";
  double allowed = 0;  ///< known error of the steps of that code

  double difference() const { return ours - published; }
  bool holds() const {
    const double last_digit = 0.5 * std::pow(10.0, -digits);
    return std::abs(difference()) <= last_digit + allowed;
  }
};

double degrees(double sine, double cosine) { return std::atan2(sine, cosine) / degree; }

void one_gradient(std::vector<Figure>& figures) {
  const WaterColumn water{SoundSpeedProfile({{0, 1500}, {5000, 1580}}), {}};
  const Eigenray ray = EigenrayFinder(water, 1000).direct(1200, 5000).value();
  const std::string where = "c = 1500 + 0.016 z; from 1000 m to 1200 m at 5 km";
  figures.push_back(
      {where, "launch, degrees", degrees(ray.launch_sine, ray.launch_cosine), 3.80048, 5, "BELLHOP", 6e-5});
  figures.push_back({where, "time, s", ray.time_s, 3.29689956, 8, "BELLHOP", 4e-5});
  const double pressure = std::sqrt(1519.2 / 1516 / ray.tube_area_m2_per_sr);
  figures.push_back({where, "pressure, re 1 m", pressure, 1.99781e-4, 9, "BELLHOP", 1.5e-8});
  figures.push_back(
      {where, "transmission loss, dB", -20 * std::log10(pressure), 73.98936, 5, "BELLHOP", 1e-5});
}

void calibration_case(std::vector<Figure>& figures) {
  const WaterColumn water{SoundSpeedProfile({{0, 1500}, {100, 1480}}), {}};
  const struct {
    double launch_deg, depth_m;
  } rows[] = {{-6.5, 20.2149},     {-5.969388, 9.7281}, {-0.132653, 58.6608}, {0.132653, 57.0742},
              {3.051020, 95.0450}, {5.969388, 56.3080}, {6.5, 94.0345}};
  for (const auto& row : rows) {
    const auto nodes = trace_ray(water, 50, row.launch_deg * degree,
                                 {.surface_m = 0, .bottom_m = 100, .longest_range_m = 10000});
    figures.push_back({"calibraygrad: 1500 to 1480 m/s over 100 m, both ends reflect; from 50 m",
                       fmt::format("depth after 10 km at {:+g} degrees, m", row.launch_deg),
                       nodes.back().state.depth_m, row.depth_m, 4, "BELLHOP", 1.3e-3});
  }
}

void square_of_index(std::vector<Figure>& figures) {
  const auto speed = [](double z) { return n2_linear_sound_speed_m_s(z, 1550, 1.2); };
  const WaterColumn water{SoundSpeedProfile(sample_profile(speed, 0, 1300, 0.25)), {}};
  const struct {
    double from_m, to_m, range_m, launch_deg, arrival_deg, time_s;
  } rows[] = {{1000, 800, 3000, 40.6078, 35.9053, 2.8449}, {75, 75, 500, 10.1467, 10.1467, 0.3390}};
  for (const auto& row : rows) {
    const auto rays = EigenrayFinder(water, row.from_m).all(row.to_m, row.range_m);
    const auto nearest =
        std::min_element(rays.begin(), rays.end(), [&](const Eigenray& a, const Eigenray& b) {
          const auto off = [&](const Eigenray& e) {
            return std::abs(degrees(e.launch_sine, e.launch_cosine) + row.launch_deg);
          };
          return off(a) < off(b);
        });
    if (nearest == rays.end()) throw std::runtime_error("no eigenray in the n^2-linear profile");
    const std::string where = fmt::format("n^2-linear, c0 = 1550, g = 1.2; from {:g} m to {:g} m at {:g} m",
                                          row.from_m, row.to_m, row.range_m);
    figures.push_back({where, "launch (upwards), degrees",
                       -degrees(nearest->launch_sine, nearest->launch_cosine), row.launch_deg, 4, "GRAB",
                       4e-3});
    figures.push_back({where, "arrival, degrees", degrees(nearest->arrival_sine, nearest->arrival_cosine),
                       row.arrival_deg, 4, "GRAB", 5e-3});
    figures.push_back({where, "time, s", nearest->time_s, row.time_s, 4, "GRAB", 0});
  }
}

void sound_channel(std::vector<Figure>& figures) {
  const auto speed = [](double z) { return munk_sound_speed_m_s(z); };
  const WaterColumn water{SoundSpeedProfile(sample_profile(speed, 0, 5000, 10)), {}};
  const struct { double launch_deg, range_m; } rows[] = {{14, 64961.28}, {5, 50185.59}};
  for (const auto& row : rows) {
    const auto nodes =
        trace_ray(water, 1000, row.launch_deg * degree, {.surface_m = 0, .longest_range_m = 70000});
    const auto cycle = std::find_if(nodes.begin() + 1, nodes.end(), [](const RayNode& n) {
      return n.state.depth_m == 1000 && n.state.sine > 0;
    });
    if (cycle == nodes.end()) throw std::runtime_error("no full cycle in the Munk profile");
    figures.push_back({"Munk profile in layers of 10 m; from 1000 m",
                       fmt::format("full cycle at {:g} degrees, m", row.launch_deg), cycle->state.range_m,
                       row.range_m, 2, "BELLHOP", 0});
  }
}

std::string page(const std::vector<Figure>& figures) {
  std::string text =
      "# Comparison with other ray codes\n\nThe table compares published figures of independent ray codes "
      "(standard cases of BELLHOP; comparison of USML with GRAB)\nwith those of tubefoot. These codes "
      "advance along a ray in steps, but tubefoot joins exact arcs, so most of the\ndifference is theirs. "
      "[Energies](../docs/energies.md) compares the values of tubefoot with closed forms, to many "
      "more\ndigits. `make rays` writes this page; the test `Rays.SecondOpinion` fails if a difference is "
      "larger than the last column.\n\n| water | quantity | tubefoot | published | code | difference | "
      "allowed |\n|---|---|---|---|---|---|---|\n";
  for (const Figure& f : figures) {
    const auto shown = [&](double value, int more) {
      return f.published < 0.01 ? fmt::format("{:.{}e}", value, 5 + more)
                                : fmt::format("{:.{}f}", value, f.digits + more);
    };
    text += fmt::format("| {} | {} | {} | {} | {} | {:+.1e} | {:.1e}{} |\n", f.water, f.what,
                        shown(f.ours, 1), shown(f.published, 0), f.code, f.difference(),
                        0.5 * std::pow(10.0, -f.digits) + f.allowed, f.holds() ? "" : " **over**");
  }
  return text;
}

int run(const char* file) {
  std::vector<Figure> figures;
  one_gradient(figures);
  calibration_case(figures);
  square_of_index(figures);
  sound_channel(figures);
  const std::string text = page(figures);
  if (file == nullptr) {
    fmt::print("{}", text);
  } else {
    std::ofstream out(file);
    out << text;
    if (!out.flush()) throw std::runtime_error(fmt::format("cannot write {}", file));
  }
  return std::all_of(figures.begin(), figures.end(), [](const Figure& f) { return f.holds(); }) ? 0 : 1;
}

}  // namespace
}  // namespace tubefoot

int main(int argc, char** argv) {
  if (argc > 2) {
    fmt::print(stderr, "usage: tubefoot_rays [PAGE]\n");
    return 2;
  }
  try {
    return tubefoot::run(argc == 2 ? argv[1] : nullptr);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
