// Irradiance by each lamp separately on the places of a recording.
//
// The light of a lamp on a point is that of its aperture (raytrace/direct/disc_light.h), minus the
// parts of the aperture that boxes and the scene hide. Walls reflect light once, diffusely or
// like a mirror; everything else is black.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "diagnosis/light/model/lab.h"

namespace photorque {

// obstacles.cpp: obstacles between the lamps and the receiver.

// Evenly distributed points on a disc of radius 1, in a spiral of golden angles. Source: H. Vogel,
// Mathematical Biosciences 44, 179 (1979).
std::vector<Vec2> even_disc(size_t count);

// Whether the straight line between two points crosses a triangle; its ends are excluded.
bool crosses(const std::array<Vec3, 3>& triangle, const Vec3& from, const Vec3& to);

// Obstacles at one attitude.
class Obstacles {
 public:
  // Keeps references to lab and boxes.
  Obstacles(const LightLab& lab, const std::vector<ShadowBox>& boxes, const Quat& lab_from_body);

  bool any() const { return !boxes_.empty() || !lab_.walls().empty(); }

  // Whether a box may hide a part of an aperture of this radius from a point.
  bool meets_boxes(const Vec3& point, const Vec3& lamp, double radius_m) const;

  // The visible part of a lamp's aperture from a point: its fraction, and the first moment over the
  // whole aperture. The moment is the mean position relative to the centre, in radii along `side`
  // and `up`, where hidden parts count as 0.
  struct Open {
    double fraction = 1.0;
    Vec2 moment = Vec2::Zero();
  };
  // All vectors are in the body frame; `side` and `up` span the disc and have its radius.
  // `skipped`: index of a wall to ignore; past the end: none. A single flat wall or box is exact
  // and varies smoothly. Otherwise 100 points of the aperture are tested.
  Open visible(const Vec3& point, const Vec3& lamp, const Vec3& side, const Vec3& up,
               size_t skipped) const;

 private:
  struct BodyBox {
    std::array<Vec3, 8> corners;  // body frame
    Vec3 centre;
    double radius;
  };
  Open sampled(const Vec3& point, const Vec3& lamp, const Vec3& side, const Vec3& up) const;

  const LightLab& lab_;
  const std::vector<ShadowBox>& boxes_;
  Quat lab_from_body_;
  std::vector<BodyBox> in_body_;
  mutable std::vector<size_t> near_walls_, near_boxes_;
};

// illumination.cpp: light of the lamps.

// Places on the receiver and their times. An output is one point of a scan, or the weighted mean
// over the points of a cell.
struct LightSites {
  struct Group {
    size_t first_point = 0, count = 0;  // range of `points_body_m`
  };
  std::vector<Vec3> points_body_m;
  std::vector<double> weights;
  std::vector<Group> groups;  // one point, or one cell
  struct Output {
    size_t attitude = 0, group = 0;
  };
  std::vector<Output> outputs;
  std::vector<Quat> lab_from_body;  // for each attitude
  bool enters_cells = false;        // includes transmission through the front of cells
};

// Parameters of a lamp's light except its power.
struct LampGeometry {
  size_t lamp = 0;
  Vec2 aim = Vec2::Zero();
  double divergence = 1.0;
  Vec3 shift_m = Vec3::Zero();
  Vec2 attitude_bias_rad = Vec2::Zero();
  std::vector<ShadowBox> boxes;
  std::optional<double> glass_index;

  bool operator==(const LampGeometry&) const = default;
};
// The geometry of one lamp in a state.
LampGeometry geometry_of(const LightState& state, size_t lamp, bool enters_cells);

// Irradiance [W/m²] of one lamp at full power on every output.
using LampField = std::vector<double>;

// The field of the same lamp with another geometry.
struct KnownField {
  const LampGeometry* geometry;
  const LampField* field;
};
// The field of one lamp. If only the boxes of `known` differ, its outputs are reused where neither
// its boxes nor the new ones hide a part of the lamp.
LampField lamp_field(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
                     const LampGeometry& geometry, const std::optional<KnownField>& known);

constexpr size_t no_wall = std::numeric_limits<size_t>::max();

class Illumination {
 public:
  // All references must outlive this object.
  Illumination(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
               const LampGeometry& geometry);

  void move_to(size_t attitude);

  // The irradiance at a point of the body on a surface with this normal, with all obstacles except
  // one wall.
  double on(const Vec3& point, const Vec3& normal, size_t skipped) const;
  const Vec3& lamp_body_m() const { return lamp_body_m_; }
  // Two radii of the lamp's disc that span it, in body axes.
  const Vec3& side_m() const { return side_m_; }
  const Vec3& up_m() const { return up_m_; }

  // Whether a box may hide a part of the lamp from any point of an output at the present attitude.
  bool meets_boxes(size_t output) const;

  // Computes Σ weight · at(point) over the places of each output. If known(output) is not null, its
  // target is used as the sum.
  template <typename At, typename Known>
  LampField over_places(const At& at, const Known& known) {
    LampField field(sites_.outputs.size(), 0.0);
    size_t attitude = std::numeric_limits<size_t>::max();
    for (size_t o = 0; o < sites_.outputs.size(); ++o) {
      if (sites_.outputs[o].attitude != attitude) move_to(attitude = sites_.outputs[o].attitude);
      if (const double* sum = known(o)) {
        field[o] = *sum;
        continue;
      }
      const LightSites::Group& group = sites_.groups[sites_.outputs[o].group];
      for (size_t i = group.first_point; i < group.first_point + group.count; ++i) {
        field[o] += sites_.weights[i] * at(sites_.points_body_m[i]);
      }
    }
    return field;
  }

 private:
  const LightLab& lab_;
  const LightSites& sites_;
  const LampGeometry& geometry_;
  const LampTable& light_;
  RigidTransform pose_;
  // The lamp at the present attitude.
  Mat3 lamp_from_body_;
  Vec3 lamp_body_m_, offset_m_, side_m_, up_m_;
  std::optional<Obstacles> obstacles_;
};

// bounce.cpp: light after one reflection at a wall.

// A small part of a wall with its normal on the side of the receiver.
struct WallPatch {
  std::array<Vec3, 3> corners_m;
  Vec3 centre_m, normal;
  double area_m2;
};

// Exchange of light between a wall and the places of a recording, independent of the lamps.
struct WallExchange {
  std::vector<WallPatch> patches;
  // For each group of places (rows) and patch (columns): the irradiance per light that leaves the
  // patch.
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> shares;
};
// The exchange of the places with wall number `wall`.
WallExchange exchange_with(const LightLab& lab, const LightSites& sites, size_t wall);

// Light of each lamp after reflection at a wall with reflectance 1: diffuse, or specular if
// `diffuse` is null.
std::vector<LampField> wall_fields(const LightLab& lab, const LampSet& lamps,
                                   const LightSites& sites,
                                   const std::vector<LampGeometry>& geometries, size_t wall,
                                   const WallExchange* diffuse);

}  // namespace photorque
