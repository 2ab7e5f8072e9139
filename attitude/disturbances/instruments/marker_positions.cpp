// Markers whose true positions differ from those that the camera's pose assumes.
#include <cmath>

#include "attitude/camera/spot.h"
#include "attitude/disturbances/kind.h"
#include "core/text/format.h"

namespace photorque::kinds::marker_positions {
namespace {

constexpr const char* marker_key = "marker";
constexpr const char* error_key = "error_m";

namespace key {
constexpr IntegerKey marker(marker_key, 1, 1'000'000,
                            "which of `markers_m`, the first is 1; without it all, with "
                            "three numbers of `error_m` for each",
                            {.optional = true, .varies = true});
constexpr NumbersKey error(error_key, {-0.1, 0.1},
                           "true position minus `markers_m`, body axes; as [sensors.camera] "
                           "`marker_error_m` for simulated recordings",
                           {.has_error = true});
}  // namespace key

// The properties of one marker that the law needs.
struct SeenMarker {
  Vec3 place_m, normal;  // body axes
};

// The least-squares pose for markers with true positions m + e and assumed positions m, in full
// perspective, so that it depends on the attitude and the camera position. To first order in e it
// is rotated, in body axes, by
//   θ = (Σ w Hᵀ H)⁻¹ Σ w Hᵀ D e,  D = ∂(pixel)/∂m,  H θ = D (θ × m)
// (for a free pose H also contains the shift). A flat board close to the centre of rotation needs
// higher orders, by Gauss–Newton iterations. Contradicting errors have the weights of the pose: the
// weight w is the information of a marker's spot on its centre, or one.
struct MarkerPositions final : LawOf<MarkerPositions> {
  MarkerPositions(const TrackingCamera& camera, std::optional<size_t> only)
      : lab_from_camera_(camera.lab_from_camera.rotation.toRotationMatrix()),
        camera_lab_m_(camera.lab_from_camera.translation_m),
        is_free_(!camera.knows_centre),
        emission_exponent_(std::log(0.5) / std::log(std::cos(camera.half_angle_rad))),
        pixels_(camera.focal_length_m / camera.pixel_m),
        middle_px_({0.5 * (camera.width - 1), 0.5 * (camera.height - 1)}),
        only_(only) {
    for (const Marker& marker : camera.markers) {
      if (!marker.is_lit) continue;
      markers_.push_back({marker.position_body_m, marker.normal_body});
      index_.push_back(static_cast<size_t>(&marker - camera.markers.data()));
    }
    weigh(camera);
  }

  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    if (is_free_) {
      now.camera_error_rad += turn<6>(own, now);
    } else {
      now.camera_error_rad += turn<3>(own, now);
    }
  }

 private:
  // Weights from the Fisher information of the first visible spot at zero tilt and of a fainter
  // one, at the centre of a pixel and on the edge between two: N²/information = a N + b.
  void weigh(const TrackingCamera& camera) {
    for (size_t i = 0; i < markers_.size() && !camera.weighs_alike; ++i) {
      const auto view = view_of(camera, index_[i], {});
      if (!view) continue;
      constexpr double less = 0.7;
      const auto over_information = [&](double phase, double part) {
        Spot spot = spot_of(camera, *view);
        spot.centre_px = Vec2(100.0 + phase, 100.25);
        spot.electrons *= part;
        return part * part * centre_covariance_px2(spot, pixel_noise(camera))(0, 0);
      };
      for (const double phase : {0.0, 0.5}) {
        Information& here = phase == 0.0 ? in_middle_ : on_edge_;
        const double full = over_information(phase, 1.0);
        here.per_brightness = (full - over_information(phase, less)) / (1.0 - less);
        here.constant = full - here.per_brightness;
      }
      const Vec3 away_m = camera_lab_m_ - markers_[i].place_m;
      unit_brightness_ = brightness_at<Lanes>(away_m.cast<Lanes>(), markers_[i].normal,
                                              -lab_from_camera_.col(2).dot(away_m))[0];
      return;
    }
  }

  // Information of a spot on its centre along one axis, from the marker's brightness and the
  // position within the pixel. It is one for all markers if the pose weights them equally.
  template <class T>
  T information(const T& brightness, const T& pixel) const {
    if (in_middle_.constant == 0.0) return T(1.0);
    const T edge = T(0.5) - T(0.5) * cos(T(2.0 * pi) * pixel);
    const T slope = T(in_middle_.per_brightness) +
                    T(on_edge_.per_brightness - in_middle_.per_brightness) * edge;
    const T constant = T(in_middle_.constant) + T(on_edge_.constant - in_middle_.constant) * edge;
    return brightness * brightness / (slope * brightness + constant);
  }

