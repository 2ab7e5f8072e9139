// Faces that lie in each other are lit once. Expected forces are textbook formulas and silhouettes
// that a rasteriser counts, which knows neither sides nor shadows.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "core/constants.h"
#include "raytrace/tracing/tracer.h"
#include "receivers/gather/bodies/sunlit_body.h"
#include "scenes/cad/model.h"
#include "scenes/experiment/experiment.h"
#include "scenes/gltf/coincident.h"
#include "scenes/gltf/reader.h"
#include "tests/outside.h"
#include "tests/settings.h"

namespace photorque::coincidence {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double irradiance_W_m2 = 1361.0, pressure_Pa = irradiance_W_m2 / speed_of_light_m_s;

// F = P A cos θ [(1 − ρs) d − 2 (ρs cos θ + ρd/3) n]
// Source: J. R. Wertz (ed.), Spacecraft Attitude Determination and Control (1978), eq. 17-37.
Vec3 textbook_N(double diffuse, const Vec3& travel, const Vec3& normal) {
  return -pressure_Pa * travel.dot(normal) * (travel - 2.0 / 3.0 * diffuse * normal);
}

Beam sun(double scene_radius_m) {
  return test::make_beams("sun",
                          {{"irradiance_W_m2", {irradiance_W_m2}},
                           {"angular_radius_deg", {0.0}},
                           {"direction", test::vector_node(0, 0, -1)}},
                          {.scene_radius_m = scene_radius_m})[0];
}

GltfModel model_of(const std::string& obj) {
  return read_cad_bytes(obj, "part.obj", CadFormat::obj, {1.0});
}

// The model as an experiment uses it.
GltfModel separated(GltfModel model) {
  for (std::string& line : separate_coincident_faces(model.scene)) {
    model.notices.push_back(std::move(line));
  }
  return model;
}

std::vector<std::string> about_coincidence(const GltfModel& model) {
  std::vector<std::string> lines;
  for (const std::string& line : model.notices) {
    if (line.find(" coincide ") != std::string::npos) lines.push_back(line);
  }
  return lines;
}

Scene black(Scene scene) {
  for (OpticalSurface& surface : scene.surfaces) surface = grey_surface("black", 0.0, 0.0);
  return scene;
}

Vec3 sunlit_N(const Scene& scene, const Vec3& travel) {
  const TraceableScene traceable(scene);
  const Beam beam = sun(scene.radius_m());
  SunlitEffort effort;
  effort.scattered.rays = 1 << 14;
  const auto body = SunlitBody::make(traceable, std::span(&beam, 1), Vec3::Zero(), effort);
  if (!body) return Vec3::Zero();  // too many triangles
  const Quat body_from_lab = Quat::FromTwoVectors(-Vec3::UnitZ(), travel);
  const SunlitWrench found = body->wrench({body_from_lab.conjugate(), Vec3::Zero()}, INFINITY);
  return found.total().head<3>().matrix();
}

// The force of light along its `travel`, divided by its pressure.
double pushed_m2(const Scene& scene, const Vec3& travel) {
  return sunlit_N(scene, travel).dot(travel) / pressure_Pa;
}

// Area of the shadow across `travel`, by the centres of 1501² squares.
double silhouette_m2(const Scene& scene, const Vec3& travel) {
  constexpr int side = 1501;
  const double half_m = scene.radius_m(), square_m = 2.0 * half_m / side;
  const Vec3 x = travel.unitOrthogonal(), y = travel.cross(x);
  std::vector<uint8_t> dark(static_cast<size_t>(side) * side, 0);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& triangle : mesh.triangles) {
      std::array<Vec2, 3> p;
      for (size_t k = 0; k < 3; ++k) {
        const Vec3 at = instance.body_from_mesh * mesh.vertices_m[triangle[k]];
        p[k] = {at.dot(x), at.dot(y)};
      }
      const auto turn = [](const Vec2& a, const Vec2& b, const Vec2& c) {
        return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
      };
      const double way = turn(p[0], p[1], p[2]);
      if (std::abs(way) < 1e-12 * half_m * half_m) continue;  // seen from its edge
      const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
      const auto [low, high] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
      const auto square = [&](double at_m) {
        return std::clamp(static_cast<int>((at_m + half_m) / square_m), 0, side - 1);
      };
      for (int i = square(left); i <= square(right); ++i) {
        for (int j = square(low); j <= square(high); ++j) {
          const Vec2 at(-half_m + (i + 0.5) * square_m, -half_m + (j + 0.5) * square_m);
          if (turn(p[0], p[1], at) * way >= 0.0 && turn(p[1], p[2], at) * way >= 0.0 &&
              turn(p[2], p[0], at) * way >= 0.0) {
            dark[static_cast<size_t>(i) * side + static_cast<size_t>(j)] = 1;
          }
        }
      }
    }
  }
  return square_m * square_m * static_cast<double>(std::ranges::count(dark, 1));
}

