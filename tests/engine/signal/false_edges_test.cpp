// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the echo of a shadow border on a smooth plane. Kirchhoff's approximation gives the border an echo.
// Kirchhoff's approximation of second order has other echoes instead (docs/notes/smooth-surfaces.md, "False
// edges").
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "engine/signal/smooth_amplitude.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

double db(double ratio) { return 20 * std::log10(ratio); }
Complex phasor(double phase) { return {std::cos(phase), std::sin(phase)}; }

/// A sonar above a plane. Between them lies a half-plane parallel to the plane, which covers all positions
/// x > `edge`.
struct Occluder {
  double height_m = 1;     ///< of the sonar
  double above_m = 0.3;    ///< of the half-plane, over the plane
  double angle_rad = 0.5;  ///< of the ray to its edge, from the vertical

  double to_edge_m() const { return (height_m - above_m) / std::cos(angle_rad); }
  double to_border_m() const { return height_m / std::cos(angle_rad); }
  double edge_m() const { return (height_m - above_m) * std::tan(angle_rad); }
  /// Distance from the edge over the plane to the sonar.
  double rx_m() const { return std::hypot(edge_m(), height_m + above_m); }
  double rx_angle_rad() const { return std::atan(edge_m() / (height_m + above_m)); }
  /// Difference between the path over the border and the path over the edge and the plane.
  double detour_m() const { return 2 * to_border_m() - to_edge_m() - rx_m(); }
};

/// Returns the factor that a straight edge gives to a wave that it turns by an angle. A point source has
/// the further factor e^{ik(r + s)} / sqrt(r s (r + s)). A source that is uniform along the edge has /
/// sqrt(r s). (Kirchhoff's approximation; Keller 1962 has the form.)
double edge_factor(double turned_rad, double k) {
  return 0.5 / std::tan(turned_rad / 2) / std::sqrt(2 * pi * k);
}

// ---- The result of the engine

/// Computes the echo over path lengths of a Gaussian pulse about k0, for the facets that a sonar sees
/// through one tube.
class SeenEcho {
 public:
  SeenEcho(const Occluder& scene, double k0) : k0_(k0), width_(k0 / 8) {
    const WorldGrid grid(20, glm::dvec3(0));
    MeshBuilder builder(grid);
    const double to = 6, edge = scene.edge_m(), up = scene.above_m;
    const std::vector<std::array<std::uint32_t, 3>> two{{0, 1, 2}, {0, 2, 3}};
    builder.add({{-to, -to, 0}, {to, -to, 0}, {to, to, 0}, {-to, to, 0}}, two, 0, 0);
    builder.add({{edge, -to, up}, {to, -to, up}, {to, to, up}, {edge, to, up}}, two, 0, 1);
    MeshReport report;
    const FacetMesh mesh = builder.finish(report);
    const SceneTree tree(mesh);
    TubeSet set{grid.snap({0, 0, scene.height_m}), {}, {}, 1e9};
    AngularGrid angles;
    angles.azimuth_edges_rad = {-1.1, 1.1};
    angles.elevation_edges_rad = {-1.05, 1.05};
    angles.frame = glm::dmat3(glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0));
    append_tubes(set, angles);
    const History history = TubeEngine(mesh, tree, grid.unit_m(), {}).trace(set);
    constexpr int waves = 200;
    for (int n = 0; n < waves; ++n) k_.push_back(k0 + width_ * (8.0 * (n + 0.5) / waves - 4));
    spectrum_.resize(k_.size());
    const SmoothSurface rigid;
    SmoothAmplitude(k_, 0).add(
        history, [&](FacetId) { return &rigid; }, spectrum_);
  }
  double at(double path_m) const {
    Complex sum = 0;
    double weights = 0;
    for (std::size_t n = 0; n < k_.size(); ++n) {
      const double x = (k_[n] - k0_) / width_, weight = std::exp(-0.5 * x * x);
      sum += weight * spectrum_[n] * phasor(-k_[n] * path_m);
      weights += weight;
    }
    return std::abs(sum) / weights;
  }

 private:
  double k0_, width_;
  std::vector<double> k_;
  std::vector<Complex> spectrum_;
};