  // The light that enters the lens, relative to a constant: cosᵐ ε cos α/d², with α at the lens. A
  // marker that is turned away is treated like one at grazing angle.
  template <class T>
  T brightness_at(const Vec3Of<T>& to_camera_m, const Vec3& normal, const T& depth_m) const {
    const T distance_m = length<T>(to_camera_m);
    const T cosine =
        (to_camera_m[0] * normal[0] + to_camera_m[1] * normal[1] + to_camera_m[2] * normal[2]) /
        distance_m;
    constexpr double grazing = 0.02;
    const T shining = where_at_least(cosine, grazing, cosine, T(grazing));
    return pow(shining, emission_exponent_) * depth_m / (distance_m * distance_m * distance_m);
  }

  template <class T>
  Vec3Of<T> error_of(const ParametersAndStates<T>& own, size_t marker) const {
    if (!only_)
      return {own.parameters[3 * marker], own.parameters[3 * marker + 1],
              own.parameters[3 * marker + 2]};
    if (*only_ != marker) return {T(0.0), T(0.0), T(0.0)};
    return {own.parameters[1], own.parameters[2], own.parameters[3]};
  }

  // The present estimate of the pose: a rotation in body axes and, for a free pose, a shift.
  template <class T>
  struct Found {
    Mat3Of<T> turned = Mat3Of<T>::Identity();
    Vec3Of<T> turn{T(0.0), T(0.0), T(0.0)}, shift_m{T(0.0), T(0.0), T(0.0)};
  };

  template <int unknowns, class T>
  Vec3Of<T> turn(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    // The camera in body axes.
    std::array<Vec3Of<T>, 3> axis;
    for (int k = 0; k < 3; ++k) {
      axis[k] = now.to_body(Vec3Of<T>(lab_from_camera_.col(k).template cast<T>()));
    }
    const Vec3Of<T> camera_m = now.to_body(Vec3Of<T>(camera_lab_m_.template cast<T>()));
    Found<T> found;
    for (int round = 0; round < rounds; ++round) {
      std::array<std::array<T, unknowns>, unknowns> normal;
      std::array<T, unknowns> right;
      for (int r = 0; r < unknowns; ++r) {
        right[r] = T(0.0);
        normal[r].fill(T(0.0));
      }
      for (size_t i = 0; i < markers_.size(); ++i) {
        const Vec3Of<T> place_m = markers_[i].place_m.template cast<T>();
        const Vec3Of<T> truth_m = place_m + error_of(own, index_[i]) - camera_m;
        const Vec3Of<T> arm_m = found.turned * place_m;
        const Vec3Of<T> taken_m = arm_m + found.shift_m - camera_m;
        const T depth_m = axis[2].dot(taken_m);
        const T brightness = brightness_at<T>(Vec3Of<T>(-taken_m), markers_[i].normal, depth_m) /
                             T(unit_brightness_);
        for (int k = 0; k < 2; ++k) {
          const T aside = axis[k].dot(taken_m) / depth_m;
          const Vec3Of<T> by_place = (axis[k] - axis[2] * aside) / depth_m;
          const Vec3Of<T> by_turn = arm_m.cross(by_place);
          std::array<T, unknowns> by;
          for (int c = 0; c < unknowns; ++c) by[c] = c < 3 ? by_turn[c] : by_place[c - 3];
          const T seen = axis[k].dot(truth_m) / axis[2].dot(truth_m);
          const T weight =
              information<T>(brightness, T(pixels_) * seen + T(middle_px_[static_cast<size_t>(k)]));
          const T off = seen - aside;
          for (int r = 0; r < unknowns; ++r) {
            const T weighted = weight * by[r];
            right[r] += weighted * off;
            for (int c = r; c < unknowns; ++c) normal[r][c] += weighted * by[c];
          }
        }
      }
      step<unknowns, T>(solved<unknowns, T>(normal, right), found);
    }
    return found.turn;
  }

  // Adds a rotation of at most about 0.01 rad, accurate to third order.
  template <int unknowns, class T>
  static void step(const std::array<T, unknowns>& by, Found<T>& found) {
    const Vec3Of<T> turn{by[0], by[1], by[2]};
    for (int c = 0; c < 3; ++c) {
      const Vec3Of<T> column = found.turned.col(c);
      const Vec3Of<T> once = turn.cross(column), twice = turn.cross(once);
      found.turned.col(c) =
          column + once + T(0.5) * twice + T(1.0 / 6.0) * Vec3Of<T>(turn.cross(twice));
    }
    // The rotation vector of two successive rotations (Baker, Campbell, Hausdorff).
    found.turn += turn + T(0.5) * Vec3Of<T>(turn.cross(found.turn));
    for (int c = 3; c < unknowns; ++c) found.shift_m[c - 3] += by[c];
  }

