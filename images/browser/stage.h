// The three-dimensional scene of a page as plain data: a body among lamps, in one or many states.
#pragma once

#include <string>
#include <vector>

#include "core/product.h"
#include "core/transform.h"
#include "images/drawing/colour.h"

namespace photorque {

// Triangles of one colour, body frame.
struct StagePart {
  std::string name;
  Rgb colour;
  std::vector<float> position_m;    // x, y, z of each vertex
  std::vector<uint32_t> triangles;  // three vertices each, counter-clockwise seen from the front
};

// Triangles on which a map is painted, body frame. (0, 0) is the lower left corner of the map, (1,
// 1) the upper right one.
struct PaintedSurface {
  std::string name;  // of the receiver
  std::vector<float> position_m;
  std::vector<float> uv;  // two numbers per vertex
  std::vector<uint32_t> triangles;
  enum class Side { front, back, both };
  Side side = Side::both;
  // Name of a map of the page's product. If empty: one map per light of the stage, all of one size.
  std::string map;
  std::vector<Map> map_of_light = {};
};

// Surfaces that are painted together and share a colour scale.
struct Painting {
  std::string title;
  std::string unit;
  bool signed_values = false;
  std::vector<PaintedSurface> surfaces;
};

// A lamp, lab frame.
struct StageLamp {
  std::string name;
  Vec3 position_lab_m = Vec3::Zero();
  Vec3 direction_lab = -Vec3::UnitZ();  // direction of emission
  double radius_m = 0.0;                // of its aperture; 0: a point
  bool is_far = false;                  // parallel light: only the direction is used
};

// A vector at the body's origin that every state has.
struct StageArrow {
  std::string name;  // "torque of light"
  std::string unit;
  enum class Kind { force, torque, turn };
  Kind kind = Kind::force;
  // Length on the page [m] per unit; 0: the longest of all states is as long as the body.
  double m_per_unit = 0.0;
  std::string remark = {};  // shown beside the name: "drawn 1000 times larger"
};

// One instant or one attitude.
struct StageState {
  std::vector<Quat> lab_from_body;  // one per body
  // One vector per arrow, and its standard error, in body axes.
  std::vector<Vec3> arrow_body = {}, arrow_error_body = {};
  std::vector<Estimate> figures = {};  // one per figure of the stage
};

// Axis of a slider. Several axes span a grid of states; the first varies fastest.
struct StageAxis {
  std::string name;  // "tilt"
  std::string unit;
  std::vector<double> values;  // rising
  // a time axis: it can be played, and attitudes between states are interpolated
  bool plays = false;
  // Text per value, shown instead of the number; empty: numbers are shown.
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

// The number of states must be the product of the sizes of the axes, or one without axes.
struct SceneStage {
  std::vector<StagePart> parts;
  std::vector<Painting> paintings;
  std::vector<StageLamp> lamps;
  // Names of the copies of the body that are shown together; the first is drawn solid, others
  // see-through.
  std::vector<std::string> bodies = {"platform"};
  std::vector<StageArrow> arrows;
  std::vector<StageFigure> figures;
  std::vector<StageAxis> axes;
  std::vector<StageState> states;
  // Rays of each light traced at some attitudes, from the lamp to their first hit: x, y, z of start
  // and end of each ray.
  std::vector<std::vector<float>> rays_of_light_lab_m;
  // Index of the light that a state shows; empty: each state shows its own.
  std::vector<size_t> light_of_state;
  StageCamera camera;
  double radius_m = 1.0;    // radius of a sphere about the origin that contains the body
  std::string remark = {};  // a note on deviations from reality, as printed
};

}  // namespace photorque
