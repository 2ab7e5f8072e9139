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

RunEnsemble ensemble_of(const std::vector<std::pair<Estimation, TruthTrack>>& runs) {
  const auto count = static_cast<double>(std::max<size_t>(1, runs.size()));
  int numbers = 6;
  const auto rows_of = [&](std::vector<AttitudeEstimate> Estimation::*which) {
    RunEnsemble::Rows rows;
    for (const auto& [estimation, truth] : runs) {
      rows.nees.resize(estimation.filtered.size(), 0.0);
      rows.rms_rad.resize(estimation.filtered.size(), 0.0);
      const std::vector<AttitudeEstimate>& estimates = estimation.*which;
      for (size_t i = 0; i < estimates.size(); ++i) {
        if (!truth[i]) continue;
        const NormalisedError error = normalised_error(estimates[i], *truth[i]);
        numbers = error.numbers;
        rows.nees[i] += error.chi2;
        rows.rms_rad[i] += std::pow(attitude_error_rad(estimates[i], *truth[i]), 2);
      }
    }
    for (double& x : rows.nees) x /= count;
    for (double& x : rows.rms_rad) x = std::sqrt(x / count);
    return rows;
  };
  RunEnsemble all{
      runs.size(), rows_of(&Estimation::filtered), rows_of(&Estimation::smoothed), {}, {}, {}};
  const Band whole = chi2_band_95(numbers * count);
  all.band = {whole.low / count, whole.high / count};
  for (const auto& [estimation, truth] : runs) {
    all.attitude.chi2 += estimation.attitude.chi2;
    all.attitude.numbers += estimation.attitude.numbers;
    all.gyro.chi2 += estimation.gyro.chi2;
    all.gyro.numbers += estimation.gyro.numbers;
  }
  return all;
}

double RunEnsemble::part_in_band(const Rows& rows, size_t from) const {
  double inside = 0.0;
  for (size_t i = from; i < rows.nees.size(); ++i) inside += band.holds(rows.nees[i]) ? 1.0 : 0.0;
  return rows.nees.size() > from ? inside / static_cast<double>(rows.nees.size() - from) : 0.0;
}

}  // namespace photorque
