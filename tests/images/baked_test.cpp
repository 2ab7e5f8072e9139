// Baked models: what a viewer of glTF finds in the file.
#include "images/browser/baked.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "images/writers/read_picture.h"

namespace photorque {
namespace {

using nlohmann::json;

struct Glb {
  json file;
  std::string bytes;

  template <typename T>
  std::vector<T> numbers(const json& accessor_index) const {
    const json& accessor = file["accessors"][accessor_index.get<size_t>()];
    const json& view = file["bufferViews"][accessor["bufferView"].get<size_t>()];
    std::vector<T> all(view["byteLength"].get<size_t>() / sizeof(T));
    std::memcpy(all.data(), bytes.data() + view["byteOffset"].get<size_t>(),
                all.size() * sizeof(T));
    return all;
  }
  const json& node(size_t scene, size_t root, size_t child) const {
    const json& above = file["nodes"][file["scenes"][scene]["nodes"][root].get<size_t>()];
    return file["nodes"][above["children"][child].get<size_t>()];
  }
  const json& primitive(const json& node) const {
    return file["meshes"][node["mesh"].get<size_t>()]["primitives"][0];
  }
};

// By the layout of glTF 2.0, section 4.4.
Glb opened(const std::string& glb) {
  const auto word = [&glb](size_t at) {
    uint32_t number = 0;
    std::memcpy(&number, glb.data() + at, sizeof number);
    return number;
  };
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2u);
  EXPECT_EQ(word(8), glb.size());
  const uint32_t text = word(12);
  EXPECT_EQ(glb.substr(16, 4), "JSON");
  EXPECT_EQ(text % 4, 0u);
  EXPECT_EQ(glb.substr(24 + text, 4), std::string("BIN\0", 4));
  EXPECT_EQ(word(20 + text), glb.size() - 28 - text);
  return {json::parse(glb.substr(20, text)), glb.substr(28 + text)};
}

// A square of 2 m, its map of 2 × 2 bins from 0 to 30 W/m², on a part with one more triangle.
struct Lit {
  SceneStage stage;
  Product product;
};

Lit lit_square(PaintedSurface::Side side) {
  Lit lit;
  const std::vector<float> corners = {-1, -1, 0.5f, 1, -1, 0.5f, 1, 1, 0.5f, -1, 1, 0.5f};
  StagePart part{"plate", {0.5, 0.5, 0.5}, corners, {0, 1, 2, 0, 2, 3, 0, 1, 4}};
  part.position_m.insert(part.position_m.end(), {0, 0, 0});
  lit.stage.parts = {part};
  PaintedSurface surface{"cells", corners,           {0, 0, 1, 0, 1, 1, 0, 1}, {0, 1, 2, 0, 2, 3},
                         side,    "irradiance_cells"};
  lit.stage.paintings = {{"Irradiance", "W/m²", false, {surface}}};
  // A turn by 30 deg about body y.
  lit.stage.states = {
      {{Quat(std::cos(std::acos(-1.0) / 12), 0, std::sin(std::acos(-1.0) / 12), 0)}}};
  Map map;
  map.name = "irradiance_cells";
  map.title = "Irradiance on cells";
  map.unit = "W/m²";
  map.width = map.height = 2;
  map.value = {0, 10, 20, 30};  // the lower row first
  map.standard_error.assign(4, 0.1);
  lit.product.maps = {map};
  return lit;
}

TEST(Baked, TexturesShowTheMapInItsColours) {
  const Lit lit = lit_square(PaintedSurface::Side::both);
  const Glb glb = opened(baked_glb(lit.stage, lit.product, build_provenance()));
  EXPECT_EQ(glb.file["asset"]["extras"]["photorque"]["low"], 0.0);
  EXPECT_EQ(glb.file["asset"]["extras"]["photorque"]["high"], 30.0);
  const json& view = glb.file["bufferViews"][glb.file["images"][0]["bufferView"].get<size_t>()];
  const LinearPicture picture =
      read_picture(glb.bytes.substr(view["byteOffset"], view["byteLength"]));
  ASSERT_EQ(picture.width, 2);
  ASSERT_EQ(picture.height, 2);
  // The ends of viridis as matplotlib publishes them, (68, 1, 84) and (253, 231, 37), made linear
  // by IEC 61966-2-1: the smallest value is the lower left bin, the largest the upper right one.
  const auto linear = [](int byte) {
    const double x = byte / 255.0;
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  };
  const std::array<int, 3> dark = {68, 1, 84}, bright = {253, 231, 37};
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(picture.rgb[6 + k], linear(dark[k]), 0.02) << k;
    EXPECT_NEAR(picture.rgb[3 + k], linear(bright[k]), 0.02) << k;
  }
  // (u, v) counts from the top: body (−1, −1, 0.5) is glTF (−1, 0.5, 1) and the picture's lower
  // left corner.
  const json& attributes = glb.primitive(glb.node(0, 1, 0))["attributes"];
  EXPECT_THAT(glb.numbers<float>(attributes["POSITION"]),
              testing::ElementsAre(-1, 0.5f, 1, 1, 0.5f, 1, 1, 0.5f, -1, -1, 0.5f, -1));
  EXPECT_THAT(glb.numbers<float>(attributes["TEXCOORD_0"]),
              testing::ElementsAre(0, 1, 1, 1, 1, 0, 0, 0));
}

