// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

// What accuracy costs: one trial is one engine in one setting on one scene.
namespace tubefoot {

enum class ErrorMeasure { l1, rms_db };

/// What a ping took of the one thread that computed it.
struct PingWork {
  double seconds = 0;            ///< by the clock: what else runs on the machine is in them
  double processor_seconds = 0;  ///< that the thread was running
  double instructions = 0;       ///< that it executed outside of the system; 0 where they are not counted
};

enum class WorkMeasure { seconds, processor_seconds, instructions };

double amount_of(const PingWork& work, WorkMeasure measure);

/// What one ping has to say about the errors of the pings it belongs to.
struct PingError {
  double difference_j = 0, reference_j = 0;  ///< sum |E - E_ref|, sum E_ref
  double squared_db = 0, lit_bins = 0;       ///< sum of squared errors of lit bins, dB^2; how many there are
};

/// Relative L1 error, or RMS error of lit bins in dB, of pings together.
double error_of(std::span<const PingError> pings, ErrorMeasure measure);

struct Trial {
  std::string scene, engine, setting;
  double l1_error = 0;      ///< relative: sum |E - E_ref| / sum E_ref
  double rms_db_error = 0;  ///< over lit bins
  PingWork work;            ///< medians of the repeats
  double bound = 0;         ///< of the reference itself: sum of half-widths / sum of energies
  double samples = 0;       ///< rays a ping; 0 for engines that do not sample
  bool counts = true;       ///< false: drawn, but nobody's choice, like plain double, which promises nothing
  std::vector<std::vector<PingError>> pings;  ///< by sensor
};

double error_of(const Trial& trial, ErrorMeasure measure);

/// What depends least on how busy the machine was: instructions if all trials have them counted, else the
/// processor's seconds.
WorkMeasure steadiest_measure(std::span<const Trial> trials);

/// Errors above this say nothing of convergence: most bins are still missed.
constexpr double unconverged_l1 = 0.3, unconverged_db = 3;

/// Slope of log error over log `samples`, by least squares over the trials that have both positive and whose
/// error is above `floor` and has begun to converge. None with fewer than three such trials.
std::optional<double> convergence_order(std::span<const Trial> trials, ErrorMeasure measure, double floor);

/// Samples a ping for an error of `error`, by the power law through the last (at most three) trials of one
/// engine's ladder, which is ordered. None where their error does not fall with the samples.
std::optional<double> samples_for(std::span<const Trial> ladder, ErrorMeasure measure, double error);

/// What it costs to reach an error, from trials of any number of engines.
struct Cost {
  double amount = 0;          ///< in seconds or instructions, as asked
  bool extrapolated = false;  ///< beyond the best trial, along the engine's fitted order
};

/// Least work for an error of at most `error`. Engines without samples count as measured. Engines with
/// samples are interpolated between trials, along straight lines in the logarithms, and extrapolated beyond
/// their best trial by their fitted order, if they have one. None where no engine reaches it.
std::optional<Cost> cost_of(std::span<const Trial> trials, ErrorMeasure measure, double error,
                            WorkMeasure work = WorkMeasure::seconds);

/// The largest error, up to 1, at which `exact` costs no more than `sampling`: above it, sampling is the
/// cheaper choice. 0 if it always is.
double crossing_error(std::span<const Trial> exact, std::span<const Trial> sampling, ErrorMeasure measure,
                      WorkMeasure work = WorkMeasure::seconds);

}  // namespace tubefoot