// The echo of the shadow border is as strong as that of the edge of the occluder, except for the path
// length. It is 3 dB per octave below the echo of the plane.
TEST(FalseEdges, AreAsLoudAsTrueOnes) {
  for (const Occluder& scene : {Occluder{2, 0.6, 0.45}, Occluder{2, 1.1, 0.35}, Occluder{2, 0.3, 0.7}})
    for (const double k : {200.0, 400.0, 800.0}) {
      const SeenEcho echo(scene, k);
      const double plane = echo.at(2 * scene.height_m), false_edge = echo.at(2 * scene.to_border_m()),
                   true_edge = echo.at(2 * scene.to_edge_m()), r = scene.to_border_m();
      EXPECT_NEAR(plane, 1 / (2 * scene.height_m), 1e-3);
      const double model = edge_factor(2 * scene.angle_rad, k) / std::sqrt(2 * r * r * r);
      EXPECT_NEAR(db(false_edge / model), 0, 0.1) << k;
      EXPECT_NEAR(
          model / plane,
          std::pow(std::cos(scene.angle_rad), 2) / (2 * std::sin(scene.angle_rad) * std::sqrt(pi * k * r)),
          1e-2 * model / plane);
      EXPECT_NEAR(false_edge / true_edge, std::pow(scene.to_edge_m() / scene.to_border_m(), 1.5), 0.02);
    }
}

// The second order has an echo over the edge of the occluder, the plane and the sonar, or in reverse order.
// The engine computes the integral of the occluder between the sonar and its image in edge form.
TEST(FalseEdges, AreByTheEdgeAndThePlaneInSecondOrder) {
  const Occluder scene{2, 0.6, 0.45};
  const double to = 40, edge = scene.edge_m();
  const PlanarPolygon plate = test::planar({{edge, -to}, {to, -to}, {to, to}, {edge, to}}, 1.4);
  for (const double k0 : {200.0, 800.0}) {
    std::vector<double> k;
    for (int n = 0; n < 400; ++n) k.push_back(k0 / 8 * (8.0 * (n + 0.5) / 400 - 4) + k0);
    std::vector<Complex> blocked(k.size());
    // The test mirrors the image at the plane of the occluder, which gives the same integral with both ends
    // on one side.
    SmoothAmplitude(k, 0).add(plate, {scene.height_m + scene.above_m, {0, 0}}, {}, blocked);
    const auto at = [&](double path_m) {
      Complex sum = 0;
      double weights = 0;
      for (std::size_t n = 0; n < k.size(); ++n) {
        const double weight = std::exp(-0.5 * std::pow((k[n] - k0) * 8 / k0, 2));
        sum += weight * blocked[n] * phasor(-k[n] * path_m);
        weights += weight;
      }
      return std::abs(sum) / weights;
    };
    const double tx = scene.to_edge_m(), rx = scene.rx_m();
    const double model =
        edge_factor(scene.angle_rad + scene.rx_angle_rad(), k0) / std::sqrt(tx * rx * (tx + rx));
    EXPECT_NEAR(db(at(tx + rx) / model), 0, 0.15);
    EXPECT_LT(db(at(2 * scene.to_border_m()) / model), -50);  // nothing at the time of the false edge
    // The echo arrives twice, and is stronger than the false edge that represents it.
    const double border = scene.to_border_m(),
                 false_edge = edge_factor(2 * scene.angle_rad, k0) / std::sqrt(2 * std::pow(border, 3));
    EXPECT_GT(db(2 * model / false_edge), 6);
  }
}

// ---- Second order, uniform along the edge

