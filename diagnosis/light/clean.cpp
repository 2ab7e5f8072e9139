#include "diagnosis/light/diagnose.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numerics/linear.h"
#include "core/numerics/median.h"

namespace photorque {
namespace {

constexpr size_t neighbours = 8;

// Rows of a scan nearest to one row, at equal attitude.
std::vector<size_t> nearest_in_place(const LightRecording& r, size_t row) {
  std::vector<std::pair<double, size_t>> all;
  for (size_t j = 0; j < r.rows(); ++j) {
    if (j == row || r.lab_from_body[j].coeffs() != r.lab_from_body[row].coeffs()) continue;
    all.emplace_back(std::hypot(r.u_m[j] - r.u_m[row], r.v_m[j] - r.v_m[row]), j);
  }
  const size_t count = std::min(neighbours, all.size());
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), all.end());
  std::vector<size_t> near;
  for (size_t k = 0; k < count; ++k) near.push_back(all[k].second);
  return near;
}

// Rows before and after one row, within one sweep.
std::vector<size_t> nearest_in_time(const LightRecording& r, size_t row) {
  std::vector<size_t> near;
  const size_t reach = neighbours / 2;
  for (size_t j = row > reach ? row - reach : 0; j <= std::min(row + reach, r.rows() - 1); ++j) {
    if (j == row || (!r.sweep.empty() && r.sweep[j] != r.sweep[row])) continue;
    near.push_back(j);
  }
  return near;
}

// Whether a value deviates from the plane through its neighbours by more than their scatter about
// it.
bool leaves_plane(const std::vector<Vec2>& at, const std::vector<double>& value, double own,
                  double allowed) {
  if (at.size() < 5) return true;
  Eigen::MatrixXd A(static_cast<Eigen::Index>(at.size()), 3);
  Eigen::VectorXd b(A.rows());
  for (size_t k = 0; k < at.size(); ++k) {
    A.row(static_cast<Eigen::Index>(k)) << 1.0, at[k].x(), at[k].y();
    b[static_cast<Eigen::Index>(k)] = value[k];
  }
  const Eigen::VectorXd x = least_squares(A, b).solution;
  const double scatter = std::sqrt((A * x - b).squaredNorm() / static_cast<double>(at.size() - 3));
  constexpr double of_scatter = 4.0;
  return std::abs(own - x[0]) > allowed + of_scatter * scatter;
}

}  // namespace

std::vector<size_t> rows_without_outliers(const LightRun& run, const Eigen::VectorXd& residuals,
                                          const Thresholds::Noise& limits) {
  const LightRecording& r = run.recording();
  const bool is_scan = r.kind == LightRecording::Kind::scan;
  std::vector<bool> is_outlier(r.rows(), false);
  const size_t channels = run.channels().size();
  const auto residual = [&](size_t row, size_t channel) {
    return residuals[static_cast<Eigen::Index>(row * channels + channel)];
  };
  for (size_t row = 0; row < r.rows(); ++row) {
    // Most rows agree with the previous one, which saves the search for neighbours.
    bool looks_usual = row > 0;
    for (size_t c = 0; c < channels && looks_usual; ++c) {
      looks_usual = std::abs(residual(row, c) - residual(row - 1, c)) < limits.outlier_sigma;
    }
    if (looks_usual && !is_outlier[row - 1]) continue;
    const std::vector<size_t> near = is_scan ? nearest_in_place(r, row) : nearest_in_time(r, row);
    if (near.size() < 3) continue;
    for (size_t c = 0; c < channels; ++c) {
      double least = 1e300;
      std::vector<Vec2> at;
      std::vector<double> value;
      for (const size_t j : near) {
        value.push_back(residual(j, c));
        least = std::min(least, std::abs(residual(row, c) - value.back()));
        at.push_back(is_scan ? Vec2(r.u_m[j] - r.u_m[row], r.v_m[j] - r.v_m[row])
                             : Vec2(static_cast<double>(j) - static_cast<double>(row), 0.0));
      }
      if (least > limits.outlier_sigma &&
          leaves_plane(at, value, residual(row, c), limits.outlier_sigma)) {
        is_outlier[row] = true;
      }
    }
  }
  std::vector<size_t> good;
  for (size_t row = 0; row < r.rows(); ++row) {
    if (!is_outlier[row]) good.push_back(row);
  }
  return good;
}

std::vector<size_t> rows_within_noise(const LightRun& run, const Eigen::VectorXd& residuals) {
  constexpr double stray_sigma = 5.0, from_all_sigma = 3.0;
  const LightRecording& r = run.recording();
  const size_t channels = run.channels().size();
  const auto residual = [&](size_t row, size_t channel) {
    return residuals[static_cast<Eigen::Index>(row * channels + channel)];
  };
  const auto strays = [&](size_t row, size_t channel) {
    const double own = residual(row, channel);
    if (std::abs(own) < stray_sigma) return false;
    const std::vector<size_t> near =
        r.kind == LightRecording::Kind::scan ? nearest_in_place(r, row) : nearest_in_time(r, row);
    if (near.size() < 4) return false;
    std::vector<double> others, sizes;
    double least = std::numeric_limits<double>::infinity();
    for (const size_t j : near) {
      others.push_back(residual(j, channel));
      sizes.push_back(std::abs(others.back()));
      least = std::min(least, std::abs(own - others.back()));
    }
    // Near unmodelled effects neighbours deviate as well. By chance the median size of eight
    // neighbours rarely exceeds its expected value by half.
    const double level = std::max(1.0, median_of(std::move(sizes)) / (1.5 * normal_median));
    return least > from_all_sigma &&
           std::abs(own - median_of(std::move(others))) > stray_sigma * level;
  };
  std::vector<size_t> good;
  for (size_t row = 0; row < r.rows(); ++row) {
    bool stays = true;
    for (size_t c = 0; c < channels; ++c) stays = stays && !strays(row, c);
    if (stays) good.push_back(row);
  }
  return good;
}

}  // namespace photorque
