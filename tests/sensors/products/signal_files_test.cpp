// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the products of element signals. Points have their positions in each picture and file, and
// soundings are those of the seabed. Impossible products are reported with a reason.
#include "sensors/products/signal_files.hpp"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <random>

#include "fixtures/csv_rows.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/packet_reader.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/formats/signals_netcdf.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/fan_page.hpp"
#include "sensors/products/signal_makers.hpp"
#include "sensors/products/signal_soundings.hpp"
#include "sensors/signals/point_signals.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double c = 1500, frequency_hz = 100e3, wavelength_m = c / frequency_hz;
const TransmitWaveform chirp = linear_chirp(90e3, 110e3, 1e-3, 0.2);

VehicleMotion northwards(std::size_t pings, double step_m, const glm::dquat& attitude = {1, 0, 0, 0}) {
  std::vector<double> starts;
  for (std::size_t k = 0; k < pings; ++k) starts.push_back(static_cast<double>(k) * step_m);
  return {{{0, {{0, 0, 0}, attitude}}, {1000, {{0, 1000, 0}, attitude}}}, starts};
}

ElementArray across(std::size_t receivers) { return line_array(receivers, {wavelength_m / 2, 0, 0}); }

/// Index of the largest value of [beam][sample].
std::pair<std::size_t, std::size_t> brightest(const std::vector<Complex>& beams, std::size_t samples) {
  std::size_t best = 0;
  for (std::size_t k = 0; k < beams.size(); ++k)
    if (std::abs(beams[k]) > std::abs(beams[best])) best = k;
  return {best / samples, best % samples};
}

struct SeenPicture {
  int width = 0, height = 0;
  std::vector<float> values;
  Complex hue(int x, int y) const {
    Complex sum = 0;
    for (int k = 0; k < 3; ++k) sum += std::polar(1.0, 2 * pi * k / 3) * double(at(x, y, k));
    return sum;
  }
  float at(int x, int y, int k) const { return values[std::size_t(3 * (y * width + x) + k)]; }
};

SeenPicture seen(const std::filesystem::path& file) {
  auto input = OIIO::ImageInput::open(file.string());
  if (!input) throw std::logic_error(OIIO::geterror());
  SeenPicture picture{input->spec().width, input->spec().height, {}};
  picture.values.resize(std::size_t(3 * picture.width * picture.height));
  if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, picture.values.data()))
    throw std::logic_error(input->geterror());
  return picture;
}

/// A level seabed of points in a strip across the track, as narrow as the insonified sector of a
/// transmission.
std::vector<PointScatterer> level_seabed(double depth_m, double half_width_m, std::size_t count,
                                         unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  std::normal_distribution<double> normal;
  std::vector<PointScatterer> points;
  for (std::size_t k = 0; k < count; ++k) {
    const double east = half_width_m * share(random), north = 0.1 * share(random), real = normal(random);
    points.push_back({{east, north, -depth_m}, {real, normal(random)}});
  }
  return points;
}

TEST(SignalProducts, FansHavePointsInTheirCells) {
  for (const auto plane : {SignalFan::Plane::forward, SignalFan::Plane::across_track}) {
    const SignalFan fan{plane,
                        61,
                        radians(90),
                        plane == SignalFan::Plane::forward ? radians(15) : 0,
                        {ApertureWindow::Law::hann}};
    const std::vector<double> angles = fan.angles_rad();
    EXPECT_DOUBLE_EQ(angles.front(), -radians(45));
    EXPECT_DOUBLE_EQ(angles.back(), radians(45));
    const ElementArray array = across(32);
    for (const std::size_t beam : {5u, 30u, 52u}) {
      const double range_m = 4 + 0.05 * double(beam);
      const ElementSignals one =
          compressed_ping(point_signals({{fan.directions()[beam] * range_m, 1}}, array, chirp,
                                        {frequency_hz, 60e3, 0.004, 480}, northwards(1, 1), c),
                          0, {});
      const auto [found, sample] =
          brightest(focused_beams(one, fan, interpolator_for(chirp, one.sampling, 1e-4)), one.samples());
      EXPECT_EQ(found, beam);
      const RangeSamples ranges = ranges_of(one.sampling, c);
      EXPECT_NEAR(ranges.first_m + (double(sample) + 0.5) * ranges.step_m, range_m, 0.5001 * ranges.step_m);
    }
  }
}

