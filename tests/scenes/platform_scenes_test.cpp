// The committed platforms: as generated, closed, balanced, and consistent with their experiments.
#include <filesystem>

#include "core/constants.h"
#include "core/files.h"
#include "platform_closed_mesh.h"
#include "scenes/experiment/experiment.h"
#include "scenes/experiment/toml.h"
#include "scenes/gltf/reader.h"
#include "scenes/platforms/generator.h"

namespace photorque {
namespace {

struct Committed {
  std::string name;
  std::string experiment;
};
const Committed platforms[] = {{"stasis", "nominal"},
                               {"dumbbell", "dumbbell"},
                               {"tabletop", "tabletop"},
                               {"hollow", "hollow"},
                               {"spacecraft", "spacecraft"}};

std::filesystem::path folder_of(const Committed& platform) {
  return std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "scenes" / platform.name;
}

PlatformModel generated(const Committed& platform) {
  const SettingsNode parameters = read_toml(folder_of(platform) / "parameters.toml");
  return generate_platform(Settings(std::make_shared<const SettingsNode>(parameters)));
}

Scene scene_of(const Committed& platform) {
  return read_gltf(folder_of(platform) / (platform.name + ".gltf")).scene;
}

// Sheets of cells are open by design: one layer of cells, lit from one side.
bool is_sheet(const Instance& instance) {
  return instance.material == "solar_cell";
}

class CommittedPlatform : public testing::TestWithParam<Committed> {};

TEST_P(CommittedPlatform, IsByteForByteWhatTheGeneratorWrites) {
  const std::string committed = read_file(folder_of(GetParam()) / (GetParam().name + ".gltf"));
  EXPECT_TRUE(gltf_text(to_gltf(generated(GetParam()))) == committed)
      << "run: make_platform scenes/" << GetParam().name << "/parameters.toml scenes/"
      << GetParam().name << "/" << GetParam().name << ".gltf";
  EXPECT_LT(committed.size(), 500000u);
}

TEST_P(CommittedPlatform, ConsistsOfClosedSolidsThatFaceOutwards) {
  const Scene scene = scene_of(GetParam());
  size_t triangles = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    triangles += mesh.triangles.size();
    if (is_sheet(instance)) continue;
    EXPECT_EQ(fault_of_closed_mesh(mesh), "") << instance.path;
    Mesh placed = mesh;
    for (Vec3& vertex : placed.vertices_m) vertex = instance.body_from_mesh * vertex;
    EXPECT_GT(moments_of(placed).volume_m3, 0.0) << instance.path;
  }
  EXPECT_GE(triangles, 2000u);
  EXPECT_LE(triangles, 20000u);
}

// Through the file and back: axes, hierarchy, rotations and copies.
TEST_P(CommittedPlatform, ComesBackFromItsFileWhereItWasPut) {
  const PlatformModel platform = generated(GetParam());
  const Scene scene = scene_of(GetParam());
  ASSERT_EQ(scene.instances.size(), platform.parts.size());
  for (const PlatformPart& part : platform.parts) {
    const auto found = scene.instances_of(part.node);
    ASSERT_FALSE(found.empty()) << part.node;
    const Instance& instance = scene.instances[found.front()];
    ASSERT_EQ(instance.path, part.node);
    const Mesh& original = platform.meshes[part.mesh];
    const Mesh& read = scene.meshes[instance.mesh];
    ASSERT_EQ(read.triangles.size(), original.triangles.size());
    double farthest_m = 0.0;
    for (size_t i = 0; i < original.triangles.size(); ++i) {
      for (size_t k = 0; k < 3; ++k) {  // the reader may renumber vertices
        const Vec3& written_m = original.vertices_m[original.triangles[i][k]];
        const Vec3& read_m = read.vertices_m[read.triangles[i][k]];
        const Vec3 error_m =
            instance.body_from_mesh * read_m - part.body_from_part.point(written_m);
        farthest_m = std::max(farthest_m, error_m.norm());
      }
    }
    EXPECT_LT(farthest_m, 3e-7) << part.node;  // positions are floats in the file
  }
}

TEST_P(CommittedPlatform, HasItsCentreOfMassAtTheCentreOfRotation) {
  // Hand-set to 0.1 mm of the balancing parts, far below what moving masses correct.
  EXPECT_LT(generated(GetParam()).mass.centre_m.norm(), 2e-5);
}

TEST_P(CommittedPlatform, AgreesWithTheMassPropertiesOfItsExperiment) {
  const PlatformModel platform = generated(GetParam());
  const ExperimentFile file =
      read_experiment_file(folder_of(GetParam()) / (GetParam().experiment + ".toml"));
  const auto tables = file.others("platform");
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables[0].text("topology"), platform.topology);
  EXPECT_NEAR(tables[0].number("mass_kg") / platform.mass.mass_kg, 1.0, 1e-5);
  const Mat3 difference = tables[0].matrix3("inertia_kg_m2") - platform.mass.inertia_kg_m2;
  EXPECT_LT(difference.norm(), 1e-5 * platform.mass.inertia_kg_m2.norm());
}