/// Hankel functions of the first kind, by their asymptotic series: accurate to 1e-8 for x above 10.
struct Hankel {
  Complex h0, h1;
  explicit Hankel(double x) : h0(series(0, x)), h1(series(1, x)) {}
  static Complex series(int order, double x) {
    Complex sum = 1, term = 1;
    for (int m = 1; m <= 14; ++m) {
      term *= Complex(0, (4.0 * order * order - (2.0 * m - 1) * (2.0 * m - 1)) / (8 * m * x));
      sum += term;
    }
    return std::sqrt(2 / (pi * x)) * phasor(x - order * pi / 2 - pi / 4) * sum;
  }
};

/// The wave of a line source, i/4 H0(kr), and its derivatives by the height of the point and by the heights
/// of both ends.
struct LineWave {
  Complex value, by_place, by_both;
  LineWave(double k, double x, double up) {
    const double r = std::hypot(x, up), c = up / r;
    const Hankel hankel(k * r);
    const Complex first = -Complex(0, 0.25 * k) * hankel.h1,
                  second = -Complex(0, 0.25 * k * k) * (hankel.h0 - hankel.h1 / (k * r));
    value = Complex(0, 0.25) * hankel.h0;
    by_place = first * c;
    by_both = -(second * c * c + first * (1 - c * c) / r);
  }
};

/// Echoes of the plane minus the echo of its image, e^{2ikh}: for the exact insonified polygon, and in
/// second order. In second order, the wave on the plane is the Kirchhoff integral behind the occluder, on
/// both legs. With images, and with u(x) the wave at a position, from which the occluder removes u_P,
/// integral of d/dn (u - u_P)^2 = image - 2 u_P(image) + u_PP'(image).
/// P' is the image of the occluder, which removes u_PP' from the wave of P.
struct PlaneEcho {
  Complex image, sharp, second;
};

/// The occluder extends from its edge outwards (the foot point is insonified) or over the foot point (it is
/// hidden). The other end fades over many wavelengths, so that it is not an edge.
PlaneEcho plane_echo(const Occluder& scene, double k, bool foot_is_lit) {
  const double edge = scene.edge_m(), wave_m = 2 * pi / k, h = scene.height_m, up = scene.above_m;
  const double even_m = foot_is_lit ? 0.25 : 0.25 + 2 * edge, fade_m = std::max(0.6, 30 * wave_m);
  // Nodes of Gauss's rule of 4 on panels of a third of a wavelength.
  constexpr std::array node{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526},
      weight{0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
  const int panels = static_cast<int>(std::ceil(3 * (even_m + fade_m) / wave_m));
  const double half = (even_m + fade_m) / panels / 2;
  std::vector<double> x, w;
  for (int p = 0; p < panels; ++p)
    for (std::size_t n = 0; n < node.size(); ++n) {
      const double from_edge = half * (2 * p + 1 + node[n]),
                   v = std::clamp((from_edge - even_m) / fade_m, 0.0, 1.0);
      x.push_back(edge + (foot_is_lit ? from_edge : -from_edge));
      w.push_back(half * weight[n] *
                  (1 - std::pow(v, 5) * (126 - v * (420 - v * (540 - v * (315 - 70 * v))))));
    }
  const double scale = h / (h - up);  // of the shadow
  Complex shadow = 0, once = 0, twice = 0;
  std::vector<LineWave> tx, rx;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const LineWave lit(k, scale * x[n], -h);
    shadow += scale * w[n] * 2.0 * lit.value * lit.by_place;
    tx.emplace_back(k, x[n], up - h);  // from the sonar to the occluder
    // from the image of the sonar to the occluder, and to P' with its sign below
    rx.emplace_back(k, x[n], up + h);
    once += w[n] * (rx[n].value * tx[n].by_place - tx[n].value * rx[n].by_place);
  }
  for (std::size_t m = 0; m < x.size(); ++m) {
    Complex value = 0, by_height = 0;
    for (std::size_t n = 0; n < x.size(); ++n) {
      const LineWave between(k, x[n] - x[m], 2 * up);
      value += w[n] * (between.value * tx[n].by_place - between.by_place * tx[n].value);
      by_height += w[n] * (-between.by_place * tx[n].by_place - between.by_both * tx[n].value);
    }
    const LineWave end(k, x[m], h - up);  // from the image to P'
    twice += w[m] * (end.value * by_height - value * end.by_place);
  }
  const Complex image = LineWave(k, 0, 2 * h).value;
  const Complex whole = foot_is_lit ? 0 : image;
  return {image, whole - shadow, whole - 2.0 * once + twice};
}

