// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <stdexcept>

#include "sensors/pictures/label_picture.hpp"

namespace tubefoot {

std::vector<std::filesystem::path> write_label_pictures(const std::filesystem::path& folder,
                                                        const Recording& recording,
                                                        const LabelRecording& label_recording, int bits) {
  const std::string& name = recording.sensor->description().name;
  const std::string& font = label_font();
  std::vector<std::filesystem::path> files;
  const auto write = [&](const Canvas& canvas, const std::string& end) {
    files.emplace_back(fmt::format("{}-labels{}.png", name, end));
    canvas.write_png(folder / files.back(),
                     fmt::format("{}: labels of the energy, and its mean height", name), bits);
  };
  const std::size_t pings = recording.pings();
  if (pings == 0) return files;
  if (recording.sensor->beams().size() <= 2) {
    write(draw_labels_of_track(recording, label_recording, font), "");
    return files;
  }
  constexpr std::size_t most = 5;
  const std::size_t frames = std::min(pings, most);
  for (std::size_t k = 0; k < frames; ++k) {
    const std::size_t ping = frames == 1 ? 0 : k * (pings - 1) / (frames - 1);
    write(draw_labels_of_ping(recording, label_recording, ping, font),
          fmt::format("-{:04}", recording.number_of(ping)));
  }
  return files;
}

}  // namespace tubefoot