TEST(SignalProducts, FansAcrossTheTrackHangDown) {
  std::vector<double> energy(8 * 10), angles;
  for (int k = 0; k < 8; ++k) angles.push_back(0.1 * (k - 3.5));
  energy[1 * 10 + 8] = 1;  // far and to port
  const double largest[] = {1};
  const auto spot = [&](FanPage::Towards towards) {
    const FanPage page(CameraFan(angles, {1, 1, 10}, 400, 400), towards);
    const TestFolder folder;
    page.draw({"", "", ""}, {energy, {}}, DecibelScale(largest), "").write_png(folder / "fan.png", "", 8);
    const SeenPicture picture = seen(folder / "fan.png");
    double x = 0, y = 0, count = 0;
    for (int row = 100; row < picture.height - 70; ++row)
      for (int column = 0; column < picture.width - 130; ++column)
        if (picture.at(column, row, 0) > 0.9f) x += column, y += row, ++count;
    EXPECT_GT(count, 50);
    return std::array{x / count - (picture.width - 96 - 2 * 60 - 56) / 2.0 - 28 - 60,
                      y / count - 100 - page.fan().height() / 2.0};
  };
  const auto up = spot(FanPage::Towards::up), down = spot(FanPage::Towards::down);
  EXPECT_LT(up[0], -20);  // port is left in both
  EXPECT_NEAR(down[0], up[0], 1);
  EXPECT_LT(up[1], -50);
  EXPECT_NEAR(down[1], -up[1], 2);
}

TEST(SignalProducts, SoundsALevelSeabed) {
  constexpr double depth_m = 6;
  SignalMultibeam multibeam;
  multibeam.fan = {SignalFan::Plane::across_track, 61, radians(120), 0, {ApertureWindow::Law::taylor, 30, 4}};
  double outer_amplitude = 0, outer_phase = 0, outer_best = 0, said = 0;
  int outer = 0, inner_by_phase = 0, outer_by_phase = 0;
  for (const unsigned seed : {1u, 2u, 3u}) {
    // Heading east and rolled, starboard down: the beams look further to port than their nominal angles.
    const glm::dquat attitude = attitude_from_angles(radians(90), 0, radians(5));
    std::vector<PointScatterer> seabed = level_seabed(depth_m, 16, 4000, seed);
    for (PointScatterer& point : seabed)
      std::swap(point.position_m.x, point.position_m.y);  // now along north
    const ElementSignals signals = point_signals(seabed, across(48), chirp, {frequency_hz, 40e3, 0.0065, 560},
                                                 northwards(1, 1, attitude), c);
    const SignalSoundings found = signal_soundings(compressed_ping(signals, 0, {}), multibeam,
                                                   interpolator_for(chirp, signals.sampling, 1e-4));
    for (std::size_t beam = 0; beam < 61; ++beam) {
      const double angle = std::abs(multibeam.fan.angles_rad()[beam] - radians(5));
      ASSERT_TRUE(found.amplitude[beam]);
      const Sounding best = *found.best(beam);
      EXPECT_NEAR(best.position_m.z, -depth_m, 0.03 * depth_m) << beam;
      // Starboard of a heading to the east is south.
      EXPECT_NEAR(best.position_m.y, -depth_m * std::tan(multibeam.fan.angles_rad()[beam] - radians(5)),
                  0.3 + 0.05 * depth_m);
      EXPECT_NEAR(best.position_m.x, 0, 1e-9);
      if (angle < radians(5)) inner_by_phase += best.method == DetectionMethod::split_beam;
      if (angle < radians(30) || angle > radians(58) || !found.phase[beam]) continue;
      ++outer;
      outer_by_phase += best.method == DetectionMethod::split_beam;
      // In range: the axis of the beam meets the seabed there.
      const double labels = depth_m / std::cos(multibeam.fan.angles_rad()[beam] - radians(5));
      outer_amplitude += std::pow(found.amplitude[beam]->slant_range_m - labels, 2);
      outer_phase += std::pow(found.phase[beam]->slant_range_m - labels, 2);
      outer_best += std::pow(best.slant_range_m - labels, 2);
      said += std::pow(found.phase_sigma_m[beam], 2);
    }
  }
  EXPECT_GT(outer, 60);
  EXPECT_LT(outer_phase, 0.25 * outer_amplitude);
  EXPECT_LT(outer_best, 0.4 * outer_amplitude);
  EXPECT_GT(outer_by_phase, 0.8 * outer);
  EXPECT_LE(inner_by_phase, 3);
  EXPECT_GT(outer_phase / said, 0.3);
  EXPECT_LT(outer_phase / said, 4);
}

