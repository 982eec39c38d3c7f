// SPDX-License-Identifier: GPL-3.0-or-later
// Runs Stonefish on a scenario file and saves the images of its forward-looking sonars:
//   stonefish_images SCENE.scn FOLDER [NUMBER [FIRST_STEP]]
// Stonefish's own parser reads the scenario, and Stonefish renders each image. FOLDER/SONAR-NNNN.png (8 bits)
// or FOLDER/SONAR-NNNN.npy (other formats) contains the rows as Stonefish stores them: the first row is the
// farthest range. Mesh names are relative to the folder of the scenario.
#include <Stonefish/core/Console.h>
#include <Stonefish/core/GraphicalSimulationApp.h>
#include <Stonefish/core/ScenarioParser.h>
#include <Stonefish/core/SimulationManager.h>
#include <Stonefish/sensors/vision/FLS.h>
#include <Stonefish/stb_image_write.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace {

namespace fs = std::filesystem;

constexpr double step_s = 0.1;
// The first images show an empty scene, because Stonefish fills its drawing queue after the first step.
constexpr int default_first_step = 4;

struct Request {
  fs::path scenario, folder;
  int images = 1, first_step = default_first_step;
};

std::string npy_header(const char* type, unsigned rows, unsigned columns) {
  std::string text = std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': (" +
                     std::to_string(rows) + ", " + std::to_string(columns) + "), }";
  constexpr std::size_t preamble = 10, alignment = 64;
  while ((preamble + text.size() + 1) % alignment) text += ' ';
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() % 256);
  header += static_cast<char>(text.size() / 256);
  return header + text;
}

bool save(sf::FLS& sonar, const fs::path& stem) {
  unsigned beams = 0, bins = 0;
  sonar.getResolution(beams, bins);
  const void* data = sonar.getImageDataPointer();
  const auto write_npy = [&](const char* type, std::size_t bytes) {
    std::ofstream file(stem.string() + ".npy", std::ios::binary);
    file << npy_header(type, bins, beams);
    file.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes * beams * bins));
    return static_cast<bool>(file);
  };
  switch (sonar.getOutputFormat()) {
    case sf::SonarOutputFormat::U8:
      return stbi_write_png((stem.string() + ".png").c_str(), static_cast<int>(beams), static_cast<int>(bins),
                            1, data, static_cast<int>(beams)) != 0;
    case sf::SonarOutputFormat::U16:
      return write_npy("<u2", 2);
    case sf::SonarOutputFormat::U32:
      return write_npy("<u4", 4);
    case sf::SonarOutputFormat::F32:
      return write_npy("<f4", 4);
  }
  return false;
}

class Manager : public sf::SimulationManager {
 public:
  explicit Manager(const Request& request) : sf::SimulationManager(1 / step_s), request_(request) {}

  void BuildScenario() override {
    sf::ScenarioParser parser(this);
    const bool read = parser.Parse(request_.scenario.string());
    for (const sf::ConsoleMessage& message : parser.getLog())
      if (message.type != sf::MessageType::INFO)
        std::fprintf(stderr, "%s: %s\n", request_.scenario.c_str(), message.text.c_str());
    if (!read) fail("Stonefish cannot read the scenario");
    for (unsigned k = 0; sf::Sensor* sensor = getSensor(k); ++k)
      if (auto* sonar = dynamic_cast<sf::FLS*>(sensor)) {
        saved_[sonar->getName()] = 0;
        sonar->InstallNewDataHandler([this](sf::FLS* which) { receive(*which); });
      }
    if (saved_.empty()) fail("no sensor of type fls in the scenario");
  }

  void step_begins() { ++steps_; }

  bool complete() const {
    for (const auto& [name, number] : saved_)
      if (number < request_.images) return false;
    return true;
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    std::fprintf(stderr, "%s: %s\n", request_.scenario.c_str(), what);
    std::_Exit(2);  // Stonefish's threads are running, so static objects must not be destroyed here.
  }

  void receive(sf::FLS& sonar) {
    int& number = saved_[sonar.getName()];
    if (steps_ < request_.first_step || number >= request_.images) return;
    char digits[16];
    std::snprintf(digits, sizeof digits, "-%04d", number++);
    if (!save(sonar, request_.folder / (sonar.getName() + digits))) fail("cannot write the image");
  }

  Request request_;
  std::map<std::string, int> saved_;
  int steps_ = 0;
};

class App : public sf::GraphicalSimulationApp {
 public:
  App(const Request& request, sf::RenderSettings settings, Manager& manager)
      : sf::GraphicalSimulationApp("sonar images", request.scenario.parent_path().string() + "/", settings,
                                   sf::HelperSettings(), &manager),
        manager_(manager) {}

  /// Advances the simulation by one step per rendered frame, so that images do not depend on the speed of the
  /// machine.
  void ProcessInputs() override {
    if (manager_.complete()) {
      std::fflush(nullptr);
      std::_Exit(0);  // Stonefish's clean-up ends in errors of its window system on some machines.
    }
    manager_.step_begins();
    StepSimulation();
  }

 private:
  Manager& manager_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc > 5) {
    std::fprintf(stderr, "usage: %s SCENE.scn FOLDER [NUMBER [FIRST_STEP]]\n", argv[0]);
    return 2;
  }
  Request request{fs::absolute(argv[1]), fs::absolute(argv[2])};
  if (argc > 3) request.images = std::atoi(argv[3]);
  if (argc > 4) request.first_step = std::atoi(argv[4]);
  fs::create_directories(request.folder);
  sf::RenderSettings settings;
  settings.windowW = settings.windowH = 128;
  settings.shadows = settings.ao = settings.atmosphere = settings.ocean = settings.aa = settings.ssr =
      sf::RenderQuality::DISABLED;
  Manager manager(request);
  App app(request, settings, manager);
  app.Run(true, false, step_s);
  return 2;  // The window was closed.
}
