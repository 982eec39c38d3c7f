// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/certified/reference.hpp"
#include "engine/echo/staff_echo.hpp"

namespace tubefoot {

/// What the two receivers of a staff hear (staff_echo.hpp), enclosed: rows upper, lower, real and imaginary
/// part of the cross product in place of beams. Bounds of the last two are held against the geometric mean of
/// both energies. `ordinary` is integrate_staff_echo()'s and only guides the work.
CertifiedEcho certify_staff_echo(const FacetMesh& mesh, const StaffHistory& history, double grid_unit_m,
                                 const Fringe& staff, std::uint32_t fan, std::uint32_t beam,
                                 const RangeSamples& samples, const EchoLaw& law, const StaffEcho& ordinary,
                                 double tolerance);

}  // namespace tubefoot
