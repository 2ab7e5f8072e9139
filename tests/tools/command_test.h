// Shared by the tests of the commands: the program run as a user runs it, in a separate folder.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/files.h"

namespace photorque {

inline const std::string program_file = std::string(PHOTORQUE_BINARY_DIR) + "/photorque",
                         source_folder = PHOTORQUE_SOURCE_DIR,
                         nominal_file = source_folder + "/scenes/stasis/nominal.toml",
                         attitude_file = source_folder + "/scenes/stasis/attitude.toml";
inline const fs::path shipped_scenes = source_folder + "/scenes";

// The exit status and all that the program printed.
struct Outcome {
  int status = -1;
  std::string out, err;
};

// The kinds of the effects of a diagnosis.
inline std::vector<std::string> kinds_in(const nlohmann::json& answer) {
  std::vector<std::string> kinds;
  for (const auto& effect : answer.at("effects")) kinds.push_back(effect.at("kind"));
  return kinds;
}

// A figure of summary.json.
inline double value(const nlohmann::json& summary, const std::string& name) {
  return summary.at(name).at("value").get<double>();
}

class CommandTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  // A command of the shell that ends in the program's arguments, or in a group of commands.
  Outcome shell(const std::string& command) const {
    const int status = std::system((command + " >" + at("stdout") + " 2>" + at("stderr")).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, file_text(at("stdout")),
            file_text(at("stderr"))};
  }
  // `photorque ARGUMENTS`.
  Outcome run(const std::string& arguments) const { return shell(program_file + " " + arguments); }
  // One that succeeds.
  Outcome succeed(const std::string& arguments) const {
    Outcome got = run(arguments);
    EXPECT_EQ(got.status, 0) << arguments << '\n' << got.err;
    return got;
  }
  // The lines, usually one, of one that is refused.
  std::string refused(const std::string& arguments, int lines = 1) const {
    return refusal_in(run(arguments), lines);
  }
  static std::string refusal_in(const Outcome& got, int lines = 1) {
    EXPECT_EQ(got.status, 2) << got.err;
    EXPECT_EQ(std::ranges::count(got.err, '\n'), lines) << got.err;
    return got.err;
  }
  // `photorque ARGUMENTS` as another process, whose text is added to a file.
  static pid_t start(const std::string& arguments, const std::string& into = "/dev/null") {
    const std::string command = "exec " + program_file + " " + arguments + " >>" + into + " 2>&1";
    const pid_t child = ::fork();
    if (child == 0) {
      ::signal(SIGINT, SIG_DFL);  // background processes of a shell ignore it
      ::signal(SIGHUP, SIG_DFL);
      ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      ::_exit(127);
    }
    return child;
  }
  // Its exit status; -1 where a signal ended it.
  static int end_of(pid_t child) {
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  static void kill_process(pid_t child) {
    ::kill(child, SIGKILL);
    end_of(child);
  }
  // Its refusal contains these words.
  void expect_refusal(const std::string& arguments, const std::string& words) const {
    EXPECT_THAT(refused(arguments), ::testing::HasSubstr(words)) << arguments;
  }
  // The path of a file in the test's folder.
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  // Writes a file into the test's folder and gives its path.
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(at(name)) << text;
    return at(name);
  }
  // summary.json of a folder, and a figure of it.
  nlohmann::json summary(const std::string& folder = "out") const {
    return nlohmann::json::parse(file_text(at(folder + "/summary.json")));
  }
  double figure(const std::string& name, const std::string& folder = "out") const {
    return value(summary(folder), name);
  }
  // A level, black, square plate, its middle at this height over the centre of rotation, and its
  // buffer in a file beside it.
  void write_plate(double edge_m = 0.4, double height_m = 0.1) const {
    std::string bytes;
    const float h = static_cast<float>(edge_m / 2), y = static_cast<float>(height_m);
    for (const auto& [x, z] : {std::pair{-h, h}, {h, h}, {h, -h}, {-h, -h}}) {
      for (const float c : {x, y, z}) bytes.append(reinterpret_cast<const char*>(&c), 4);
    }
    for (const uint16_t i : {0, 1, 2, 0, 2, 3}) bytes.append(reinterpret_cast<const char*>(&i), 2);
    write("plate geometry.bin", bytes);
    std::ostringstream out;
    out << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
        << R"("nodes":[{"mesh":0,"name":"plate"}],)"
        << R"("materials":[{"name":"black","extras":{"photorque":{"absorptance":1.0,"specular":0.0,"diffuse":0.0,"transmittance":0.0}}}],)"
        << R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],)"
        << R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)"
        << "\"min\":[" << -h << "," << y << "," << -h << "],\"max\":[" << h << "," << y << "," << h
        << "]},"
        << R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],)"
        << R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],)"
        << R"("buffers":[{"byteLength":60,"uri":"plate%20geometry.bin"}]})";
    write("plate.gltf", out.str());
  }
  // Every file below a folder by its name.
  std::map<std::string, std::string> files(const std::string& name) const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / name)) {
      if (entry.is_regular_file()) all[entry.path().filename()] = file_text(entry.path());
    }
    return all;
  }

  fs::path folder_;
};

}  // namespace photorque
