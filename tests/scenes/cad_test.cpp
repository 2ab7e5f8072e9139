// STL and OBJ: the same bodies as in other formats, with areas and volumes from geometry, and what
// is wrong with a file in one line.
#include <cmath>

#include "gltf_test_model.h"
#include "scenes/cad/model.h"
#include "scenes/cad/part.h"
#include "scenes/experiment/experiment.h"
#include "tests/settings.h"

namespace photorque {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::filesystem::path seeds =
    std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "tests/fuzz/seeds";

GltfModel stl(const std::string& bytes, const CadConventions& how = {1.0}) {
  return read_cad_bytes(bytes, "part.stl", CadFormat::stl, how);
}

GltfModel obj(const std::string& text, const CadConventions& how = {1.0},
              const GltfOptions& options = {}) {
  return read_cad_bytes(text, "part.obj", CadFormat::obj, how, options);
}

// Twice the area of a triangle is the length of this.
Vec3 twice_area(const std::array<Vec3, 3>& p) {
  return (p[1] - p[0]).cross(p[2] - p[0]);
}

double area_in_triangles(const std::vector<Vec3>& polygon) {
  double area = 0.0;
  for (const auto& [a, b, c] : cad::triangles_of(polygon)) {
    area += 0.5 * twice_area({polygon[a], polygon[b], polygon[c]}).norm();
  }
  return area;
}

struct Extent {
  size_t triangles = 0;
  double area_m2 = 0.0, volume_m3 = 0.0;  // volume by the divergence theorem: positive outwards
  Vec3 area_vector_m2 = Vec3::Zero();
};

Extent extent_of(const Scene& scene) {
  Extent extent;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    for (size_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t) {
      const auto p = body_corners(scene, i, t);
      ++extent.triangles;
      extent.area_m2 += 0.5 * twice_area(p).norm();
      extent.area_vector_m2 += 0.5 * twice_area(p);
      extent.volume_m3 += p[0].dot(p[1].cross(p[2])) / 6.0;
    }
  }
  return extent;
}

using StlFacet = std::array<float, 9>;  // x, y, z of three corners

// Without a normal or attributes.
std::string facet_bytes(const StlFacet& corners) {
  return std::string(12, '\0') +
         std::string(reinterpret_cast<const char*>(corners.data()), sizeof corners) +
         std::string(2, '\0');
}

