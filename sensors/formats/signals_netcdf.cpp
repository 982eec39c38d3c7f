// SPDX-License-Identifier: GPL-3.0-or-later
// Writes and reads signals.nc, in the layout of docs/output-files.md. The reader checks dimensions, units,
// sizes and values before it allocates memory.
#include "sensors/formats/signals_netcdf.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"
#include "geometry/steps/steps.hpp"
#include "sensors/formats/echo_netcdf.hpp"
#include "sensors/recordings/netcdf_group.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr std::string_view unit_one[] = {"1"}, unit_metre[] = {"m"}, unit_second[] = {"s"},
                           unit_pressure[] = {"W^(1/2)"};
constexpr const char *our_factor = "exp(-i omega t)", *other_factor = "exp(+i omega t)";

/// The complex numbers as pairs of reals in memory.
std::span<const double> pairs(std::span<const std::complex<double>> values) {
  return {reinterpret_cast<const double*>(values.data()), 2 * values.size()};
}

std::string derivative_name(const ElementSignals::Derivative& by) {
  return "pressure_gradient." + by.parameter;
}

void define(EchoGroup& root, const ElementSignals& signals) {
  const SignalSampling& sampling = signals.sampling;
  root.attribute("source_energy", "1 J/sr at 1 m");
  root.attribute("time_factor", our_factor);
  root.attribute("baseband_frequency", sampling.baseband_hz);
  root.attribute("sample_rate", sampling.rate_hz);
  root.attribute("sound_speed_m_s", signals.sound_speed_m_s);
  root.attribute("matched_filtered", signals.matched_filtered ? 1.0 : 0.0);
  root.attribute("stop_and_hop", signals.motion.stop_and_hop() ? 1.0 : 0.0);
  root.attribute("waveform_start_frequency", signals.waveform.start_hz);
  root.attribute("waveform_stop_frequency", signals.waveform.stop_hz);
  root.attribute("waveform_duration", signals.waveform.duration_s);
  root.attribute("waveform_taper", signals.waveform.taper);

  const std::vector<Trajectory::Sample>& track = signals.motion.track();
  const int ping = root.dimension("ping", signals.pings());
  const int receiver = root.dimension("receiver", signals.receivers());
  const int sample = root.dimension("sample", signals.samples());
  const int part = root.dimension("complex", 2);
  const int xyz = root.dimension("xyz", 3), wxyz = root.dimension("wxyz", 4);
  const int knot = root.dimension("track", track.size());

  const int pressure = root.define(
      "pressure", {ping, receiver, sample, part}, "W^(1/2)",
      signals.matched_filtered
          ? "complex baseband pressure after a matched filter, real and imaginary part: an echo "
            "peaks at its delay"
          : "complex baseband pressure, real and imaginary part; its squared modulus over time is "
            "energy, for a pulse of 1 J/sr at 1 m");
  root.attribute(pressure, "coordinates", "ping_start_time sample_time");
  root.chunk(pressure, "pressure", {1, signals.receivers(), signals.samples(), 2});

  if (!signals.bound.empty()) {
    const int bound = root.define("pressure_bound", {ping, receiver, sample, part}, "W^(1/2)",
                                  "certified half-width: the true real and imaginary parts lie within "
                                  "pressure +- pressure_bound; an infinite value means no bound");
    root.attribute(bound, "coordinates", "ping_start_time sample_time");
    root.attribute(bound, "comment",
                   "The bounds hold for Kirchhoff's approximation of smooth surfaces. Facets and the sensor "
                   "lie on the world grid, and their visible polygons are exact. Positions of elements, "
                   "times, pulse, sound speed, absorption and reflection count as exact numbers. A bound is "
                   "infinite where a sample may contain an echo without a bound: an echo from a surface that "
                   "is not smooth, or that is smooth with a fluid or roughness, an echo through beam "
                   "patterns or mirrors, or an echo between ends that move within a ping.");
    root.chunk(bound, "pressure_bound", {1, signals.receivers(), signals.samples(), 2});
  }

  for (const ElementSignals::Derivative& by : signals.derivatives) {
    const std::string name = derivative_name(by);
    const int derivative =
        root.define(name, {ping, receiver, sample, part}, by.units,
                    by.meaning + ", real and imaginary part, for echoes of smooth surfaces");
    root.attribute(derivative, "coordinates", "ping_start_time sample_time");
    root.attribute(derivative, "comment",
                   "Echoes of other surfaces are speckle "
                   "with the mean 0 and contribute nothing.");
    root.chunk(derivative, name, {1, signals.receivers(), signals.samples(), 2});
  }

  std::vector<double> times;
  for (std::size_t k = 0; k < signals.samples(); ++k) times.push_back(sampling.time_s(k));
  root.variable("sample_time", {sample}, "s", "time of the sample after the ping's start", times);
  root.variable("ping_start_time", {ping}, "s", "start of the transmission on the scene's clock",
                signals.motion.ping_start_s());

  const glm::dvec3& tx = signals.array.transmitter_m;
  root.variable("transmitter_position", {xyz}, "m",
                "position of the transmitter on the vehicle: starboard, forward, up", {tx.x, tx.y, tx.z});
  std::vector<double> places;
  for (const glm::dvec3& p : signals.array.receivers_m) places.insert(places.end(), {p.x, p.y, p.z});
  root.variable("receiver_position", {receiver, xyz}, "m",
                "positions of the receivers on the vehicle: starboard, forward, up", places);

  const auto poses = [&](const std::string& of, int dimension, const std::string& when,
                         const std::vector<Pose>& all) {
    std::vector<double> positions, attitudes;
    for (const auto& [p, q] : all) {
      positions.insert(positions.end(), {p.x, p.y, p.z});
      attitudes.insert(attitudes.end(), {q.w, q.x, q.y, q.z});
    }
    root.variable(of + "_position", {dimension, xyz}, "m",
                  "position of the vehicle " + when + ": east, north, up", positions);
    root.variable(
        of + "_attitude", {dimension, wxyz}, "1",
        "quaternion w, x, y, z that turns the vehicle's axes (x starboard, y forward, z up) into the "
        "local frame, " +
            when,
        attitudes);
  };
  std::vector<Pose> at_pings, at_knots;
  std::vector<double> knot_times;
  for (std::size_t k = 0; k < signals.pings(); ++k) at_pings.push_back(signals.motion.ping_pose(k));
  for (const auto& [time_s, pose] : track) at_knots.push_back(pose), knot_times.push_back(time_s);
  poses("ping", ping, "at the ping's start", at_pings);
  root.variable("track_time", {knot}, "s",
                "times of the track on the scene's clock; between them positions are interpolated linearly "
                "and attitudes turn at a constant rate",
                knot_times);
  poses("track", knot, "at the track's times", at_knots);
  root.write();
}

