// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "sensors/pictures/grid_panels.hpp"
#include "sensors/products/signal_products.hpp"
#include "sensors/recordings/run_context.hpp"

// What makes the files of signals (signal_files.hpp), each of one kind of product.
namespace tubefoot {

/// What all of them need to know.
struct SignalJob {
  const std::filesystem::path& folder;
  const ElementSignals& signals;  ///< as they were handed over
  const SignalProducts& products;
  const RunContext& run;
  const SignalInterpolator& interpolator;
  std::vector<NavigationFix> fixes;  ///< of all pings
  std::string font;
  std::vector<std::filesystem::path>& files;  ///< that were written

  std::uint32_t number_of(std::size_t ping) const {
    return products.ping_numbers.empty() ? static_cast<std::uint32_t>(ping) : products.ping_numbers[ping];
  }
  bool on_earth() const { return run.frame.is_georeferenced(); }
  /// Where <name><ending> is to be written; it is one of the files from now on.
  std::filesystem::path new_file(const std::string& ending) const;
  bool pictures() const { return run.pictures.wants(PictureSettings::Which::sequence); }
  void write(const Canvas& canvas, const std::string& ending, const std::string& what) const;
  /// "100 kHz, 90 to 110 kHz in 3 ms, 64 receivers".
  std::string said_of_signals() const;
};

/// Takes pings one after the other, each by itself and compressed.
class SignalMaker {
 public:
  virtual ~SignalMaker() = default;
  virtual bool wants(std::size_t) const { return true; }
  virtual void add(std::size_t ping, const ElementSignals& compressed) = 0;
  virtual void finish() = 0;
};

std::unique_ptr<SignalMaker> make_fan_picture(const SignalJob& job);
std::unique_ptr<SignalMaker> make_sidescan(const SignalJob& job);
std::unique_ptr<SignalMaker> make_soundings(const SignalJob& job);
std::unique_ptr<SignalMaker> make_interferogram(const SignalJob& job);
std::unique_ptr<SignalMaker> make_complex_beams(const SignalJob& job);
/// Of signals as they are recorded.
void write_elements_picture(const SignalJob& job);
/// `compressed`: all pings.
void write_aperture_picture(const SignalJob& job, const ElementSignals& compressed);

/// The signals of one ping, compressed if they are not yet.
ElementSignals compressed_ping(const ElementSignals& signals, std::size_t ping, const ApertureWindow& window);
/// Of some receivers only.
ElementSignals of_receivers(const ElementSignals& one_ping, const std::vector<std::size_t>& receivers);

/// Middle between the transmitter and the receivers: where a transducer would be that receives what they
/// receive.
glm::dvec3 phase_centre_m(const ElementArray& array);
/// The slant ranges that samples are of, each about the middle of its own; from the phase centre.
RangeSamples ranges_of(const SignalSampling& sampling, double sound_speed_m_s);
/// Beams [beam][sample] that receive such directions, focused at every range from the phase centre. `one`: a
/// ping.
std::vector<std::complex<double>> focused_beams(const ElementSignals& one,
                                                const std::vector<glm::dvec3>& directions,
                                                const std::vector<double>& weights,
                                                const SignalInterpolator& interpolator);
/// Of a fan, with its window.
std::vector<std::complex<double>> focused_beams(const ElementSignals& one, const SignalFan& fan,
                                                const SignalInterpolator& interpolator);
/// |y|^2 r^4: what a point returns is its target strength, wherever it is.
double strength_of(std::complex<double> value, double range_m);

/// A drawing of levels in dB below the largest. `values`: [row][column].
GridPanel level_panel(std::string title, std::vector<double> values, std::size_t columns);

}  // namespace tubefoot