// A unit tetrahedron at the origin: volume 1/6, area 3/2 + √3/2.
std::string tetrahedron_stl() {
  const StlFacet facets[] = {{0, 0, 0, 0, 1, 0, 1, 0, 0},
                             {0, 0, 0, 1, 0, 0, 0, 0, 1},
                             {0, 0, 0, 0, 0, 1, 0, 1, 0},
                             {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  std::string bytes(80, ' ');
  bytes += word_bytes(4);
  for (const StlFacet& facet : facets) bytes += facet_bytes(facet);
  return bytes;
}

TEST(Stl, TetrahedronHasItsVolumeAndArea) {
  const GltfModel model = stl(tetrahedron_stl(), {1e-3});
  const Extent extent = extent_of(model.scene);
  EXPECT_EQ(extent.triangles, 4u);
  EXPECT_NEAR(extent.volume_m3, 1e-9 / 6.0, 1e-16);
  EXPECT_NEAR(extent.area_m2, 1e-6 * (1.5 + std::sqrt(3.0) / 2.0), 1e-13);
  EXPECT_NEAR(extent.area_vector_m2.norm(), 0.0, 1e-13);
  // Corners at one place are one vertex, so the body is known to be closed.
  ASSERT_EQ(model.scene.meshes.size(), 1u);
  EXPECT_EQ(model.scene.meshes[0].vertices_m.size(), 4u);
  EXPECT_TRUE(model.scene.meshes[0].encloses);
  EXPECT_EQ(model.scene.instances[0].node, "part");
  EXPECT_EQ(model.scene.instances[0].material, "part");
  EXPECT_EQ(model.inputs.front().first, "part.stl");
}

TEST(Stl, TextAndBinaryOfOneBodyAreTheSame) {
  const Extent binary = extent_of(read_cad(seeds / "stl" / "tetrahedron_binary.stl", {1.0}).scene);
  // The text has a second solid: a triangle of base 11 and height 1 at z = 0.25.
  const GltfModel text = read_cad(seeds / "stl" / "tetrahedron_text.stl", {1.0});
  ASSERT_EQ(text.scene.instances.size(), 2u);
  EXPECT_EQ(text.scene.instances[0].node, "tetra hedron");
  EXPECT_EQ(text.scene.instances[1].node, "tetrahedron_text");
  const Extent all = extent_of(text.scene);
  EXPECT_NEAR(all.area_m2, binary.area_m2 + 5.5, 1e-12);
  EXPECT_EQ(all.triangles, binary.triangles + 1);
}

TEST(Stl, ASolidMayHaveTheMaterialOfItsName) {
  const Settings black = test::settings_of({{"name", {"tetra hedron"}}, {"absorptance", {1.0}}});
  const GltfModel model =
      read_cad(seeds / "stl" / "tetrahedron_text.stl", {1.0}, {.materials = {black}});
  EXPECT_EQ(model.scene.instances[0].material, "tetra hedron");
  EXPECT_EQ(model.scene.instances[1].material, "tetrahedron_text");
}

// Keywords in capitals, a byte order mark, all on one line, and a name that holds keywords.
TEST(Stl, DialectsOfTextAreTheSameSquare) {
  const std::string plain =
      "solid square\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
      "endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\n"
      "vertex 0 1 0\nendloop\nendfacet\nendsolid square\n";
  std::string upper = plain, one_line = plain, two = plain + plain;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::ranges::replace(one_line, '\n', ' ');
  std::ranges::replace(two, '\n', ' ');
  std::string carriage_returns = upper, named = plain;
  std::ranges::replace(carriage_returns, '\n', '\r');
  for (size_t at = 0; (at = named.find("square", at)) != std::string::npos; at += 6) {
    named.replace(at, 6, "facet plate endsolid");
  }
  std::string two_words = plain;
  for (const std::string block : {"loop", "facet", "solid"}) {
    for (size_t at = 0; (at = two_words.find("end" + block, at)) != std::string::npos;) {
      two_words.insert(at + 3, " ");
    }
  }
  for (const std::string& text :
       {plain, upper, one_line, two_words, "\xEF\xBB\xBF" + plain, "\xEF\xBB\xBF" + upper,
        "\n " + plain, carriage_returns, named, plain + "\x1A", plain + std::string(3, '\0')}) {
    const GltfModel model = stl(text);
    ASSERT_EQ(model.scene.meshes.size(), 1u) << text;
    EXPECT_EQ(model.scene.meshes[0].triangles.size(), 2u) << text;
    EXPECT_EQ(model.scene.meshes[0].vertices_m.size(), 4u) << text;
    EXPECT_NEAR(extent_of(model.scene).area_m2, 1.0, 1e-12) << text;
  }
  EXPECT_EQ(stl(two).scene.instances.size(), 2u);
  EXPECT_THAT(refusal_of([&] { stl(std::string("\xFF\xFEs\0o\0", 6)); }), HasSubstr("UTF-16"));
}

// A binary file may begin with "solid"; where its length is wrong, that is what is said.
TEST(Stl, ABinaryFileThatBeginsWithSolidIsBinary) {
  std::string binary = tetrahedron_stl();
  binary.replace(0, 10, "solid tetr");
  EXPECT_EQ(stl(binary).scene.meshes[0].triangles.size(), 4u);
  std::string marked = binary;
  marked.replace(0, 3, "\xEF\xBB\xBF");
  EXPECT_EQ(stl(marked).scene.meshes[0].triangles.size(), 4u);
  EXPECT_THAT(refusal_of([&] { stl(binary + "xx"); }), HasSubstr("expected 84 + 50 × 4 bytes"));
}

TEST(Obj, AFaceThatCrossesItselfIsRefused) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 3 0.2 0.1\n";
  for (const char* face : {"f 1 2 4 3\n", "f 1 3 2 4\n", "f 1 3 2 4 5\n"}) {
    EXPECT_THAT(refusal_of([&] { obj(corners + face); }),
                HasSubstr("part.obj:6: f: found a face whose edges cross each other"));
  }
  // A quad that is not plane, one that is hollow, and one with a corner twice.
  for (const char* face : {"f 1 2 5 4\n", "f 1 2 3 3\n", "f 4 1 2 3 2\n"}) obj(corners + face);
}

TEST(Cad, AxesAndUnitsAreAsAsked) {
  // One triangle with a normal along z of the file.
  const std::string text = "v 0 0 0\nv 3 0 0\nv 0 4 0\nf 1 2 3\n";
  EXPECT_NEAR((extent_of(obj(text).scene).area_vector_m2 - Vec3(0, 0, 6)).norm(), 0.0, 1e-12);
  // As glTF: (x, y, z) is body (x, −z, y).
  const Extent upright = extent_of(obj(text, {0.0254, true}).scene);
  EXPECT_NEAR((upright.area_vector_m2 - 0.0254 * 0.0254 * Vec3(0, -6, 0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(metres_of_unit("mm"), 1e-3);
  EXPECT_EQ(metres_of_unit("in"), 0.0254);  // NIST SP 811, appendix B
  EXPECT_EQ(metres_of_unit("ft"), 0.3048);
  EXPECT_EQ(metres_of_unit("furlong"), 0.0);
}

TEST(Obj, GroupsMaterialsAndIndicesAreRead) {
  const GltfModel model = read_cad(seeds / "obj" / "house.obj", {1.0});
  std::vector<std::pair<std::string, std::string>> parts;
  for (const Instance& instance : model.scene.instances) {
    parts.emplace_back(instance.path, instance.material);
  }
  EXPECT_EQ(parts, (std::vector<std::pair<std::string, std::string>>{{"house/walls", "white wall"},
                                                                     {"house/roof", "black"}}));
  // Gable: (0,0) (2,0) (2,2) (1,3), then in to (1,1), then (0,2): by the shoelace formula 4.
  const auto gable = extent_of(model.scene);
  double walls = 0.0;
  for (size_t t = 0; t < 4; ++t) walls += 0.5 * twice_area(body_corners(model.scene, 0, t)).norm();
  EXPECT_NEAR(walls, 4.0, 1e-6);
  EXPECT_EQ(gable.triangles, 4u + 2u + 1u);
}

TEST(Obj, PolygonsKeepTheirArea) {
  // A comb of 50 teeth, 1 wide and 1 high with gaps of 1, on a back 1 high: 99 + 50.
  std::vector<Vec3> comb = {{0, 0, 0}, {99, 0, 0}};
  for (int tooth = 49; tooth >= 0; --tooth) {
    const double x = 2.0 * tooth;
    comb.insert(comb.end(), {{x + 1, 1, 0}, {x + 1, 2, 0}, {x, 2, 0}, {x, 1, 0}});
  }
  EXPECT_NEAR(area_in_triangles(comb), 149.0, 1e-9);
  for (const auto& [a, b, c] : cad::triangles_of(comb)) {
    // None lies the other way round.
    EXPECT_GE(twice_area({comb[a], comb[b], comb[c]}).z(), 0.0);
  }
  // A square ring as one outline with a slit: 9 − 1.
  const std::vector<Vec3> ring = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0},
                                  {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}};
  EXPECT_NEAR(area_in_triangles(ring), 8.0, 1e-12);
}

TEST(Obj, ManyCornersTakeTheirSquareAtMost) {
  // A spiral of 4000 corners, nearly none of them convex on its inner side.
  std::vector<Vec3> spiral;
  const auto add = [&](double inner, int i) {
    const double turn = 0.02 * i;
    spiral.emplace_back((inner + turn) * std::cos(turn), (inner + turn) * std::sin(turn), 0.0);
  };
  for (int i = 0; i < 2000; ++i) add(1.0, i);
  for (int i = 1999; i >= 0; --i) add(0.5, i);
  double shoelace = 0.0;
  for (size_t i = 0; i < spiral.size(); ++i) {
    const Vec3 &a = spiral[i], &b = spiral[(i + 1) % spiral.size()];
    shoelace += 0.5 * (a.x() * b.y() - b.x() * a.y());
  }
  EXPECT_NEAR(area_in_triangles(spiral), std::abs(shoelace), 1e-9 * std::abs(shoelace));
}

// A square of 1 mm at 10 km, where single precision has steps of 1 mm: text keeps all digits.
TEST(Cad, TextFarFromTheOriginKeepsItsDigits) {
  const std::string corners[] = {"10000 5 -7000", "10000.001 5 -7000", "10000.001 5.001 -7000"};
  const std::string triangle =
      "v " + corners[0] + "\nv " + corners[1] + "\nv " + corners[2] + "\nf 1 2 3\n";
  const std::string facet = "solid a\nfacet normal 0 0 1\nouter loop\nvertex " + corners[0] +
                            "\nvertex " + corners[1] + "\nvertex " + corners[2] +
                            "\nendloop\nendfacet\nendsolid a\n";
  for (const GltfModel& model : {obj(triangle), stl(facet)}) {
    EXPECT_NEAR(extent_of(model.scene).area_m2, 0.5e-6, 1e-6 * 0.5e-6);
    EXPECT_THAT(model.notices, Not(Contains(HasSubstr("single precision"))));
  }
}

// Facets of 5 cm, 540 m from the origin: steps of 6e-5 m turn them by about a milliradian.
TEST(Cad, FacetsThatSinglePrecisionTurnsAreReported) {
  const auto far_stl = [](float at_m) {
    return std::string(80, ' ') + word_bytes(1) +
           facet_bytes({at_m, 0, 0, at_m + 0.05f, 0, 0, at_m, 0.05f, 0});
  };
  EXPECT_THAT(stl(far_stl(540.0f)).notices,
              Contains(HasSubstr("turns the facets by about 0.46 mrad")));
  EXPECT_THAT(stl(far_stl(5.0f)).notices, Not(Contains(HasSubstr("single precision"))));
}

TEST(Cad, MaterialsAreOfTheExperimentOrReported) {
  const std::string text = "usemtl black\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_THAT(obj(text).notices,
              Contains(HasSubstr("'black': the file contains no optical properties")));
  const Settings black = test::settings_of({{"name", {"black"}}, {"absorptance", {1.0}}});
  const GltfModel model = obj(text, {1.0}, {.materials = {black}});
  EXPECT_EQ(model.scene.surfaces[model.scene.instances[0].front_surface].absorbed[0], 1.0);
  for (const std::string& notice : model.notices) EXPECT_THAT(notice, Not(HasSubstr("optics")));
}

struct BrokenCad {
  const char* name;
  CadFormat format;
  std::string bytes;
  const char* message;
};

std::vector<BrokenCad> broken_cad_files() {
  const std::string good = tetrahedron_stl();
  std::string not_finite = good;
  not_finite.replace(84 + 12, 4, word_bytes(0x7fc00000));  // NaN
  const std::string facet =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex ";
  return {
      {"torn", CadFormat::stl, good.substr(0, good.size() - 7),
       "part.stl: found 277 bytes, expected 84 + 50 × 4 bytes"},
      {"short", CadFormat::stl, "abc", "text that begins with \"abc\", expected an STL file"},
      {"page", CadFormat::stl, "<html>\n" + std::string(200, ' '), "begins with \"<html>\""},
      {"comment", CadFormat::stl, "# made\n" + facet,
       "part.stl:1: found text that begins with \"#\""},
      {"empty", CadFormat::stl, "", "found 0 bytes"},
      {"none", CadFormat::stl, "solid a\nendsolid a\n", "found no facet"},
      {"no_number", CadFormat::stl, facet + "0 one 0\nendloop\nendfacet\nendsolid\n",
       "part.stl:6: vertex: found \"one\""},
      {"two_numbers", CadFormat::stl, facet + "0 1\n", "part.stl:6: vertex: found 2 values"},
      {"huge", CadFormat::stl, facet + "0 1e999 0\n", "part.stl:6: vertex: found \"1e999\""},
      {"ends", CadFormat::stl, facet + "0 1 0\nendloop\n", "found the end of the file"},
      {"word", CadFormat::stl, "solid a\nfacett\n", "part.stl:2: found \"facett\""},
      {"not_finite", CadFormat::stl, not_finite, "part.stl: facet 1: found a corner that is not"},
      {"no_face", CadFormat::obj, "v 0 0 0\n", "found no face"},
      {"index", CadFormat::obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n",
       "part.obj:5: f: found \"4\", expected a vertex from 1 to 3"},
      {"zero", CadFormat::obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n",
       "part.obj:4: f: found \"0\""},
      {"back", CadFormat::obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "part.obj:4: f"},
      {"half", CadFormat::obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1.5 1 2\n", "part.obj:4: f"},
      {"text", CadFormat::obj, "v 0 x 0\n", "part.obj:1: v: found \"x\""},
      {"few", CadFormat::obj, "v 0 0\n", "part.obj:1: v: found 2 values"},
      {"line", CadFormat::obj, "v 0 0 0\nv 1 0 0\nf 1 2\n", "part.obj:3: f: found 2 corners"},
      {"early", CadFormat::obj, "f 1 2 3\n", "expected vertices before their faces"},
      {"curve", CadFormat::obj, "v 0 0 0\ncurv 0 1 1 2\n", "part.obj:2: found \"curv\""},
      {"far", CadFormat::obj, "v 0 0 0\nv 1e20 0 0\nv 0 1e20 0\nf 1 2 3\n", "at most 1e9 m"},
  };
}

TEST(Cad, MistakesAreReportedInOneLine) {
  for (const BrokenCad& broken : broken_cad_files()) {
    SCOPED_TRACE(broken.name);
    const std::string file = broken.format == CadFormat::stl ? "part.stl" : "part.obj";
    const std::string message =
        refusal_of([&] { read_cad_bytes(broken.bytes, file, broken.format, {1.0}); });
    EXPECT_THAT(message, HasSubstr(broken.message));
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

// Exit of a reader with the text of an experiment whose scene is one of the seeds.
std::string refusal_of_scene(const std::string& keys) {
  const std::string text = "[scene]\n" + keys +
                           "\n[[source]]\nkind = \"laser\"\npower_W = 1\nwavelength_nm = 730\n"
                           "waist_mm = 1\nposition_m = [0, 0, 9]\naim_m = [0, 0, 0]\n";
  return refusal_of([&] { read_experiment_text(seeds / "obj" / "lab.toml", text); });
}

TEST(Cad, ExperimentsStateTheUnit) {
  EXPECT_THAT(refusal_of_scene("file = \"house.obj\""),
              HasSubstr("scene.unit: found nothing, expected one of \"mm\""));
  EXPECT_THAT(refusal_of_scene("file = \"house.OBJ\"\nunit = \"yd\""),
              HasSubstr("lab.toml:3: scene.unit: found \"yd\""));
  EXPECT_THAT(refusal_of_scene("file = \"house.obj\"\nmetres_per_unit = 0.1"), IsEmpty());
  EXPECT_THAT(refusal_of_scene("file = \"house.obj\"\nmetres_per_unit = 0.1\nunit = \"m\""),
              HasSubstr("lab.toml:3: scene.metres_per_unit: found unit and metres_per_unit"));
  const std::string gltf = "file = \"../gltf/lights.gltf\"\n";
  EXPECT_THAT(refusal_of_scene(gltf + "unit = \"mm\""),
              HasSubstr("lab.toml:3: scene.unit: found a glTF file"));
  EXPECT_THAT(refusal_of_scene(gltf + "up = \"z\""), HasSubstr("scene.up"));
}

TEST(Cad, AMistypedNameIsReportedBeforeTheUnit) {
  EXPECT_THAT(refusal_of_scene("file = \"no_house.gltf\"\nunit = \"mm\""),
              HasSubstr("lab.toml:2: scene.file: found no file"));
  EXPECT_THAT(refusal_of_scene("file = \"house.ob\"\nunit = \"mm\""),
              HasSubstr("lab.toml:2: scene.file: found no file"));
}

}  // namespace
}  // namespace photorque