TEST(SignalProducts, HasPhasesOfTwoReceiversWhereTheyAre) {
  // One point and two receivers above each other: the phase is 2 pi f times the difference of delays.
  const glm::dvec3 point(8, 0, -3), upper(0, 0, 0.02), lower(0, 0, -0.02);
  const ElementSignals signals = point_signals({{point, 1}}, ElementArray{{0, 0, 0}, {upper, lower}}, chirp,
                                               {frequency_hz, 40e3, 0.01, 200}, northwards(4, 1e-4), c);
  SignalProducts products;
  products.name = "staff";
  products.elements = false;
  products.interferogram = SignalInterferogram{{0}, {1}, {1, 0, 0}, 2, 2};
  const TestFolder folder;
  std::vector<std::string> warnings;
  const auto files = write_signal_files(folder.path(), signals, products, {}, warnings);
  EXPECT_THAT(files, ElementsAre("staff-signals.nc", "staff-interferogram.png"));
  const SeenPicture picture = seen(folder / "staff-interferogram.png");
  constexpr int left = 28 + 76, width = 360, top = 100 - 28 + 58;
  // The column of the range of the point.
  const RangeSamples ranges = ranges_of(signals.sampling, c);
  const double share = (glm::length(point) - ranges.first_m) / (ranges.count * ranges.step_m);
  const Complex hue = picture.hue(left + static_cast<int>(share * width), top + 30);
  const double expected =
      2 * pi * frequency_hz / c * (glm::length(point - upper) - glm::length(point - lower));
  EXPECT_NEAR(std::abs(hue), 1.5 * 0.45, 0.02);  // brightness follows coherence
  EXPECT_NEAR(std::remainder(std::arg(hue) - expected, 2 * pi), 0, 0.05);
}

/// All products of 6 pings of two points, by a cross of elements.
struct EverythingOfSignals {
  glm::dvec3 point{3, 0.05, -4}, port{-2.4, 0.05, -3.2};
  ElementSignals signals;
  SignalProducts products;
  EverythingOfSignals() : signals(made()) {
    products.name = "cross";
    products.fan = SignalFan{SignalFan::Plane::across_track, 21, radians(100)};
    products.sidescan = SignalSidescan{SignalSidescan::Sides::both, radians(50)};
    products.multibeam.emplace();
    products.multibeam->fan.beams = 31;
    products.aperture = SignalAperture{{{2, -1, -4}, {0.1, 0, 0}, {0, 0.1, 0}, 20, 25}};
    products.interferogram = SignalInterferogram{{0}, {15}, {1, 0, 0}, 3, 2};
    products.jsf = products.sonar_netcdf = true;
    products.ping_numbers = {10, 11, 12, 13, 14, 15};
  }
  ElementSignals made() const {
    ElementArray array = across(16);
    const ElementArray forward = line_array(16, {0, wavelength_m, 0});
    array.receivers_m.insert(array.receivers_m.end(), forward.receivers_m.begin(), forward.receivers_m.end());
    return point_signals({{point, 1}, {port, 1}}, array, chirp, {frequency_hz, 40e3, 0.004, 240},
                         northwards(6, 0.02), c);
  }
};