class SignalsInput {
 public:
  explicit SignalsInput(const fs::path& path)
      : file_(path, {"a file of element signals (signals.nc)", "docs/output-files.md"}),
        root_(file_, file_.id(), ""),
        attributes_(root_.attributes()) {}

  ElementSignals read() const {
    const double speed = number("sound_speed_m_s", "m/s");
    const TransmitWaveform waveform{number("waveform_start_frequency", "Hz"),
                                    number("waveform_stop_frequency", "Hz"), number("waveform_duration", "s"),
                                    number("waveform_taper", "a fraction of the duration")};
    const Words along{"ping", "receiver", "sample", "complex"};
    const std::vector<std::size_t> shape = root_.checked_shape("pressure", along, unit_pressure);
    if (shape[3] != 2)
      root_.fail("pressure",
                 fmt::format("has {} values along 'complex', expected 2: real and imaginary part", shape[3]));
    require_memory_for_paths();
    try {
      ElementSignals signals{waveform,         sampling(shape[2]),       speed, array(shape[1]),
                             motion(shape[0]), flag("matched_filtered"), {}};
      require_memory(16.0 * static_cast<double>(shape[0] * shape[1] * shape[2]), {file_.path().string()},
                     "its signals", "use a machine with more memory, or a file with fewer pings");
      signals.pressure.resize(shape[0] * shape[1] * shape[2]);
      const std::span<double> values(reinterpret_cast<double*>(signals.pressure.data()),
                                     2 * signals.pressure.size());
      root_.read_into("pressure", along, values);
      for (std::size_t k = 0; k < values.size(); ++k)
        if (!std::isfinite(values[k]))
          root_.fail("pressure", fmt::format("holds {} at ping {}; expected finite numbers", values[k],
                                             k / (values.size() / shape[0])));
      if (conjugate())
        for (std::complex<double>& value : signals.pressure) value = std::conj(value);
      if (root_.has("pressure_bound")) read_bound(shape, signals);
      check(signals);
      return signals;
    } catch (const std::invalid_argument& error) {
      file_.fail(error.what());
    }
  }

