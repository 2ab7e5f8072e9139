#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/text/format.h"
#include "tools/coupling/direction_map.h"

namespace photorque {
namespace {

WrenchComponents components_of(const Wrench& wrench) {
  const Vec3 &f = wrench.force_N, &t = wrench.torque_N_m;
  return {f.x(), f.y(), f.z(), t.x(), t.y(), t.z()};
}

// Wrench of light after its first contact, about a point, from each half of the replicates.
WrenchPair bounced_of(const WrenchReceiver& receiver, const BinSums& sums,
                      const Vec3& about_body_m) {
  const int half = sums.replicates / 2;
  const auto mean = [&](int from, int to) {
    WrenchComponents all{};
    for (int r = from; r < to; ++r) {
      const auto bins = sums.of(r);
      for (size_t bin = receiver.direct_entries(); bin < receiver.bins(); ++bin) {
        all[bin % all.size()] += bins[bin] / (to - from);
      }
    }
    return components_of(wrench_about(
        Wrench{{all[0], all[1], all[2]}, {all[3], all[4], all[5]}, receiver.about_body_m()},
        about_body_m));
  };
  return {mean(0, half), mean(half, sums.replicates)};
}

class TracedDirections final : public LightDirections {
 public:
  TracedDirections(const OpticalRun& run, const DistantSource& sun, const Vec3& about_body_m)
      : run_(run), sun_(sun), about_body_m_(about_body_m) {}

  DirectionWrench at(const RigidTransform& lab_from_body) const override {
    return found_of(run_.run(lab_from_body, {}, run_.experiment().file.torque_map_rays));
  }

  // Bounced light is smoothed, unless the nodes are too far apart for that.
  void fill(WrenchTable& table, const std::vector<DirectionWrench>& found, bool whole,
            const Console& console, int threads, std::vector<std::string>&) const override {
    std::vector<WrenchPair> halves;
    double own_square = 0.0, smooth_square = 0.0;
    for (size_t node = 0; node < table.nodes(); ++node) {
      halves.push_back(found[node].bounced);
      add(table, node, found[node].direct, found[node].error);
      for (size_t k = 3; k < 6; ++k) {
        own_square += 0.25 * std::pow(halves[node].first[k] - halves[node].second[k], 2);
      }
    }
    std::optional<SmoothWrench> smooth;
    if (whole) {
      smooth = smooth_over_sphere(table, halves);
      for (size_t k = 3; k < 6; ++k) {
        smooth_square += std::pow(smooth->error[k], 2) * static_cast<double>(halves.size());
      }
      if (!(smooth_square < own_square)) smooth.reset();
    }
    for (size_t node = 0; node < table.nodes(); ++node) {
      WrenchComponents value{}, error{};
      for (size_t k = 0; k < 6; ++k) {
        const WrenchPair& one = halves[node];
        value[k] = smooth ? smooth->at_node[6 * node + k] : 0.5 * (one.first[k] + one.second[k]);
        error[k] = smooth  ? smooth->error[k]
                   : whole ? std::sqrt(own_square / 3.0 / static_cast<double>(halves.size()))
                           : 0.5 * std::abs(one.first[k] - one.second[k]);
      }
      add(table, node, value, error);
    }
    if (smooth) print_comparison(*smooth, table, console, threads);
  }

 private:
  DirectionWrench found_of(const OpticalResult& result) const {
    const BinSums& sums = result.sums[run_.wrench_index()];
    const WrenchEstimate direct = wrench_about(run_.wrench().direct(sums), about_body_m_);
    DirectionWrench found;
    found.direct = components_of(direct.mean);
    for (size_t k = 0; k < 6; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      found.error[k] = std::sqrt(direct.covariance(i, i));
    }
    found.bounced = bounced_of(run_.wrench(), sums, about_body_m_);
    found.rays = result.rays;
    found.warnings = run_.warnings(result);
    return found;
  }

  static void add(WrenchTable& table, size_t node, const WrenchComponents& value,
                  const WrenchComponents& error) {
    for (size_t k = 0; k < 6; ++k) {
      const auto axis = static_cast<Eigen::Index>(k % 3);
      (k < 3 ? table.force_body_N : table.torque_body_N_m)[node][axis] += value[k];
      double& own = (k < 3 ? table.force_error_N : table.torque_error_N_m)[node][axis];
      own = std::hypot(own, error[k]);
    }
  }

  // Prints the difference between series and rays in directions to which it was not fitted.
  void print_comparison(const SmoothWrench& smooth, const WrenchTable& table,
                        const Console& console, int threads) const {
    constexpr size_t fresh = 32;
    constexpr uint64_t more = 8;  // times the rays, so that their own noise is small
    const ExperimentFile& file = run_.experiment().file;
    const std::vector<RigidTransform> attitudes = fresh_directions(fresh, sun_);
    std::vector<double> square(fresh, 0.0), noise(fresh, 0.0);
    parallel_for(fresh, threads, [&](size_t i) {
      const OpticalResult result =
          run_.run(attitudes[i], {}, more * file.torque_map_rays.value_or(file.trace.rays));
      const WrenchPair truth =
          bounced_of(run_.wrench(), result.sums[run_.wrench_index()], about_body_m_);
      const Vec3 towards_body = attitudes[i].inverse().direction(sun_.towards_lab);
      const TableAngles angles = azimuth_and_elevation(towards_body);
      const Eigen::VectorXd own = smooth.series.at(angles.around_rad, angles.polar_rad);
      for (size_t k = 3; k < 6; ++k) {
        const double mean = 0.5 * (truth.first[k] + truth.second[k]);
        square[i] += std::pow(mean - own[static_cast<Eigen::Index>(k)], 2) / 3.0;
        noise[i] += 0.25 * std::pow(truth.first[k] - truth.second[k], 2) / 3.0;
      }
    });
    double squares = 0.0, noises = 0.0;
    for (size_t i = 0; i < fresh; ++i) {
      squares += square[i] / fresh;
      noises += noise[i] / fresh;
    }
    const double largest_N_m = std::max(largest_torque_N_m(table), 1e-300);
    const double stated = std::sqrt((std::pow(smooth.error[3], 2) + std::pow(smooth.error[4], 2) +
                                     std::pow(smooth.error[5], 2)) /
                                    3.0);
    console.line("  scattered light is smoothed by spherical harmonics up to degree " +
                 std::to_string(smooth.series.degree()) + "; error of the torque " +
                 readable_number(stated / largest_N_m, 2) + " of the largest (rms); in " +
                 std::to_string(fresh) + " other directions, traced torques differ by " +
                 readable_number(std::sqrt(squares) / largest_N_m, 2) + ", with a noise of " +
                 readable_number(std::sqrt(noises) / largest_N_m, 2));
  }

  const OpticalRun& run_;
  const DistantSource& sun_;
  Vec3 about_body_m_;
};

}  // namespace

std::unique_ptr<LightDirections> traced_directions(const OpticalRun& run, const DistantSource& sun,
                                                   const Vec3& about_body_m) {
  return std::make_unique<TracedDirections>(run, sun, about_body_m);
}

}  // namespace photorque
