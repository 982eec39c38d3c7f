// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the files and pictures of signals with phase (docs/output-files.md), ping by ping: signals.nc, and
// the requested beams, soundings, images and interferograms. Estimates their cost and memory.

#include "sensors/products/signal_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "files/memory_at_hand.hpp"
#include "geometry/steps/steps.hpp"
#include "sensors/formats/signals_netcdf.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/signal_makers.hpp"
#include "sensors/signals/matched_filter.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Navigation of the vehicle at each ping.
std::vector<NavigationFix> fixes_of(const ElementSignals& signals, const RunContext& run) {
  Recording poses;
  for (std::size_t ping = 0; ping < signals.pings(); ++ping) {
    poses.ping_time_s.push_back(signals.motion.ping_start_s()[ping]);
    poses.ping_pose.push_back(signals.motion.ping_pose(ping));
  }
  return navigation(poses, run, 0, signals.pings());
}

Provenance provenance_of(const SignalProducts& products, const RunContext& run) {
  Provenance provenance;
  provenance.title = run.title.empty() ? products.name : run.title;
  provenance.frame = run.frame;
  return provenance;
}

bool silent(const ElementSignals& signals) {
  return std::ranges::all_of(signals.pressure,
                             [](const std::complex<double>& value) { return value == 0.0; });
}

double compressed_bytes(const SignalCounts& counts) {
  return 16.0 * static_cast<double>(counts.receivers) * static_cast<double>(counts.samples);
}

}  // namespace

std::vector<fs::path> write_signal_files(const fs::path& folder, const ElementSignals& true_signals,
                                         const SignalProducts& products, const RunContext& run,
                                         std::vector<std::string>& warnings, const ElementSignals* recorded) {
  const ElementSignals& signals = recorded != nullptr ? *recorded : true_signals;
  const SignalCounts counts{signals.pings(), signals.receivers(), signals.samples()};
  check(signals);
  check(products, signals.array, counts);
  const SignalInterpolator interpolator =
      interpolator_for(signals.waveform, signals.sampling, products.interpolation_error);
  require_memory(memory_of_signal_files(products, counts), {},
                 fmt::format("the files of '{}'", products.name),
                 "use fewer pings, or no synthetic aperture");
  std::vector<fs::path> files;
  if (run.writes("signals.nc")) {
    files.emplace_back(products.name + "-signals.nc");
    write_signals(folder / files.front(), true_signals, provenance_of(products, run));
  }
  if (silent(signals)) {
    warnings.push_back(
        fmt::format("'{}': the receivers receive nothing, so tubefoot computes no pictures, beams or "
                    "soundings from their signals",
                    products.name));
    return files;
  }
  const bool pictures = run.pictures.wants(PictureSettings::Which::sequence);
  const SignalJob job{folder,
                      signals,
                      products,
                      run,
                      interpolator,
                      fixes_of(signals, run),
                      pictures ? font_for(products.name, warnings) : std::string(),
                      files};
  std::vector<std::unique_ptr<SignalMaker>> makers;
  if (products.fan && run.draws("fan.png")) makers.push_back(make_fan_picture(job));
  if (products.sidescan && (run.draws("sidescan.png") || products.jsf)) makers.push_back(make_sidescan(job));
  if (products.multibeam &&
      (run.writes("soundings.csv") || run.writes("soundings.gpkg") || run.draws("beams.png")))
    makers.push_back(make_soundings(job));
  if (products.interferogram && pictures) makers.push_back(make_interferogram(job));
  if (products.sonar_netcdf) makers.push_back(make_complex_beams(job));
  if (products.elements && pictures) write_elements_picture(job);
  Steps steps("pings of signals", signals.pings());
  for (std::size_t ping = 0; ping < signals.pings(); ++ping) {
    std::optional<ElementSignals> one;
    for (const auto& maker : makers) {
      if (!maker->wants(ping)) continue;
      if (!one) one = compressed_ping(signals, ping, products.range_window);
      maker->add(ping, *one);
    }
    steps.done();
  }
  for (const auto& maker : makers) maker->finish();
  if (products.aperture && pictures)
    write_aperture_picture(
        job, signals.matched_filtered ? signals : matched_filtered(signals, products.range_window));
  return files;
}

std::vector<std::string> signal_file_products() {
  return {"signals.nc", "signals.png",  "fan.png",          "sidescan.png",
          "jsf",        "beams.png",    "soundings.csv",    "soundings.gpkg",
          "sonar.nc",   "aperture.png", "interferogram.png"};
}

