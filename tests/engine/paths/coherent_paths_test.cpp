// SPDX-License-Identifier: GPL-3.0-or-later
// Tests coherent signals over mirrors. The comparisons are Lloyd's mirror, sums over images that the test
// makes by hand, reciprocity, energies, and the image series of a channel.

#include "engine/paths/coherent_paths.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <numbers>

#include "engine/signal/gated_covariance.hpp"
#include "engine/signal/smooth_amplitude.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/world/path_scenes.hpp"
#include "fixtures/world/refracted_rays.hpp"

namespace tubefoot {
namespace {

using namespace test;
using Complex = std::complex<double>;

constexpr double c = 1500;

/// Images of a `Setting`, and the signal model between its apexes.
struct Mirrored {
  explicit Mirrored(const Setting& setting, std::vector<Complex> of_materials = {})
      : s(setting), phase(std::move(of_materials)), tree(s.mesh), model(s.model(s.transmit)) {
    s.reflection.resize(s.mu.size());
    settings = s.paths;
    settings.mirrors.reflection = s.reflection;
    settings.mirrors.phase = phase;
    images = std::make_unique<PathImages>(s.mesh, tree, unit, s.options, s.transmit, s.receive, settings,
                                          s.absorption_db_per_m);
  }
  Mirrored(const Mirrored&) = delete;

  Setting s;
  std::vector<Complex> phase;
  SceneTree tree;
  EchoModel model;
  PathSettings settings;
  std::unique_ptr<PathImages> images;
};

CoherentReceiver receiver_of(std::vector<SignalChannel> channels, double carrier_hz, double sigma_s,
                             SignalTimes times) {
  CoherentReceiver receiver;
  receiver.channels = std::move(channels);
  receiver.pulse = gaussian_pulse(sigma_s);
  receiver.times = times;
  receiver.carrier_hz = carrier_hz;
  receiver.sound_speed_m_s = c;
  return receiver;
}

/// A single scatterer on a small square of material 0.
struct LoneScatterer {
  SurfaceField field;
  glm::dvec3 at_m{0}, normal{0};
  Complex amplitude = 0;

  /// `u`, `v`: half edges. The corners should be on the grid. Otherwise the facets tilt against each other
  /// by more than the phase tolerance. The constructor takes the first seed from 1 that gives exactly one
  /// scatterer.
  LoneScatterer(Setting& s, glm::dvec3 middle, glm::dvec3 u, glm::dvec3 v) {
    normal = glm::normalize(glm::cross(u, v));
    std::array<glm::dvec3, 4> corners{middle - u - v, middle + u - v, middle + u + v, middle - u + v};
    for (glm::dvec3& corner : corners) corner = metres(at(corner));
    add_quad(s.mesh, corners[0], corners[1], corners[2], corners[3], 0);
    field.spacing_m = 3 * glm::length(u);
    for (field.seed = 1;; ++field.seed) {
      int count = 0;
      field.for_scatterers(corners, normal, [&](glm::dvec3 place, Complex z) {
        ++count;
        at_m = place;
        amplitude = z;
      });
      if (count == 1) break;
    }
  }

