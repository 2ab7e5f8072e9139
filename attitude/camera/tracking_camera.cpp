#include "attitude/camera/tracking_camera.h"

#include <cmath>

#include "attitude/camera/spot.h"
#include "core/constants.h"
#include "core/settings/typed_keys.h"
#include "core/transform.h"

namespace photorque {
namespace {

namespace tracking_key {
constexpr CameraParts usual;
constexpr Vec3sKey markers(
    "markers_m",
    "positions of the markers, body axes; at least two, four for a free pose. The noise then "
    "follows from board, lens and sensor instead of `noise_arcsec`",
    {.optional = true});
constexpr Vec3Key marker_normal("marker_normal", {0.0, 0.0, 1.0},
                                "direction in which the markers emit, body axes, any length");
constexpr Vec3sKey marker_error("marker_error_m",
                                "one per marker: true position minus `markers_m`; affects "
                                "recorded attitudes, but not the filter",
                                {.usually = "none"});
constexpr NumberKey intensity("intensity_W_sr", Range::positive(),
                              "radiant intensity of a marker along its normal", {.optional = true});
constexpr NumberKey half_angle(
    "half_angle_deg", usual.half_angle_rad, {0.0, 0.5 * pi, true, true},
    "angle of half the intensity, which is a power of the cosine; 60 is Lambert's law");
constexpr NumberKey wavelength("wavelength_nm", usual.wavelength_m, {1e-7, 2e-6},
                               "wavelength of the light of the markers");
constexpr NumberKey focal_length("focal_length_mm", Range::positive(), "focal length of the lens",
                                 {.optional = true});
constexpr NumberKey f_number("f_number", usual.f_number, {0.5, 128.0}, "f-number of the lens");
constexpr NumberKey transmittance("transmittance", usual.transmittance, {0.0, 1.0, true, false},
                                  "transmittance of lens and filter");
constexpr NumberKey spot("spot_px", usual.spot_px, {0.3, 50.0},
                         "standard deviation of a spot without diffraction and motion");
constexpr NumbersKey distortion("distortion", {-10.0, 10.0},
                                "calibrated distortion of the lens: [k1, k2, p1, p2], radial and "
                                "tangential, as OpenCV defines them",
                                {.usually = "none", .size = 4});
constexpr NumbersKey distortion_error(
    "distortion_error", {-10.0, 10.0},
    "true distortion minus `distortion`; affects recorded attitudes, but not the filter",
    {.usually = "none", .size = 4});
constexpr NumberKey pixel("pixel_um", {1e-7, 1e-3}, "pixel pitch of the sensor",
                          {.optional = true});
constexpr NumbersKey resolution("resolution", {8.0, 65536.0},
                                "number of pixels of the sensor: [columns, rows]",
                                {.optional = true, .size = 2});
constexpr NumberKey exposure("exposure_s", Range::positive(),
                             "exposure time; no pixel may exceed the full well at zero tilt",
                             {.optional = true});
constexpr NumberKey line_time("line_time_s", usual.line_time_s, Range::not_negative(),
                              "rolling shutter: delay of each row after the one above");
constexpr NumberKey quantum_efficiency("quantum_efficiency", usual.quantum_efficiency,
                                       {0.0, 1.0, true, false}, "quantum efficiency of the sensor");
constexpr NumberKey read_noise_electrons("read_noise_electrons", usual.read_noise_electrons,
                                         Range::positive(), "read noise of a pixel");
constexpr NumberKey background_electrons("background_electrons", usual.background_electrons,
                                         Range::not_negative(),
                                         "background electrons of a pixel in one exposure");
constexpr NumberKey full_well_electrons("full_well_electrons", usual.full_well_electrons,
                                        Range::positive(), "full-well capacity of a pixel");
constexpr Vec3Key position("position_m", "position of the camera, lab axes", {.optional = true});
constexpr Vec3Key aim("aim_m", {0.0, 0.0, 0.0}, "point on the optical axis, lab axes");
constexpr ChoiceKey pose("pose",
                         {{"about_centre", "the centre of rotation is known"},
                          {"free", "the position is estimated too"}},
                         0, "knowledge of the platform's position");
constexpr ChoiceKey pose_weights("pose_weights",
                                 {{"information", "by the Fisher information of their images"},
                                  {"equal", "the same for all markers"}},
                                 0, "weights of the markers in the pose");
}  // namespace tracking_key

// A spot is measured if it has at least this many electrons, and if the motion during the exposure
// smears it by at most this length.
constexpr double least_electrons = 1.0, longest_smear_px = 128.0;

// Cosine-power law with the given half angle: cosᵐ ε.
double emission(double cosine, double half_angle_rad) {
  return std::pow(cosine, std::log(0.5) / std::log(std::cos(half_angle_rad)));
}

void read_markers(const Settings& s, TrackingCamera& camera) {
  const Vec3 normal = s.get(tracking_key::marker_normal);
  if (!(normal.norm() > 0.0))
    throw s.error(tracking_key::marker_normal, "no direction", "a direction");
  for (const Vec3& position_m : s.get(tracking_key::markers)) {
    camera.markers.push_back({position_m, normal.normalized(), true});
  }
  if (s.has(tracking_key::marker_error))
    camera.marker_error_body_m = s.get(tracking_key::marker_error);
  if (!camera.marker_error_body_m.empty() &&
      camera.marker_error_body_m.size() != camera.markers.size()) {
    throw s.error(tracking_key::marker_error,
                  std::to_string(camera.marker_error_body_m.size()) + " errors",
                  "one for each of the " + std::to_string(camera.markers.size()) + " markers");
  }
  camera.radiant_intensity_W_sr = s.get(tracking_key::intensity);
  camera.half_angle_rad = s.get(tracking_key::half_angle);
  camera.wavelength_m = s.get(tracking_key::wavelength);
}

void read_sensor(const Settings& s, TrackingCamera& camera) {
  camera.pixel_m = s.get(tracking_key::pixel);
  const std::vector<double> size = s.get(tracking_key::resolution);
  if (size.size() != 2) {
    throw s.error(tracking_key::resolution, std::to_string(size.size()) + " numbers",
                  "[columns, rows]");
  }
  camera.width = static_cast<int>(size[0]);
  camera.height = static_cast<int>(size[1]);
  camera.exposure_s = s.get(tracking_key::exposure);
  camera.line_time_s = s.get(tracking_key::line_time);
  camera.quantum_efficiency = s.get(tracking_key::quantum_efficiency);
  camera.read_noise_electrons = s.get(tracking_key::read_noise_electrons);
  camera.background_electrons = s.get(tracking_key::background_electrons);
  camera.full_well_electrons = s.get(tracking_key::full_well_electrons);
}

void read_place(const Settings& s, TrackingCamera& camera) {
  const Vec3 position_m = s.get(tracking_key::position);
  const Vec3 direction = s.get(tracking_key::aim) - position_m;
  if (!(direction.norm() > 0.0)) throw s.error(tracking_key::aim, "position_m", "another point");
  camera.lab_from_camera = frame_looking_along(direction, position_m);
  camera.knows_centre = s.get(tracking_key::pose) == 0;
  camera.weighs_alike = s.get(tracking_key::pose_weights) == 1;
}

// InputError if a pixel exceeds the full well at zero tilt, or if too few markers are visible
// there.
void check_view(const Settings& s, const TrackingCamera& camera) {
  const size_t least = camera.knows_centre ? 2 : 4;
  size_t seen = 0;
  for (size_t i = 0; i < camera.markers.size(); ++i) {
    const auto view = view_of(camera, i, {});
    if (!view) continue;
    ++seen;
    const double peak = brightest_pixel(spot_of(camera, *view)) + camera.background_electrons;
    if (peak > camera.full_well_electrons) {
      throw s.error(tracking_key::exposure,
                    "a spot of " + std::to_string(std::lround(peak)) + " electrons in a pixel",
                    "at most full_well_electrons");
    }
  }
  if (seen < least) {
    throw s.error(tracking_key::markers,
                  std::to_string(seen) +
                      " with an electron or more in the image at zero tilt, of " +
                      std::to_string(camera.markers.size()),
                  "at least " + std::to_string(least));
  }
}

// InputError unless the image position increases with the angle up to the corners of the sensor.
// Otherwise some positions would appear twice.
void check_distortion(const Settings& s, const NumbersKey& key, const TrackingCamera& camera,
                      const Distortion& distortion) {
  const Vec2 corner =
      0.5 * Vec2(camera.width, camera.height) * camera.pixel_m / camera.focal_length_m;
  for (const double part : {0.25, 0.5, 0.75, 1.0}) {
    for (const Vec2& at : {Vec2(corner), Vec2(corner.x(), -corner.y()), Vec2(corner.x(), 0.0),
                           Vec2(0.0, corner.y())}) {
      for (const double side : {part, -part}) {
        const Eigen::Matrix2d slope = distortion.slope(side * at);
        if (slope.determinant() > 0.0 && slope.trace() > 0.0) continue;
        throw s.error(key, "a distortion that folds the image within the sensor",
                      "an image that grows with the angle");
      }
    }
  }
}

}  // namespace

Distortion read_distortion(const Settings& settings, const NumbersKey& key) {
  if (!settings.has(key)) return {};
  const std::vector<double> numbers = settings.get(key);
  if (numbers.size() != 4) {
    throw settings.error(key, std::to_string(numbers.size()) + " numbers", "[k1, k2, p1, p2]");
  }
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

Vec2 Distortion::distorted(const Vec2& u) const {
  const double r2 = u.squaredNorm(), radial = 1.0 + r2 * (k1 + r2 * k2);
  return {u.x() * radial + 2.0 * p1 * u.x() * u.y() + p2 * (r2 + 2.0 * u.x() * u.x()),
          u.y() * radial + p1 * (r2 + 2.0 * u.y() * u.y()) + 2.0 * p2 * u.x() * u.y()};
}

Eigen::Matrix2d Distortion::slope(const Vec2& u) const {
  const double r2 = u.squaredNorm(), radial = 1.0 + r2 * (k1 + r2 * k2);
  Eigen::Matrix2d d =
      radial * Eigen::Matrix2d::Identity() + 2.0 * (k1 + 2.0 * r2 * k2) * u * u.transpose();
  d(0, 0) += 2.0 * p1 * u.y() + 6.0 * p2 * u.x();
  d(1, 1) += 6.0 * p1 * u.y() + 2.0 * p2 * u.x();
  d(0, 1) += 2.0 * (p1 * u.x() + p2 * u.y());
  d(1, 0) += 2.0 * (p1 * u.x() + p2 * u.y());
  return d;
}

std::vector<Key> tracking_camera_keys() {
  using namespace tracking_key;
  return {markers,
          marker_normal,
          marker_error,
          intensity,
          half_angle,
          wavelength,
          focal_length,
          f_number,
          transmittance,
          spot,
          distortion,
          distortion_error,
          pixel,
          resolution,
          exposure,
          line_time,
          quantum_efficiency,
          read_noise_electrons,
          background_electrons,
          full_well_electrons,
          position,
          aim,
          pose,
          pose_weights};
}

std::optional<TrackingCamera> read_tracking_camera(const Settings& settings) {
  if (!settings.has(tracking_key::markers)) return {};
  TrackingCamera camera;
  read_markers(settings, camera);
  camera.focal_length_m = settings.get(tracking_key::focal_length);
  camera.f_number = settings.get(tracking_key::f_number);
  camera.transmittance = settings.get(tracking_key::transmittance);
  camera.spot_px = settings.get(tracking_key::spot);
  read_sensor(settings, camera);
  camera.distortion = read_distortion(settings, tracking_key::distortion);
  camera.distortion_error = read_distortion(settings, tracking_key::distortion_error);
  check_distortion(settings, tracking_key::distortion, camera, camera.distortion);
  check_distortion(settings, tracking_key::distortion_error, camera,
                   camera.distortion + camera.distortion_error);
  read_place(settings, camera);
  check_view(settings, camera);
  return camera;
}

std::optional<MarkerView> view_of(const TrackingCamera& camera, size_t index, const Pose& pose,
                                  bool in_truth) {
  const Marker& marker = camera.markers[index];
  if (!marker.is_lit) return {};
  Vec3 place_body_m = marker.position_body_m;
  if (in_truth && !camera.marker_error_body_m.empty()) {
    place_body_m += camera.marker_error_body_m[index];
  }
  const Quat camera_from_lab = camera.lab_from_camera.rotation.conjugate();
  const double scale = camera.focal_length_m / camera.pixel_m;
  const Vec3 arm_lab_m = pose.lab_from_body * place_body_m;
  const Distortion lens =
      in_truth ? camera.distortion + camera.distortion_error : camera.distortion;
  MarkerView view;
  view.marker = index;
  Vec3 arm_m = arm_lab_m, seen_m;
  // The row of the marker's image determines the time of its exposure, and this time determines the
  // image. Two iterations suffice: the second changes the time by less than the rate times the line
  // time squared.
  for (int round = 0; round < (camera.line_time_s > 0.0 ? 3 : 1); ++round) {
    const double late_s = camera.line_time_s * view.pixel.y();
    arm_m = turn_by(late_s * pose.rate_lab_rad_s) * arm_lab_m;
    seen_m = camera_from_lab * (arm_m + pose.centre_m - camera.lab_from_camera.translation_m);
    if (!(seen_m.z() > camera.focal_length_m)) return {};
    view.pixel = scale * lens.distorted(seen_m.head<2>() / seen_m.z());
  }
  // The whole spot must fall onto the sensor.
  const double margin_px = 4.5 * spot_sigma_px(camera) + 1.0;
  if (!(std::abs(view.pixel.x()) <= 0.5 * camera.width - margin_px &&
        std::abs(view.pixel.y()) <= 0.5 * camera.height - margin_px)) {
    return {};
  }
  const double distance_m = seen_m.norm();
  const Vec3 to_camera_lab = -(camera.lab_from_camera.rotation * seen_m) / distance_m;
  const double cosine = to_camera_lab.dot(pose.lab_from_body * marker.normal_body);
  if (!(cosine > 0.0) || (camera.is_hidden && camera.is_hidden(index, pose.lab_from_body))) {
    return {};
  }
  const double opening_m2 =
      0.25 * pi * std::pow(camera.focal_length_m / camera.f_number, 2) * seen_m.z() / distance_m;
  const double photon_J = planck_J_s * speed_of_light_m_s / camera.wavelength_m;
  view.electrons = camera.radiant_intensity_W_sr * emission(cosine, camera.half_angle_rad) *
                   opening_m2 / (distance_m * distance_m) * camera.transmittance *
                   camera.exposure_s * camera.quantum_efficiency / photon_J;
  if (!(view.electrons >= least_electrons)) return {};
  Eigen::Matrix<double, 2, 3> by_place;
  by_place << 1.0, 0.0, -seen_m.x() / seen_m.z(), 0.0, 1.0, -seen_m.y() / seen_m.z();
  by_place = scale / seen_m.z() * lens.slope(seen_m.head<2>() / seen_m.z()) * by_place;
  const Eigen::Matrix<double, 2, 3> by_shift = by_place * camera_from_lab.toRotationMatrix();
  view.derivative << -by_shift * skew(arm_m), by_shift;
  view.smear_px = by_shift * pose.rate_lab_rad_s.cross(arm_m) * camera.exposure_s;
  if (!(view.smear_px.norm() <= longest_smear_px)) return {};
  return view;
}

double spot_sigma_px(const TrackingCamera& camera) {
  const double diffraction_px = 0.42 * camera.wavelength_m * camera.f_number / camera.pixel_m;
  return std::hypot(camera.spot_px, diffraction_px);
}

}  // namespace photorque
