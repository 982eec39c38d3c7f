// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/echo/scattering_cut.hpp"
#include "engine/echo/texture_cells.hpp"
#include "engine/gradient/beam_gains.hpp"
#include "engine/gradient/polygon_borders.hpp"
#include "engine/scattering/echo_model.hpp"
#include "engine/scattering/reflectivity_gradient.hpp"
#include "engine/scattering/scattering_derivative.hpp"
#include "geometry/integrals/path_cut.hpp"

namespace tubefoot {

/// Derivatives of the energies of one visible polygon by row (beam) and range bin. With Lambert's law, they
/// are those for a Lambert parameter of 1. Corners have coordinates (x, y) about the foot point, in a frame
/// (u, v) that moves with the plane. The place of a point is -D n + x u + y v.
struct PolygonDerivatives {
  /// Numbers of a row and bin.
  enum : std::size_t {
    energy,
    by_absorption,                    ///< by beta, per metre
    by_borders,                       ///< by the relative change of all borders of range bins
    by_distance,                      ///< by D, at fixed (x, y)
    by_tilt,                          ///< by the components of dn along u and v, at fixed (x, y)
    by_place = by_tilt + 2,           ///< by a translation of all true places against the texture
    by_place_x = by_place + 3,        ///< the same by a translation times x
    by_place_y = by_place_x + 3,      ///< the same by a translation times y
    own_parameters = by_place_y + 3,  ///< by parameters of the scattering model
  };
  /// Derivatives by the corners of an edge, which joins corner `edge` and the next one.
  struct Part {
    std::size_t row, bin, edge;
    glm::dvec2 by_first, by_second;
  };

  bool weighted = false;  ///< the row is a sum over beams with the weights of bins
  std::size_t rows = 0, first_bin = 0, end_bin = 0, count = own_parameters;
  std::vector<double> numbers;  ///< [bin - first_bin][row][number]
  std::vector<Part> parts;

  void reset(std::size_t row_count, SampleSpan bins, std::size_t parameters);
  double* at(std::size_t row, std::size_t bin) {
    return numbers.data() + ((bin - first_bin) * rows + row) * count;
  }
};

/// A visible polygon with what determines its energy.
struct SeenPolygon {
  const PlanarPolygon& polygon;
  const FacetPlane& plane;
  const PlaneFrame& frame;
  SurfaceProperties surface;
  LyingPlane lies;         ///< with a texture
  bool displaced = false;  ///< whether `lies` is an affine map from apparent to true positions
  std::span<const ScatteringDerivative* const> parameters;
};

/// Differentiates energies of polygons (docs/notes/gradients.md). An object contains scratch memory and
/// prepared integrals: use one per thread.
class PolygonGradient {
 public:
  /// `absorption`: whether derivatives by the absorption are necessary. The caller selects each polygon in
  /// `gains`, which must outlive this object.
  PolygonGradient(const RangeSamples& samples, const EchoModel& model, BeamGains& gains, bool absorption);

  /// Computes the derivatives of one polygon. Returns null if no bin receives energy from it. The result is
  /// valid until the next call.
  const PolygonDerivatives* of(const SeenPolygon& seen);

 private:
  bool find_bins(const SeenPolygon& seen, std::size_t rows);
  void radial(const SeenPolygon& seen);
  void general(const SeenPolygon& seen);
  void add_area(const SeenPolygon& seen, const PlanarPolygon& part, const ReflectivityGradient* texture);
  void add_arcs(const SeenPolygon& seen, const PlanarPolygon& part);
  void add_edges(const SeenPolygon& seen);
  void finish_general(const SeenPolygon& seen);
  ScatteringCutter& cutter_of(const ScatteringDerivative& parameter);
  double density_at(const SeenPolygon& seen, double range) const;

  std::vector<double> borders_;
  double beta_, tolerance_;
  RangeSamples samples_;
  BeamGains& gains_;
  bool patterns_, absorption_;
  RangeCells plain_, kinked_;
  const RangeCells* cells_ = nullptr;
  BorderSmoothness smooth_;
  PolygonBorders borders_of_;
  PolygonDerivatives out_;
  // Closed forms in range.
  std::shared_ptr<const RadialIntegral> lambert_;
  std::optional<RadialIntegral> lambert_moment_;
  std::optional<RangeCutter> lambert_cutter_, moment_cutter_;
  std::optional<ScatteringCutter> scattering_cutter_, scattering_moment_cutter_;
  std::vector<std::pair<const ScatteringDerivative*, std::unique_ptr<ScatteringCutter>>> parameter_cutters_;
  std::vector<double> row_, turned_;
  // Quadrature.
  TextureCells texture_cells_;
  std::optional<PathCutter> path_cutter_;
  const RangeCells* path_cells_ = nullptr;
  std::vector<double> area_, gain_, sums_;
  std::vector<std::pair<const ReflectivityField*, ReflectivityGradient>> textures_;
};

}  // namespace tubefoot
