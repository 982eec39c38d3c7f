// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products.hpp"

#include "sensors/echosounder_files.hpp"
#include "sensors/interferometric_files.hpp"

namespace tubefoot {

ReceiverChain receiver_of(const Recording& recording, const RunContext& run) {
  const SignalDescription& signal = recording.sensor->description().signal;
  ReceiverDescription receiver;
  receiver.source_level_db = signal.source_level_db;
  receiver.noise_level_db = signal.noise_level_db;
  receiver.speckle.law = signal.speckle == "rayleigh" ? SpeckleLaw::rayleigh
                         : signal.speckle == "k"      ? SpeckleLaw::k
                                                      : SpeckleLaw::none;
  receiver.speckle.looks = signal.speckle_looks;
  receiver.speckle.shape = signal.speckle_shape;
  if (signal.tvg_spreading) {
    TimeVariedGain gain;
    gain.spreading = *signal.tvg_spreading;
    gain.absorption_db_per_km = signal.tvg_absorption_db_per_km.value_or(recording.absorption_db_per_km);
    gain.gain_db = signal.tvg_gain_db;
    receiver.tvg = gain;
  }
  receiver.seed = run.seed;
  return ReceiverChain(receiver);
}

std::vector<std::filesystem::path> write_products(const std::filesystem::path& folder,
                                                  const Recording& recording, const RunContext& run,
                                                  std::vector<std::string>& warnings) {
  const auto& kind = recording.sensor->description().kind;
  if (std::holds_alternative<EchosounderDescription>(kind))
    return write_echosounder_files(folder, recording, run, warnings);
  std::vector<std::filesystem::path> files = write_pictures(folder, recording, &warnings);
  if (std::holds_alternative<InterferometricDescription>(kind))
    for (auto& file : write_interferometric_files(folder, recording, run)) files.push_back(std::move(file));
  return files;
}

}  // namespace tubefoot
