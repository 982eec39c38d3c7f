// SPDX-License-Identifier: GPL-3.0-or-later
// Compares shadows in a synthetic-aperture image with the exact footprints of the pings. The speckle is
// scene-fixed: visible parts have the same image with and without a wall, and hidden parts have none.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "engine/signal/visible_polygons.hpp"
#include "fixtures/test_folder.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "run/transmission.hpp"
#include "sensors/beamforming/back_projection.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/array_files.hpp"
#include "sensors/products/signal_products.hpp"
#include "sensors/signals/matched_filter.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

constexpr double seabed_up_m = -6, range_resolution_m = 1500.0 / (2 * 12e3);

/// A sonar on a rail to the north looks to starboard. A wall of 1 m stands along the rail, and its material
/// scatters almost nothing.
std::string scene(bool with_wall, int seed) {
  const std::string wall =
      "[[objects]]\nname = \"wall\"\nshape = \"box\"\nmaterial = \"silent\"\nsize_m = [0.1, 2.4, 1.2]\n"
      "position_m = [6, 0, -5.6]\n";
  return fmt::format(
      "[water]\nsound_speed_m_s = 1500\nabsorption_db_per_km = 0\n"
      "[[materials]]\nname = \"sand\"\nlambert_db = -20\n"
      "[[materials]]\nname = \"silent\"\nlambert_db = -110\n"
      "[[terrain]]\nkind = \"flat\"\nmaterial = \"sand\"\ncentre_m = [7, 0, {}]\nwidth_m = 4\nlength_m = "
      "4.6\n{}"
      "[trajectory]\nkind = \"line\"\nstart_m = [0, -1.64, 0]\nend_m = [0, 1.7, 0]\nspeed_m_s = 1\n"
      "[scatterers]\nspacing_m = 0.025\n[run]\nseed = {}\n"
      "[[sensors]]\nname = \"rail\"\nkind = \"array\"\nyaw_deg = 90\ntilt_deg = 40\nfrequency_khz = 30\n"
      "bandwidth_khz = 12\npulse_length_us = 4000\npulse_taper = 0.3\nrange_min_m = 7\nrange_max_m = 14.5\n"
      "horizontal_deg = 24\nvertical_deg = 40\ntransmit_pattern = \"gaussian\"\n"
      "transmit_beam_width_deg = 9\nreceivers = 1\npings = 56\nping_interval_s = 0.06\n",
      seabed_up_m, with_wall ? wall : "", seed);
}

struct ApertureShadow : testing::Test {
  TestFolder folder;
  std::unique_ptr<const Survey> survey;
  RunRequest request;

  ElementSignals signals_of(bool with_wall, int seed) {
    const SceneDescription description = read_scene_file(folder.write("scene.toml", scene(with_wall, seed)));
    request = request_of(description.run);
    survey = open_survey(description, Facets::merged);
    SimulationStats stats;
    return matched_filtered(element_signals_of(simulate(*survey, request, stats).at(0)),
                            {ApertureWindow::Law::hann});
  }
  /// Returns the visible polygons of a ping in the last scene that was read.
  VisiblePolygons seen_at(std::size_t ping) const {
    const Transmissions transmissions(*survey, request);
    const Transmission transmission = transmissions.of(survey->transmissions.at(0), ping, 0);
    return visible_polygons(transmission.trace(), transmission.model(0).model);
  }
};

/// Returns whether a point of the seabed lies in a polygon, for either orientation of its corners.
bool holds(const VisiblePolygons& seen, glm::dvec2 place) {
  return std::any_of(seen.patches.begin(), seen.patches.end(), [&](const VisiblePolygon& patch) {
    const auto corners = seen.corners(patch);
    bool left = true, right = true;
    for (std::size_t k = 0; k < corners.size() && (left || right); ++k) {
      const glm::dvec3 a = corners[k] + seen.origin_m, b = corners[(k + 1) % corners.size()] + seen.origin_m;
      if (std::abs(a.z - seabed_up_m) > 1e-3) return false;
      const double side = (b.x - a.x) * (place.y - a.y) - (b.y - a.y) * (place.x - a.x);
      left = left && side >= 0;
      right = right && side <= 0;
    }
    return left || right;
  });
}

