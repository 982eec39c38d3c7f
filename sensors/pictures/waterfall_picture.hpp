// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// A sidescan recording drawn as a waterfall. Slant range extends to port on the left and to starboard on
/// the right. The first ping is at the bottom and the last on top, so that forward is up. Pings are repeated
/// so that along-track and across-track scales are equal, within limits; the subtitle reports unequal
/// scales. A pixel shows the mean energy of the cells (ping, sample) that it covers, weighted by their
/// shares of it. Beam 0 is port.
class Waterfall {
 public:
  /// `font` as for Canvas. Reads all pings.
  Waterfall(const Recording& recording, std::string font);
  ~Waterfall();
  Waterfall(const Waterfall&) = delete;
  Waterfall& operator=(const Waterfall&) = delete;

  /// Draws the waterfall. With `receiver_output` it shows the instrument's display, on the scale of the
  /// ideal picture. If the receiver has its own gain, the picture has only that gain and its own scale.
  Canvas draw(const ReceiverOutput* receiver_output = nullptr) const;

 private:
  struct Echoes;
  struct Layout;
  Echoes echoes_of(const ReceiverOutput* receiver_output) const;

  const Recording& recording_;
  std::string font_;
  std::unique_ptr<Layout> layout_;
  std::unique_ptr<Echoes> ideal_;
  DecibelScale scale_;
};

}  // namespace tubefoot
