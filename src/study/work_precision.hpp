// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

// Work that accuracy requires. A trial is one engine with one setting on one scene.
namespace tubefoot {

enum class ErrorMeasure { l1, rms_db };

/// Work of the single thread that computed a ping.
struct PingWork {
  double seconds = 0;            ///< elapsed time, which depends on the load of the machine
  double processor_seconds = 0;  ///< time during which the thread ran
  double instructions = 0;       ///< instructions of the thread in user mode; 0 if they are not counted
};

enum class WorkMeasure { seconds, processor_seconds, instructions };

double amount_of(const PingWork& work, WorkMeasure measure);

/// Contribution of one ping to the errors of a set of pings.
struct PingError {
  double difference_j = 0, reference_j = 0;  ///< sum |E - E_ref|, sum E_ref
  /// Sum of squared errors of insonified bins in dB^2, and their number.
  double squared_db = 0, lit_bins = 0;
};

/// Returns the error of all pings together: relative L1 error, or RMS error of insonified bins in dB.
double error_of(std::span<const PingError> pings, ErrorMeasure measure);

struct Trial {
  std::string scene, engine, setting;
  double l1_error = 0;      ///< relative: sum |E - E_ref| / sum E_ref
  double rms_db_error = 0;  ///< over insonified bins
  PingWork work;            ///< medians over the repetitions
  double bound = 0;         ///< relative bound of the reference: sum of half-widths / sum of energies
  double samples = 0;       ///< rays per ping; 0 for engines that do not sample
  bool counts = true;       ///< false: shown but never selected, for example plain double arithmetic, which
                            ///< guarantees nothing
  std::vector<std::vector<PingError>> pings;  ///< by sensor
};

double error_of(const Trial& trial, ErrorMeasure measure);

/// Returns the measure that depends least on the load of the machine: instructions if all trials have
/// counts, otherwise processor seconds.
WorkMeasure steadiest_measure(std::span<const Trial> trials);

/// Larger errors are excluded from estimates of convergence, because most bins are still missed.
constexpr double unconverged_l1 = 0.3, unconverged_db = 3;

/// Returns the slope of log error over log `samples` by least squares. Only trials with positive values, an
/// error above `floor` and a converging error count. Returns nothing for fewer than three such trials.
std::optional<double> convergence_order(std::span<const Trial> trials, ErrorMeasure measure, double floor);

/// Returns the number of samples per ping for an error of `error`. It uses a power law through the last
/// trials (at most three) of one engine, ordered by samples. Returns nothing if their error does not decrease
/// with the samples.
std::optional<double> samples_for(std::span<const Trial> ladder, ErrorMeasure measure, double error);

/// Work that an error requires, from trials of any number of engines.
struct Cost {
  double amount = 0;          ///< in seconds or instructions, as requested
  bool extrapolated = false;  ///< beyond the best trial, by the fitted order of the engine
};

/// Returns the least work for an error of at most `error`. Engines without samples count as measured.
/// Engines with samples are interpolated linearly in logarithms between trials. Beyond their best trial,
/// their fitted order, if any, extrapolates them. Returns nothing if no engine reaches the error.
std::optional<Cost> cost_of(std::span<const Trial> trials, ErrorMeasure measure, double error,
                            WorkMeasure work = WorkMeasure::seconds);

/// Returns the largest error, up to 1, at which `exact` needs no more work than `sampling`. Above it,
/// sampling needs less work. Returns 0 if sampling always needs less.
double crossing_error(std::span<const Trial> exact, std::span<const Trial> sampling, ErrorMeasure measure,
                      WorkMeasure work = WorkMeasure::seconds);

}  // namespace tubefoot
