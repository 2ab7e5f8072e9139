// The committed platforms: closed, with optics, and with parts where they belong. That they are as
// generated, balanced and consistent with their experiments: test_make_platform.py.
#include <filesystem>
#include <map>

#include "core/constants.h"
#include "core/transform.h"
#include "scenes/gltf/reader.h"

namespace photorque {
namespace {

const std::string platforms[] = {"stasis", "dumbbell", "tabletop", "hollow", "spacecraft"};

std::filesystem::path scene_file(const std::string& platform) {
  return std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "scenes" / platform / (platform + ".gltf");
}

Scene scene_of(const std::string& platform) {
  return read_gltf(scene_file(platform)).scene;
}

// Sheets of cells are open by design: one layer of cells, lit from one side.
bool is_sheet(const Instance& instance) {
  return instance.material == "solar_cell";
}

// The fault of triangles that are not a closed surface with every edge once in each direction;
// empty if nothing does.
std::string fault_of_closed_mesh(const Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> uses;
  for (const auto& triangle : mesh.triangles) {
    for (size_t i = 0; i < 3; ++i) {
      const std::pair edge{triangle[i], triangle[(i + 1) % 3]};
      if (edge.first == edge.second) return "a triangle with two equal corners";
      if (++uses[edge] > 1) return "an edge twice in the same direction";
    }
  }
  for (const auto& [edge, count] : uses) {
    if (!uses.contains({edge.second, edge.first})) return "an open edge";
  }
  return uses.empty() ? "no triangles" : "";
}

double volume_m3(const Mesh& mesh) {
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume += mesh.vertices_m[a].cross(mesh.vertices_m[b]).dot(mesh.vertices_m[c]) / 6.0;
  }
  return volume;
}

class CommittedPlatform : public testing::TestWithParam<std::string> {};

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
    EXPECT_GT(volume_m3(placed), 0.0) << instance.path;
  }
  EXPECT_GE(triangles, 2000u);
  EXPECT_LE(triangles, 20000u);
}

TEST_P(CommittedPlatform, ListsTheOpticsOfEveryMaterial) {
  const GltfModel model = read_gltf(scene_file(GetParam()));
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
                         [](const auto& tested) { return tested.param; });

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

// Axis-aligned boxes at any multiple of 90 deg: parts touch but do not share space.
TEST(Stasis, PartsDoNotOverlap) {
  const Scene scene = scene_of(platforms[0]);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Instance& instance : scene.instances) boxes.push_back(scene.box_of(instance));
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
