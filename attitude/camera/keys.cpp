#include "attitude/camera/keys.h"

#include "attitude/camera/study.h"
#include "core/constants.h"

namespace photorque {
namespace {

std::vector<double> read_study_span(const Settings& s, const NumbersKey& key, double low,
                                    double high) {
  if (!s.has(key)) return {low, high};
  std::vector<double> span = s.get(key);
  if (span.size() != 2 || !(span[0] < span[1])) {
    throw s.error(key, std::to_string(span.size()) + " numbers", "[from, to]");
  }
  return span;
}

}  // namespace

std::vector<Key> tracking_camera_keys() {
  using namespace tracking_key;
  const TrackingCamera usual;
  return {markers,
          marker_normal,
          marker_error,
          intensity,
          half_angle.with_default(usual.half_angle_rad),
          wavelength.with_default(usual.wavelength_m),
          focal_length,
          f_number.with_default(usual.f_number),
          transmittance.with_default(usual.transmittance),
          spot.with_default(usual.spot_px),
          distortion,
          distortion_error,
          pixel,
          resolution,
          exposure,
          line_time.with_default(usual.line_time_s),
          quantum_efficiency.with_default(usual.quantum_efficiency),
          read_noise_electrons.with_default(usual.read_noise_electrons),
          background_electrons.with_default(usual.background_electrons),
          full_well_electrons.with_default(usual.full_well_electrons),
          position,
          aim,
          pose,
          pose_weights};
}

Key camera_study_table() {
  using namespace study_key;
  const CameraStudy usual;
  return camera_study.of({max_tilt, rate, calibration.with_default(usual.calibration_px),
                          distortion_error, images.with_default(usual.images),
                          grid.with_default(usual.grid), focal_length, board_scale});
}

CameraStudy read_camera_study(const Settings& root, const TrackingCamera& camera,
                              std::optional<double> tilt_limit_rad) {
  CameraStudy study;
  study.camera = camera;
  study.max_tilt_rad = tilt_limit_rad.value_or(study.max_tilt_rad);
  study.focal_length_m = {0.75 * camera.focal_length_m, 1.5 * camera.focal_length_m};
  study.board_scale = {0.5, 2.0};
  if (!root.has(study_key::camera_study)) return study;
  const Settings own(std::make_shared<const SettingsNode>(root.raw(study_key::camera_study)),
                     root.get(study_key::camera_study).name());
  study.max_tilt_rad = own.get_or(study_key::max_tilt, study.max_tilt_rad);
  study.rate_body_rad_s = own.get(study_key::rate);
  study.calibration_px = own.get_or(study_key::calibration, study.calibration_px);
  if (own.has(study_key::distortion_error)) {
    const std::vector<double> numbers = own.get(study_key::distortion_error);
    if (numbers.size() != 4) {
      throw own.error(study_key::distortion_error, std::to_string(numbers.size()) + " numbers",
                      "[k1, k2, p1, p2]");
    }
    study.distortion_error = {numbers[0], numbers[1], numbers[2], numbers[3]};
  }
  study.images = static_cast<int>(own.get_or(study_key::images, study.images));
  study.grid = static_cast<int>(own.get_or(study_key::grid, study.grid));
  study.focal_length_m = read_study_span(own, study_key::focal_length, study.focal_length_m[0],
                                         study.focal_length_m[1]);
  study.board_scale =
      read_study_span(own, study_key::board_scale, study.board_scale[0], study.board_scale[1]);
  own.finish();
  return study;
}

}  // namespace photorque
