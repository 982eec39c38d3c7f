// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "files/descriptor.hpp"
#include "run/kept/ping_values.hpp"

namespace tubefoot {

/// Apparent facets of shots through refracting water (engine/ground/refracted_ground.hpp), and where some
/// have not exactly one ray: azimuth and elevation in degrees and range in metres, from the sonar in the
/// local frame.
struct StraighteningCounts {
  std::uint64_t facets = 0, in_shadow = 0, of_several = 0, folded = 0;
  double largest_gap_m = 0;
  std::array<double, 3> shadow{}, several{};  ///< the first of each
  std::uint64_t unbounded = 0;                ///< of a reference: bins whose bound is infinite
  std::uint64_t at_limit = 0;                 ///< shots that would need a finer ground than is worth it
};

/// What the simulation of one ping counted. Plain data: it is kept beside the ping's energies.
struct PingCounts {
  std::uint64_t tubes = 0, candidates = 0, footprints = 0, pieces = 0, hits = 0;
  double visibility_seconds = 0, echo_seconds = 0;
  /// Of a reference: bins whose bound is above what was asked, and the worst of them.
  std::uint64_t bins_over = 0;
  double worst_ratio = 0;
  std::uint32_t worst_sensor = 0, worst_beam = 0, worst_sample = 0, padding = 0;
  /// With relief: facets made for the ping's shots, and what finer relief would change (FinerRelief).
  std::uint64_t refined_facets = 0;
  double finer_relief_largest = 0, finer_relief_rms = 0;
  /// Of paths: image apexes, arrivals without scattering, and the energy of each order.
  std::uint64_t images = 0, arrivals = 0;
  std::array<double, 9> energy_of_order{};
  /// Of refraction, by shot: apparent facets, and those that StraighteningCounts names.
  StraighteningCounts refraction;
};

/// A file of pings that cannot be gone on with.
struct UnusableStore : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// One that another run has.
struct StoreInUse : UnusableStore {
  explicit StoreInUse(const std::filesystem::path& file);
};

/// Opens a file of pings, or makes it where there must be none yet, so that no other run gets it while it is
/// open. No descriptor if there is none and none is made. Throws UnusableStore for what is not a run's own
/// file (a link, a file with a second name or of somebody else), and std::runtime_error naming the file.
Descriptor take_ping_file(const std::filesystem::path& file, bool make);

/// The energies of a run, ping by ping in any order, each sensor's in one block [ping][beam][sample]: in
/// memory, or in a file that survives the program. The file is as large as it will ever be from the start, so
/// that a full disk is met before anything is computed; it is mapped, so that memory holds no more than the
/// pings at hand.
class PingStore {
 public:
  /// Zeroed, in memory.
  explicit PingStore(const StoreLayout& layout);
  /// A new file in place of any that is there. `identity` says what the pings belong to. Throws
  /// std::runtime_error naming the file and the reason, such as a full disk.
  PingStore(const StoreLayout& layout, const std::filesystem::path& file, const std::string& identity);
  /// The same in a file that was taken.
  PingStore(const StoreLayout& layout, const std::filesystem::path& file, Descriptor taken,
            const std::string& identity);
  /// Goes on with a file. Pings that were cut off while they were written count as not done. Throws
  /// UnusableStore for a file of another layout, one that is cut short, in use, or no such file at all.
  static std::unique_ptr<PingStore> reopen(const StoreLayout& layout, const std::filesystem::path& file);
  static std::unique_ptr<PingStore> reopen(const StoreLayout& layout, const std::filesystem::path& file,
                                           Descriptor taken);
  ~PingStore();
  PingStore(const PingStore&) = delete;
  PingStore& operator=(const PingStore&) = delete;

  bool done(std::size_t group, std::size_t ping) const { return unit(group, ping).checksum != 0; }
  std::size_t done_units() const;
  /// Keeps a ping of a group, which is done with that. From several threads. Now and then it brings what is
  /// done to the disk: throws std::runtime_error where that fails.
  void finish(std::size_t group, std::size_t ping, const PingCounts& counts, const PingValues& values);
  const PingCounts& counts(std::size_t group, std::size_t ping) const { return unit(group, ping).counts; }

  /// [ping][channel][beam][sample].
  std::span<const double> energy(std::size_t sensor) const { return block(sensor, 0); }
  std::span<const double> energy(std::size_t sensor, std::size_t ping) const { return part(sensor, ping, 0); }
  /// Empty without bounds.
  std::span<const double> bound(std::size_t sensor) const { return block(sensor, 1); }
  std::span<const double> bound(std::size_t sensor, std::size_t ping) const { return part(sensor, ping, 1); }
  /// Lets go of the memory of a ping that lies in a file. Its values come back when they are read.
  void release(std::size_t sensor, std::size_t ping);
  /// Brings all of a file to the disk. Throws std::runtime_error naming it.
  void sync() const;

 private:
  struct Unit {
    std::uint64_t checksum = 0;  ///< 0: not done
    PingCounts counts;
  };
  void map();
  Unit& unit(std::size_t group, std::size_t ping) const;
  std::span<double> block(std::size_t sensor, int which) const;
  std::span<double> part(std::size_t sensor, std::size_t ping, int which) const;
  void put(std::span<const double> values, std::span<double> place) const;

  explicit PingStore(const StoreLayout& layout, std::filesystem::path path, std::size_t identity_bytes);

  StoreLayout layout_;
  std::filesystem::path path_;           ///< empty: in memory
  std::size_t first_unit_byte_ = 0;      ///< after the header
  std::vector<std::size_t> first_unit_;  ///< by group
  std::vector<std::size_t> first_byte_;  ///< by sensor: of its energies; its bounds follow
  std::size_t bytes_ = 0;
  unsigned char* data_ = nullptr;
  Descriptor file_;
  std::atomic<std::chrono::steady_clock::time_point> next_sync_;
};

/// What a file of pings says of itself, without going on with it.
struct StoreSummary {
  std::string identity;
  std::size_t units = 0, done = 0;
  bool in_use = false;  ///< another process writes to it
};
/// Throws UnusableStore.
StoreSummary summary_of(const std::filesystem::path& file);
StoreSummary summary_of(const std::filesystem::path& name, const Descriptor& file);

}  // namespace tubefoot
