// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tubefoot {

struct Provenance;
struct Recording;
struct RunContext;

/// Codes of a receiver: 0 for no echo and for levels up to `bottom_db`, in steps of `step_db` above it.
struct CodeSteps {
  int bits = 0;
  double bottom_db = 0, step_db = 0;
};

/// The received data of a sensor: its energies after its receiver. Pictures, echoes.nc and Python read them
/// here.
struct ReceiverOutput {
  std::function<std::vector<double>(std::size_t ping)> energy_of;  ///< [beam][sample], J/m2; thread-safe
  bool has_gain = false;  ///< true if the energies include the receiver's own time-varied gain
  std::string said;       ///< caption for readers: "as received: speckle, noise"
  std::uint64_t seed = 1;
  double unit_level_db = 0;                    ///< level of an energy of 1 J/m2 [dB re 1 uPa]
  std::vector<double> sector_unit_level_db{};  ///< the same by transmit sector; empty without them
  std::optional<CodeSteps> codes{};
  /// The same at the lower receiver of a pair; empty for one receiver.
  std::function<std::vector<double>(std::size_t ping)> lower_energy_of{};

  /// The energies of a ping in the form of echoes.nc and of Python, rounded to 24 significant bits. The
  /// other bits of random numbers would double the size of the file.
  std::vector<double> recorded_energy_of(std::size_t ping, bool lower = false) const;
};

/// The received data of a recording, which must outlive them; empty for an ideal receiver.
std::optional<ReceiverOutput> receiver_output_of(const Recording& recording, const RunContext& run);

/// Writes echoes.nc as write_echoes() without a context does, and adds the variable `received` for sensors
/// whose receiver is not ideal. A receiver pair also has `received_lower`.
void write_echoes(const std::filesystem::path& file, const std::vector<Recording>& recordings,
                  const Provenance& provenance, const RunContext& run);

}  // namespace tubefoot
