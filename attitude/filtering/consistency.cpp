#include "attitude/filtering/consistency.h"

#include <cmath>

#include "core/numerics/linear.h"
#include "core/transform.h"

namespace photorque {
namespace {

Vec3 turn_error(const AttitudeEstimate& estimate, const TruthAtRow& truth) {
  return turn_vector(estimate.lab_from_body.conjugate() * truth.lab_from_body);
}

}  // namespace

NormalisedError normalised_error(const AttitudeEstimate& estimate, const TruthAtRow& truth) {
  std::vector<double> errors;
  std::vector<int> places;
  const auto put = [&](const Vec3& error, int first) {
    for (int k = 0; k < 3; ++k) {
      // An axis that cannot turn has no error.
      if (!(estimate.covariance(first + k, first + k) > 0.0)) continue;
      errors.push_back(error[k]);
      places.push_back(first + k);
    }
  };
  put(turn_error(estimate, truth), 0);
  if (truth.rate_body_rad_s) put(*truth.rate_body_rad_s - estimate.rate_body_rad_s, 3);
  if (errors.empty()) return {};
  const VecX error = Eigen::Map<VecX>(errors.data(), static_cast<Eigen::Index>(errors.size()));
  return {squared_distance(error, estimate.covariance(places, places)),
          static_cast<int>(errors.size())};
}

double attitude_error_rad(const AttitudeEstimate& estimate, const TruthAtRow& truth) {
  return turn_error(estimate, truth).norm();
}

Band chi2_band_95(double freedom) {
  constexpr double normal_975 = 1.959963985;
  const double part = 2.0 / (9.0 * freedom);
  const auto quantile = [&](double z) {
    return freedom * std::pow(std::max(0.0, 1.0 - part + z * std::sqrt(part)), 3);
  };
  return {quantile(-normal_975), quantile(normal_975)};
}

Band innovation_band(const InnovationSum& sum) {
  if (!(sum.numbers > 0.0)) return {};
  const Band whole = chi2_band_95(sum.numbers);
  return {whole.low / sum.numbers, whole.high / sum.numbers};
}

RunErrors run_errors(const std::vector<AttitudeEstimate>& estimates, const TruthTrack& truth,
                     size_t from) {
  RunErrors errors;
  double square_rad2 = 0.0, rate_rad2_s2 = 0.0, nees = 0.0, inside = 0.0;
  size_t rates = 0;
  for (size_t i = from; i < estimates.size(); ++i) {
    if (!truth[i]) continue;
    ++errors.rows;
    square_rad2 += std::pow(attitude_error_rad(estimates[i], *truth[i]), 2);
    if (truth[i]->rate_body_rad_s) {
      ++rates;
      rate_rad2_s2 += (*truth[i]->rate_body_rad_s - estimates[i].rate_body_rad_s).squaredNorm();
    }
    const NormalisedError normalised = normalised_error(estimates[i], *truth[i]);
    nees += normalised.chi2 / std::max(1, normalised.numbers);
    inside += chi2_band_95(normalised.numbers).holds(normalised.chi2) ? 1.0 : 0.0;
  }
  // Without values the mean is NaN.
  const auto count = static_cast<double>(errors.rows);
  errors.rms_attitude_rad = std::sqrt(square_rad2 / count);
  errors.rms_rate_rad_s = std::sqrt(rate_rad2_s2 / static_cast<double>(rates));
  errors.mean_nees = nees / count;
  errors.part_in_band = inside / count;
  return errors;
}

void RunEnsemble::add(const Estimation& estimation, const TruthTrack& truth) {
  const size_t rows = estimation.filtered.size();
  if (runs_++ == 0) {
    chi2_filtered_.assign(rows, 0.0);
    chi2_smoothed_ = square_filtered_ = square_smoothed_ = chi2_filtered_;
  }
  const auto put = [&](const std::vector<AttitudeEstimate>& estimates, std::vector<double>& chi2,
                       std::vector<double>& square) {
    for (size_t i = 0; i < std::min(rows, estimates.size()); ++i) {
      if (!truth[i]) continue;
      const NormalisedError error = normalised_error(estimates[i], *truth[i]);
      numbers_ = error.numbers;
      chi2[i] += error.chi2;
      square[i] += std::pow(attitude_error_rad(estimates[i], *truth[i]), 2);
    }
  };
  put(estimation.filtered, chi2_filtered_, square_filtered_);
  put(estimation.smoothed, chi2_smoothed_, square_smoothed_);
  const auto sum = [](InnovationSum& into, const InnovationSum& one) {
    into.chi2 += one.chi2;
    into.numbers += one.numbers;
  };
  sum(attitude_, estimation.attitude);
  sum(gyro_, estimation.gyro);
}

std::vector<double> RunEnsemble::mean_of(std::vector<double> sums) const {
  for (double& sum : sums) sum /= std::max(1, runs_);
  return sums;
}

std::vector<double> RunEnsemble::rms_of(const std::vector<double>& squares) const {
  std::vector<double> rms = mean_of(squares);
  for (double& x : rms) x = std::sqrt(x);
  return rms;
}

Band RunEnsemble::band() const {
  const Band whole = chi2_band_95(static_cast<double>(numbers_) * std::max(1, runs_));
  return {whole.low / std::max(1, runs_), whole.high / std::max(1, runs_)};
}

double RunEnsemble::part_in_band(const std::vector<double>& nees, size_t from) const {
  double inside = 0.0;
  for (size_t i = from; i < nees.size(); ++i) inside += band().holds(nees[i]) ? 1.0 : 0.0;
  return nees.size() > from ? inside / static_cast<double>(nees.size() - from) : 0.0;
}

}  // namespace photorque