// Area that light of `travel` meets: of a black scene, by rays.
Estimate met_m2(const Scene& scene, const Vec3& travel) {
  const TraceableScene traceable(scene);
  const Beam beam = sun(scene.radius_m());
  const RigidTransform lab_from_body{Quat::FromTwoVectors(travel, -Vec3::UnitZ()), Vec3::Zero()};
  const Estimate absorbed_W =
      trace(traceable, lab_from_body, std::span(&beam, 1), {}, {.rays = 1 << 18})
          .power_balance.absorbed_W;
  return {absorbed_W.value / irradiance_W_m2, absorbed_W.standard_error / irradiance_W_m2};
}

const std::string unit_square = "v -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\n";

TEST(CoincidentFaces, ReceiveTheLightOnce) {
  const std::string front = "f 1 2 3 4\n", back = "f 4 3 2 1\n";
  const std::string closed_box =
      unit_square + "v -0.5 -0.5 -1\nv 0.5 -0.5 -1\nv 0.5 0.5 -1\nv -0.5 0.5 -1\n" +
      "o box\nf 1 2 3 4\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n";
  const std::vector<std::pair<const char*, std::string>> sheets = {
      {"shared corners", unit_square + "o a\n" + front + back},
      {"another diagonal", unit_square + "o a\n" + front + "f 2 1 4 3\n"},
      {"own corners", unit_square + "o a\n" + front + unit_square + "f 8 7 6 5\n"},
      {"two parts", unit_square + "o a\n" + front + "o b\n" + back},
      {"face alike", unit_square + "o a\n" + front + "o b\nf 2 3 4 1\n"},
      {"polygon and its double", unit_square + "o a\n" + front + front},
      {"four times", unit_square + "o a\n" + front + back + "o b\n" + back + front},
      {"rounded", unit_square + "o a\n" + front +
                      "v -0.5 -0.5 3e-7\nv 0.5 -0.5 -3e-7\nv 0.5 0.5 3e-7\nv -0.5 0.5 3e-7\n" +
                      "f 8 7 6 5\n"},
      {"partly", unit_square + "o a\n" + front +
                     "v 0.2 -0.3 0\nv 1.1 -0.3 0\nv 1.1 0.9 0\nv 0.2 0.9 0\no b\nf 8 7 6 5\n"},
      {"partly alike",
       unit_square + "o a\n" + front +
           "v 0.2 -0.3 0\nv 1.1 -0.3 0\nv 1.1 0.9 0\nv 0.2 0.9 0\no b\nf 5 6 7 8\n"},
      {"on a box", closed_box + "o sheet\nv -0.3 -0.3 0\nv 0.4 -0.3 0\nv 0.4 0.3 0\nf 9 10 11\n"},
      {"box and its lining",
       closed_box + "o lining\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"},
      {"three layers and a needle", unit_square + "o a\n" + front + "o b\n" + back +
                                        "o c\nf 2 3 4\n" +
                                        "v -0.5 -0.4999999 0\nf 1 2 5\no d\nf 1 2 4\n"},
  };
  for (const auto& [what, obj] : sheets) {
    const GltfModel model = separated(model_of(obj));
    EXPECT_FALSE(about_coincidence(model).empty()) << what;
    const Scene scene = black(model.scene);
    for (const Vec3& towards :
         {Vec3(0, 0, -1), Vec3(0, 0, 1), Vec3(0.5, 0.3, -0.6), Vec3(-0.2, 0.7, 0.5)}) {
      const Vec3 travel = towards.normalized();
      const Vec3 force_N = sunlit_N(scene, travel);
      const double area_m2 = silhouette_m2(scene, travel);
      EXPECT_NEAR(force_N.dot(travel) / pressure_Pa, area_m2, 4e-3) << what << towards;
      EXPECT_LT(force_N.cross(travel).norm(), 1e-4 * force_N.norm()) << what;
    }
  }
}