SignalProducts without_omitted(SignalProducts products, const OmittedProducts& omitted) {
  const auto omits = [&](const char* product) { return omitted.contains(product); };
  products.elements = products.elements && !omits("signals.png");
  products.jsf = products.jsf && !omits("jsf");
  products.sonar_netcdf = products.sonar_netcdf && !omits("sonar.nc");
  const SignalFan* complex_beams = products.sonar_netcdf ? fan_of_complex_beams(products) : nullptr;
  const bool needs_fan = products.fan && complex_beams == &*products.fan,
             needs_multibeam = products.multibeam && complex_beams == &products.multibeam->fan;
  if (omits("fan.png") && !needs_fan) products.fan.reset();
  if (omits("sidescan.png") && !products.jsf) products.sidescan.reset();
  if (omits("beams.png") && omits("soundings.csv") && omits("soundings.gpkg") && !needs_multibeam)
    products.multibeam.reset();
  if (omits("aperture.png")) products.aperture.reset();
  if (omits("interferogram.png")) products.interferogram.reset();
  return products;
}

double memory_of_signal_files(const SignalProducts& products, const SignalCounts& counts) {
  const double pings = static_cast<double>(counts.pings), samples = static_cast<double>(counts.samples);
  constexpr double canvas = 64e6;
  double most = 3 * compressed_bytes(counts) + canvas;
  const auto beams = [&](const SignalFan& fan) { return 48.0 * static_cast<double>(fan.beams) * samples; };
  if (products.fan) most += beams(*products.fan);
  if (products.multibeam) most += beams(products.multibeam->fan);
  if (products.sidescan) most += 2 * 2 * 8.0 * pings * samples;
  if (products.interferogram)
    most += 32.0 * pings * samples / static_cast<double>(products.interferogram->looks_range);
  if (products.elements)
    most += 32.0 * samples * static_cast<double>(std::max(counts.pings, counts.receivers));
  if (products.aperture)
    most += pings * compressed_bytes(counts) +
            64.0 * static_cast<double>(products.aperture->plane.columns * products.aperture->plane.rows);
  return most;
}

WritingCost cost_of_signal_files(const SignalProducts& products, const SignalCounts& counts,
                                 const PictureSettings& settings, const OmittedProducts& omitted) {
  constexpr double packing_s = 8e-9, writing_s = 3e-9, compressing_s = 4e-7, focusing_s = 1.2e-7,
                   picture_s = 0.3, picture_bytes = 1e6, sounding_bytes = 400;
  const bool pictures = settings.wants(PictureSettings::Which::sequence);
  const double pings = static_cast<double>(counts.pings), samples = static_cast<double>(counts.samples),
               receivers = static_cast<double>(counts.receivers), bytes = pings * compressed_bytes(counts);
  WritingCost cost;
  if (!omitted.contains("signals.nc")) cost += {writing_s * bytes, packing_s * bytes, bytes};
  const auto draw = [&] {
    if (pictures) cost += {picture_s, 0, picture_bytes};
  };
  const auto beams = [&](double count, double of_pings) {
    cost += {0, of_pings * receivers * samples * (count * focusing_s + compressing_s), 0};
  };
  if (products.elements) draw();
  if (products.fan && pictures) {
    beams(static_cast<double>(products.fan->beams), 1);
    draw();
  }
  if (products.sidescan && (pictures || products.jsf)) {
    const double sides = products.sidescan->sides == SignalSidescan::Sides::both ? 2 : 1;
    beams(sides, pings);
    draw();
    if (products.jsf) cost += {0, 0, sides * pings * (256 + 4 * samples)};
  }
  if (products.multibeam) {
    const double count = static_cast<double>(products.multibeam->fan.beams);
    beams(count, pings);
    cost += {0, 0, 2 * sounding_bytes * count * pings};
    draw();
  }
  if (products.sonar_netcdf) {
    const SignalFan* fan = fan_of_complex_beams(products);
    const double count = fan != nullptr ? static_cast<double>(fan->beams) : 0;
    beams(count, pings);
    cost += {writing_s * 8 * count * samples * pings, 0, 8 * count * samples * pings};
  }
  if (products.interferogram && pictures) {
    beams(0, pings);
    draw();
  }
  if (products.aperture && pictures) {
    const PixelPlane& plane = products.aperture->plane;
    beams(0, pings);
    cost += {0, static_cast<double>(plane.columns * plane.rows) * pings * receivers * focusing_s, 0};
    draw();
  }
  return cost;
}

}  // namespace tubefoot
