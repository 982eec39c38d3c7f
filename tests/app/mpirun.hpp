// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

namespace tubefoot {

/// How ranks send to each other.
enum class Sending {
  as_usual,  ///< what is short leaves before the other asks for it
  /// Not a byte leaves before the other asks for it: the least that Open MPI takes for its "eager limit" are
  /// the 56 bytes of its own headers. Over TCP, since ranks that share memory send up to 256 bytes whatever
  /// the limit.
  nothing_ahead
};

/// What is put before a command so that so many ranks of this machine run it, whoever starts it.
inline std::vector<std::string> mpirun(int ranks, Sending sending = Sending::as_usual) {
  std::vector<std::string> words{TUBEFOOT_MPIRUN,
                                 "--allow-run-as-root",
                                 "--oversubscribe",
                                 "--bind-to",
                                 "none",
                                 "--mca",
                                 "oob_tcp_if_include",
                                 "lo"};
  const auto add = [&words](std::initializer_list<const char*> more) {
    words.insert(words.end(), more.begin(), more.end());
  };
  if (sending == Sending::as_usual)
    add({"--mca", "btl", "self,vader"});
  else
    add({"--mca", "pml", "ob1", "--mca", "btl", "self,tcp", "--mca", "btl_tcp_if_include", "lo", "--mca",
         "btl_tcp_eager_limit", "56"});
#ifdef TUBEFOOT_SANITIZED
  // Open MPI unloads its plugins, so that what they do not give back has no name to hush it by.
  add({"-x", "ASAN_OPTIONS=detect_leaks=0"});
#endif
  words.insert(words.end(), {"-n", std::to_string(ranks)});
  return words;
}

}  // namespace tubefoot