// Sheets that touch along an edge, or cross in the middle, at angles at which they are apart by
// less than the rounding of rays over some or all of their width. Either is seen as one square.
TEST(CoincidentFaces, AtASlightAngleReceiveTheLightOnce) {
  for (const double angle_rad : {1.2e-6, 1e-5, 1e-4, 2e-3}) {
    for (const double axis_m : {-0.5, 0.1}) {
      for (const char* face : {"f 5 6 7 8\n", "f 8 7 6 5\n"}) {
        std::ostringstream tilted;
        tilted.precision(12);
        for (const auto& [x, y] : {std::pair(-0.5, -0.5), {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
          tilted << "v " << axis_m + (x - axis_m) * std::cos(angle_rad) << " " << y << " "
                 << (x - axis_m) * std::sin(angle_rad) << "\n";
        }
        const Scene scene = black(
            separated(model_of(unit_square + "o a\nf 1 2 3 4\n" + tilted.str() + "o b\n" + face))
                .scene);
        for (const Vec3& travel : {Vec3(0, 0, -1), Vec3(0, 0, 1)}) {
          EXPECT_NEAR(pushed_m2(scene, travel), 1.0, 3e-4) << angle_rad << " " << axis_m << face;
        }
      }
    }
  }
}

// In E = 1361 W/m², a sheet of 1 m² absorbs E A (1 − t), with the transmittance t of the lit side.
// The force is the absorbed power over c, because nothing is reflected. The second of two sheets,
// 0.5 m apart, receives the light that passes the first.
TEST(CoincidentFaces, ThatTransmitAreOneSheet) {
  const std::string front = "usemtl front\nf 1 2 3 4\n", back = "usemtl back\nf 4 3 2 1\n";
  const std::string below = "v -0.5 -0.5 -0.5\nv 0.5 -0.5 -0.5\nv 0.5 0.5 -0.5\nv -0.5 0.5 -0.5\n";
  struct Case {
    const char* what;
    std::string obj;
    double front, back;  // transmittances
    int sheets = 1;
  };
  const std::vector<Case> all = {
      {"doubled polygon", unit_square + "o a\n" + front + front, 0.5, 0.5},
      {"another diagonal", unit_square + "o a\n" + front + "f 2 3 4 1\n", 0.5, 0.5},
      {"three parts", unit_square + "o a\n" + front + "o b\n" + front + "o c\n" + front, 0.5, 0.5},
      {"rounded",
       unit_square + "o a\n" + front +
           "v -0.5 -0.5 5e-7\nv 0.5 -0.5 -5e-7\nv 0.5 0.5 5e-7\nv -0.5 0.5 -5e-7\no b\nf 5 6 7 8\n",
       0.5, 0.5},
      {"back to back", unit_square + "o a\n" + front + back, 0.3, 0.8},
      {"back to back of two parts", unit_square + "o a\n" + front + "o b\n" + back, 0.3, 0.8},
      {"four times", unit_square + "o a\n" + front + back + "o b\n" + back + front, 0.3, 0.8},
      {"two sheets", unit_square + below + "o a\n" + front + front + "f 5 6 7 8\nf 6 7 8 5\n", 0.5,
       0.5, 2},
  };
  for (const Case& one : all) {
    Scene scene = model_of(one.obj).scene;
    for (const Instance& part : scene.instances) {
      const double through = part.material == "back" ? one.back : one.front;
      for (const uint32_t side : {part.front_surface, part.back_surface}) {
        scene.surfaces[side] = grey_surface("sheet", 0.0, 0.0, through);
      }
    }
    separate_coincident_faces(scene);
    for (const auto& [travel, through] :
         {std::pair(Vec3(0, 0, -1), one.front), std::pair(Vec3(0, 0, 1), one.back)}) {
      const double absorbed = 1.0 - std::pow(through, one.sheets);
      EXPECT_NEAR(pushed_m2(scene, travel), absorbed, 1e-5) << one.what << travel.z();
      const Estimate met = met_m2(scene, travel);
      EXPECT_NEAR(met.value, absorbed, 3.0 * met.standard_error + 1e-4) << one.what << travel.z();
    }
  }
}

// White and black sheets in one plane reflect these parts of the light from the front and from
// behind.
void expect_sides(Scene scene, double front, double back) {
  for (const Instance& instance : scene.instances) {
    scene.surfaces[instance.front_surface] =
        grey_surface("s", 0.0, instance.material == "white" ? 1.0 : 0.0);
  }
  for (const Vec3& towards : {Vec3(0, 0, -1), Vec3(0.3, 0.2, -0.8)}) {
    const Vec3 down = towards.normalized(), up = -down;
    const Vec3 front_N = textbook_N(front, down, Vec3::UnitZ());
    const Vec3 back_N = textbook_N(back, up, -Vec3::UnitZ());
    const Vec3 on_front_N = sunlit_N(scene, down);
    const Vec3 on_back_N = sunlit_N(scene, up);
    EXPECT_LT((on_front_N - front_N).norm(), 1e-5 * front_N.norm());
    EXPECT_LT((on_back_N - back_N).norm(), 1e-5 * back_N.norm());
  }
}

TEST(CoincidentFaces, BackToBackHaveTheOpticsOfTheirOwnSides) {
  for (const char* back : {"f 4 3 2 1\n", "f 3 2 1 4\n"}) {
    const GltfModel model = separated(
        model_of(unit_square + "o a\nusemtl cell\nf 1 2 3 4\no b\nusemtl white\n" + back));
    EXPECT_THAT(about_coincidence(model),
                ElementsAre(HasSubstr("4 triangles of \"a\" and \"b\" coincide back to back")));
    expect_sides(model.scene, 0.0, 1.0);
  }
}

// A foil on a panel, drawn in one plane and the same way: each side is that of the face that light
// meets first there, and of no other.
TEST(CoincidentFaces, AlikeHaveTheFrontOfTheFirstAndTheBackOfTheLast) {
  const GltfModel model = separated(model_of(
      unit_square + "o foil\nusemtl white\nf 1 2 3 4\no panel\nusemtl black\nf 2 3 4 1\n"));
  EXPECT_THAT(about_coincidence(model),
              ElementsAre(HasSubstr("light from the front meets only the first, of \"foil\", light "
                                    "from behind only the last, of \"panel\"")));
  expect_sides(model.scene, 1.0, 0.0);
}

// The faces of a box, outwards, of corners behind `first` others: lower ones, then upper ones.
std::string box_faces(int first) {
  std::string text;
  for (const auto& face :
       {std::array{4, 3, 2, 1}, std::array{5, 6, 7, 8}, std::array{1, 2, 6, 5},
        std::array{2, 3, 7, 6}, std::array{3, 4, 8, 7}, std::array{4, 1, 5, 8}}) {
    text += "f";
    for (const int corner : face) text += " " + std::to_string(corner + first);
    text += "\n";
  }
  return text;
}

// A closed box over the unit square between two heights; `first` corners precede it.
std::string box(int first, double low, double high = NAN) {
  std::ostringstream text;
  text.precision(15);
  if (std::isnan(high)) high = low + 1.0;
  for (const double at : {low, high}) {
    text << "v 0 0 " << at << "\nv 1 0 " << at << "\nv 1 1 " << at << "\nv 0 1 " << at << "\n";
  }
  text << box_faces(first);
  return text.str();
}

TEST(CoincidentFaces, OfSolidsThatTouchStayAndOthersAreNotTouched) {
  const GltfModel touching = separated(model_of("o a\n" + box(0, 0.0) + "o b\n" + box(8, 1.0)));
  EXPECT_THAT(about_coincidence(touching), IsEmpty());
  for (const Mesh& mesh : touching.scene.meshes) EXPECT_EQ(mesh.vertices_m.size(), 8u);
  // Neighbours in one plane, and sheets a millimetre apart.
  EXPECT_THAT(about_coincidence(separated(
                  model_of(unit_square + "v 1.5 -0.5 0\nv 1.5 0.5 0\no a\nf 1 2 3 4\nf 2 5 "
                                         "6 3\no b\nv 0 0 0.001\nv 1 0 0.001\nv 0 1 "
                                         "0.001\nf 7 8 9\n"))),
              IsEmpty());
}

// The optics of each part by the name of its material: fractions that are diffused and transmitted.
using Optics = std::map<std::string, std::pair<double, double>>;

Scene with_optics(Scene scene, const Optics& optics) {
  for (const Instance& part : scene.instances) {
    const auto [diffuse, through] = optics.at(part.material);
    for (const uint32_t side : {part.front_surface, part.back_surface}) {
      scene.surfaces[side] = grey_surface(part.material, 0.0, diffuse, through);
    }
  }
  separate_coincident_faces(scene);
  return scene;
}

// Light falls along z through glass that touches a panel, with fractions t and, diffuse, ρ. Where
// both fill the square of 1 m², the panel absorbs t (1 − ρ) of it, and the force is that of the
// panel, F = P A (1 + 2 ρ/3), for t = 1.
TEST(CoincidentFaces, OfTransparentSolidsLetTheLightThrough) {
  for (const double gap_m : {0.0, 1e-8, 1e-7, 5e-7, 1e-5, 1e-4}) {
    for (const bool glass_first : {false, true}) {
      const std::string first = glass_first ? "o glass\nusemtl glass\n" + box(0, gap_m, 0.01)
                                            : "o panel\nusemtl panel\n" + box(0, -0.1, 0.0);
      const std::string second = glass_first ? "o panel\nusemtl panel\n" + box(8, -0.1, 0.0)
                                             : "o glass\nusemtl glass\n" + box(8, gap_m, 0.01);
      const Scene scene =
          with_optics(model_of(first + second).scene, {{"glass", {0, 1}}, {"panel", {0.5, 0}}});
      EXPECT_NEAR(pushed_m2(scene, {0, 0, -1}), 1.0 + 0.5 * 2.0 / 3.0, 1e-4) << gap_m;
      const Estimate met = met_m2(scene, {0, 0, -1});
      EXPECT_NEAR(met.value, 0.5, 3.0 * met.standard_error + 1e-4) << gap_m;
    }
  }
}

// Glass transmits 0.9 and absorbs the rest; what passes it falls on a black face, so that all is
// absorbed, from both sides.
TEST(CoincidentFaces, BehindTransparentOnesAreMet) {
  const std::string glass = "o glass\nusemtl glass\n", black = "o cell\nusemtl black\n";
  const std::string up = "f 1 2 3 4\n", down = "f 4 3 2 1\n";
  const std::vector<std::string> all = {
      glass + up + black + up,
      black + up + glass + up,
      glass + up + black + down,
      black + down + glass + up,
      glass + up + up + black + up,
      glass + up + "o film\n" + up + black + up + "o back\n" + down,
      black + up + "o film\nusemtl glass\n" + down + glass + up,
  };
  for (const std::string& faces : all) {
    const Scene scene =
        with_optics(model_of(unit_square + faces).scene, {{"glass", {0, 0.9}}, {"black", {0, 0}}});
    for (const Vec3& travel : {Vec3(0, 0, -1), Vec3(0, 0, 1)}) {
      EXPECT_NEAR(pushed_m2(scene, travel), 1.0, 1e-5) << faces << travel.z();
      const Estimate met = met_m2(scene, travel);
      EXPECT_NEAR(met.value, 1.0, 3.0 * met.standard_error + 1e-4) << faces << travel.z();
    }
  }
}

// A thin plate of a closed part, far from another part: each of its faces transmits half of the
// light, and absorbs the other half.
TEST(CoincidentFaces, OfAThinPlateActOneAfterTheOther) {
  for (const double thickness_m : {1e-7, 1e-6, 1e-5, 1e-4}) {
    const Scene scene = with_optics(
        model_of("o plate\nusemtl half\n" + box(0, 0.0, thickness_m)).scene, {{"half", {0, 0.5}}});
    const Estimate met = met_m2(scene, {0, 0, -1});
    EXPECT_NEAR(met.value, 0.75, 3.0 * met.standard_error + 2e-3) << thickness_m;
  }
}

// A panel of 2 m × 1 m with black cells in its plane, turned about two axes and written as text.
class RoundedPanel {
 public:
  static constexpr int along = 10, across = 5;
  static constexpr double cell_m = 0.18;
  // Direction of light on its front.
  Vec3 travel() const { return -(turn_ * Vec3::UnitZ()); }

  // Lengths in units of 1/scale; `decimals` of them are written, or six digits if negative.
  RoundedPanel(double scale, int decimals) : scale_(scale) {
    if (decimals >= 0) {
      text_.precision(decimals);
      text_ << std::fixed;
    }
  }

  // A rectangle in the plane at a height, divided into cells of n × m; turned over if `down`.
  void add(const std::string& part, const Vec2& low, const Vec2& high, double height_m, int n,
           int m, bool down) {
    text_ << "o " << part << "\nusemtl " << part << "\n";
    const int first = count_ + 1;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= m; ++j) {
        corner({low.x() + (high.x() - low.x()) * i / n, low.y() + (high.y() - low.y()) * j / m,
                height_m});
      }
    }
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < m; ++j) {
        const int a = first + i * (m + 1) + j, b = a + m + 1;
        if (down) {
          text_ << "f " << a << " " << a + 1 << " " << b + 1 << " " << b << "\n";
        } else {
          text_ << "f " << a << " " << b << " " << b + 1 << " " << a + 1 << "\n";
        }
      }
    }
  }
  void add_cells() {
    for (int i = 0; i < along; ++i) {
      for (int j = 0; j < across; ++j) {
        const Vec2 low(-1.0 + 0.2 * i + 0.01, -0.5 + 0.2 * j + 0.01);
        add("cells", low, low + Vec2(cell_m, cell_m), 0.0, 1, 1, false);
      }
    }
  }
  // The box below the plane.
  void add_box() {
    const int a = count_;
    text_ << "o box\nusemtl box\n";
    for (const double height_m : {-0.1, 0.0}) {
      for (const auto& [x, y] : {std::pair(-1.0, -0.5), {1.0, -0.5}, {1.0, 0.5}, {-1.0, 0.5}}) {
        corner({x, y, height_m});
      }
    }
    text_ << box_faces(a);
  }
  Scene scene(const Optics& optics) const {
    const double metres = 1.0 / scale_;
    return with_optics(read_cad_bytes(text_.str(), "panel.obj", CadFormat::obj, {metres}).scene,
                       optics);
  }

 private:
  void corner(const Vec3& at_m) {
    const Vec3 at = scale_ * (turn_ * at_m);
    text_ << "v " << at.x() << " " << at.y() << " " << at.z() << "\n";
    ++count_;
  }

  Quat turn_ = Quat(Eigen::AngleAxisd(0.5, Vec3::UnitZ())) *
               Quat(Eigen::AngleAxisd(0.7, Vec3(1.0, 0.3, 0.0).normalized()));
  double scale_;
  int count_ = 0;
  std::ostringstream text_;
};