 private:
  void read_bound(const std::vector<std::size_t>& of_pressure, ElementSignals& signals) const {
    const Words along{"ping", "receiver", "sample", "complex"};
    if (root_.checked_shape("pressure_bound", along, unit_pressure) != of_pressure)
      root_.fail("pressure_bound", "differs in shape from 'pressure'");
    require_memory(16.0 * static_cast<double>(signals.pressure.size()), {file_.path().string()},
                   "the bounds of its signals", "use a machine with more memory, or a file with fewer pings");
    signals.bound.resize(signals.pressure.size());
    const std::span<double> values(reinterpret_cast<double*>(signals.bound.data()), 2 * signals.bound.size());
    root_.read_into("pressure_bound", along, values);
    for (const double value : values)
      if (!(value >= 0))
        root_.fail("pressure_bound", fmt::format("holds {}; expected values of at least 0", value));
  }
  std::optional<double> found(const char* name) const {
    for (const EchoAttribute& attribute : attributes_)
      if (attribute.name == name)
        if (const auto* value = std::get_if<double>(&attribute.value)) return *value;
    return std::nullopt;
  }
  double number(const char* name, const char* unit) const {
    const std::optional<double> value = found(name);
    if (!value)
      file_.fail(fmt::format(
          "attribute '{}' is missing or not a number; expected {} (see docs/output-files.md for the layout)",
          name, unit));
    return *value;
  }
  bool flag(const char* name) const {
    const double value = number(name, "0 or 1");
    if (value != 0 && value != 1)
      file_.fail(fmt::format("attribute '{}' is {}, expected 0 or 1", name, value));
    return value == 1;
  }
  bool conjugate() const {
    const std::string factor = root_.text("time_factor");
    if (factor != our_factor && factor != other_factor)
      file_.fail(
          fmt::format("attribute 'time_factor' is '{}', expected '{}' or '{}': write the one that matches "
                      "the sign of the phases",
                      factor, our_factor, other_factor));
    return factor == other_factor;
  }

  /// Prefix of the variables with the path's poses. A file without a track has the poses of pings, between
  /// which the vehicle moves in a straight line.
  std::string way() const { return root_.has("track_time") ? "track" : "ping"; }

  /// Checks the memory for all variables except the pressures. Those are checked when their number is known
  /// to be right.
  void require_memory_for_paths() const {
    double bytes = 0;
    for (const char* name : {"sample_time", "ping_start_time", "receiver_position"})
      if (root_.has(name)) bytes += root_.bytes_of(name);
    const std::string of = way();
    for (const char* what : {"_time", "_position", "_attitude"})
      if (root_.has((of + what).c_str())) bytes += root_.bytes_of((of + what).c_str());
    constexpr double copies = 3;
    require_memory(copies * bytes, {file_.path().string()}, "its positions and times",
                   "use a machine with more memory, or a file with fewer pings");
  }

  /// Reads finite values and checks their number.
  std::vector<double> values(const char* name, const Words& along, std::span<const std::string_view> units,
                             std::optional<std::size_t> expected) const {
    std::vector<std::size_t> shape;
    std::vector<double> all = root_.values(name, along, units, &shape);
    if (expected && all.size() != *expected)
      root_.fail(name, fmt::format("has {} values, expected {}", all.size(), *expected));
    root_.require(
        name, along, shape, all, [](double v) { return std::isfinite(v); }, "a finite number");
    return all;
  }