  /// Returns amplitude and phase of one leg to or from the scatterer. The amplitude is Lambert's sine over
  /// the range squared.
  Complex leg(glm::dvec3 from, double k) const {
    const glm::dvec3 way = from - at_m;
    const double r = glm::length(way);
    return std::polar(std::sqrt(glm::dot(way, normal) / r) / r, k * r);
  }
};

/// A transmitter, receiver or element, and its images as the test makes them.
struct Source {
  glm::dvec3 at_m;
  Complex reflection = 1;
  int mirrors = 0;
};

/// Computes the return of a scatterer over all pairs of sources with fewer than `order` mirrors.
std::vector<Complex> returned(const LoneScatterer& one, double mu, const std::vector<Source>& sent,
                              const std::vector<Source>& received, int order,
                              const CoherentReceiver& receiver) {
  const double k = 2 * pi * receiver.carrier_hz / c;
  std::vector<Complex> y(receiver.times.count);
  for (const Source& t : sent)
    for (const Source& r : received) {
      if (t.mirrors + r.mirrors >= order) continue;
      const double way = glm::distance(t.at_m, one.at_m) + glm::distance(r.at_m, one.at_m);
      for (std::size_t n = 0; n < y.size(); ++n)
        y[n] += std::sqrt(mu) * one.amplitude * t.reflection * r.reflection * one.leg(t.at_m, k) *
                one.leg(r.at_m, k) * receiver.pulse.at(receiver.times.time_s(n) - way / c);
    }
  return y;
}

ChannelSignals all_signals(const Mirrored& m, const CoherentReceiver& receiver, const SurfaceField& field) {
  ChannelSignals sum = mirrored_signals(*m.images, receiver, m.model, field);
  if (m.images->one_place()) {
    const History history = TubeEngine(m.s.mesh, m.tree, unit, {}).trace(m.s.transmit);
    superpose(element_signals(visible_polygons(history, m.model), receiver, m.model, field), 1, sum);
  } else {
    const BistaticHistory history = trace_bistatic(m.s.mesh, m.tree, unit, {}, m.s.transmit, m.s.receive);
    superpose(element_signals(visible_polygons(history, m.model), receiver, m.model, field), 1, sum);
  }
  return sum;
}

void expect_near_signals(const ChannelSignals& found, std::size_t channel,
                         const std::vector<Complex>& expected, double tolerance) {
  double loudest = 0, worst = 0;
  for (std::size_t n = 0; n < expected.size(); ++n) {
    loudest = std::max(loudest, std::abs(expected[n]));
    worst = std::max(worst, std::abs(found.at(channel, n) - expected[n]));
  }
  ASSERT_GT(loudest, 0);
  EXPECT_LT(worst, tolerance * loudest) << "channel " << channel;
}

glm::dvec3 mirrored_up(glm::dvec3 p) { return {p.x, p.y, -p.z}; }

// Lloyd's mirror: the direct and the surface path, on both legs, give (a e^{ikr} - a' e^{ikr'})^2 for a
// scatterer that a steady tone insonifies.
TEST(CoherentPaths, LloydsMirrorHasItsFringesOverDepth) {
  const double k = 2 * pi * 5000 / c;
  Setting s;
  const LoneScatterer one(s, {60, 0.3, -10}, {0, 0.01, 0}, {0, 0, -0.01});
  s.mu = {0.1};
  s.paths.order = 3;
  s.paths.mirrors.surface = SeaSurface{0, 1, 0};
  s.paths.arrivals = false;
  ASSERT_GT(one.normal.x * -1, 0.99);
  const auto further = [&](double depth) {
    return glm::distance({0, 0, depth}, one.at_m) - glm::distance({0, 0, -depth}, one.at_m);
  };
  // Returns the depth at which the surface path is longer by the given number of wavelengths.
  const auto depth_of = [&](double wavelengths) {
    double low = 0.1, high = 9;
    for (int n = 0; n < 60; ++n) {
      const double middle = (low + high) / 2;
      (further(middle) < wavelengths * 0.3 ? low : high) = middle;
    }
    return low;
  };
  const auto loudness = [&](double depth) {
    const glm::dvec3 sonar = metres(at({0, 0, -depth}));
    s.transmit = s.receive = towards(sonar, {60, 0, 0}, 20, 2, 400);
    const Mirrored m(s);
    const CoherentReceiver receiver =
        receiver_of({{sonar, sonar}}, 5000, 8e-3, {2 * glm::distance(sonar, one.at_m) / c, 1000, 1});
    const ChannelSignals y = all_signals(m, receiver, one.field);
    const std::vector<Source> ends{{sonar}, {mirrored_up(sonar), -1, 1}};
    expect_near_signals(y, 0, returned(one, 0.1, ends, ends, 3, receiver), 1e-5);
    const std::vector<Source> straight{{sonar}};
    return std::norm(y.at(0, 0) / returned(one, 0.1, straight, straight, 1, receiver)[0]);
  };
  for (const double n : {1.0, 2.0, 3.0}) {
    EXPECT_LT(loudness(depth_of(n)), 1e-4) << n;
    // four equal amplitudes, less the difference in spreading loss
    EXPECT_GT(loudness(depth_of(n - 0.5)), 14) << n;
    EXPECT_NEAR(loudness(depth_of(n - 0.75)), 4, 0.3) << n;
  }
  EXPECT_NEAR(k * 0.3, 2 * pi, 1e-12);
}

/// Two perpendicular mirrors: a rough surface above and a wall ahead. Transmitter and receiver are
/// separate, and elements lie next to the apexes.
struct Corner {
  static constexpr double mu = 0.2, wall_x = 20;
  Setting s;
  LoneScatterer one;
  Complex wall = std::polar(1.0, 0.7);

