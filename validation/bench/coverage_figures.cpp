// SPDX-License-Identifier: GPL-3.0-or-later
// Measures coverages in child processes, by the times and the peak memory that the system counts.
// coverage_figures.hpp lists the figures.
#include "coverage_figures.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "app/commands.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

struct ChildCost {
  double seconds = 0, peak_mb = 0;
};

/// Runs a command in a child process.
ChildCost cost_of(const std::function<int()>& command) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot start a process");
  if (child == 0) {
    dup2(open("/dev/null", O_WRONLY | O_CLOEXEC), STDOUT_FILENO);
    int code = 1;
    try {
      code = command();
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
    }
    _exit(code);
  }
  int status = 0;
  rusage used{};
  if (wait4(child, &status, 0, &used) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error("a command on the scene of a wall failed");
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {seconds(used.ru_utime) + seconds(used.ru_stime), static_cast<double>(used.ru_maxrss) / 1024};
}

/// A temporary folder that its destructor removes with its contents.
struct CoverageFolder {
  CoverageFolder() {
    std::string pattern = (fs::temp_directory_path() / "tubefoot-bench-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path = pattern;
  }
  CoverageFolder(const CoverageFolder&) = delete;
  CoverageFolder& operator=(const CoverageFolder&) = delete;
  ~CoverageFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  fs::path path;
};

/// Returns the scene with fewer pings along the same trajectory.
fs::path wall_with_pings(const fs::path& folder, int pings) {
  std::ifstream file(fs::path(TUBEFOOT_SCENES) / "coverage/scene.toml");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto replace = [&](const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    if (at == std::string::npos) throw std::runtime_error("the scene of a wall has no line " + what);
    text.replace(at, what.size(), by);
  };
  replace("pings = 100", fmt::format("pings = {}", pings));
  replace("ping_interval_s = 0.09", fmt::format("ping_interval_s = {}", 0.09 * 100 / pings));
  const fs::path scene = folder / fmt::format("wall-{}.toml", pings);
  std::ofstream(scene) << text;
  return scene;
}

}  // namespace

void coverage_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const CoverageFolder folder;
  const auto coverage = [&](int pings) {
    CoverageOptions options;
    options.scene = wall_with_pings(folder.path, pings);
    options.output = folder.path / fmt::format("coverage-{}", pings);
    options.quiet = true;
    options.threads = 1;
    return cost_of([&] { return coverage_command(options); });
  };
  const ChildCost all = coverage(100), half = coverage(50), quarter = coverage(25);
  const ChildCost run = cost_of([&] {
    RunOptions options;
    options.scene = wall_with_pings(folder.path, 100);
    options.output = folder.path / "run";
    options.quiet = true;
    options.threads = 1;
    return run_command(options);
  });
  figure("coverage_100_pings_s", all.seconds);
  figure("coverage_100_pings_over_run", all.seconds / run.seconds);
  figure("coverage_peak_mb", all.peak_mb);
  figure("coverage_growth_exponent",
         std::max(std::log2(all.seconds / half.seconds), std::log2(half.seconds / quarter.seconds)));
}

}  // namespace tubefoot