TEST_P(CommittedPlatform, SaysWhatEveryMaterialDoesWithLight) {
  const GltfModel model = read_gltf(folder_of(GetParam()) / (GetParam().name + ".gltf"));
  for (const GltfMaterial& material : model.materials) {
    EXPECT_EQ(material.origin, OpticsOrigin::extras) << material.name;
  }
  EXPECT_TRUE(model.notices.empty()) << model.notices.front();
}

// Cells lie at least 0.2 mm above what carries them: no two surfaces at one depth.
TEST_P(CommittedPlatform, HasItsCellsClearOfTheBoard) {
  const Scene scene = scene_of(GetParam());
  const auto height_range = [&](const Instance& instance) {
    std::pair<double, double> range{1e9, -1e9};
    for (const Vec3& vertex : scene.meshes[instance.mesh].vertices_m) {
      const double z = (instance.body_from_mesh * vertex).z();
      range = {std::min(range.first, z), std::max(range.second, z)};
    }
    return range;
  };
  int sheets = 0;
  for (const Instance& cells : scene.instances) {
    if (!is_sheet(cells)) continue;
    ++sheets;
    EXPECT_FALSE(scene.meshes[cells.mesh].uv.empty());
    double nearest_m = 1e9;
    for (const Instance& other : scene.instances) {
      if (is_sheet(other)) continue;
      nearest_m =
          std::min(nearest_m, std::abs(height_range(cells).first - height_range(other).second));
    }
    EXPECT_GT(nearest_m, 1.99e-4) << cells.path;
  }
  EXPECT_GE(sheets, 1);
}

INSTANTIATE_TEST_SUITE_P(All, CommittedPlatform, testing::ValuesIn(platforms),
                         [](const auto& tested) { return tested.param.name; });

TEST(Stasis, WeighsSevenKilograms) {
  EXPECT_NEAR(generated(platforms[0]).mass.mass_kg, 7.0, 0.05 * 7.0);
}

TEST(Stasis, HasThePartsThatThePaperNames) {
  const Scene scene = scene_of(platforms[0]);
  const auto count = [&](const std::string& start) {
    return std::count_if(scene.instances.begin(), scene.instances.end(),
                         [&](const Instance& i) { return i.node.starts_with(start); });
  };
  EXPECT_EQ(count("horizontal_mass"), 4);
  EXPECT_EQ(count("vertical_mass"), 4);
  EXPECT_EQ(count("horizontal_rail") + count("vertical_rail"), 8);
  EXPECT_EQ(count("battery"), 4);
  EXPECT_EQ(count("stiffener"), 4);
  for (const char* node : {"bearing_ball", "top_plate", "bottom_plate", "solar_array"}) {
    EXPECT_EQ(count(node), 1) << node;
  }
}

// Half a full step of the balancing motors moves the centre of mass by the paper's 1.79e-7 m.
TEST(Stasis, MovingMassesGiveThePublishedResolution) {
  const PlatformModel platform = generated(platforms[0]);
  const double step_deg = 1.8, lead_m = 2e-3;  // assumed in parameters.toml
  for (const PlatformPart& part : platform.parts) {
    if (part.node.find("_mass_") == std::string::npos) continue;
    const double shift_m = 0.5 * step_deg / 360 * lead_m * part.mass_kg / platform.mass.mass_kg;
    EXPECT_NEAR(shift_m, 1.79e-7, 0.005e-7) << part.node;
  }
}

// Axis-aligned boxes at any multiple of 90 deg: parts touch but do not share space.
TEST(Stasis, PartsDoNotOverlap) {
  const Scene scene = scene_of(platforms[0]);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Instance& instance : scene.instances) {
    Eigen::AlignedBox3d box;
    for (const Vec3& vertex : scene.meshes[instance.mesh].vertices_m) {
      box.extend(Vec3(instance.body_from_mesh * vertex));
    }
    boxes.push_back(box);
  }
  for (size_t a = 0; a < boxes.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      const Vec3 shared_m = boxes[a].intersection(boxes[b]).sizes();
      EXPECT_LT(shared_m.minCoeff(), 1e-6)
          << scene.instances[a].path << " and " << scene.instances[b].path;
    }
  }
}

// The socket's pedestal, 40 mm wide from 50 mm below the centre downwards, stays clear of the
// platform at the paper's limit of 30 deg in every direction.
TEST(Stasis, ClearsThePedestalAtThirtyDegrees) {
  const Scene scene = scene_of(platforms[0]);
  for (int heading_deg = 0; heading_deg < 360; heading_deg += 5) {
    const RigidTransform lab_from_body =
        lab_from_body_at(30 * degree_rad, heading_deg * degree_rad);
    for (const Instance& instance : scene.instances) {
      const Mesh& mesh = scene.meshes[instance.mesh];
      for (const auto& triangle : mesh.triangles) {
        // Corners and middles of edges: no edge is long enough to cross the pedestal between them.
        for (size_t i = 0; i < 3; ++i) {
          const Vec3& a = mesh.vertices_m[triangle[i]];
          const Vec3& b = mesh.vertices_m[triangle[(i + 1) % 3]];
          for (const Vec3& corner : {a, Vec3(0.5 * (a + b))}) {
            const Vec3 p = lab_from_body.point(instance.body_from_mesh * corner);
            const bool inside = p.z() < -0.05 && p.head<2>().norm() < 0.02;
            ASSERT_FALSE(inside) << instance.path << " at heading " << heading_deg;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace photorque
