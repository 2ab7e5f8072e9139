#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/parallel.h"
#include "core/text/format.h"
#include "receivers/gather/bodies/sunlit_body.h"
#include "tools/coupling/direction_map.h"

namespace photorque {
namespace {

constexpr size_t torque = 3;  // index of its first component

class SunlitDirections final : public LightDirections {
 public:
  SunlitDirections(const OpticalRun& run, const DistantSource& sun,
                   std::unique_ptr<const SunlitBody> body, int threads)
      : run_(run), sun_(sun), body_(std::move(body)) {
    // Tolerance: mirrored light with a torque that is small compared with the largest is not
    // refined.
    constexpr size_t few = 32;
    constexpr double small = 3e-5;
    const std::vector<RigidTransform> attitudes = fresh_directions(few, sun);
    // If torques cancel by symmetry, the tolerance follows from the force times a small lever arm.
    const double lever_m = 1e-3 * run.experiment().scene.radius_m();
    std::vector<double> torques_N_m(few, 0.0);
    parallel_for(few, threads, [&](size_t i) {
      const WrenchSum all = body_->wrench(attitudes[i], INFINITY).total();
      torques_N_m[i] =
          std::max(all.tail<3>().matrix().norm(), lever_m * all.head<3>().matrix().norm());
    });
    tolerance_N_m_ = small * *std::ranges::max_element(torques_N_m);
  }

  DirectionWrench at(const RigidTransform& lab_from_body) const override {
    const SunlitWrench light = body_->wrench(lab_from_body, tolerance_N_m_);
    DirectionWrench found;
    for (size_t k = 0; k < 6; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      found.direct[k] = light.direct[i];
      found.error[k] = light.mirror_error[i];
      found.bounced.first[k] = light.bounced[i];
      found.bounced.second[k] = light.bounced[6 + i];
    }
    found.rays = light.rays;
    return found;
  }

  void fill(WrenchTable& table, const std::vector<DirectionWrench>& found, bool,
            const Console& console, int threads,
            std::vector<std::string>& warnings) const override {
    // The error of the scattered light is common to all directions, because it comes from one
    // field.
    WrenchComponents scattered{};
    for (const DirectionWrench& one : found) {
      for (size_t k = 0; k < 6; ++k) {
        scattered[k] += 0.25 * std::pow(one.bounced.first[k] - one.bounced.second[k], 2) /
                        static_cast<double>(found.size());
      }
    }
    double square = 0.0;
    for (size_t node = 0; node < table.nodes(); ++node) {
      const DirectionWrench& one = found[node];
      for (size_t k = 0; k < 6; ++k) {
        const auto axis = static_cast<Eigen::Index>(k % torque);
        const double value = one.direct[k] + 0.5 * (one.bounced.first[k] + one.bounced.second[k]);
        const double error = std::hypot(one.error[k], std::sqrt(scattered[k]));
        (k < torque ? table.force_body_N : table.torque_body_N_m)[node][axis] = value;
        (k < torque ? table.force_error_N : table.torque_error_N_m)[node][axis] = error;
        if (k >= torque) square += error * error / 3.0 / static_cast<double>(table.nodes());
      }
    }
    print_comparison(std::sqrt(square), table, console, threads, warnings);
  }

 private:
  // Prints the difference between table and rays in directions outside the table, and its expected
  // size.
  void print_comparison(double stated_N_m, const WrenchTable& table, const Console& console,
                        int threads, std::vector<std::string>& warnings) const {
    constexpr size_t fresh = 16;
    constexpr uint64_t rays = 1 << 19;
    const std::vector<RigidTransform> attitudes = fresh_directions(fresh, sun_);
    std::vector<double> square(fresh, 0.0), noise(fresh, 0.0), sent_W(fresh, 0.0);
    parallel_for(fresh, threads, [&](size_t i) {
      const OpticalResult result = run_.run(attitudes[i], {}, rays);
      const WrenchEstimate traced =
          wrench_about(run_.wrench().total(result.sums[run_.wrench_index()]), table.about_body_m);
      const WrenchSum own = body_->wrench(attitudes[i], tolerance_N_m_).total();
      const Vec3 difference = traced.mean.torque_N_m - own.tail<3>().matrix();
      square[i] = difference.squaredNorm() / 3.0;
      noise[i] = traced.torque_error_N_m().squaredNorm() / 3.0;
      sent_W[i] = result.sent_W;
    });
    double squares = 0.0, noises = 0.0;
    for (size_t i = 0; i < fresh; ++i) {
      squares += square[i] / fresh;
      noises += noise[i] / fresh;
    }
    // Torque of all the light at the largest arm. Rays are in single precision, so that a torque
    // that is zero by symmetry has an error of 1e-7 of it.
    const double arm_m = run_.experiment().scene.radius_m() + table.about_body_m.norm();
    const double scale_N_m = arm_m * *std::ranges::max_element(sent_W) / speed_of_light_m_s;
    const double rounding_N_m = 1e-7 * scale_N_m;
    const double largest_N_m = std::max(largest_torque_N_m(table), 1e-3 * scale_N_m);
    console.line("  by quadrature over lit pieces, scattered light included; error of the torque " +
                 readable_number(stated_N_m / largest_N_m, 2) + " of the largest (rms); in " +
                 std::to_string(fresh) + " other directions, traced torques differ by " +
                 readable_number(std::sqrt(squares) / largest_N_m, 2) + ", with a noise of " +
                 readable_number(std::sqrt(noises) / largest_N_m, 2));
    constexpr double loud = 3.0;  // for a root mean square over 48 numbers
    const double sigmas =
        std::sqrt(squares / (noises + stated_N_m * stated_N_m + rounding_N_m * rounding_N_m));
    if (sigmas > loud) {
      warnings.push_back(
          "torques by quadrature and by rays differ by " + show(sigmas) +
          " standard errors (rms) in " + std::to_string(fresh) +
          " additional directions. Causes: parts too small for the rays, light through gaps; "
          "compare with trace.direct = \"rays\"");
    }
  }

  const OpticalRun& run_;
  const DistantSource& sun_;
  std::unique_ptr<const SunlitBody> body_;
  double tolerance_N_m_ = 0.0;
};

}  // namespace

std::unique_ptr<LightDirections> sunlit_directions(const OpticalRun& run, const DistantSource& sun,
                                                   const Vec3& about_body_m, int threads) {
  // A lower depth limit than the default can be fulfilled only by rays.
  const ExperimentFile& file = run.experiment().file;
  if (file.effort.direct == TraceEffort::Direct::rays) return nullptr;
  if (file.trace.max_depth < TraceOptions{}.max_depth) return nullptr;
  SunlitEffort effort;
  // Scattered light is computed once for all directions.
  constexpr uint64_t for_all = 64, most = 1ull << 24;
  const uint64_t rays = file.torque_map_rays.value_or(file.trace.rays);
  effort.scattered.rays = std::min(for_all * std::min(rays, most), most);
  effort.scattered.seed = run.provenance().seed;
  effort.scattered.threads = threads;
  auto body = SunlitBody::make(run.scene(), run.experiment().beams, about_body_m, effort);
  if (!body) return nullptr;
  return std::make_unique<SunlitDirections>(run, sun, std::move(body), threads);
}

}  // namespace photorque