// Scales and decimals: millimetres with two decimals, with six digits; metres of a panel of 0.2 m
// with six decimals.
const std::vector<std::pair<double, int>> roundings = {{1000.0, 2}, {1000.0, -1}, {0.1, 6}};

// Black cells in the plane of a white box absorb E times their area, in either order of the file,
// and the light on them does not depend on the rounding.
TEST(CoincidentFaces, OfRoundedCellsLieOnTheirPanel) {
  for (const auto& [scale, decimals] : roundings) {
    for (const bool cells_first : {false, true}) {
      RoundedPanel panel(scale, decimals);
      if (cells_first) panel.add_cells();
      panel.add_box();
      if (!cells_first) panel.add_cells();
      const Scene scene = panel.scene({{"cells", {0, 0}}, {"box", {1, 0}}});
      const double cells_m2 =
          RoundedPanel::along * RoundedPanel::across * RoundedPanel::cell_m * RoundedPanel::cell_m;
      const Estimate met = met_m2(scene, panel.travel());
      EXPECT_NEAR(met.value, cells_m2, 3.0 * met.standard_error + 5e-4) << scale << cells_first;
    }
  }
}

// A black sheet and a finer white one back to back, with rounded corners: the black side absorbs
// all light, F = P A; the white one diffuses it, F = P A (1 + 2/3).
TEST(CoincidentFaces, OfRoundedPanelsBackToBackHaveTheOpticsOfTheirOwnSides) {
  for (const auto& [scale, decimals] : roundings) {
    RoundedPanel panel(scale, decimals);
    panel.add("front", {-1.0, -0.5}, {1.0, 0.5}, 0.0, 1, 1, false);
    panel.add("back", {-1.0, -0.5}, {1.0, 0.5}, 0.0, 12, 7, true);
    const Scene scene = panel.scene({{"front", {0, 0}}, {"back", {1, 0}}});
    const Estimate met = met_m2(scene, panel.travel()), behind = met_m2(scene, -panel.travel());
    EXPECT_NEAR(met.value, 2.0, 3.0 * met.standard_error + 1e-3) << scale;
    EXPECT_NEAR(behind.value, 0.0, 1e-3) << scale;
    EXPECT_NEAR(pushed_m2(scene, panel.travel()), 2.0, 1e-3) << scale;
    EXPECT_NEAR(pushed_m2(scene, -panel.travel()), 2.0 * (1.0 + 2.0 / 3.0), 1e-3) << scale;
  }
}

