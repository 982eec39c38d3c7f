// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/measured_column.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "files/hdf5_chunks.hpp"
#include "run/run_request.hpp"
#include "run/run_steps.hpp"
#include "run/selection.hpp"

namespace tubefoot {
namespace {

/// Level of a code in dB.
constexpr double code_db = 0.5;
constexpr std::int8_t lowest_code = -128;

/// Geometry of the range bins, and the gain of a mode.
struct BinAxis {
  double first_m, step_m;
  std::size_t count;
  double sound_speed_m_s;

  double range_m(double sample, double rate_hz) const { return sound_speed_m_s * sample / (2 * rate_hz); }
  /// Returns the bin of a range; count if there is none.
  std::size_t bin_of(double range_m) const {
    const double bin = std::floor((range_m - first_m) / step_m);
    return bin >= 0 && bin < double(count) ? static_cast<std::size_t>(bin) : count;
  }
};

/// The pings of a mode, read from the file on request.
class MeasuredPings : public PackedPings {
 public:
  MeasuredPings(const KmallMode& mode, std::shared_ptr<KmallFile> file, BinAxis axis)
      : mode_(mode), file_(std::move(file)), axis_(axis) {}

  KmallWaterColumn column(std::size_t ping) const {
    const std::lock_guard lock(mutex_);
    return read_kmall_water_column(*file_, file_->records("#MWC").at(*mode_.pings.at(ping).column));
  }

  /// Calls `use` with the beam and its number.
  template <class Use>
  void each_beam(const KmallWaterColumn& column, const Use& use) const {
    for (std::size_t beam = 0; beam < mode_.beam_numbers.size(); ++beam)
      use(column.beams.at(mode_.beam_numbers[beam]), beam);
  }

  PingEnergies values(std::size_t ping, std::size_t) const override {
    const KmallWaterColumn column = this->column(ping);
    auto energies = std::make_shared<std::vector<double>>(mode_.beam_numbers.size() * axis_.count);
    each_beam(column, [&](const KmallWaterBeam& recorded, std::size_t beam) {
      const double absorption_db_per_m = absorption_of(column, recorded) / 1000;
      for (std::size_t k = 0; k < recorded.levels.size(); ++k) {
        const auto sample = static_cast<double>(recorded.first_sample + k);
        const std::size_t bin = axis_.bin_of(axis_.range_m(sample, column.sample_rate_hz));
        if (bin == axis_.count || recorded.levels[k] == lowest_code) continue;
        // The gain refers to ranges by the sound speed at the transducer.
        const double range_m = column.sound_speed_m_s * sample / (2 * column.sample_rate_hz);
        const double level_db = code_db * recorded.levels[k] - column.gain_exponent * std::log10(range_m) -
                                2 * absorption_db_per_m * range_m - column.gain_offset_db;
        constexpr double decibels = 10;
        (*energies)[beam * axis_.count + bin] = std::pow(decibels, level_db / decibels);
      }
    });
    return {std::span<const double>(*energies), energies};
  }

  std::vector<unsigned char> chunk(std::size_t ping, std::size_t channel) const override {
    const PingEnergies energies = values(ping, channel);
    return packed_chunk(energies.values());
  }

 private:
  /// Absorption of the sector of a beam. Sectors of a mode are in order from port, those of a column in that
  /// of the file.
  double absorption_of(const KmallWaterColumn& column, const KmallWaterBeam& beam) const {
    const double frequency_hz = column.sectors.at(beam.sector).frequency_hz;
    std::size_t nearest = 0;
    for (std::size_t t = 1; t < mode_.sectors.size(); ++t)
      if (std::abs(mode_.sectors[t].frequency_hz - frequency_hz) <
          std::abs(mode_.sectors[nearest].frequency_hz - frequency_hz))
        nearest = t;
    return mode_.absorptions_db_per_km.at(nearest);
  }

