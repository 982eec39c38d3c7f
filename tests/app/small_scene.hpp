// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace tubefoot {

/// A tetrahedron on a flat bed, one small camera frame: the least work for tests of everything around it.
/// Lines are counted on in tests.
constexpr std::string_view small_scene = R"(title = "A tetrahedron"
[[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 20
length_m = 30
[[objects]]
name = "thing"
shape = "mesh"
file = "thing.obj"
[trajectory]
kind = "fixed"
position_m = [0, 0, 2]
[[sensors]]
name = "camera"
kind = "didson"
beams = 4
horizontal_deg = 4
tilt_deg = 30
)";

constexpr std::string_view tetrahedron = R"(v 0 3 0
v 1 3 0
v 0 4 0
v 0 3 1
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
)";

}  // namespace tubefoot