// An occluder that covers everything blocks all sound, in either order.
TEST(FalseEdges, NothingIsLeftBehindAWideOccluder) {
  const PlaneEcho echo = plane_echo({1, 0.3, 1.2}, 100, false);
  EXPECT_LT(std::abs(echo.sharp), 0.01 * std::abs(echo.image));
  EXPECT_LT(std::abs(echo.second), 0.01 * std::abs(echo.image));
}

// For a detour of many radians the echoes are separate, and the edge formulas give their strengths.
TEST(FalseEdges, AreNothingOfTheSecondOrderWhereTheDetourIsLong) {
  for (const double k : {200.0, 600.0})
    for (const Occluder& scene : {Occluder{1, 0.3, pi / 6}, Occluder{1, 0.1, pi / 4}}) {
      const double tx = scene.to_edge_m(), rx = scene.rx_m(), border = scene.to_border_m();
      const Complex spread(0, 0.25), away = std::sqrt(2 / (pi * k)) * phasor(-pi / 4);
      EXPECT_GT(k * scene.detour_m(), 10);
      const double wave = std::abs(spread * away),
                   false_edge = wave * edge_factor(2 * scene.angle_rad, k) / border,
                   once = wave * edge_factor(scene.angle_rad + scene.rx_angle_rad(), k) / std::sqrt(tx * rx),
                   twice = wave * std::pow(edge_factor(scene.angle_rad, k), 2) /
                           std::sqrt(tx * 2 * scene.above_m * tx);
      const PlaneEcho lit = plane_echo(scene, k, true), hidden = plane_echo(scene, k, false);
      EXPECT_NEAR(db(std::abs(lit.sharp) / false_edge), 0, 0.2);
      EXPECT_NEAR(db(std::abs(hidden.sharp) / false_edge), 0, 0.2);
      // If the foot point is insonified, there are two echoes over the edge and the plane, and a weaker one
      // over the edge twice.
      EXPECT_LT(std::abs(std::abs(lit.second) - 2 * once), 1.2 * twice);
      EXPECT_GT(db(std::abs(lit.second) / false_edge), 5);
      // If the foot point is hidden, only the last echo remains, which falls by 6 dB per octave.
      EXPECT_NEAR(db(std::abs(hidden.second) / twice), 0, 0.5);
      EXPECT_LT(db(std::abs(hidden.second) / false_edge), -10);
    }
}

// For a detour of a fraction of a radian the echoes coincide, and the exact polygon has their sum. The
// agreement improves with shorter detours.
TEST(FalseEdges, AreTheSecondOrderWhereTheDetourIsShort) {
  const double k = 200;
  double before = 1;
  for (const double above : {0.3, 0.1, 0.04}) {
    const Occluder scene{1, above, pi / 36};
    const PlaneEcho hidden = plane_echo(scene, k, false), lit = plane_echo(scene, k, true);
    const double off = std::abs(hidden.second - hidden.sharp) / std::abs(hidden.sharp);
    EXPECT_LT(off, 0.9 * before) << above;
    EXPECT_LT(off, 0.7 * std::sqrt(k * scene.detour_m()));
    EXPECT_LT(std::abs(lit.second - lit.sharp) / std::abs(lit.sharp), 2 * std::sqrt(k * scene.detour_m()));
    before = off;
  }
}

}  // namespace
}  // namespace tubefoot
