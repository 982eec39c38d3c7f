// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/law/radial_law.hpp"

#include "engine/law/density.hpp"
#include "engine/law/echo_law.hpp"

namespace tubefoot {

RadialIntegral lambert_radial_integral(const RangeSamples& samples, double absorption_db_per_m) {
  const double beta = absorption_per_m(absorption_db_per_m);
  return RadialIntegral(sample_borders_m(samples),
                        [beta](double r) { return lambert_density(Way<double>::of(r), beta); });
}

}  // namespace tubefoot
