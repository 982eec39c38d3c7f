// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>

#include "sensors/kinds/kind_didson.hpp"
#include "sensors/kinds/kind_sidescan.hpp"
#include "sensors/recordings/recording.hpp"

// Small sensors and recordings for the tests of this folder.
namespace tubefoot::samples {

inline constexpr double degree = std::numbers::pi / 180;

inline SensorDescription camera(int beams = 96, int range_samples = 512) {
  SensorDescription description;
  description.name = "camera";
  DidsonDescription didson;
  didson.beams = beams;
  didson.samples = range_samples;
  description.kind = didson;
  return description;
}

inline SensorDescription sidescan(int range_samples = 1000) {
  SensorDescription description;
  description.name = "sidescan";
  SidescanDescription fan;
  fan.samples = range_samples;
  description.kind = fan;
  return description;
}

/// A recording that owns its sensor: pings 0.5 m apart northwards, all energies zero.
struct OwnedRecording {
  std::unique_ptr<Sensor> sensor;
  Recording recording;
  std::vector<double> energies;

  double& energy(std::size_t ping, std::size_t beam, std::size_t sample) {
    return energies[(ping * sensor->beams().size() + beam) * sensor->samples().count + sample];
  }
};

inline OwnedRecording silent(SensorDescription description, int pings) {
  description.pings = pings;
  OwnedRecording made{make_sensor(description), {}, {}};
  made.recording.sensor = made.sensor.get();
  made.recording.ping_time_s = made.sensor->ping_times_s();
  for (int ping = 0; ping < pings; ++ping)
    made.recording.ping_pose.push_back({{0, 0.5 * ping, -5}, {1, 0, 0, 0}});
  made.energies.assign(std::size_t(pings) * made.sensor->beams().size() * made.sensor->samples().count, 0.0);
  made.recording.energy = made.energies;
  made.recording.sound_speed_m_s = 1480;
  made.recording.absorption_db_per_km = 700;
  return made;
}

/// A folder of the test's own, gone afterwards.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tubefoot-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// No file can grow beyond `bytes` while this lives: writing more fails as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Runs `action`, which must throw a std::runtime_error that names the file; returns what it says.
template <typename Action>
std::string failure_naming(const std::filesystem::path& file, Action action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error for " << file;
  return {};
}

}  // namespace tubefoot::samples
