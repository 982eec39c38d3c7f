// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/numbers/scalars.hpp"

// Implements the parts of the driver that do not depend on the source of the polygons. They are requested
// bounds and their comparison, textures by material, and the loop that narrows the parts. See
// docs/notes/certified-energies.md.
namespace tubefoot {

std::vector<double> reference_targets(const Echo& echo, double tolerance) {
  const auto samples = std::size_t(echo.samples);
  const double ping_peak =
      echo.energy.empty() ? 0 : *std::max_element(echo.energy.begin(), echo.energy.end());
  std::vector<double> target(echo.energy.size());
  for (std::size_t row = 0; row < target.size(); row += samples) {
    double floor = reference_floor * reference_floor * ping_peak;
    for (std::size_t k = 0; k < samples; ++k) floor = std::max(floor, reference_floor * echo.energy[row + k]);
    for (std::size_t k = 0; k < samples; ++k)
      target[row + k] = std::max(tolerance * std::max(echo.energy[row + k], floor), least_allowed);
  }
  return target;
}

void compare_with(CertifiedEcho& certified, double tolerance) {
  compare_with(certified, tolerance, reference_targets);
}

void compare_with(CertifiedEcho& certified, double tolerance, const Targets& targets) {
  // The certain part of the energy determines the requested bound.
  const auto row = std::size_t(certified.echo.samples);
  certified.bins_over = 0;
  certified.worst_ratio = 0;
  Echo least = certified.echo;
  for (std::size_t bin = 0; bin < certified.bound.size(); ++bin) {
    const double sure = least.energy[bin] - certified.bound[bin];
    least.energy[bin] = sure > 0 ? sure : 0;
  }
  const std::vector<double> requested = targets(least, tolerance * (1 + 1e-6));
  for (std::size_t bin = 0; bin < certified.bound.size(); ++bin) {
    const double ratio = certified.bound[bin] / requested[bin];
    certified.bins_over += !(ratio <= 1);
    if (ratio > certified.worst_ratio && std::isfinite(ratio)) {
      certified.worst_ratio = ratio;
      certified.worst_beam = int(bin / row);
      certified.worst_sample = int(bin % row);
    }
  }
}

std::optional<std::size_t> material_without_enclosure(
    std::span<const std::shared_ptr<const ReflectivityField>> reflectivity) {
  for (std::size_t material = 0; material < reflectivity.size(); ++material)
    if (reflectivity[material] != nullptr && certified_texture(reflectivity[material]) == nullptr)
      return material;
  return std::nullopt;
}

std::vector<std::shared_ptr<const CertifiedTexture>> certified_textures(const EchoModel& model) {
  if (const auto material = material_without_enclosure(model.reflectivity))
    throw std::invalid_argument(
        fmt::format("there is no certified bound for the reflectivity texture of material {}", *material));
  std::vector<std::shared_ptr<const CertifiedTexture>> textures(model.material_mu.size());
  for (std::size_t material = 0; material < model.reflectivity.size(); ++material)
    if (model.reflectivity[material] != nullptr)
      textures.at(material) = certified_texture(model.reflectivity[material]);
  return textures;
}

CertifiedRequest::CertifiedRequest(const EchoModel& echo_model, const RangeSamples& samples)
    : model(echo_model),
      textures(certified_textures(echo_model)),
      borders(sample_borders_m(samples)),
      step_m(samples.step_m),
      beta_per_m(Ball(echo_model.absorption_db_per_m) * log(Ball(10)) / Ball(10)) {}

std::pair<std::uint32_t, std::uint32_t> CertifiedRequest::beams_of(
    std::uint32_t tube, std::span<const std::uint32_t> beam_of_tube) const {
  if (model.patterns != nullptr) return model.patterns->beams_of_tube[tube];
  return {beam_of_tube[tube], beam_of_tube[tube] + 1};
}

TexturedPolygon CertifiedRequest::textured(const CertifiedPolygon& polygon, std::uint16_t material,
                                           const FacetMap& lies) const {
  TexturedPolygon textured(polygon, textures[material].get(), lies, tolerance);
  if (textured.has_too_many_cells()) is_coarse = true;
  return textured;
}

void require_exact(const VisibilityOptions& options) {
  if (options.arithmetic == Arithmetic::plain_double)
    throw std::invalid_argument("certified bounds need exact arithmetic: fixed, filtered or rational");
}

void require_one_position(std::span<const BistaticFacet> bistatic) {
  if (!bistatic.empty())
    throw std::invalid_argument(
        "there is no certified bound for facets whose apparent positions differ between two apexes");
}

void take_enclosure(CertifiedEcho& certified, std::size_t bin, const Ball& total, bool is_energy) {
  if (!total.is_finite()) {
    certified.bound[bin] = infinite;
    return;
  }
  const double middle = is_energy ? std::max(total.middle(), 0.0) : total.middle();
  const Ball off = total - Ball(middle);
  certified.echo.energy[bin] = middle;
  certified.bound[bin] = std::max({off.hi(), -off.lo(), 0.0});
}

CertifiedEcho enclosed_echo(const Echo& ordinary, std::span<const Ball> total) {
  CertifiedEcho certified{ordinary, std::vector<double>(total.size())};
  for (std::size_t bin = 0; bin < total.size(); ++bin) take_enclosure(certified, bin, total[bin]);
  return certified;
}

CertifiedEcho refined_until_tolerance(CertifiedRequest& request, const Echo& ordinary, double tolerance,
                                      const Targets& targets, const std::function<CertifiedEcho()>& enclose) {
  constexpr int most_tries = 3;
  request.tolerance = tolerance;
  for (int tries = 1;; ++tries) {
    request.target = targets(ordinary, request.tolerance);
    request.is_coarse = false;
    CertifiedEcho certified = enclose();
    compare_with(certified, tolerance, targets);
    const double excess = certified.worst_ratio;
    const bool bounded = std::ranges::all_of(certified.bound, [](double b) { return std::isfinite(b); });
    if (certified.bins_over == 0 || tries == most_tries || request.is_coarse || !bounded || !(excess < 1000))
      return certified;
    request.tolerance /= 2 * excess;
  }
}

}  // namespace tubefoot
