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
#include "diagnosis/light/model/lamp_table.h"
#include "diagnosis/light/model/obstacles.h"

namespace photorque {

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

// A known field for a geometry that may differ in the boxes. It is reused for all outputs that are
// affected by no box of either geometry.
struct KnownField {
  const LampGeometry* geometry;
  const LampField* field;
};
// The field of one lamp; `known` saves the computation of unaffected outputs.
LampField lamp_field(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
                     const LampGeometry& geometry, const std::optional<KnownField>& known = {});

// A lamp at one attitude, in body axes.
struct LampAtAttitude {
  RigidTransform body_from_lamp;
  Mat3 lamp_from_body;
  Vec3 offset_m;
  Vec3 side, up;  // radii of the disc

  LampAtAttitude(const RigidTransform& lab_from_lamp, const Quat& lab_from_body, double radius_m);
};

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
  const Vec3& lamp_body_m() const { return at_->body_from_lamp.translation_m; }
  const LampAtAttitude& lamp() const { return *at_; }

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
  std::optional<LampAtAttitude> at_;
  std::optional<Obstacles> obstacles_;
};

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
