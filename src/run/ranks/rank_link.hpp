// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace tubefoot {

/// Bytes from another rank.
struct RankMessage {
  int from = 0;
  std::string bytes;
};

/// Messages between the processes ("ranks") that mpirun or srun started as one. Used by one thread. Messages
/// from one rank to another arrive whole and in order. Nothing but leave() waits for another rank: bytes
/// move, both ways, while receive() is called. A library of its own (src/mpi) makes it, so that the program
/// itself needs no MPI.
class RankLink {
 public:
  virtual ~RankLink() = default;
  virtual int rank() const = 0;
  virtual int ranks() const = 0;
  /// Ranks on this machine, this one included.
  virtual int local_ranks() const = 0;
  /// The machine.
  virtual std::string host() const = 0;
  /// Keeps the message until it has left.
  virtual void send(int to, std::string bytes) = 0;
  /// A message that has arrived; nothing if there is none yet.
  virtual std::optional<RankMessage> receive() = 0;
  /// Bytes of messages that have not left.
  virtual std::size_t unsent() const = 0;
  /// Whether a message is on its way out or in: then receive() should be called again soon.
  virtual bool moving() const = 0;
  /// How long to rest before receive() is called again.
  std::chrono::microseconds pause() const { return std::chrono::microseconds(moving() ? 50 : 1000); }
  /// Waits until all messages have left and all ranks leave, and ends the link. Messages to this rank must
  /// have been received. Without it MPI takes the end of the program for a fault.
  virtual void leave() = 0;
};

/// The link of a process that mpirun or srun started together with others; null for one that is alone. Throws
/// UsageError where the library that speaks MPI is missing, or another MPI started the program.
std::unique_ptr<RankLink> join_ranks();

/// Whether this is not the first of several processes, by what their starter told them: known before
/// join_ranks(), for what only one of them shall say.
bool is_later_rank();
/// Whether others were started together with this one.
bool is_one_of_several_ranks();

/// Threads for a rank that was given no number: its share of the machine's cores, or those it is bound to if
/// they are fewer.
int threads_of_rank(int local_ranks);

}  // namespace tubefoot
