// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// A sidescan recording drawn as a waterfall: slant range to port left and to starboard right, the first ping
/// at the bottom and the last on top, so that forward is up. Pings are repeated so that along-track and
/// across-track scales are equal, within limits (and the subtitle says where they are not). A pixel shows the
/// mean energy of the cells (ping, sample) that it covers, weighted by their shares of it. Beam 0 is port.
class Waterfall {
 public:
  /// `font` as for Canvas. Reads all pings.
  Waterfall(const Recording& recording, std::string font);
  ~Waterfall();
  Waterfall(const Waterfall&) = delete;
  Waterfall& operator=(const Waterfall&) = delete;

  /// With `receiver_output`, what the instrument shows: on the scale of the ideal picture, or, where the
  /// receiver has a gain of its own, after that gain alone and on its own scale.
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