// Corners with too few digits to be found in one plane are named.
TEST(CoincidentFaces, ThatCrossNearlyInOnePlaneAreNamed) {
  const auto lines = [](double height_m) {
    std::ostringstream obj;
    obj << unit_square << "v -0.4 -0.4 " << height_m << "\nv 0.4 -0.4 " << -height_m
        << "\nv 0.4 0.4 " << height_m << "\no a\nf 1 2 3 4\no b\nf 5 6 7\n";
    Scene scene = model_of(obj.str()).scene;
    return separate_coincident_faces(scene);
  };
  EXPECT_THAT(lines(5e-5), Contains(HasSubstr("\"a\" and \"b\" cross each other within")));
  EXPECT_THAT(lines(1e-5), ElementsAre(HasSubstr("coincide")));
  EXPECT_THAT(lines(1e-3), IsEmpty());
}

// Two squares side by side, black. Folded about their common edge by a joint they are one sheet of
// 1 m²; drawn folded and opened by the joint, they are two that do not coincide.
TEST(CoincidentFaces, AreFoundAfterTheJointsHaveTurned) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "folded";
  std::filesystem::create_directories(folder);
  const auto experiment = [&](const std::string& second, const char* angle_deg) {
    std::ofstream(folder / "sheets.obj")
        << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no a\nf 1 2 3 4\no b\n"
        << second;
    return resolve_experiment(read_experiment_text(
        folder / "sheets.toml",
        std::string(
            "[scene]\nfile = \"sheets.obj\"\nunit = \"m\"\n[[source]]\nkind = \"sun\"\n"
            "direction = [0, 0, -1]\n[[joint]]\nnode = \"b\"\naxis = [0, 1, 0]\nangle_deg = ") +
            angle_deg));
  };
  const Experiment folded = experiment("v -1 0 0\nv 0 0 0\nv 0 1 0\nv -1 1 0\nf 5 6 7 8\n", "180");
  EXPECT_NEAR(pushed_m2(black(folded.scene), {0, 0, -1}), 1.0, 1e-5);
  const Experiment opened = experiment("f 4 3 2 1\n", "180");
  EXPECT_NEAR(pushed_m2(black(opened.scene), {0, 0, -1}), 2.0, 1e-5);
  const auto coincide = [](const Experiment& one) {
    return std::ranges::count_if(one.notices, [](const std::string& line) {
      return line.find("coincide") != std::string::npos;
    });
  };
  EXPECT_EQ(coincide(folded), 1);
  EXPECT_EQ(coincide(opened), 0);
}