  // Solves a symmetric system, given by its upper half, by Gaussian elimination from the last
  // unknown upwards.
  template <int unknowns, class T>
  static std::array<T, unknowns> solved(std::array<std::array<T, unknowns>, unknowns>& a,
                                        std::array<T, unknowns>& right) {
    for (int p = unknowns - 1; p > 0; --p) {
      for (int r = 0; r < p; ++r) {
        const T factor = a[r][p] / a[p][p];
        right[r] -= factor * right[p];
        for (int c = r; c < p; ++c) a[r][c] -= factor * a[c][p];
      }
    }
    std::array<T, unknowns> x;
    for (int p = 0; p < unknowns; ++p) {
      x[p] = right[p];
      for (int c = 0; c < p; ++c) x[p] -= a[c][p] * x[c];
      x[p] /= a[p][p];
    }
    return x;
  }

  static constexpr int rounds = 3;

  Mat3 lab_from_camera_;
  Vec3 camera_lab_m_;
  bool is_free_;
  double emission_exponent_, unit_brightness_ = 1.0;
  double pixels_;                    // focal length in pixels
  std::array<double, 2> middle_px_;  // image centre, from the centre of its first pixel
  struct Information {
    double per_brightness = 0.0, constant = 0.0;
  };
  Information in_middle_, on_edge_;  // of a pixel
  std::optional<size_t> only_;
  std::vector<SeenMarker> markers_;
  std::vector<size_t> index_;  // index of each in camera.markers
};

const TrackingCamera& camera_of(const Settings& settings, const DisturbanceContext& context) {
  if (context.camera == nullptr) {
    throw settings.error("kind", "marker_positions without markers_m in [sensors.camera]",
                         "a camera with markers");
  }
  return *context.camera;
}

// Reads the errors of the markers, which must be small: the law is valid only near the true pose.
PlacedParameters read_error_m(const Settings& settings, size_t size, int first) {
  constexpr double most_m = 0.1;
  PlacedParameters group = array_parameter(settings, error_key, size, first);
  for (const Parameter& p : group.parameters) {
    if (std::abs(p.value) <= most_m) continue;
    throw settings.error(error_key, std::to_string(p.value) + " m", "at most 0.1 m either way");
  }
  return group;
}

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const TrackingCamera& camera = camera_of(settings, context);
  const auto count = static_cast<int64_t>(camera.markers.size());
  if (!settings.has(key::marker)) {
    return make_disturbance<MarkerPositions>(
        {read_error_m(settings, static_cast<size_t>(3 * count), 0)}, Stage::measurement, {}, camera,
        std::optional<size_t>{});
  }
  const int64_t which = settings.get(key::marker.within(1, count));
  const double value[] = {static_cast<double>(which)};
  return make_disturbance<MarkerPositions>(
      {fixed_parameter(marker_key, value), read_error_m(settings, 3, 1)}, Stage::measurement, {},
      camera, std::optional<size_t>(static_cast<size_t>(which - 1)));
}

// One parametrisation for each marker alone, and one for all together.
std::vector<Parametrisation> of_markers(const DisturbanceContext& context) {
  std::vector<Parametrisation> all;
  if (context.camera == nullptr) return all;
  constexpr double expected_m = 3e-4;
  const std::vector<Marker>& markers = context.camera->markers;
  for (size_t i = 0; i < markers.size(); ++i) {
    const Vec3 at_mm = 1e3 * markers[i].position_body_m;
    all.push_back({printed("marker %zu, stated at (%.4g, %.4g, %.4g) mm, is displaced: the pose is "
                           "rotated",
                           i + 1, at_mm.x(), at_mm.y(), at_mm.z()),
                   {EffectKey::fixed_at(marker_key, static_cast<double>(i + 1)),
                    EffectKey::vector(error_key, expected_m)}});
  }
  all.push_back(
      {"several of the camera's markers are not where they are stated: the pose turns by "
       "them",
       {{error_key, std::vector<double>(3 * markers.size(), 0.0), expected_m}}});
  return all;
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "marker_positions",
          .summary = "the camera's markers deviate from the positions used for the pose",
          .read = read,
          .screening = {.of_experiment = of_markers,
                        .widths = "`error_m` 0.0003 each, of every marker alone and of all; needs "
                                  "markers in [sensors.camera]"},
          .budget = {.reason_against = "an error of an instrument: no torque"},
          .keys = {key::marker, key::error}};
}

}  // namespace photorque::kinds::marker_positions
