// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace tubefoot {

/// Weights across an aperture, or across a chirp's band. They lower the side lobes and widen the main lobe.
struct ApertureWindow {
  enum class Law {
    uniform,    ///< side lobe -13.26 dB
    hann,       ///< -31.47 dB
    hamming,    ///< -42.7 dB (0.54, 0.46)
    taylor,     ///< the first `nearly_equal` - 1 side lobes near `side_lobe_db` (Taylor 1955)
    chebyshev,  ///< all side lobes at `side_lobe_db` (Dolph 1946); only for uniformly spaced elements
  };
  Law law = Law::uniform;
  double side_lobe_db = 30;  ///< below the main lobe, above 0
  int nearly_equal = 4;
};

/// Weight at a position of the aperture, which extends from -1/2 to 1/2; 0 outside. Throws
/// std::invalid_argument for Chebyshev's window, which has no continuous form, and for invalid parameters.
double window_at(const ApertureWindow& window, double place);

/// Weights of uniformly spaced elements, each at the middle of its share of the aperture. The largest weight
/// need not be 1.
std::vector<double> window_weights(const ApertureWindow& window, std::size_t elements);

}  // namespace tubefoot
