// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "import/frames/foreign_frame.hpp"
#include "import/import_options.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

namespace tubefoot {

/// Bins along one axis: increasing centres, and the edges between them (one more than centres).
struct Bins {
  std::vector<double> centres, edges;
  std::size_t count() const { return centres.size(); }
};

/// Axes of a picture: beams (azimuths in degrees, starboard positive) and range samples (metres).
struct BinAxes {
  Bins beams, samples;
};

/// Returns bins with these centres; edges lie half-way between centres.
Bins bins_about(std::vector<double> centres);
Bins bin_intervals(std::vector<double> edges);

/// Returns the axes of a sensor of the reference.
BinAxes axes_of(const WholeEchoFile& reference, std::size_t sensor);

/// Increasing values of beams and samples from a file; empty if the file has none.
struct AxesOfFile {
  std::vector<double> azimuth_deg, range_m;
};

/// Determines the axes of a picture with these numbers of beams and samples. Declared axes take precedence,
/// then those of the file, then those of the reference. Throws InputError or UsageError, with advice what
/// to declare, if they contradict each other.
BinAxes picture_axes(std::size_t beams, std::size_t samples, const AxesOfFile& file, const BinAxes& reference,
                     const ImportOptions& options, std::vector<std::string>& told);

/// Returns whether `compare` accepts the axes as equal: within 0.001 degree and 1 % of a sample.
bool same_axes(const BinAxes& a, const BinAxes& b);

/// Returns the means of a picture [beam][sample] over the bins of `to`. The picture has the bins of `from`;
/// outside of them it is 0.
std::vector<double> rebinned(const std::vector<double>& picture, const BinAxes& from, const BinAxes& to);

/// Parses "FIRST:LAST". Throws UsageError, which names the option.
std::pair<double, double> first_and_last(const std::string& words, const char* option);

}  // namespace tubefoot
