#include "diagnosis/light/scan.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/numerics/order.h"
#include "core/parallel.h"

namespace photorque {
namespace {

// All combinations of the starts of a kind's nonlinear parameters.
std::vector<std::vector<double>> grid_of_starts(const LightCandidate& c) {
  std::vector<std::vector<double>> all = {c.start()};
  for (size_t k = 0; k < c.numbers.size(); ++k) {
    const std::vector<double>& starts = c.kind.parameters[c.numbers[k].parameter].starts;
    if (starts.empty()) continue;
    std::vector<std::vector<double>> more;
    for (const std::vector<double>& x : all) {
      for (const double s : starts) {
        more.push_back(x);
        more.back()[k] = s;
      }
    }
    all = std::move(more);
  }
  return all;
}

std::vector<LeftOfRun> left_of(const LightTrial& parent, const LightCandidates& all,
                               const std::vector<FittedRun>& runs) {
  std::vector<LeftOfRun> left;
  const LightState state = state_of(parent, all);
  for (const FittedRun& run : runs) {
    LeftOfRun l{run.run.get(), {}, residuals_of(parent, all, run), {}};
    l.signals = run.run->signals(state, run.run->fields(state, run.nominal.get()));
    run.run->residuals(state, l.signals, &l.slopes);
    left.push_back(std::move(l));
  }
  return left;
}

// Predicted fall of χ² if only the strengths of a law are fitted.
double gain_alone(const LightCandidate& c, const std::vector<double>& start,
                  const std::vector<LeftOfRun>& left) {
  std::vector<size_t> strengths;
  for (size_t k = 0; k < c.numbers.size(); ++k) {
    if (c.numbers[k].is_strength) strengths.push_back(k);
  }
  const auto n = static_cast<Eigen::Index>(strengths.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
  for (const LeftOfRun& l : left) {
    Eigen::MatrixXd J(l.residuals.size(), n);
    for (Eigen::Index k = 0; k < n; ++k) {
      std::vector<double> x = start;
      for (const size_t s : strengths) x[s] = 0.0;
      x[strengths[static_cast<size_t>(k)]] = 1.0;
      LightState alone(0, 0, 0, 0);
      c.kind.act(alone, 0, x);
      std::vector<double> change(l.signals.size());
      for (size_t i = 0; i < change.size(); ++i) {
        change[i] = l.signals[i] * (alone.light_laws.front()(l.run->circumstances()[i]) - 1.0);
      }
      J.col(k) = -l.run->moved(l.slopes, change);
    }
    H += J.transpose() * J;
    g += J.transpose() * l.residuals;
  }
  const double gain = linear_gain(H, g);
  return std::isfinite(gain) ? gain : 0.0;
}

std::vector<LightStart> best_of_grid(const LightCandidate& c, const std::vector<LeftOfRun>& left,
                                     const Thresholds::Scoring& limits) {
  constexpr size_t few = 12, most = 3;
  const std::vector<std::vector<double>> grid = grid_of_starts(c);
  std::vector<LightStart> result;
  if (grid.size() <= few || !c.is_empirical || c.kind.in_circuit) {
    for (const std::vector<double>& x : grid) result.push_back({x});
    return result;
  }
  std::vector<double> gain;
  for (const std::vector<double>& x : grid) gain.push_back(gain_alone(c, x, left));
  for (const size_t i :
       sorted_indices(grid.size(), [&](size_t a, size_t b) { return gain[a] > gain[b]; })) {
    if (result.size() == most || gain[i] < limits.min_scan_gain) break;
    result.push_back({grid[i]});
  }
  return result;
}

}  // namespace

std::vector<std::vector<LightStart>> LightCandidates::starts(const Trial& parent,
                                                             const std::vector<size_t>& candidates,
                                                             const Runs& runs, const Runs&,
                                                             int threads) const {
  std::vector<std::vector<LightStart>> result(candidates.size());
  const std::vector<LeftOfRun> left = left_of(parent, *this, runs);
  parallel_for(candidates.size(), threads, [&](size_t i) {
    const LightCandidate& c = list[candidates[i]];
    switch (c.kind.scan) {
      case LightEffectKind::Scan::shadow:
        result[i] = shadow_starts(parent, *this, runs, c.index == 1);
        break;
      case LightEffectKind::Scan::wave:
        result[i] = wave_starts(c, left, limits.scoring);
        break;
      case LightEffectKind::Scan::trapped:
        result[i] = {{trapped_interval(parent, *this, runs)}};
        break;
      case LightEffectKind::Scan::none:
        result[i] = best_of_grid(c, left, limits.scoring);
        break;
    }
  });
  return result;
}

std::vector<double> trapped_interval(const LightTrial& parent, const LightCandidates& all,
                                     const std::vector<FittedRun>& runs) {
  // The interval with the largest sum of gains (J. Bentley, Communications of the ACM 27, 865
  // (1984)).
  LightState state = state_of(parent, all);
  state.trapped.clear();
  double best = 0.0;
  std::vector<double> interval = {0.0, -1.0, 0.0};
  for (const FittedRun& run : runs) {
    const LightRecording& r = run.run->recording();
    if (r.kind != LightRecording::Kind::run) continue;
    const std::vector<double> signals =
        run.run->signals(state, run.run->fields(state, run.nominal.get()));
    const std::vector<double> gain = run.run->gain_if_trapped(state, signals);
    double sum = 0.0;
    size_t from = 0;
    for (size_t i = 0; i < gain.size(); ++i) {
      if (sum <= 0.0) {
        sum = 0.0;
        from = i;
      }
      sum += gain[i];
      if (sum > best && gain[i] > 0.0) {
        best = sum;
        interval = {r.time_s[from], r.time_s[i], static_cast<double>(run.run->number())};
      }
    }
  }
  return interval;
}

std::vector<std::vector<double>> in_order_of_place(const LightRun& run,
                                                   const Eigen::VectorXd& residuals) {
  std::vector<std::vector<double>> ordered(run.channels().size());
  if (run.recording().kind != LightRecording::Kind::scan) {
    for (Eigen::Index i = 0; i < residuals.size(); ++i) {
      const auto k = static_cast<size_t>(i);
      ordered[static_cast<size_t>(run.sample_channel()[k])].push_back(residuals[i]);
    }
    return ordered;
  }
  const LightRecording& r = run.recording();
  const SurfaceGrid& g = run.lab().grid();
  const double area = (g.u_high - g.u_low) * (g.v_high - g.v_low);
  // A block contains about twenty places per attitude.
  std::vector<size_t> attitude(r.rows(), 0);
  for (size_t i = 1; i < r.rows(); ++i) {
    const bool is_new = r.lab_from_body[i].coeffs() != r.lab_from_body[i - 1].coeffs();
    attitude[i] = attitude[i - 1] + (is_new ? 1 : 0);
  }
  constexpr double places_of_a_block = 20.0;
  const double side =
      std::sqrt(places_of_a_block * area * static_cast<double>(attitude.back() + 1) /
                static_cast<double>(r.rows()));
  // Attitude, block along v, block along u, row.
  std::vector<std::tuple<size_t, int, int, size_t>> places;
  for (size_t i = 0; i < r.rows(); ++i) {
    places.emplace_back(attitude[i], static_cast<int>(std::floor((r.v_m[i] - g.v_low) / side)),
                        static_cast<int>(std::floor((r.u_m[i] - g.u_low) / side)), i);
  }
  std::ranges::sort(places);
  for (const auto& place : places) {
    ordered[0].push_back(residuals[static_cast<Eigen::Index>(std::get<3>(place))]);
  }
  return ordered;
}

}  // namespace photorque