// A mesh that two instances share is moved in one of them alone.
TEST(CoincidentFaces, MoveTheInstanceThatLiesInAnother) {
  Scene scene;
  scene.surfaces.push_back(grey_surface("black", 0.0, 0.0));
  Mesh sheet;
  sheet.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}};
  scene.meshes.push_back(sheet);
  for (const double z : {0.0, 3.0}) {
    Instance instance;
    instance.path = z == 0.0 ? "near" : "far";
    instance.body_from_mesh.translation().z() = z;
    scene.instances.push_back(instance);
  }
  sheet.triangles = {{0, 2, 1}};
  scene.meshes.push_back(sheet);
  Instance back;
  back.path = "back";
  back.mesh = 1;
  scene.instances.push_back(back);
  EXPECT_THAT(separate_coincident_faces(scene), ElementsAre(HasSubstr("\"near\" and \"back\"")));
  EXPECT_NE(scene.instances[0].mesh, scene.instances[1].mesh);
  EXPECT_EQ(scene.meshes[scene.instances[1].mesh].triangles[0], (std::array<uint32_t, 3>{0, 1, 2}));
  const auto height_m = [&](size_t instance) {
    const Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
    return mesh.vertices_m[mesh.triangles[0][0]].z();
  };
  EXPECT_GT(height_m(0), 0.0);
  EXPECT_LT(height_m(2), 0.0);
}

