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

// Writers of the files of signals (signal_files.hpp), one per kind of product.
namespace tubefoot {

/// Common data of all writers.
struct SignalJob {
  const std::filesystem::path& folder;
  const ElementSignals& signals;  ///< as passed by the caller
  const SignalProducts& products;
  const RunContext& run;
  const SignalInterpolator& interpolator;
  std::vector<NavigationFix> fixes;  ///< of all pings
  std::string font;
  std::vector<std::filesystem::path>& files;  ///< names of the written files

  std::uint32_t number_of(std::size_t ping) const {
    return products.ping_numbers.empty() ? static_cast<std::uint32_t>(ping) : products.ping_numbers[ping];
  }
  bool on_earth() const { return run.frame.is_georeferenced(); }
  /// Path for <name><ending>. Appends it to the list of files.
  std::filesystem::path new_file(const std::string& ending) const;
  void write(const Canvas& canvas, const std::string& ending, const std::string& what) const;
  /// "100 kHz, 90 to 110 kHz in 3 ms, 64 receivers".
  std::string said_of_signals() const;
};

/// Receives compressed pings one after the other.
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
/// Uses the signals as recorded.
void write_elements_picture(const SignalJob& job);
/// `compressed`: all pings.
void write_aperture_picture(const SignalJob& job, const ElementSignals& compressed);

/// The compressed signals of one ping; signals that are already compressed are copied.
ElementSignals compressed_ping(const ElementSignals& signals, std::size_t ping, const ApertureWindow& window);
/// The signals of some receivers.
ElementSignals of_receivers(const ElementSignals& one_ping, const std::vector<std::size_t>& receivers);

/// Middle between the transmitter and the receivers' mean position: the position of the equivalent single
/// transducer.
glm::dvec3 phase_centre_m(const ElementArray& array);
/// Slant ranges of the samples from the phase centre; each interval is centred on its sample.
RangeSamples ranges_of(const SignalSampling& sampling, double sound_speed_m_s);
/// Beams [beam][sample] in these directions, focused at every range from the phase centre. `one`: a ping.
std::vector<std::complex<double>> focused_beams(const ElementSignals& one,
                                                const std::vector<glm::dvec3>& directions,
                                                const std::vector<double>& weights,
                                                const SignalInterpolator& interpolator);
/// The same for a fan, with its window.
std::vector<std::complex<double>> focused_beams(const ElementSignals& one, const SignalFan& fan,
                                                const SignalInterpolator& interpolator);
/// |y|^2 r^4: for a point it is the target strength, at any range.
double strength_of(std::complex<double> value, double range_m);

/// A panel of levels in dB below the largest. `values`: [row][column].
GridPanel level_panel(std::string title, std::vector<double> values, std::size_t columns);

}  // namespace tubefoot
