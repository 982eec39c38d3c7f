// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/certified/certified_driver.hpp"
#include "engine/certified/certified_integral.hpp"

namespace tubefoot {

/// A visible polygon of one apex, which is integrated by the cells of its texture.
class MonostaticPiece {
 public:
  using Integrator = CertifiedIntegrator;

  /// `beam`: the beam of the tube, for ideal beams. `scattering`: null for Lambert's law. All arguments must
  /// outlive this object.
  MonostaticPiece(const CertifiedRequest& request, const CertifiedPolygon& polygon, FacetId facet,
                  const ScatteringModel* scattering, std::uint32_t tube, std::uint32_t beam)
      : textured(
            request.textured(polygon, request.model.material[facet], request.model.path.tx.map_of(facet))),
        factor(scattering != nullptr ? Ball(1)
                                     : Ball(request.model.material_mu[request.model.material[facet]]) *
                                           squared(polygon.distance)),
        patterns_(request.model.patterns),
        scattering_(scattering),
        tube_(tube),
        beam_(beam) {}

  /// Integrates a part with the texture of its cell, if any.
  void integrate(Integrator& integrator, const CertifiedPolygon& part, const CertifiedCell* cell,
                 const Integrator::Allowance& allowance, const Sink<Ball>& sink) const {
    integrator.take_model(scattering_);
    if (patterns_ != nullptr)
      integrator.add(part, *patterns_, tube_, allowance, sink, cell);
    else
      integrator.add(part, beam_, allowance, sink, cell);
  }
  void integrate_parts(Integrator& integrator, const Integrator::Allowance& allowance,
                       const Sink<Ball>& sink) const {
    textured.each_part([&](const CertifiedPolygon& part, const CertifiedCell* cell) {
      integrate(integrator, part, cell, allowance, sink);
    });
  }

  TexturedPolygon textured;
  Ball factor;  ///< of the integrals, which contain neither mu nor the distance of the plane

 private:
  const BeamPatterns* patterns_;
  const ScatteringModel* scattering_;
  std::uint32_t tube_, beam_;
};

}  // namespace tubefoot