TEST(Baked, VerticesCarryValuesAndColours) {
  const Lit lit = lit_square(PaintedSurface::Side::both);
  const Glb glb = opened(baked_glb(lit.stage, lit.product, build_provenance()));
  const json& primitive = glb.primitive(glb.node(1, 1, 0));
  const auto position = glb.numbers<float>(primitive["attributes"]["POSITION"]);
  const auto value = glb.numbers<float>(primitive["attributes"]["_VALUE"]);
  const auto colour = glb.numbers<float>(primitive["attributes"]["COLOR_0"]);
  const auto index = glb.numbers<uint32_t>(primitive["indices"]);
  ASSERT_EQ(value.size() * 3, position.size());
  ASSERT_EQ(colour.size(), position.size());
  double area_m2 = 0.0;
  for (size_t t = 0; t < index.size(); t += 3) {
    const auto at = [&](size_t k) {
      const float* p = &position[3 * index[t + k]];
      return Vec3(p[0], p[1], p[2]);
    };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
    EXPECT_GT(normal.y(), 0.0);  // as the square's own: up
    area_m2 += 0.5 * normal.norm();
    EXPECT_LE((at(1) - at(0)).cwiseAbs().maxCoeff(), 1.0 + 1e-6);  // a bin
  }
  EXPECT_NEAR(area_m2, 4.0, 1e-6);
  for (size_t i = 0; i < value.size(); ++i) {
    // Bilinear between the middles of the bins, constant beyond: 15 + 5 x + 10 y with x, y from −1
    // to 1 (x, y in metres; the middles are at ± 0.5).
    const double x = std::clamp(position[3 * i] / 0.5, -1.0, 1.0);
    const double y = std::clamp(-position[3 * i + 2] / 0.5, -1.0, 1.0);
    EXPECT_NEAR(value[i], 15 + 5 * x + 10 * y, 1e-4);
    EXPECT_GE(colour[3 * i + 1], 0.0f);
    EXPECT_LE(colour[3 * i + 1], 0.82f);
  }
}

TEST(Baked, PartsLeaveOutWhatIsPaintedAndTheBodyIsTurned) {
  const Lit lit = lit_square(PaintedSurface::Side::both);
  const Glb glb = opened(baked_glb(lit.stage, lit.product, build_provenance()));
  const json& plate = glb.node(0, 0, 0);
  EXPECT_EQ(plate["name"], "plate");
  // In both scenes, by nodes of their own on one mesh.
  EXPECT_EQ(glb.node(1, 0, 0), plate);
  EXPECT_NE(glb.file["scenes"][0]["nodes"][0], glb.file["scenes"][1]["nodes"][0]);
  EXPECT_THAT(glb.numbers<uint32_t>(glb.primitive(plate)["indices"]),
              testing::ElementsAre(0, 1, 4));
  // 30 deg about body y, which is −z of glTF.
  for (const size_t root : {0u, 1u}) {
    const json& turn =
        glb.file["nodes"][glb.file["scenes"][0]["nodes"][root].get<size_t>()]["rotation"];
    EXPECT_NEAR(turn[0], 0.0, 1e-12);
    EXPECT_NEAR(turn[1], 0.0, 1e-12);
    EXPECT_NEAR(turn[2], -0.2588190451, 1e-9);
    EXPECT_NEAR(turn[3], 0.9659258263, 1e-9);
  }
}

TEST(Baked, AMapOfOneSideIsSeenFromThatSide) {
  for (const auto side : {PaintedSurface::Side::front, PaintedSurface::Side::back}) {
    const Lit lit = lit_square(side);
    const Glb glb = opened(baked_glb(lit.stage, lit.product, build_provenance()));
    const json& painted = glb.primitive(glb.node(0, 1, 0));
    const json& other = glb.primitive(glb.node(0, 0, 1));
    for (const json* primitive : {&painted, &other}) {
      EXPECT_EQ(glb.file["materials"][(*primitive)["material"].get<size_t>()]["doubleSided"],
                false);
    }
    const bool front = side == PaintedSurface::Side::front;
    const std::vector<uint32_t> up = {0, 1, 2, 0, 2, 3}, down = {0, 2, 1, 0, 3, 2};
    EXPECT_EQ(glb.numbers<uint32_t>(painted["indices"]), front ? up : down);
    EXPECT_EQ(glb.numbers<uint32_t>(other["indices"]), front ? down : up);
  }
}

TEST(Baked, EqualInputGivesEqualBytesAndAMissingMapIsSaid) {
  Lit lit = lit_square(PaintedSurface::Side::both);
  EXPECT_TRUE(baked_glb(lit.stage, lit.product, build_provenance()) ==
              baked_glb(lit.stage, lit.product, build_provenance()));
  lit.product.maps.clear();
  EXPECT_THROW(baked_glb(lit.stage, lit.product, build_provenance()), InputError);
}

}  // namespace
}  // namespace photorque