TEST(SignalProducts, WritesWhatIsRequested) {
  const EverythingOfSignals all;
  const TestFolder folder;
  std::vector<std::string> warnings;
  RunContext run;
  run.start_unix_s = 1714979289;
  const auto files = write_signal_files(folder.path(), all.signals, all.products, run, warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_THAT(files, testing::UnorderedElementsAre(
                         "cross-signals.nc", "cross-signals.png", "cross-fan.png", "cross-sidescan.png",
                         "cross.jsf", "cross-beams.png", "cross-soundings.csv", "cross-soundings.gpkg",
                         "cross-aperture.png", "cross-interferogram.png", "cross-sonar.nc"));
  std::set<std::string> names;
  for (const auto& file : files) names.insert(file.string());
  EXPECT_EQ(names_below(folder.path()), names);
  for (const auto& file : files)
    if (file.extension() == ".png") {
      const SeenPicture picture = seen(folder.path() / file);
      EXPECT_GT(picture.width, 500) << file;
      EXPECT_GT(picture.height, 400) << file;
    }
  EXPECT_EQ(read_signals(folder / "cross-signals.nc").pressure, all.signals.pressure);

  const auto rows = csv_rows(folder / "cross-soundings.csv");
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows.front().at("ping"), "10");
  EXPECT_EQ(rows.back().at("ping"), "15");

  // One message per ping and side, port first. On either side the peak is the point of this side.
  const std::vector<unsigned char> bytes = samples::file_content(folder / "cross.jsf");
  std::size_t messages = 0;
  for (std::size_t begin = 0; begin < bytes.size(); ++messages) {
    samples::PacketReader head{std::span(bytes).subspan(begin, 16), false};
    samples::PacketReader message{std::span(bytes).subspan(begin, 16 + head.u32(12)), false};
    const bool starboard = message.u8(8) == 1;
    EXPECT_EQ(starboard, messages % 2 == 1);
    EXPECT_EQ(message.u32(16 + 8), 10 + messages / 2);
    EXPECT_EQ(message.u32(16 + 4), 160u);  // samples from the transmission to 4 ms
    std::size_t best = 0;
    double most = 0;
    for (std::size_t k = 0; k < 240; ++k)
      if (const double own = std::hypot(message.i16(256 + 4 * k), message.i16(258 + 4 * k)); own > most) {
        most = own;
        best = k;
      }
    const glm::dvec3 away =
        (starboard ? all.point : all.port) - glm::dvec3(0, 0.02 * double(messages / 2), 0);
    EXPECT_NEAR((160 + double(best)) / 40e3 * c / 2, glm::length(away), 0.02) << messages;
    begin += message.size();
  }
  EXPECT_EQ(messages, 12u);

  const NetcdfReader sonar(folder / "cross-sonar.nc");
  const auto real = sonar.lists("/Sonar/Beam_group1", "backscatter_r"),
             imaginary = sonar.lists("/Sonar/Beam_group1", "backscatter_i");
  ASSERT_EQ(real.size(), 6u * 21);
  std::size_t loudest = 0;
  double most = 0;
  for (std::size_t beam = 0; beam < 21; ++beam) {
    ASSERT_EQ(real[beam].size(), 240u);
    for (std::size_t k = 0; k < 240; ++k)
      if (const double own = std::hypot(real[beam][k], imaginary[beam][k]); own > most) {
        most = own;
        loudest = beam;
      }
  }
  EXPECT_NEAR(-50 + 5.0 * double(loudest), -degrees(std::atan2(3, 4)), 2.6);  // that of the nearer point
}

TEST(SignalProducts, OmitWhatTheRunOmits) {
  const EverythingOfSignals all;
  const auto written = [&](const OmittedProducts& omitted) {
    const TestFolder folder;
    std::vector<std::string> warnings;
    RunContext run;
    run.omitted = omitted;
    std::map<std::string, std::string> files;
    const SignalProducts products = without_omitted(all.products, omitted);
    for (const auto& file : write_signal_files(folder.path(), all.signals, products, run, warnings))
      files[file.string()] = bytes_of(folder.path() / file);
    EXPECT_EQ(names_below(folder.path()).size(), files.size());
    return files;
  };
  const auto file_of = [](const std::string& product) {
    return (product == "jsf" ? "cross." : "cross-") + product;
  };
  const auto whole = written({});
  const std::vector<std::string> products = signal_file_products();
  EXPECT_EQ(whole.size(), products.size());
  for (const std::string& product : products) {
    auto kept = whole;
    EXPECT_EQ(kept.erase(file_of(product)), 1u) << product;
    EXPECT_TRUE(written({product}) == kept) << product;
    OmittedProducts others(products.begin(), products.end());
    others.erase(product);
    const std::map<std::string, std::string> alone{{file_of(product), whole.at(file_of(product))}};
    EXPECT_TRUE(written(others) == alone) << product << " alone";
  }
  const SignalProducts nothing = without_omitted(all.products, {products.begin(), products.end()});
  EXPECT_FALSE(nothing.fan || nothing.sidescan || nothing.multibeam || nothing.aperture ||
               nothing.interferogram || nothing.elements || nothing.jsf || nothing.sonar_netcdf);
  const SignalCounts counts{6, 32, 240};
  EXPECT_EQ(cost_of_signal_files(nothing, counts, {}, {products.begin(), products.end()}).bytes, 0);
}

TEST(SignalProducts, AreTheSameByAnyNumberOfThreads) {
  const EverythingOfSignals all;
  const TestFolder several, one;
  std::vector<std::string> warnings;
  const auto files = write_signal_files(several.path(), all.signals, all.products, {}, warnings);
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    write_signal_files(one.path(), all.signals, all.products, {}, warnings);
  }
  for (const auto& file : files)
    EXPECT_TRUE(bytes_of(several.path() / file) == bytes_of(one.path() / file)) << file;
}

