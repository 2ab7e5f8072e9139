// The three-dimensional scene of a page, as plain data: a body among lamps, in one state or many.
#pragma once

#include <string>
#include <vector>

#include "core/product.h"
#include "core/transform.h"
#include "images/drawing/colour.h"

namespace photorque {

// Triangles in one colour, body frame.
struct StagePart {
  std::string name;
  Rgb colour;
  std::vector<float> position_m;    // x, y, z of each vertex
  std::vector<uint32_t> triangles;  // three vertices each, counter-clockwise seen from the front
};

// Triangles on which a map lies, body frame. (0, 0) is the lower left corner of the map, (1, 1) the
// upper right one.
struct PaintedSurface {
  std::string name;  // of the receiver
  std::vector<float> position_m;
  std::vector<float> uv;  // two numbers for each vertex
  std::vector<uint32_t> triangles;
  enum class Side { front, back, both };
  Side side = Side::both;
  // A map of the page's product by its name; without one, a map for each light of the stage, all
  // of one size.
  std::string map;
  std::vector<Map> map_of_light = {};
};

// Surfaces that are painted together, in one colour scale.
struct Painting {
  std::string title;
  std::string unit;
  bool signed_values = false;
  std::vector<PaintedSurface> surfaces;
};

// Where light comes from, lab frame.
struct StageLamp {
  std::string name;
  Vec3 position_lab_m = Vec3::Zero();
  Vec3 direction_lab = -Vec3::UnitZ();  // in which it shines
  double radius_m = 0.0;                // of its aperture; 0: a point
  bool is_far = false;                  // parallel light: only the direction means something
};

// A vector at the body's origin that every state has.
struct StageArrow {
  std::string name;  // "torque of light"
  std::string unit;
  enum class Kind { force, torque, turn };
  Kind kind = Kind::force;
  // Length of a unit on the page [m]; 0: the longest of all states is drawn as long as the body.
  double m_per_unit = 0.0;
  std::string remark = {};  // beside its name: "drawn 1000 times larger"
};

// Copies of the body that are shown together; the first is drawn solid, others see-through.
struct StageBody {
  std::string name;  // "measured"
};

// One moment or one attitude.
struct StageState {
  std::vector<Quat> lab_from_body;  // one for each body
  // One for each arrow, and its standard error, in body axes.
  std::vector<Vec3> arrow_body = {}, arrow_error_body = {};
  std::vector<Estimate> figures = {};  // one for each of the stage's
};

// The axis of a slider. Several axes span a grid of states, the first running fastest.
struct StageAxis {
  std::string name;  // "tilt"
  std::string unit;
  std::vector<double> values;  // rising
  bool plays = false;          // a time: states between two are turned evenly, and it can be played
  // Text for each value, shown instead of the number; empty: numbers are shown.
  std::vector<std::string> names = {};
};

struct StageFigure {
  std::string label;
  std::string unit;
};

struct StageCamera {
  Vec3 position_lab_m = Vec3::UnitX();
  Vec3 target_lab_m = Vec3::Zero();
  double field_of_view_deg = 34.0;  // across the width
};

// The sizes of `states` and of `axes` agree: their product, or one state without axes.
struct SceneStage {
  std::vector<StagePart> parts;
  std::vector<Painting> paintings;
  std::vector<StageLamp> lamps;
  std::vector<StageBody> bodies = {{"platform"}};
  std::vector<StageArrow> arrows;
  std::vector<StageFigure> figures;
  std::vector<StageAxis> axes;
  std::vector<StageState> states;
  // The light as it was traced at some attitudes: rays from their lamp to where they first meet
  // something, x, y, z of start and end of each.
  std::vector<std::vector<float>> rays_of_light_lab_m;
  std::vector<size_t> light_of_state;  // which of them a state shows; empty: each its own
  StageCamera camera;
  double radius_m = 1.0;    // of a sphere about the origin that holds the body
  std::string remark = {};  // difference from reality, as printed
};

}  // namespace photorque
