// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace tubefoot {

/// Bytes from another rank.
struct RankMessage {
  int from = 0;
  std::string bytes;
};

/// Messages between the processes ("ranks") that mpirun or srun started as one. Used by one thread. Messages
/// from one rank to another arrive whole and in order. A library of its own (src/mpi) makes it, so that the
/// program itself needs no MPI.
class RankLink {
 public:
  virtual ~RankLink() = default;
  virtual int rank() const = 0;
  virtual int ranks() const = 0;
  /// Ranks on this machine, this one included.
  virtual int local_ranks() const = 0;
  /// The machine.
  virtual std::string host() const = 0;
  virtual void send(int to, std::string_view bytes) = 0;
  /// A message that has arrived; nothing if there is none yet.
  virtual std::optional<RankMessage> receive() = 0;
  /// Waits until all ranks leave, and ends the link. Without it MPI takes the end of the program for a fault.
  virtual void leave() = 0;
};

/// The link of a process that mpirun or srun started together with others; null for one that is alone. Throws
/// UsageError where the library that speaks MPI is missing, or another MPI started the program.
std::unique_ptr<RankLink> join_ranks();

/// Whether this is not the first of several processes, by what their starter told them: known before
/// join_ranks(), for what only one of them shall say.
bool is_later_rank();

/// Threads for a rank that was given no number: its share of the machine's cores, or those it is bound to if
/// they are fewer.
int threads_of_rank(int local_ranks);

}  // namespace tubefoot