// Instances of one square that are scaled, turned and mirrored in its plane.
TEST(CoincidentFaces, OfScaledAndMirroredInstancesReceiveTheLightOnce) {
  Scene scene;
  Mesh square;
  square.vertices_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes.push_back(square);
  scene.surfaces.push_back(grey_surface("black", 0.0, 0.0));
  const Quat plane(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  const auto place = [&](const Vec3& scale, double turn_rad, const Vec3& at_m) {
    Instance instance;
    instance.path = "square " + std::to_string(scene.instances.size());
    instance.body_from_mesh = Eigen::Translation3d(plane * at_m) * plane *
                              Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()) * Eigen::Scaling(scale);
    scene.instances.push_back(instance);
  };
  place({1, 1, 1}, 0.0, {0, 0, 0});
  place({1.4, 0.6, 1}, 0.5, {0.2, -0.1, 0});
  place({-1.2, 0.9, 1}, 0.2, {0.9, 0.3, 0});
  place({0.7, 1.1, -1}, -0.4, {0.4, 0.5, 0});
  EXPECT_THAT(separate_coincident_faces(scene), ::testing::Not(IsEmpty()));
  for (const Vec3& towards : {Vec3(0, 0, -1), Vec3(0.5, 0.3, 0.6)}) {
    const Vec3 travel = (plane * towards).normalized();
    const double area_m2 = silhouette_m2(scene, travel);
    EXPECT_NEAR(pushed_m2(scene, travel), area_m2, 4e-3);
    const Estimate met = met_m2(scene, travel);
    EXPECT_NEAR(met.value, area_m2, 4.0 * met.standard_error + 4e-3);
  }
}