TEST_F(ApertureShadow, IsWhereTheFootprintsSay) {
  const PixelPlane plane{{5.6, -1.5, seabed_up_m}, {0.04, 0, 0}, {0, 0.06, 0}, 75, 51};
  const std::size_t pixels = plane.columns * plane.rows;
  std::vector<Complex> both(pixels);
  std::vector<double> open(pixels), walled(pixels);
  for (const int seed : {1, 2, 3, 4}) {
    std::vector<Complex> picture[2];
    for (const bool with_wall : {false, true}) {
      const ElementSignals signals = signals_of(with_wall, seed);
      picture[with_wall] =
          back_projected(signals, plane, interpolator_for(signals.waveform, signals.sampling, 1e-4));
    }
    for (std::size_t k = 0; k < pixels; ++k) {
      both[k] += picture[1][k] * std::conj(picture[0][k]);
      open[k] += std::norm(picture[0][k]);
      walled[k] += std::norm(picture[1][k]);
    }
  }
  // The share of the pings that see a pixel, among those whose beam contains it. For white scatterers the
  // directions are independent, so that each counts with the power of the beam.
  std::vector<double> share(pixels), all(pixels);
  for (std::size_t ping = 0; ping < survey->sensors[0].times_s.size(); ++ping) {
    const VisiblePolygons seen = seen_at(ping);
    const glm::dvec3 from = survey->sensors[0].transmission_pose(ping, 0).position_m;
    for (std::size_t k = 0; k < pixels; ++k) {
      const glm::dvec3 place = plane.at(k % plane.columns, k / plane.columns), way = place - from;
      const double angle = std::asin(way.y / glm::length(way)) * 180 / M_PI;
      if (std::abs(angle) > 11) continue;
      const double weight = std::exp(-std::log(2.0) * std::pow(angle / 4.5, 2));
      all[k] += weight;
      if (holds(seen, place)) share[k] += weight;
    }
  }
  for (std::size_t k = 0; k < pixels; ++k) share[k] /= all[k];

  // Returns whether the visible share of a pixel and its neighbourhood lies between limits. The
  // neighbourhood exceeds a resolution cell.
  const auto near_alike = [&](std::size_t k, double least, double most) {
    const auto column = static_cast<int>(k % plane.columns), row = static_cast<int>(k / plane.columns);
    for (int j = -3; j <= 3; ++j)
      for (int i = -4; i <= 4; ++i) {
        const int x = column + i, y = row + j;
        if (x < 0 || y < 0 || x >= int(plane.columns) || y >= int(plane.rows)) continue;
        const double own = share[std::size_t(y) * plane.columns + std::size_t(x)];
        if (own < least || own > most) return false;
      }
    return true;
  };
  struct Sum {
    Complex both = 0;
    double open = 0, walled = 0;
    int pixels = 0;
  };
  const auto sum_of = [&](double least, double most) {
    Sum sum;
    for (std::size_t k = 0; k < pixels; ++k)
      if (near_alike(k, least, most)) {
        sum.both += both[k];
        sum.open += open[k];
        sum.walled += walled[k];
        ++sum.pixels;
      }
    return sum;
  };
  const Sum hidden = sum_of(0, 0), seen = sum_of(1, 1);
  ASSERT_GT(hidden.pixels, 200);
  ASSERT_GT(seen.pixels, 1000);
  EXPECT_LT(hidden.walled / hidden.open, 0.02);
  EXPECT_NEAR(std::abs(seen.both / seen.open - 1.0), 0, 0.02);
  EXPECT_NEAR(seen.walled / seen.open, 1, 0.02);

  // The border along the range: half of the speckle remains at the shadow border of the upper edge of the
  // wall. The polygons of all pings end there.
  constexpr double border_m = 6.05 * 6 / 5;
  double crossing_m = 0, footprint_m = 0, before = 0;
  for (std::size_t column = 15; column < plane.columns; ++column) {
    Complex product = 0;
    double power = 0, of_footprints = 0;
    int rows = 0;
    for (std::size_t row = 0; row < plane.rows; ++row) {
      if (std::abs(plane.at(column, row).y) > 0.42) continue;
      const std::size_t k = row * plane.columns + column;
      product += both[k];
      power += open[k];
      of_footprints += share[k];
      ++rows;
    }
    const double part = product.real() / power, x = plane.at(column, 0).x;
    if (crossing_m == 0 && part > 0.5)
      crossing_m = x - plane.column_step_m.x * (part - 0.5) / (part - before);
    if (footprint_m == 0 && of_footprints > 0.5 * rows) footprint_m = x;
    before = part;
  }
  EXPECT_NEAR(footprint_m, border_m, plane.column_step_m.x);
  // A quarter of a resolution cell on the surface.
  const double slant_m = std::hypot(border_m, seabed_up_m);
  EXPECT_NEAR(crossing_m, border_m, 0.25 * range_resolution_m * slant_m / border_m);

  // At the ends of the wall, where only some pings see the surface, the image has the share of these pings.
  double worst = 0;
  int partly = 0;
  for (const auto& [least, most] : {std::pair{0.15, 0.4}, {0.3, 0.7}, {0.6, 0.85}}) {
    Complex product = 0;
    double power = 0, expected = 0;
    for (std::size_t k = 0; k < pixels; ++k)
      if (share[k] > least && share[k] < most) {
        product += both[k];
        power += open[k];
        expected += share[k] * open[k];
        ++partly;
      }

    worst = std::max(worst, std::abs(product / power - expected / power));
  }
  EXPECT_GT(partly, 100);
  EXPECT_LT(worst, 0.12);
}

}  // namespace
}  // namespace tubefoot
