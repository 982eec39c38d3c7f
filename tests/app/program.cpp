// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/program.hpp"

#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace tubefoot {
namespace fs = std::filesystem;
namespace {

#ifdef TUBEFOOT_SANITIZED
constexpr unsigned longest_run_s = 1200;
#else
constexpr unsigned longest_run_s = 120;
#endif
constexpr uid_t nobody = 65534;

/// Who started the tests may ignore some (nohup, a shell's background).
void set_dispositions(const std::vector<int>& ignored) {
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  for (const int signal : ignored) std::signal(signal, SIG_IGN);
}

struct Pipe {
  int read_end = -1, write_end = -1;
  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    read_end = ends[0], write_end = ends[1];
  }
};

[[noreturn]] void become_program(std::vector<char*>& arguments, const Surroundings& surroundings, int out,
                                 int err) {
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  set_dispositions(surroundings.ignored);
  alarm(longest_run_s);  // survives exec: a program that hangs is ended
  if (surroundings.largest_file_bytes) {
    const rlimit limit{*surroundings.largest_file_bytes, *surroundings.largest_file_bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (surroundings.largest_memory_bytes) {
    const rlimit limit{*surroundings.largest_memory_bytes, *surroundings.largest_memory_bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  if (surroundings.stack_bytes) {
    const rlimit limit{*surroundings.stack_bytes, *surroundings.stack_bytes};
    setrlimit(RLIMIT_STACK, &limit);
  }
  if (surroundings.as_nobody && geteuid() == 0 &&
      (setgroups(0, nullptr) != 0 || setgid(nobody) != 0 || setuid(nobody) != 0))
    _exit(126);
  execv(arguments[0], arguments.data());
  _exit(127);
}

}  // namespace

TestFolder::TestFolder() {
  std::string name = (fs::temp_directory_path() / "tubefoot-app-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
  fs::permissions(path_, fs::perms(0755));
}

TestFolder::~TestFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path TestFolder::write(const std::string& name, std::string_view text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
  return path_ / name;
}

Outcome run_program(const std::vector<std::string>& arguments, const Surroundings& surroundings) {
  std::vector<std::string> words = surroundings.before;
  words.push_back(surroundings.program.empty() ? TUBEFOOT_PROGRAM : surroundings.program);
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  Pipe out, err;
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) become_program(pointers, surroundings, out.write_end, err.write_end);
  close(out.write_end);
  close(err.write_end);

  for (const int stream : surroundings.unread) {
    Pipe& pipe = stream == STDOUT_FILENO ? out : err;
    close(std::exchange(pipe.read_end, -1));
  }
  Outcome outcome;
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> signalled;
  bool interrupt = surroundings.interrupt_when || surroundings.interrupt_once_said;
  const auto is_time = [&] {
    return surroundings.interrupt_when ? surroundings.interrupt_when()
                                       : surroundings.interrupt_once_said(outcome.err);
  };
  std::array<pollfd, 2> streams{{{out.read_end, POLLIN, 0}, {err.read_end, POLLIN, 0}}};
  while (streams[0].fd >= 0 || streams[1].fd >= 0) {
    poll(streams.data(), streams.size(), interrupt ? 10 : -1);
    for (std::size_t k = 0; k < streams.size(); ++k) {
      if (streams[k].fd < 0 || streams[k].revents == 0) continue;
      std::array<char, 4096> buffer;
      const ssize_t count = read(streams[k].fd, buffer.data(), buffer.size());
      if (count > 0) {
        (k == 0 ? outcome.out : outcome.err).append(buffer.data(), static_cast<std::size_t>(count));
      } else {
        close(streams[k].fd);
        streams[k].fd = -1;  // poll() passes over it
      }
    }
    if (interrupt && is_time()) {
      kill(child, surroundings.signal);
      signalled = Clock::now();
      interrupt = false;
    }
  }
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  if (signalled) outcome.seconds_to_stop = std::chrono::duration<double>(Clock::now() - *signalled).count();
  outcome.peak_memory_mb = static_cast<double>(used.ru_maxrss) / 1024;
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  return outcome;
}

bool nobody_can_run_program() {
  Surroundings nobody_there;
  nobody_there.as_nobody = true;
  return run_program({"--version"}, nobody_there).exit_code == 0;
}

std::set<std::string> names_below(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    names.insert(fs::relative(entry.path(), folder).string());
  return names;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot open " + file.string());
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return bytes.str();
}

std::string replaced(std::string_view scene, std::string_view from, std::string_view to) {
  std::string text(scene);
  const std::size_t at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos)
    throw std::logic_error("the scene must contain once: " + std::string(from));
  return text.replace(at, from.size(), to);
}

}  // namespace tubefoot