// Models from elsewhere, in two directions: by rays and, of few triangles, by quadrature.
class Silhouettes : public ::testing::TestWithParam<const char*> {};

TEST_P(Silhouettes, OfModelsOfThirdPartiesAreThoseOfARasteriser) {
  const std::string file = std::string("models/") + GetParam();
  PHOTORQUE_NEEDS_THIRD_PARTY(file);
  const Scene scene = black(separated(read_gltf(outside::third_party(file))).scene);
  constexpr size_t most_by_quadrature = 5000;
  size_t triangles = 0;
  for (const Instance& part : scene.instances)
    triangles += scene.meshes[part.mesh].triangles.size();
  for (const Vec3& towards : {Vec3(0.1, 0.2, -1), Vec3(0.6, -0.7, 0.5)}) {
    const Vec3 travel = towards.normalized();
    const double area_m2 = silhouette_m2(scene, travel);
    const Estimate rays_m2 = met_m2(scene, travel);
    EXPECT_NEAR(rays_m2.value, area_m2, 4.0 * rays_m2.standard_error + 2e-3 * area_m2) << travel;
    if (triangles > most_by_quadrature) continue;
    EXPECT_NEAR(pushed_m2(scene, travel), area_m2, 2e-3 * area_m2) << travel;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shared, Silhouettes,
    ::testing::Values("2CylinderEngine.glb", "NASA_Aqua_B_draco.glb",
                      "blender/01_single_vs_double_sided/01_single_vs_double_sided.gltf",
                      "blender/02_shared_mesh/02_shared_mesh.gltf",
                      "blender/24_gpu_instancing/24_gpu_instancing.gltf", "in/TwoCubes.glb"));

}  // namespace
}  // namespace photorque::coincidence
