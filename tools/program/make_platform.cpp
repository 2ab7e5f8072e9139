// make_platform PARAMETERS.toml SCENE.gltf: builds a platform's scene from its parameter file and
// prints its mass properties as the [platform] table of an experiment.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "core/errors.h"
#include "core/files.h"
#include "scenes/experiment/toml.h"
#include "scenes/platforms/generator.h"

namespace {

constexpr int wrong_input = 2;

void make_platform(const std::filesystem::path& parameters, const std::filesystem::path& scene) {
  using namespace photorque;
  const Settings settings(std::make_shared<const SettingsNode>(read_toml(parameters)));
  const PlatformModel platform = generate_platform(settings);
  write_file_whole(scene, gltf_text(to_gltf(platform)));
  std::fputs(platform_table_toml(platform).c_str(), stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Builds the scene of a platform from a parameter file");
  std::filesystem::path parameters, scene;
  app.add_option("parameters", parameters, "parameter file (.toml)")->required();
  app.add_option("scene", scene, "scene to write (.gltf)")->required();
  try {
    app.parse(argc, argv);
    make_platform(parameters, scene);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : wrong_input;
  } catch (const photorque::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return wrong_input;
  }
  return 0;
}
