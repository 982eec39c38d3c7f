// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "import/frames/foreign_frame.hpp"
#include "import/import_options.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

namespace tubefoot {

/// Bins along one axis: their centres, increasing, and the edges between them, one more.
struct Bins {
  std::vector<double> centres, edges;
  std::size_t count() const { return centres.size(); }
};

/// Beams (azimuths in degrees, starboard positive) and range samples (metres) of a picture.
struct BinAxes {
  Bins beams, samples;
};

/// Between centres lie the edges half way.
Bins bins_about(std::vector<double> centres);
Bins bin_intervals(std::vector<double> edges);

/// Those of a sensor of the reference.
BinAxes axes_of(const WholeEchoFile& reference, std::size_t sensor);

/// Values of a file, in rising order, of beams and samples; empty: it does not say.
struct AxesOfFile {
  std::vector<double> azimuth_deg, range_m;
};

/// The axes of a picture of so many beams and samples as they are declared, else as the file says, else those
/// of the reference. Throws InputError or UsageError where they do not go together, saying what to declare.
BinAxes picture_axes(std::size_t beams, std::size_t samples, const AxesOfFile& file, const BinAxes& reference,
                     const ImportOptions& options, std::vector<std::string>& told);

/// Whether `compare` takes them for the same: 0.001 degree, 1 % of a sample.
bool same_axes(const BinAxes& a, const BinAxes& b);

/// Means, over the bins of `to`, of a picture [beam][sample] on the bins of `from`; 0 where that has none.
std::vector<double> rebinned(const std::vector<double>& picture, const BinAxes& from, const BinAxes& to);

/// "FIRST:LAST". Throws UsageError, which names the option.
std::pair<double, double> first_and_last(const std::string& words, const char* option);

}  // namespace tubefoot