TEST(SignalProducts, SayWhyThereAreNoPicturesOfSilence) {
  EverythingOfSignals all;
  all.signals.pressure.assign(all.signals.pressure.size(), 0);
  const TestFolder folder, another;
  std::vector<std::string> warnings;
  EXPECT_THAT(write_signal_files(folder.path(), all.signals, all.products, {}, warnings),
              ElementsAre("cross-signals.nc"));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0],
              HasSubstr("'cross': the receivers receive nothing, so tubefoot computes no pictures"));
  // Pictures that were not requested are not made, and give no warning. Files are made.
  EverythingOfSignals loud;
  RunContext run;
  run.pictures.which = PictureSettings::Which::none;
  warnings.clear();
  EXPECT_THAT(write_signal_files(another.path(), loud.signals, loud.products, run, warnings),
              testing::UnorderedElementsAre("cross-signals.nc", "cross.jsf", "cross-soundings.csv",
                                            "cross-soundings.gpkg", "cross-sonar.nc"));
  EXPECT_TRUE(warnings.empty());
}

TEST(SignalProducts, KnowWhatTheyCost) {
  const EverythingOfSignals all;
  const SignalCounts counts{6, 32, 240}, more{60, 32, 240};
  const PictureSettings pictures;
  EXPECT_GE(cost_of_signal_files(all.products, counts, pictures).bytes, 16.0 * 6 * 32 * 240);
  EXPECT_GT(cost_of_signal_files(all.products, more, pictures).shared_seconds,
            5 * cost_of_signal_files(all.products, counts, pictures).shared_seconds);
  SignalProducts without = all.products;
  without.aperture.reset();
  // An aperture stores all pings.
  EXPECT_GE(memory_of_signal_files(all.products, more) - memory_of_signal_files(without, more),
            16.0 * 60 * 32 * 240);
}

TEST(SignalProducts, RefuseWhatIsNone) {
  const EverythingOfSignals all;
  const auto refused = [&](const auto& change, const std::string& what, std::size_t pings = 6) {
    SignalProducts products = all.products;
    products.ping_numbers.clear();
    ElementArray array = all.signals.array;
    change(products, array);
    expect_refused([&] { check(products, array, {pings, array.receivers_m.size(), 240}); }, what);
  };
  using P = SignalProducts;
  using A = ElementArray;
  refused([](P& p, A&) { p.name = "a/b"; }, "'a/b' cannot be a file name");
  refused([](P& p, A&) { p.fan->beams = 0; }, "the fan has 0 beams, but must have 2 to 4096");
  refused([](P& p, A&) { p.fan->opening_rad = 4; }, "at most 180");
  refused([](P& p, A&) { p.fan->depression_rad = 0.1; }, "its depression must be 0");
  refused([](P& p, A&) { p.multibeam->fan.plane = SignalFan::Plane::forward; },
          "need a fan across the track");
  refused(
      [](P& p, A& a) {
        a.receivers_m.resize(1);
        p.sidescan.reset();
        p.jsf = false;
        p.interferogram.reset();
      },
      "the 1 receiver does not extend across");
  refused(
      [](P& p, A& a) {
        a = line_array(4, {0, 0.1, 0});
        p.interferogram.reset();
      },
      "these lie on a line along the forward axis: use one side");
  refused(
      [](P& p, A& a) {
        a = line_array(4, {0, 0.1, 0});
        p.interferogram.reset();
        p.sidescan.reset();
        p.jsf = false;
        p.fan->window.law = ApertureWindow::Law::hann;
      },
      "needs receivers at different positions along the axis of its weights");
  refused([](P& p, A&) { p.fan->window.law = ApertureWindow::Law::chebyshev; }, "use the Taylor window");
  refused([](P& p, A&) { p.aperture->plane.columns = 1 << 20; }, "use larger pixels");
  refused([](P& p, A&) { p.aperture->plane.row_step_m = {}; }, "0.1 x 0 m, but must be above 0");
  refused([](P&, A&) {}, "a synthetic aperture needs two or more pings", 1);
  refused([](P& p, A&) { p.interferogram->lower = {99}; },
          "no lower receiver 99 for the interferogram: receivers are 0 to 31");
  refused([](P& p, A&) { p.interferogram->lower = p.interferogram->upper; }, "are the same");
  refused([](P& p, A&) { p.interferogram->looks_pings = 7; }, "a cell must have at least 1 of each");
  refused([](P& p, A&) { p.sidescan.reset(); }, "add a sidescan");
  refused(
      [](P& p, A&) {
        p.multibeam.reset();
        p.fan.reset();
      },
      "add a fan or a multibeam");
  refused([](P& p, A&) { p.picture_ping = 6; }, "there is no ping 6 to draw: the signals have 6 pings");
  refused([](P& p, A&) { p.ping_numbers = {1}; }, "1 ping numbers for 6 pings");
  EXPECT_NO_THROW(check(all.products, all.signals.array, {6, 32, 240}));
}

}  // namespace
}  // namespace tubefoot
