// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace tubefoot {

/// Message from another rank.
struct RankMessage {
  int from = 0;
  std::string bytes;
};

/// Messages between the processes ("ranks") of one run that mpirun or srun started. One thread uses the
/// link. Messages from one rank to another arrive complete and in order. Only leave() waits for another
/// rank. Bytes move in both directions during calls of receive(). A separate library (src/mpi) implements
/// the link, so that the program itself needs no MPI.
class RankLink {
 public:
  virtual ~RankLink() = default;
  virtual int rank() const = 0;
  virtual int ranks() const = 0;
  /// Returns the number of ranks on this machine, including this one.
  virtual int local_ranks() const = 0;
  /// Returns the name of the machine.
  virtual std::string host() const = 0;
  /// Sends a message. The link keeps the message until all its bytes have left.
  virtual void send(int to, std::string bytes) = 0;
  /// Returns a message that has arrived; empty if there is none yet.
  virtual std::optional<RankMessage> receive() = 0;
  /// Returns the number of bytes that have not left.
  virtual std::size_t unsent() const = 0;
  /// Returns whether a message is being sent or received. The caller should then soon call receive() again.
  virtual bool moving() const = 0;
  /// Returns the time to wait before the next call of receive().
  std::chrono::microseconds pause() const { return std::chrono::microseconds(moving() ? 50 : 1000); }
  /// Waits until all messages have left and all ranks call leave(), and closes the link. All messages to
  /// this rank must have been received before. Without this call, MPI treats the end of the program as an
  /// error.
  virtual void leave() = 0;
};

/// Returns the link of a process that mpirun or srun started together with others; null for a single
/// process. Throws UsageError if the MPI library is missing, or if another MPI started the program.
std::unique_ptr<RankLink> join_ranks();

/// Returns whether this process is not the first of several, according to the environment of its launcher.
/// The result is known before join_ranks(). Only the first process prints certain messages.
bool is_later_rank();
/// Returns whether other processes were started together with this one.
bool is_one_of_several_ranks();

/// Returns the number of threads of a rank if the user sets none. It is the rank's share of the machine's
/// cores, but at most the number of cores to which the rank is bound.
int threads_of_rank(int local_ranks);

}  // namespace tubefoot