  const KmallMode& mode_;
  std::shared_ptr<KmallFile> file_;
  BinAxis axis_;
  mutable std::mutex mutex_;
};

/// Returns the sensor of the scene with the name of a mode. Throws if it has other pings or beams.
std::size_t sensor_of(const KmallMode& mode, const Survey& survey, const SourcePlace& scene) {
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    const Sensor& sensor = *survey.sensors[s].sensor;
    if (sensor.description().name != mode.name) continue;
    if (sensor.beams().size() != mode.beam_angles_deg.size() ||
        survey.sensors[s].times_s.size() != mode.pings.size())
      throw InputError(
          sensor.description().place,
          fmt::format("sensor '{}' has {} pings of {} beams, but the recording has {} of {}: do not change "
                      "'ping_times_s' and 'beam_angles_deg' of an imported scene",
                      mode.name, survey.sensors[s].times_s.size(), sensor.beams().size(), mode.pings.size(),
                      mode.beam_angles_deg.size()));
    return s;
  }
  throw InputError(scene,
                   fmt::format("has no sensor '{}': expected the scene that 'tubefoot import-scene' makes of "
                               "this recording",
                               mode.name));
}

RecordedVariable by_beam(const char* name, const char* long_name, std::vector<double> values,
                         std::size_t beams) {
  auto owner = std::make_shared<const std::vector<double>>(std::move(values));
  return {{name, "m", long_name, true, true}, {*owner, nullptr, owner}, 0, 1, beams};
}

}  // namespace

MeasuredColumnReport write_measured_column(const std::filesystem::path& file, const KmallSurvey& line,
                                           const Survey& survey) {
  const auto columns = std::make_shared<KmallFile>(line.column_file.value());
  MeasuredColumnReport report;
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, {});
  std::vector<Recording> recordings;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (const KmallMode& mode : line.modes) {
    const std::size_t s = sensor_of(mode, survey, {survey.scene.description.file.string(), 0, 0});
    Recording recording = recording_of(survey, s, {}, chosen.at(s));
    const RangeSamples& samples = recording.sensor->samples();
    const BinAxis axis{samples.first_m, samples.step_m, static_cast<std::size_t>(samples.count),
                       recording.sound_speed_m_s};
    const auto pings = std::make_shared<MeasuredPings>(mode, columns, axis);
    const std::size_t beams = mode.beam_numbers.size();
    std::vector<double> nearest(mode.pings.size() * beams, none), farthest = nearest, detected = nearest;
    for (std::size_t ping = 0; ping < mode.pings.size(); ++ping) {
      stop_if_wanted();
      const KmallWaterColumn column = pings->column(ping);
      pings->each_beam(column, [&](const KmallWaterBeam& beam, std::size_t number) {
        if (beam.levels.empty()) return;
        const auto range_m = [&](double sample) { return axis.range_m(sample, column.sample_rate_hz); };
        const auto first = static_cast<double>(beam.first_sample),
                   count = static_cast<double>(beam.levels.size());
        const std::size_t at = ping * beams + number;
        // A sample stands for the bin about its time.
        nearest[at] = std::max(axis.first_m, range_m(first - 0.5));
        farthest[at] = range_m(first + count - 0.5);
        constexpr double rounding_deg = 0.01;
        const double angle_deg = mode.beam_angles_deg[number];
        if (beam.detected_sample > 0 && angle_deg >= mode.swath_from_deg - rounding_deg &&
            angle_deg <= mode.swath_to_deg + rounding_deg)
          detected[at] = range_m(beam.detected_sample);
        report.samples += beam.levels.size();
        report.clipped += static_cast<std::size_t>(std::ranges::count(beam.levels, lowest_code));
      });
    }
    recording.packed_energy = pings;
    recording.further.push_back(by_beam("recorded_range_min",
                                        "slant range at which the record of the beam begins",
                                        std::move(nearest), beams));
    recording.further.push_back(by_beam("recorded_range_max",
                                        "slant range at which the record of the beam ends",
                                        std::move(farthest), beams));
    recording.further.push_back(by_beam("detected_range", "slant range of the seabed that the sonar detected",
                                        std::move(detected), beams));
    ++report.sensors;
    report.pings += mode.pings.size();
    report.beams = std::max(report.beams, beams);
    recordings.push_back(std::move(recording));
  }
  Provenance provenance = provenance_of(survey.scene, {});
  provenance.engine = "measured";
  provenance.arithmetic = "recorded";
  write_echoes(file, recordings, provenance);
  return report;
}

}  // namespace tubefoot