  SignalSampling sampling(std::size_t samples) const {
    SignalSampling sampling{number("baseband_frequency", "Hz"), number("sample_rate", "Hz"), 0, samples};
    const std::vector<double> times = values("sample_time", {"sample"}, unit_second, samples);
    sampling.first_s = times[0];
    constexpr double rounding = 1e-3;  // of a sample
    for (std::size_t k = 0; k < samples; ++k)
      if (!(std::abs(times[k] - sampling.time_s(k)) * sampling.rate_hz < rounding))
        root_.fail(
            "sample_time",
            fmt::format("is {} at sample {}, but 'sample_rate' implies {}: write evenly spaced samples",
                        times[k], k, sampling.time_s(k)));
    return sampling;
  }

  ElementArray array(std::size_t receivers) const {
    const std::vector<double> tx = values("transmitter_position", {"xyz"}, unit_metre, 3),
                              rx =
                                  values("receiver_position", {"receiver", "xyz"}, unit_metre, 3 * receivers);
    ElementArray array{{tx[0], tx[1], tx[2]}, {}};
    for (std::size_t k = 0; k < rx.size(); k += 3)
      array.receivers_m.emplace_back(rx[k], rx[k + 1], rx[k + 2]);
    return array;
  }

  VehicleMotion motion(std::size_t pings) const {
    const std::vector<double> starts = values("ping_start_time", {"ping"}, unit_second, pings);
    const std::string of = way();
    const std::vector<double> times =
        of == "track" ? values("track_time", {"track"}, unit_second, std::nullopt) : starts;
    const std::vector<double> positions =
        values((of + "_position").c_str(), {of, "xyz"}, unit_metre, 3 * times.size());
    const std::vector<double> attitudes =
        values((of + "_attitude").c_str(), {of, "wxyz"}, unit_one, 4 * times.size());
    std::vector<Trajectory::Sample> track;
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double *p = &positions[3 * k], *q = &attitudes[4 * k];
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      if (!(std::abs(length - 1) < 1e-6))
        root_.fail((of + "_attitude").c_str(),
                   fmt::format("has length {} at {} {}, expected length 1", length, of, k));
      track.push_back({times[k], {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}}});
    }
    return {std::move(track), starts, flag("stop_and_hop")};
  }

  NetcdfInput file_;
  EchoGroupInput root_;
  std::vector<EchoAttribute> attributes_;
};

}  // namespace

void write_signals(const fs::path& path, const ElementSignals& signals, const Provenance& provenance) {
  check(signals);
  const std::size_t per_ping = 2 * signals.receivers() * signals.samples(),
                    bytes =
                        (signals.pressure.size() * (1 + signals.derivatives.size()) + signals.bound.size()) *
                        sizeof(std::complex<double>);
  if (per_ping * sizeof(double) > static_cast<std::size_t>(limits::block_bytes))
    throw std::invalid_argument(fmt::format(
        "{}: a ping of {} receivers x {} samples is larger than 512 MB: write fewer receivers or samples",
        path.string(), signals.receivers(), signals.samples()));
  EchoNetcdf file(path);
  EchoGroup root = file.root();
  root.attribute("Conventions", "tubefoot-signals-1.0");
  for (const auto& [name, value] : attributes_of(provenance))
    if (std::string_view(name) != "Conventions")  // the Conventions attribute is that of echo files
      std::visit([&, name = name](const auto& v) { root.attribute(name, v); }, value);
  define(root, signals);
  Steps steps("pings of signals.nc", signals.pings());
  std::vector<PingVariable> variables;
  const auto add = [&](const std::string& name, const std::vector<std::complex<double>>& values) {
    if (values.empty()) return;
    variables.push_back({name, [&values, per_ping](std::size_t ping) {
                           return packed_chunk(pairs(values).subspan(ping * per_ping, per_ping));
                         }});
  };
  add("pressure", signals.pressure);
  add("pressure_bound", signals.bound);
  for (const ElementSignals::Derivative& by : signals.derivatives) add(derivative_name(by), by.values);
  write_pings(file.chunks(bytes), "/", variables, signals.pings(), per_ping,
              [&](std::size_t) { steps.done(); });
  file.close();
}

ElementSignals read_signals(const fs::path& path) { return SignalsInput(path).read(); }

}  // namespace tubefoot
