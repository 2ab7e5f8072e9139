#include "attitude/camera/study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/parallel.h"
#include "core/settings/typed_keys.h"
#include "core/text/format.h"
#include "core/transform.h"

namespace photorque {
namespace {

namespace study_key {
constexpr NumberKey max_tilt("max_tilt_deg", {0.0, 0.5 * pi, true, true},
                             "largest tilt in the tables",
                             {.usually = "the platform's stop, else 30"});
constexpr Vec3Key rate("rate_rad_s", {0.0, 0.0, 0.0},
                       "rate of the platform during the exposures, body axes");
constexpr NumberKey calibration("calibration_px", Range::positive(),
                                "calibration error assumed in the tables", {.optional = true});
constexpr NumbersKey distortion_error(
    "distortion_error", {-10.0, 10.0},
    "uncalibrated distortion assumed in the tables: [k1, k2, p1, p2]",
    {.usually = "[-0.1, 0, 1e-3, 1e-3]", .size = 4});
constexpr IntegerKey images("images", 10, 1'000'000,
                            "number of images simulated at each of four attitudes",
                            {.optional = true});
constexpr IntegerKey grid("grid", 5, 1000, "bins of the maps along a side", {.optional = true});
constexpr NumbersKey focal_length("focal_length_mm", Range::positive(),
                                  "[from, to] of the map over lens and board",
                                  {.usually = "0.75 to 1.5 times the lens", .size = 2});
constexpr NumbersKey board_scale("board_scale", Range::positive(),
                                 "[from, to] of the scale of the board in this map",
                                 {.usually = "[0.5, 2]", .size = 2});
constexpr TableKey camera_study("camera_study", "tables and maps of the command `camera`");
}  // namespace study_key

std::vector<double> read_study_span(const Settings& s, const NumbersKey& key,
                                    const std::vector<double>& otherwise) {
  if (!s.has(key)) return otherwise;
  std::vector<double> span = s.get(key);
  if (span.size() != 2 || !(span[0] < span[1])) {
    throw s.error(key, std::to_string(span.size()) + " numbers", "[from, to]");
  }
  return span;
}

constexpr double unseen = std::numeric_limits<double>::quiet_NaN();

Pose leaning(const CameraStudy& study, double tilt_rad, double heading_rad) {
  const Quat attitude = lab_from_body_at(tilt_rad, heading_rad).rotation;
  return {attitude, attitude * study.rate_body_rad_s, Vec3::Zero()};
}

// Errors in plane and out of plane [arcsec].
using Pair = std::array<double, 2>;
Pair arcseconds(const TrackingCamera& camera, const std::optional<Mat3>& covariance_rad2) {
  if (!covariance_rad2) return {unseen, unseen};
  const PlaneErrors errors = plane_errors(camera, *covariance_rad2);
  return {errors.in_plane_rad / arcsecond_rad, errors.out_of_plane_rad / arcsecond_rad};
}

// The larger of each; an unobserved direction (NaN) is the worst.
Pair worse(const Pair& a, const Pair& b) {
  const auto worst = [](double x, double y) {
    return std::isnan(x) || std::isnan(y) ? unseen : std::max(x, y);
  };
  return {worst(a[0], b[0]), worst(a[1], b[1])};
}

constexpr int headings = 24;

// The largest errors over all headings of a tilt.
template <class Covariance>
Pair worst_at(const CameraStudy& study, const TrackingCamera& camera, double tilt_rad,
              const Covariance& covariance) {
  Pair worst = {0.0, 0.0};
  for (int i = 0; i < (tilt_rad > 0.0 ? headings : 1); ++i) {
    const Pose pose = leaning(study, tilt_rad, 2.0 * pi * i / headings);
    worst = worse(worst, arcseconds(camera, covariance(camera, pose)));
  }
  return worst;
}

Pair worst_with_one_dark(const CameraStudy& study, double tilt_rad) {
  Pair worst = {0.0, 0.0};
  for (size_t i = 0; i < study.camera.markers.size(); ++i) {
    TrackingCamera camera = study.camera;
    camera.markers[i].is_lit = false;
    worst = worse(worst, worst_at(study, camera, tilt_rad, attitude_covariance_lab_rad2));
  }
  return worst;
}

Table marker_table(const TrackingCamera& camera) {
  Table table = Table::of("markers", "Markers in the image at zero tilt");
  for (size_t i = 0; i < camera.markers.size(); ++i) {
    const auto view = view_of(camera, i, {});
    const Vec3& place_m = camera.markers[i].position_body_m;
    const Spot spot = view ? spot_of(camera, *view) : Spot{{unseen, unseen}, unseen};
    table.row()
        .set("x_m", place_m.x())
        .set("y_m", place_m.y())
        .set("z_m", place_m.z())
        .set("column_px", spot.centre_px.x())
        .set("row_px", spot.centre_px.y())
        .set("electrons", spot.electrons)
        .set("brightest_pixel_electrons", view ? brightest_pixel(spot) : unseen)
        .set("centre_error_px",
             view ? std::sqrt(0.5 * centre_covariance_px2(spot, pixel_noise(camera)).trace())
                  : unseen);
  }
  return table;
}

std::vector<double> tilts_of(const CameraStudy& study) {
  std::vector<double> tilts;
  for (int i = 0; i <= 6; ++i) tilts.push_back(study.max_tilt_rad * i / 6.0);
  return tilts;
}

Table degradation_table(const CameraStudy& study) {
  const char* cases[] = {"all",    "one_dark",   "calibration", "principal_point",
                         "radial", "tangential", "free"};
  Table table =
      Table::of("degradation", "Attitude error of one image, the worst heading of each tilt");
  TrackingCamera free = study.camera, bound = study.camera;
  free.knows_centre = false;
  bound.knows_centre = true;
  const auto calibration = [&](const TrackingCamera& camera, const Pose& pose) {
    return calibration_error_lab_rad2(camera, pose, study.calibration_px);
  };
  const auto principal_point = [&](const TrackingCamera& camera, const Pose& pose) {
    return principal_point_error_lab_rad2(camera, pose, study.calibration_px);
  };
  const Distortion& d = study.distortion_error;
  TrackingCamera radial = study.camera, tangential = study.camera;
  radial.marker_error_body_m = tangential.marker_error_body_m = {};
  radial.distortion_error = {d.k1, d.k2, 0.0, 0.0};
  tangential.distortion_error = {0.0, 0.0, d.p1, d.p2};
  // For one attitude the bias is a rotation, not a scatter.
  const auto square_of_bias = [](const TrackingCamera& camera,
                                 const Pose& pose) -> std::optional<Mat3> {
    const auto turn_rad = marker_bias_lab_rad(camera, pose);
    if (!turn_rad) return {};
    return Mat3(*turn_rad * turn_rad->transpose());
  };
  for (const double tilt : tilts_of(study)) {
    const Pair pairs[] = {worst_at(study, study.camera, tilt, attitude_covariance_lab_rad2),
                          worst_with_one_dark(study, tilt),
                          worst_at(study, study.camera, tilt, calibration),
                          worst_at(study, study.camera, tilt, principal_point),
                          worst_at(study, radial, tilt, square_of_bias),
                          worst_at(study, tangential, tilt, square_of_bias),
                          worst_at(study, free, tilt, attitude_covariance_lab_rad2)};
    Table::Row row = table.row();
    row.set("tilt_deg", tilt / degree_rad);
    for (size_t k = 0; k < std::size(cases); ++k) {
      row.set(std::string(cases[k]) + "_in_plane_arcsec", pairs[k][0]);
      row.set(std::string(cases[k]) + "_out_of_plane_arcsec", pairs[k][1]);
    }
  }
  return table;
}

Plot error_plot(const CameraStudy& study, const Table& degradation) {
  Plot plot{"error_over_tilt", "Attitude error of one image, worst heading", "tilt [deg]",
            "in plane [arcsec]"};
  plot.y_log = true;
  Plot::Panel below{"out of plane [arcsec]", {}, true};
  const std::pair<const char*, std::string> curves[] = {
      {"all", "all markers"},
      {"one_dark", "without the most important marker"},
      {"calibration", printed("images displaced by %.3g px at random", study.calibration_px)},
      {"radial", printed("k₁ uncalibrated by %.3g", study.distortion_error.k1)},
      {"free", "centre not known"}};
  const std::vector<double>& tilt = degradation.column("tilt_deg").values;
  for (const auto& [name, label] : curves) {
    const std::string stem = name;
    Plot::Curve curve{label, tilt, degradation.column(stem + "_in_plane_arcsec").values};
    curve.dashed = stem == "calibration" || stem == "radial";
    plot.curves.push_back(curve);
    curve.y = degradation.column(stem + "_out_of_plane_arcsec").values;
    below.curves.push_back(curve);
  }
  plot.below.push_back(below);
  return plot;
}

// Two maps of `errors` at column and row: in plane and out of plane.
std::vector<Map> two_maps(Map frame, int threads, const std::string& name, const std::string& title,
                          const std::function<Pair(int, int)>& errors) {
  const auto size = static_cast<size_t>(frame.width) * static_cast<size_t>(frame.height);
  frame.unit = "arcsec";
  frame.value.assign(size, unseen);
  std::vector<Map> maps(2, frame);
  const auto width = static_cast<size_t>(frame.width);
  parallel_for(size, threads, [&](size_t at) {
    const Pair pair = errors(static_cast<int>(at % width), static_cast<int>(at / width));
    maps[0].value[at] = pair[0];
    maps[1].value[at] = pair[1];
  });
  maps[0].name = name + "in_plane_error";
  maps[0].title = "Error in the image plane" + title;
  maps[1].name = name + "out_of_plane_error";
  maps[1].title = "Error out of the image plane" + title;
  return maps;
}

std::vector<Map> lean_maps(const CameraStudy& study) {
  Map frame;
  frame.width = frame.height = study.grid;
  const double edge_deg = study.max_tilt_rad / degree_rad * (1.0 + 1.0 / study.grid);
  frame.x_low = frame.y_low = -edge_deg;
  frame.x_high = frame.y_high = edge_deg;
  frame.x_label = "tilt towards lab x [deg]";
  frame.y_label = "tilt towards lab y [deg]";
  frame.smooth = true;
  const double step_deg = 2.0 * edge_deg / study.grid;
  const auto squares_at = [&](double x_deg, double y_deg) -> Pair {
    const Pose pose =
        leaning(study, std::hypot(x_deg, y_deg) * degree_rad, std::atan2(y_deg, x_deg));
    const Pair one = arcseconds(study.camera, attitude_covariance_lab_rad2(study.camera, pose));
    return {one[0] * one[0], one[1] * one[1]};
  };
  // A bin is the mean over positions within it, which place the spots differently on the pixels.
  constexpr int places = 4;
  const auto errors = [&](int column, int row) -> Pair {
    const double x_deg = -edge_deg + column * step_deg, y_deg = -edge_deg + row * step_deg;
    const double middle_rad =
        std::hypot(x_deg + 0.5 * step_deg, y_deg + 0.5 * step_deg) * degree_rad;
    if (middle_rad > study.max_tilt_rad * (1.0 + 1e-9)) return {unseen, unseen};
    Pair sum = {0.0, 0.0};
    for (int i = 0; i < places * places; ++i) {
      const int column_within = i % places, row_within = i / places;
      const Pair one = squares_at(x_deg + (column_within + 0.5) / places * step_deg,
                                  y_deg + (row_within + 0.5) / places * step_deg);
      sum = {sum[0] + one[0], sum[1] + one[1]};
    }
    return {std::sqrt(sum[0]) / places, std::sqrt(sum[1]) / places};
  };
  return two_maps(frame, study.threads, "", " of one image", errors);
}

// Maps over the focal length, at constant f-number, and the scale of the marker distances.
std::vector<Map> design_maps(const CameraStudy& study) {
  Map frame;
  frame.width = frame.height = study.grid;
  double largest_m = 0.0;
  for (const Marker& marker : study.camera.markers) {
    largest_m = std::max(largest_m, marker.position_body_m.head<2>().norm());
  }
  frame.x_low = study.focal_length_m.front() * 1e3;
  frame.x_high = study.focal_length_m.back() * 1e3;
  frame.y_low = study.board_scale.front() * largest_m * 1e3;
  frame.y_high = study.board_scale.back() * largest_m * 1e3;
  frame.x_label = "focal length [mm]";
  frame.y_label = "farthest marker from the axis [mm]";
  frame.smooth = true;
  frame.equal_scale = false;
  const auto errors = [&](int column, int row) -> Pair {
    TrackingCamera camera = study.camera;
    const double x = (column + 0.5) / study.grid, y = (row + 0.5) / study.grid;
    camera.focal_length_m = 1e-3 * (frame.x_low + x * (frame.x_high - frame.x_low));
    const double scale =
        1e-3 * (frame.y_low + y * (frame.y_high - frame.y_low)) / std::max(largest_m, 1e-9);
    for (Marker& marker : camera.markers) marker.position_body_m.head<2>() *= scale;
    // A valid design has all markers in the image.
    for (size_t i = 0; i < camera.markers.size(); ++i) {
      if (!view_of(camera, i, {})) return {unseen, unseen};
    }
    return arcseconds(camera, attitude_covariance_lab_rad2(camera, {}));
  };
  return two_maps(frame, study.threads, "design_", " at zero tilt", errors);
}

// The errors in the paper, in and out of the image plane, with tolerances.
struct Wanted {
  const char* label;
  double error_arcsec, tolerance_arcsec;
};
constexpr Wanted wanted[] = {{"12 ± 1 arcsec in plane", 12.0, 1.0},
                             {"37 ± 2 arcsec out of plane", 37.0, 2.0}};

// The curve on which the map has the value `level`: the focal length for each distance of the
// markers, interpolated linearly between the bins of each row.
Plot::Curve level_curve(const Map& map, double level) {
  Plot::Curve curve;
  const auto width = static_cast<size_t>(map.width);
  const double x_step = (map.x_high - map.x_low) / map.width;
  const double y_step = (map.y_high - map.y_low) / map.height;
  for (int row = 0; row < map.height; ++row) {
    const double* values = map.value.data() + static_cast<size_t>(row) * width;
    for (int column = 0; column + 1 < map.width; ++column) {
      const double a = values[column], b = values[column + 1];
      if (!((a - level) * (b - level) <= 0.0) || a == b) continue;
      const double at = column + 0.5 + (level - a) / (b - a);
      curve.x.push_back(map.x_low + at * x_step);
      curve.y.push_back(map.y_low + (row + 0.5) * y_step);
      break;
    }
  }
  return curve;
}

Plot design_plot(const std::vector<Map>& maps) {
  Plot plot{"design", "Which board and lens give the paper's errors at zero tilt", maps[0].x_label,
            maps[0].y_label};
  const Plot::Colour colours[] = {Plot::Colour::blue, Plot::Colour::vermilion};
  for (size_t k = 0; k < 2; ++k) {
    for (const double side : {0.0, -1.0, 1.0}) {
      Plot::Curve curve =
          level_curve(maps[k], wanted[k].error_arcsec + side * wanted[k].tolerance_arcsec);
      if (curve.x.empty()) continue;
      curve.colour = colours[k];
      curve.dashed = side != 0.0;
      if (!curve.dashed) curve.label = wanted[k].label;
      plot.curves.push_back(std::move(curve));
    }
  }
  return plot;
}

// Predicted errors compared with those of simulated images.
Table image_table(const CameraStudy& study, const std::function<void(double)>& progress) {
  Table table = Table::of(
      "images", "Simulated images against the predicted covariance",
      {"tilt_deg", "heading_deg", "images", "without_pose", "predicted_in_plane_arcsec",
       "found_in_plane_arcsec", "predicted_out_of_plane_arcsec", "found_out_of_plane_arcsec",
       "chi2_per_freedom", "chi2_standard_error", "fit_chi2_per_freedom"});
  const double half = 0.5 * study.max_tilt_rad, full = study.max_tilt_rad;
  const std::pair<double, double> attitudes[] = {
      {0.0, 0.0}, {half, 0.0}, {half, 0.75 * pi}, {full, 0.5 * pi}};
  uint64_t number = 0;
  for (const auto& [tilt_rad, heading_rad] : attitudes) {
    const Pose pose = leaning(study, tilt_rad, heading_rad);
    const auto predicted = attitude_covariance_lab_rad2(study.camera, pose);
    if (progress) progress(static_cast<double>(number) / std::size(attitudes));
    ++number;
    if (!predicted) continue;
    const ImageStatistics seen =
        take_images(study.camera, pose, study.images, study.seed + number, *predicted);
    const Pair expected = arcseconds(study.camera, predicted);
    const Pair found = arcseconds(study.camera, seen.covariance);
    table.row()
        .set("tilt_deg", tilt_rad / degree_rad)
        .set("heading_deg", heading_rad / degree_rad)
        .set("images", seen.images)
        .set("without_pose", seen.failed)
        .set("predicted_in_plane_arcsec", expected[0])
        .set("found_in_plane_arcsec", found[0])
        .set("predicted_out_of_plane_arcsec", expected[1])
        .set("found_out_of_plane_arcsec", found[1])
        .set("chi2_per_freedom", seen.chi2)
        .set("chi2_standard_error", std::sqrt(2.0 / (3.0 * std::max(1, seen.images - seen.failed))))
        .set("fit_chi2_per_freedom", seen.chi2_fit);
  }
  return table;
}

}  // namespace

Product camera_product(const CameraStudy& study, const std::function<void(double)>& progress) {
  Product product;
  const auto covariance = attitude_covariance_lab_rad2(study.camera, leaning(study, 0.0, 0.0));
  if (covariance) {
    const PlaneErrors errors = plane_errors(study.camera, *covariance);
    product.quantities = {
        {"in_plane_error_arcsec", {errors.in_plane_rad / arcsecond_rad, 0.0}},
        {"out_of_plane_error_arcsec", {errors.out_of_plane_rad / arcsecond_rad, 0.0}}};
  }
  product.tables.push_back(marker_table(study.camera));
  product.tables.push_back(degradation_table(study));
  product.plots.push_back(error_plot(study, product.tables.back()));
  product.tables.push_back(image_table(study, progress));
  const Table& images = product.tables.back();
  if (!images.columns.front().values.empty()) {
    product.quantities.push_back({"images_chi2_per_freedom",
                                  {images.column("chi2_per_freedom").values.front(),
                                   images.column("chi2_standard_error").values.front()}});
  }
  product.maps = lean_maps(study);
  const std::vector<Map> design = design_maps(study);
  product.plots.push_back(design_plot(design));
  product.maps.insert(product.maps.end(), design.begin(), design.end());
  return product;
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
  const Settings own(root.raw(study_key::camera_study), root.get(study_key::camera_study).name());
  study.max_tilt_rad = own.get_or(study_key::max_tilt, study.max_tilt_rad);
  study.rate_body_rad_s = own.get(study_key::rate);
  study.calibration_px = own.get_or(study_key::calibration, study.calibration_px);
  if (own.has(study_key::distortion_error)) {
    study.distortion_error = read_distortion(own, study_key::distortion_error);
  }
  study.images = static_cast<int>(own.get_or(study_key::images, study.images));
  study.grid = static_cast<int>(own.get_or(study_key::grid, study.grid));
  study.focal_length_m = read_study_span(own, study_key::focal_length, study.focal_length_m);
  study.board_scale = read_study_span(own, study_key::board_scale, study.board_scale);
  own.finish();
  return study;
}

}  // namespace photorque
