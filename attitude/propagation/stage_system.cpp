#include "attitude/propagation/stage_system.h"

#include <algorithm>

#include "core/numerics/collocation_points.h"

namespace photorque {

std::vector<Dynamics::Block> state_blocks(const Dynamics& dynamics) {
  std::vector<Dynamics::Block> blocks;
  for (int first = 0; first < dynamics.size(); first += DualLanes::block) {
    Dynamics::Block block;
    for (int k = 0; k < DualLanes::block && first + k < dynamics.size(); ++k) {
      block.state[static_cast<size_t>(k)] = first + k;
    }
    blocks.push_back(block);
  }
  return blocks;
}

const std::vector<RateDerivative>& rate_derivatives(const Dynamics& dynamics,
                                                    std::span<const Dynamics::Block> blocks,
                                                    const Lanes& times_s, const ZeroOrderHold& held,
                                                    const Lanes* stages, RateWorkspace& room) {
  const size_t n = static_cast<size_t>(dynamics.size());
  std::vector<Lanes>& partials = room.partials;
  partials.resize(n * DualLanes::block);
  std::vector<RateDerivative>& jacobian = room.jacobian;
  jacobian.clear();
  for (const Dynamics::Block& block : blocks) {
    dynamics.derivatives(times_s, held, stages, block, partials.data(), room.evaluation);
    for (size_t c = 0; c < n; ++c) {
      for (size_t k = 0; k < DualLanes::block; ++k) {
        const Lanes& value = partials[c * DualLanes::block + k];
        if (block.state[k] < 0 || largest(larger_magnitude(value, 0.0)) == 0.0) continue;
        jacobian.push_back({c, static_cast<size_t>(block.state[k]), value});
      }
    }
  }
  return jacobian;
}

double stiffness_1_s(std::span<const RateDerivative> jacobian, std::span<const double> scales) {
  std::vector<double> rows(scales.size(), 0.0);
  for (const RateDerivative& entry : jacobian) {
    rows[entry.row] += largest(larger_magnitude(entry.value, 0.0)) * scales[entry.column];
  }
  double most = 0.0;
  for (size_t c = 0; c < rows.size(); ++c) most = std::max(most, rows[c] / scales[c]);
  return most;
}

StageSystem::StageSystem(size_t components, double h_s, std::span<const RateDerivative> jacobian)
    : components_(components) {
  constexpr size_t stages = gauss::points;
  const auto at = [](size_t c, size_t i) { return static_cast<Eigen::Index>(c * stages + i); };
  const Eigen::Index size = at(components, 0);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size);
  const Lanes weighted_h_s = h_s * Lanes(gauss::weights);
  for (const RateDerivative& entry : jacobian) {
    const Lanes slope = weighted_h_s * entry.value;
    for (size_t j = 0; j < stages; ++j) {
      for (size_t i = 0; i < stages; ++i) {
        matrix(at(entry.row, i), at(entry.column, j)) -=
            slope[static_cast<int>(i)] * gauss::mu_columns[j][i];
      }
    }
  }
  factors_.compute(matrix);
}

void StageSystem::solve(std::span<Lanes> x, size_t count) const {
  constexpr size_t stages = gauss::points;
  Eigen::MatrixXd columns(components_ * stages, count);
  const auto each = [&](const auto& visit) {
    for (size_t c = 0; c < components_; ++c) {
      for (size_t v = 0; v < count; ++v) {
        for (size_t i = 0; i < stages; ++i) {
          visit(x[c * count + v], static_cast<int>(i), columns(c * stages + i, v));
        }
      }
    }
  };
  each([](const Lanes& lanes, int i, double& cell) { cell = lanes[i]; });
  columns = factors_.solve(columns);
  each([](Lanes& lanes, int i, const double& cell) { lanes.set(i, cell); });
}

}  // namespace photorque