  Corner(int order, double roughness = 0) : one(s, {11, 3, -9}, {1.0 / 64, 0, -1.0 / 256}, {0, 1.0 / 64, 0}) {
    add_quad(s.mesh, {wall_x, -60, -60}, {wall_x, 60, -60}, {wall_x, 60, -0.01}, {wall_x, -60, -0.01}, 1);
    s.mu = {mu, 0};
    s.reflection = {0, 0.5};
    s.transmit = around({0, 0, -4}, -85, 85, 6, 400);
    s.receive = around({1.5, -2, -6}, -85, 85, 6, 400);
    s.paths.order = order;
    s.paths.direct = true;
    s.paths.mirrors.surface = SeaSurface{0, 0.8, roughness};
    s.absorption_db_per_m = 0.02;
  }
  std::vector<Source> sources(glm::dvec3 end, int most) const {
    const auto beyond = [](glm::dvec3 p) { return glm::dvec3(2 * wall_x - p.x, p.y, p.z); };
    const double up = -std::sqrt(0.8);
    const Complex on = std::sqrt(0.5) * wall;
    std::vector<Source> all{{end}};
    if (most > 0) {
      all.push_back({mirrored_up(end), up, 1});
      all.push_back({beyond(end), on, 1});
    }
    if (most > 1) all.push_back({mirrored_up(beyond(end)), up * on, 2});
    return all;
  }
  CoherentReceiver receiver() const {
    const glm::dvec3 t(0, 0, -4), r(1.5, -2, -6);
    return receiver_of({{t + glm::dvec3(0.07, -0.04, 0.1), r},
                        {t, r + glm::dvec3(-0.11, 0.06, 0.05)},
                        {t + glm::dvec3(0, 0.12, 0), r + glm::dvec3(0.03, 0.08, -0.09)}},
                       20e3, 4e-4, {5e-3, 10e3, 800});
  }
};

// Law Y6: images of elements are mirror images of their own positions, for any apexes. Each path counts
// once.
TEST(CoherentPaths, AreSumsOverImagesThatAreMadeByHand) {
  for (const int order : {1, 2, 3}) {
    Corner corner(order);
    corner.s.paths.arrivals = false;
    corner.s.absorption_db_per_m = 0;
    const Mirrored m(corner.s, {1, corner.wall});
    const CoherentReceiver receiver = corner.receiver();
    const ChannelSignals y = all_signals(m, receiver, corner.one.field);
    for (std::size_t n = 0; n < receiver.channels.size(); ++n) {
      const SignalChannel& channel = receiver.channels[n];
      expect_near_signals(y, n,
                          returned(corner.one, corner.mu, corner.sources(channel.transmit_m, 2),
                                   corner.sources(channel.receive_m, 2), order, receiver),
                          1e-5);
    }
  }
}

// Law Y7.
TEST(CoherentPaths, AreReciprocal) {
  Corner corner(3, 2.5);
  const Mirrored there(corner.s, {1, corner.wall});
  CoherentReceiver receiver = corner.receiver();
  const auto pattern = [](glm::dvec3 axis) {
    return Directivity{Directivity::Kind::line, glm::normalize(axis), false, 0.1, 2.5};
  };
  receiver.channels[0].transmit = pattern({1, 2, 3});
  receiver.channels[0].receive = pattern({-2, 1, 1});
  receiver.channels[1].receive = pattern({0, 0, 1});
  const ChannelSignals sent = all_signals(there, receiver, corner.one.field);
  std::swap(corner.s.transmit, corner.s.receive);
  const Mirrored back(corner.s, {1, corner.wall});
  for (SignalChannel& channel : receiver.channels) {
    std::swap(channel.transmit_m, channel.receive_m);
    std::swap(channel.transmit, channel.receive);
  }
  const ChannelSignals rx = all_signals(back, receiver, corner.one.field);
  for (std::size_t n = 0; n < receiver.channels.size(); ++n) {
    const auto begin = rx.value.begin() + std::ptrdiff_t(n * rx.samples);
    expect_near_signals(sent, n, {begin, begin + std::ptrdiff_t(rx.samples)}, 1e-9);
  }
}

/// A seabed with a tilted plate that reflects, under a rough surface.
Setting furnished_seabed(bool apart) {
  Setting s;
  s.mesh = square_seabed(-12, 12);
  add_quad(s.mesh, {-4, 6, -12}, {4, 7, -12}, {4, 8, -6}, {-4, 7, -6}, 1);
  s.mu = {0.02, 0.05};
  s.reflection = {0, 0.4};
  s.transmit = around({0, 0, -5}, -88, 88, 4, 120);
  s.receive = apart ? around({1, -2, -7}, -88, 88, 4, 120) : s.transmit;
  s.samples = {0, 1, 60};
  s.paths.order = 3;
  s.paths.arrivals = false;
  s.paths.mirrors.surface = SeaSurface{0, 0.7, 1.5};
  s.absorption_db_per_m = 0.03;
  return s;
}

// Each path has the energy that the energy engine computes for it. The test compares variances over all
// time, with losses, rough surfaces and patterns.
TEST(CoherentPaths, TheirVariancesAreEnergies) {
  const Directivity sent{Directivity::Kind::gaussian, glm::normalize(glm::dvec3(0.3, 0.5, -0.8)), true, 0,
                         1.5},
      received{Directivity::Kind::gaussian, glm::normalize(glm::dvec3(-0.2, 0.4, 0.7)), true, 0, 1.8};
  for (const bool apart : {false, true}) {
    const Setting s = furnished_seabed(apart);
    const Mirrored m(s);
    BeamPatterns patterns{{sent}, {received}, {}, {}};
    patterns.fan_of_tube.assign(s.receive.tubes.size(), 0);
    patterns.beams_of_tube.assign(s.receive.tubes.size(), {0, 1});
    const PathEcho energies = s.run(&patterns);
    const CoherentReceiver receiver = receiver_of(
        {{metres(s.transmit.apex), metres(s.receive.apex), sent, received}}, 10e3, 1e-3, {0, 2100, 180});
    std::vector<SignalSample> samples;
    for (std::uint32_t n = 0; n < receiver.times.count; ++n) samples.push_back({0, n});
    std::vector<double> by_order(4);
    std::size_t paths = 0;
    for_coherent_paths(*m.images, m.model, receiver.channels, [&](const CoherentPath& path) {
      ++paths;
      CoherentReceiver own = receiver;
      own.channels = path.channels;
      const CovarianceMatrix r = signal_covariances(path.patches, own, samples, path.model, 1e-5);
      for (std::size_t n = 0; n < samples.size(); ++n)
        by_order[path.order] += r.at(n, n).real() / receiver.times.rate_hz;
      EXPECT_NEAR(std::abs(path.phase), 1, 1e-15);
    });
    EXPECT_GE(paths, 6u);
    for (const std::size_t order : {2, 3}) {
      const double energy = total(energies.by_order[order]);
      EXPECT_GT(energy, 0);
      EXPECT_NEAR(by_order[order], energy, 1e-4 * energy) << apart << " order " << order;
    }
  }
}

// In the mean over surface realisations, the energies of two different paths add up. The two directions
// along one path are the same signal twice.
TEST(CoherentPaths, OverSurfacesTheyAddUpAsEnergiesExceptForOneRoundPath) {
  const Setting s = furnished_seabed(false);
  const Mirrored m(s);
  const glm::dvec3 at = metres(s.transmit.apex);
  const CoherentReceiver receiver =
      receiver_of({{at, at}, {at + glm::dvec3(1.5, 0, 0.5), at}}, 20e3, 1e-4, {0, 25e3, 1600});
  std::array<double, 2> together{}, alone{};
  constexpr int surface_meshes = 12;
  for (int seed = 1; seed <= surface_meshes; ++seed) {
    const SurfaceField field{std::uint64_t(seed), 0.25};
    ChannelSignals sum{2, receiver.times.count, {}};
    sum.value.assign(sum.channels * sum.samples, 0);
    CoherentReceiver own = receiver;
    for_coherent_paths(*m.images, m.model, receiver.channels, [&](const CoherentPath& path) {
      // One leg is direct, and the other leg goes over the surface.
      if (path.order != 2 ||
          path.sent->leg.loss.rough_normals.size() + path.received->leg.loss.rough_normals.size() != 1)
        return;
      own.channels = path.channels;
      const ChannelSignals y = element_signals(path.patches, own, path.model, field);
      for (std::size_t n = 0; n < y.value.size(); ++n) alone[n / y.samples] += std::norm(y.value[n]);
      superpose(y, path.phase, sum);
    });
    for (std::size_t n = 0; n < sum.value.size(); ++n) together[n / sum.samples] += std::norm(sum.value[n]);
  }
  EXPECT_NEAR(together[0] / alone[0], 2, 1e-3);
  EXPECT_NEAR(together[1] / alone[1], 1, 0.15);
  // This check is not only of ratios: the mean equals the energy within the statistical error.
  Setting surface_only = s;
  surface_only.reflection = {0, 0};
  const double energy = total(surface_only.run().by_order[2]);
  EXPECT_NEAR(alone[0] / surface_meshes / receiver.times.rate_hz, energy, 0.15 * energy);
}

// Nodes that represent many scatterers resolve the amplitude that a rough surface leaves.
TEST(CoherentPaths, ResolveWhatARoughSurfaceLeaves) {
  Setting s = under_surface(3);
  s.mesh = FacetMesh();
  add_quad(s.mesh, {-6, 15, -12}, {-6, 15, -0.5}, {6, 15, -0.5}, {6, 15, -12});
  s.transmit = s.receive = around({0, 0, -1}, -88, 88, 2, 120);
  s.paths.arrivals = false;
  s.paths.mirrors.surface->roughness = 300;
  const Mirrored m(s);
  const glm::dvec3 at = metres(s.transmit.apex);
  CoherentReceiver receiver = receiver_of({{at, at}}, 3e3, 3e-3, {0, 2e3, 120});
  std::size_t paths = 0;
  for_coherent_paths(*m.images, m.model, receiver.channels, [&](const CoherentPath& path) {
    ++paths;
    receiver.channels = path.channels;
    const SurfaceField field{7, 0.05};
    const ChannelSignals fine = element_signals(path.patches, receiver, path.model, field, 1e-8),
                         coarse = element_signals(path.patches, receiver, path.model, field, 1e-3);
    expect_near_signals(coarse, 0, fine.value, 1e-3);
  });
  EXPECT_EQ(paths, 3u);
}

// A smooth plate seen over a wall has the value that the signals sheet gives for a square of 0.2 m. The
// receiver of the sheet is the mirror image of the receiver here.
TEST(CoherentPaths, ASmoothPlateOverAWallIsThatOfTheImage) {
  constexpr double finer = 64;
  Setting s;
  const auto quad = [&](glm::dvec3 a, glm::dvec3 b, glm::dvec3 d, glm::dvec3 e, std::uint16_t material) {
    add_quad(s.mesh, finer * a, finer * b, finer * d, finer * e, material);
  };
  quad({-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0.1, 0.1, 0}, {-0.1, 0.1, 0}, 0);
  quad({0.2, -1, -1}, {0.2, 1, -1}, {0.2, 1, 2}, {0.2, -1, 2}, 1);
  s.mu = {1, 1};
  s.reflection = {0, 1};
  s.transmit = around(finer * glm::dvec3(-0.2, 0.05, 1), -89, 60, 4, 10 * finer);
  s.receive = around(finer * glm::dvec3(0.1, -0.1, 0.8), -89, 60, 4, 10 * finer);
  s.paths.order = 2;
  const SceneTree tree(s.mesh);
  PathSettings settings = s.paths;
  settings.mirrors.reflection = s.reflection;
  const PathImages images(s.mesh, tree, unit / finer, {}, s.transmit, s.receive, settings, 0);
  const double k = 2 * pi * 100e3 / c;
  SmoothAmplitude amplitude(std::span(&k, 1), 0);
  const SmoothSurface rigid;
  Complex p = 0;
  int told = 0;
  EchoModel model{s.mu, s.mesh.material};
  model.path.tx.apex_m = {-0.2, 0.05, 1};
  const std::array<SignalChannel, 1> channel{{{{-0.2, 0.05, 1}, {0.1, -0.1, 0.8}}}};
  for_coherent_paths(images, model, channel, [&](const CoherentPath& path) {
    if (path.received->mirrors == 0) return;
    ++told;
    EXPECT_LT(glm::distance(path.channels[0].receive_m, glm::dvec3(0.3, -0.1, 0.8)), 1e-7);
    EXPECT_EQ(path.channels[0].transmit_m, glm::dvec3(-0.2, 0.05, 1));
    Complex one = 0;
    amplitude.add(
        images.history(*path.sent, *path.received),
        [&](FacetId facet) { return s.mesh.material[facet] == 0 ? &rigid : nullptr; }, std::span(&one, 1));
    p += path.phase * one;
  });
  EXPECT_EQ(told, 1);
  EXPECT_LT(std::abs(p - Complex(0.318785111189, -0.343830832103)), 1e-5);
}

// Unscattered arrivals over surface and seabed are the image series with signs, for elements next to the
// apexes.
TEST(CoherentArrivals, OfAChannelAreTheImageSeries) {
  constexpr int order = 4;
  Setting s;
  s.mesh = square_seabed(-20, 150);
  s.transmit = around({0, 0, -5}, -86, 86, 2, 180);
  s.receive = around({100, 0, -10}, -86, 86, 2, 180);
  s.mu = {1e-30};
  s.reflection = {0.25};
  s.paths.order = order;
  s.paths.cutoff_db = 300;
  s.paths.direct = true;
  s.paths.mirrors.surface = SeaSurface{0, 0.8, 0.4};
  s.absorption_db_per_m = 0.01;
  const Mirrored m(s);
  const Directivity line{Directivity::Kind::line, {0, 0, 1}, false, 0.05, 12};
  CoherentReceiver receiver =
      receiver_of({{{0, 0, -5}, {100, 0, -10}}, {{0.1, 0.2, -4.9}, {99.8, -0.1, -10.15}, line, line}}, 12e3,
                  1e-4, {0.06, 30e3, 600});
  ChannelSignals y{2, receiver.times.count, {}};
  y.value.assign(2 * receiver.times.count, 0);
  std::size_t arrivals = 0;
  for_coherent_arrivals(*m.images, m.model, receiver.channels, [&](const CoherentArrival& arrival) {
    ++arrivals;
    EXPECT_EQ(arrival.order, arrival.sent->mirrors);
    add_arrival(arrival, receiver, y);
  });
  EXPECT_EQ(arrivals, 1u + 2 * order);
  for (std::size_t channel = 0; channel < 2; ++channel) {
    const SignalChannel& ends = receiver.channels[channel];
    std::vector<Complex> expected(receiver.times.count);
    for (int n = 0; n <= order; ++n)
      for (int first = 0; first < (n == 0 ? 1 : 2); ++first) {
        double z = ends.transmit_m.z, passes = 1;
        int at_surface = 0;
        for (int turn = 0; turn < n; ++turn) {
          const bool up = (first + turn) % 2 == 0;
          z = up ? -z : -40 - z;
          at_surface += up;
          passes *= up ? -std::sqrt(0.8) : 0.5;
        }
        const glm::dvec3 way = ends.receive_m - glm::dvec3(ends.transmit_m.x, ends.transmit_m.y, z);
        const double length = glm::length(way), sine = way.z / length;
        passes *= std::exp(-0.4 * at_surface * sine * sine / 2) * std::pow(10, -0.0005 * length) / length;
        if (channel == 1)  // each mirror exchanges up and down, as seen from the transmitter
          passes *= amplitude_pattern(line, {0, 0, n % 2 == 0 ? sine : -sine}) *
                    amplitude_pattern(line, {0, 0, -sine});
        for (std::size_t t = 0; t < expected.size(); ++t)
          expected[t] += std::polar(passes, 2 * pi * 12e3 / c * length) *
                         receiver.pulse.at(receiver.times.time_s(t) - length / c);
      }
    expect_near_signals(y, channel, expected, 2e-5);
  }
  // Signals over mirrors contain the arrivals, too.
  const ChannelSignals all = mirrored_signals(*m.images, receiver, m.model, {1, 5});
  for (std::size_t n = 0; n < y.value.size(); ++n) EXPECT_NEAR(std::abs(all.value[n] - y.value[n]), 0, 1e-12);
}

TEST(CoherentArrivals, OneSonarReceivesTheSurfaceAboveIt) {
  Setting s = under_surface(1);
  s.transmit = s.receive = towards({1, 2, -5}, {1.001, 2, 0}, 30, 2, 100);
  const Mirrored m(s);
  const std::array<SignalChannel, 2> channels{{{{1, 2, -5}, {1, 2, -5}}, {{1, 2, -5}, {1.3, 2.4, -5}}}};
  int told = 0;
  for_coherent_arrivals(*m.images, m.model, channels, [&](const CoherentArrival& arrival) {
    ++told;
    EXPECT_NEAR(arrival.waves[0].way_m, 10, 1e-12);
    EXPECT_LT(std::abs(arrival.waves[0].amplitude + std::sqrt(0.6) / 10), 1e-12);
    EXPECT_NEAR(arrival.waves[1].way_m, std::hypot(10, 0.5), 1e-12);
  });
  EXPECT_EQ(told, 1);
}

// Law I5.
TEST(ImageOfPlace, IsBehindTheMirrorsAndKnowsFractionsOfTheGrid) {
  const Setting s = furnished_seabed(true);
  const Mirrored m(s);
  const glm::dvec3 apex = metres(s.transmit.apex),
                   place = apex + glm::dvec3(0.1234567891, -0.2, 0.3141592653);
  const glm::dvec3 u = metres(at({4, 7, -12})) - metres(at({-4, 6, -12})),
                   v = metres(at({4, 8, -6})) - metres(at({-4, 6, -12})),
                   n = glm::normalize(glm::cross(u, v)), corner = metres(at({-4, 6, -12}));
  std::size_t leaning = 0;
  for (const Image& image : m.images->sent()) {
    glm::dvec3 by_hand = place;
    for (const MirrorPlane& plane : image.chain) {
      if (plane == MirrorPlane::horizontal(0)) {
        by_hand.z = -by_hand.z;
      } else {
        ++leaning;
        by_hand -= 2 * glm::dot(n, by_hand - corner) * n;
      }
    }
    EXPECT_LT(glm::distance(image_of_place(place, image.chain, s.transmit.apex, apex, unit), by_hand), 1e-12);
    // The image of the apex itself lies on the grid, in agreement with the chain of images.
    EXPECT_LT(glm::distance(image_of_place(apex, image.chain, s.transmit.apex, apex, unit),
                            metres(image.windows.apex)),
              1.8 * image.mirrors * unit + 1e-15);
  }
  EXPECT_GT(leaning, 1u);
}

TEST(CoherentPaths, AreTheSameForAnyNumberOfThreads) {
  const Corner corner(3, 1.5);
  const auto signals = [&] {
    return mirrored_signals(*Mirrored(corner.s, {1, corner.wall}).images, corner.receiver(),
                            corner.s.model(corner.s.transmit), corner.one.field);
  };
  std::vector<Complex> one;
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    one = signals().value;
  }
  EXPECT_EQ(one, signals().value);
}

template <class Call>
void expect_refusal(const Call& call, const std::string& word) {
  try {
    call();
    ADD_FAILURE() << "nothing was said of " << word;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(CoherentPaths, SayWhatTheyCannotDo) {
  const Corner corner(2);
  const Mirrored m(corner.s);
  const CoherentReceiver receiver = corner.receiver();
  const auto nothing = [](const auto&) {};
  expect_refusal([&] { for_coherent_paths(*m.images, m.model, {}, nothing); }, "channel");
  const std::array<SignalChannel, 1> same{{{{1, 1, -3}, {1, 1, -3}}}};
  expect_refusal([&] { for_coherent_arrivals(*m.images, m.model, same, nothing); }, "channel 0");
  ChannelSignals other{2, 10, std::vector<Complex>(20)};
  expect_refusal([&] { add_arrival({1, nullptr, {{3, 1}}}, receiver, other); }, "do not match");
  expect_refusal([&] { superpose({1, 20, std::vector<Complex>(20)}, 1, other); }, "added");
  for_coherent_paths(*m.images, m.model, receiver.channels, [&](const CoherentPath& path) {
    const BistaticHistory seen = m.images->history(*path.sent, *path.received);
    expect_refusal([&] { visible_polygons(seen, path.model); }, "for_coherent_paths");
    expect_refusal(
        [&] {
          gated_covariances(path.patches, path.channels[0], path.channels[1], {0, 1, 5}, 10, path.model);
        },
        "mirrors");
  });
  Setting refracted = under_surface(2);
  refracted.mesh = square_seabed(-20, 30);
  const WaterColumn column = gradient(-0.5, 1510);
  const PathWater water = water_of(column, 1e-2);
  const SceneTree tree(refracted.mesh);
  PathSettings settings = refracted.paths;
  settings.mirrors.reflection = refracted.reflection;
  const PathImages images(refracted.mesh, tree, unit, {}, refracted.transmit, refracted.receive, settings, 0,
                          &water);
  expect_refusal([&] { for_coherent_paths(images, refracted.model(refracted.transmit), same, nothing); },
                 "straight rays");
  expect_refusal([&] { for_coherent_arrivals(images, refracted.model(refracted.transmit), same, nothing); },
                 "straight rays");
}

}  // namespace
}  // namespace tubefoot
