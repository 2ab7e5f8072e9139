// A lamp from an IES file and the tracer together, against a closed form that neither uses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/constants.h"
#include "core/files.h"
#include "core/provenance.h"
#include "raytrace/tracing/tracer.h"
#include "scenes/experiment/experiment.h"
#include "sources/photometry/file.h"
#include "tests/raytrace/test_scenes.h"
#include "tests/settings.h"
#include "tests/sources/ies_writer.h"

namespace photorque {
namespace {

// The power by Lambert's law from a point to a square of side 2a at distance z in front of it,
// centred on the axis: four times the view factor to a rectangle with a corner on the axis. Source:
// J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3.
double lambert_on_square(double a_over_z) {
  const double root = std::sqrt(1.0 + a_over_z * a_over_z);
  return 4.0 * 2.0 * (a_over_z / root) * std::atan(a_over_z / root) / (2.0 * pi);
}

std::vector<Beam> lamp_over_origin(const std::filesystem::path& folder) {
  return test::make_beams("ies",
                          {{"file", {"lambert.ies"}},
                           {"power_W", {2.0}},
                           {"wavelength_nm", {730.0}},
                           {"position_m", test::vector_node(0, 0, 1)},
                           {"direction", test::vector_node(0, 0, -1)}},
                          {.folder = folder});
}

// Lambert's law in steps of one degree, written as a file.
std::filesystem::path lambert_file(const std::string& folder) {
  PhotometricFile file;
  for (int degrees = 0; degrees <= 90; ++degrees) {
    file.table.polar_rad.push_back(degrees * degree_rad);
    file.table.intensity.push_back(std::max(0.0, std::cos(degrees * degree_rad)));
  }
  file.table.azimuth_rad = {0.0};
  const auto path = std::filesystem::path(::testing::TempDir()) / folder / "lambert.ies";
  write_file_whole(path, write_ies(file));
  return path;
}

TEST(IesLamp, IsFoundBesideTheExperimentAndHashedAmongItsInputs) {
  const auto file = lambert_file("ies_beside_experiment");
  const auto scene = std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "scenes/stasis/stasis.gltf";
  const auto toml = file.parent_path() / "lamp.toml";
  write_file_whole(toml, "[scene]\nfile = \"" + scene.string() +
                             "\"\n[[source]]\nkind = \"ies\"\nfile = \"lambert.ies\"\n"
                             "power_W = 3\nwavelength_nm = 730\nposition_m = [0, 0, 2]\n"
                             "direction = [0, 0, -1]\n");
  const Experiment experiment = resolve_experiment(read_experiment_file(toml));
  ASSERT_EQ(experiment.beams.size(), 1u);
  EXPECT_EQ(experiment.beams[0].emitter->power_W(), 3.0);
  const std::pair<std::string, std::string> input{"lambert.ies", content_hash(read_file(file))};
  EXPECT_NE(std::find(experiment.inputs.begin(), experiment.inputs.end(), input),
            experiment.inputs.end());
  EXPECT_THROW(resolve_experiment(read_experiment_file(
                   toml, std::vector<std::string>{"source[0].file=other.ies"})),
               InputError);
}

}  // namespace
}  // namespace photorque
