// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/receiver_pair_files.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <iterator>

#include "files/streamed_file.hpp"
#include "geometry/steps/in_order.hpp"
#include "sensors/detection/receiver_pair_soundings.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/pictures/image_file.hpp"
#include "sensors/pictures/phase_picture.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

void write_soundings(const fs::path& path, const Recording& recording, const RunContext& run,
                     const InterferometricNoise& noise) {
  StreamedFile file(path);
  file.append(
      "ping,time_s,side,sample,range_m,energy_j,phase_rad,coherence,angle_deg,angle_sigma_deg,"
      "depth_m,depth_sigma_m,east_m,north_m,up_m\n");
  const auto lines_of = [&](std::size_t ping) {
    std::string lines;
    for (const InterferometricSounding& s : interferometric_soundings(recording, ping, noise, run))
      fmt::format_to(std::back_inserter(lines),
                     "{},{:.9g},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},"
                     "{:.9g}\n",
                     recording.number_of(ping), recording.ping_time_s[ping],
                     s.beam == 0 ? "port" : "starboard", s.sample, s.range_m, s.energy_j, s.phase_rad,
                     s.coherence, degrees(s.estimate.angle_rad), degrees(s.estimate.angle_sigma_rad),
                     s.estimate.depth_m, s.estimate.depth_sigma_m, s.position_m.x, s.position_m.y,
                     s.position_m.z);
    return lines;
  };
  constexpr std::size_t bytes_a_line = 200;
  Steps steps("pings of soundings", recording.pings());
  in_order(steps, 0, recording.pings(), bytes_a_line * recording.cells(), lines_of,
           [&](std::size_t, const std::string& lines) { file.append(lines); });
  file.close();
}

/// Writes an EXR with the rows and columns of a sidescan's EXR. Cells without a common signal are 0.
template <typename Value>
void write_cells_exr(const fs::path& file, const Recording& recording, const char* quantity, Value value) {
  const auto count = static_cast<std::size_t>(recording.sensor->samples().count);
  std::vector<float> cells(2 * count * recording.pings());
  Steps steps("pings of a picture", recording.pings());
  tbb::parallel_for(std::size_t{0}, recording.pings(), [&](std::size_t ping) {
    float* port = cells.data() + 2 * count * ping;
    const ReceiverPairPing receiver_output(recording, ping);
    for (std::size_t k = 0; k < count; ++k) {
      port[count - 1 - k] = static_cast<float>(value(receiver_output.ideal(0, k)));
      port[count + k] = static_cast<float>(value(receiver_output.ideal(1, k)));
    }
    steps.done();
  });
  OIIO::ParamValueList attributes;
  attributes.attribute("sensor", recording.sensor->description().name);
  attributes.attribute("quantity", quantity);
  attributes.attribute("rows", "pings, first ping on top");
  attributes.attribute("columns", "port samples, farthest first, then starboard samples, nearest first");
  write_exr(file, static_cast<int>(2 * count), static_cast<int>(recording.pings()), cells, attributes);
}

}  // namespace

std::vector<std::string> receiver_pair_products() {
  return {"phase.png", "phase.exr", "coherence.exr", "soundings.csv", "phase-received.png"};
}

std::vector<fs::path> write_receiver_pair_files(const fs::path& folder, const Recording& recording,
                                                const RunContext& run, bool phase_noise) {
  check(recording);
  const std::string& name = recording.sensor->description().name;
  const InterferometricNoise noise{receiver_of(recording, run).noise_j(), phase_noise, run.seed};
  std::vector<fs::path> files;
  const auto new_file = [&](const std::string& product) {
    files.emplace_back(name + "-" + product);
    return folder / files.back();
  };
  if (run.draws("phase.png"))
    draw_phases(recording, label_font())
        .write_png(new_file("phase.png"), name + ", phase", run.pictures.bits);
  if (run.draws("phase.exr"))
    write_cells_exr(new_file("phase.exr"), recording,
                    "phase of the upper relative to the lower receiver [rad]",
                    [](const InterferometricSample& s) { return s.phase_rad().value_or(0); });
  if (run.draws("coherence.exr"))
    write_cells_exr(new_file("coherence.exr"), recording, "coherence of the two receivers [1]",
                    [](const InterferometricSample& s) { return s.coherence(); });
  if (run.writes("soundings.csv")) write_soundings(new_file("soundings.csv"), recording, run, noise);
  if (run.draws("phase-received.png") && (noise.phase_noise || noise.receiver_noise_j > 0))
    draw_phases(recording, label_font(), &noise)
        .write_png(new_file("phase-received.png"), name + ", phase as received", run.pictures.bits);
  return files;
}

}  // namespace tubefoot
