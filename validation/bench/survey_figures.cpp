// SPDX-License-Identifier: GPL-3.0-or-later
// Measures sidescan lines in child processes, whose statistics give speed and peak memory.
// survey_figures.hpp lists the figures.
#include "survey_figures.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "app/commands.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Runs a scene in a child process and returns its stats.json.
nlohmann::json run_apart(const fs::path& scene, const fs::path& output) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot start a process");
  if (child == 0) {
    dup2(open("/dev/null", O_WRONLY | O_CLOEXEC), STDOUT_FILENO);
    int code = 1;
    try {
      RunOptions options;
      options.scene = scene;
      options.output = output;
      options.quiet = true;
      code = run_command(options);
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
    }
    _exit(code);
  }
  int status = 0;
  if (waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(fmt::format("the run of {} failed", scene.string()));
  std::ifstream file(output / "stats.json");
  return nlohmann::json::parse(file);
}

double peak_of_flat_line(const fs::path& folder, int pings) {
  const fs::path scene = folder / fmt::format("flat-{}.toml", pings);
  std::ofstream(scene) << fmt::format(R"([georeference]
origin_lat_lon_deg = [48.36, -4.52]
[[materials]]
name = "mud"
[[terrain]]
kind = "flat"
width_m = 200
length_m = 1000
[trajectory]
kind = "line"
start_m = [0, -400, 5]
end_m = [0, 400, 5]
speed_m_s = 2
[[sensors]]
name = "sidescan"
kind = "sidescan"
pings = {}
ping_interval_s = 0.2
samples = 1000
)",
                                      pings);
  return run_apart(scene, folder / fmt::format("flat-{}", pings)).at("peak_memory_mb").get<double>();
}

/// A temporary folder that its destructor removes with its contents.
struct TemporaryFolder {
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "tubefoot-bench-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path = pattern;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  fs::path path;
};

}  // namespace

nlohmann::json stats_of_run(const fs::path& scene) {
  const TemporaryFolder folder;
  return run_apart(scene, folder.path / "run");
}

void survey_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const TemporaryFolder own;
  const fs::path& folder = own.path;

  const double few = peak_of_flat_line(folder, 100);
  figure("survey_growth_mb", peak_of_flat_line(folder, 2000) - few);
  const fs::path scenes = TUBEFOOT_SCENES;
  const nlohmann::json stats = run_apart(scenes / "real-grid/sidescan-line.toml", folder / "line");
  figure("survey_peak_mb", stats.at("peak_memory_mb").get<double>());
  figure("survey_pings_per_s",
         stats.at("pings").get<double>() / stats.at("seconds").at("simulation").get<double>());
}

}  // namespace tubefoot
