// Maps and forces computed by other programs.
#include <gtest/gtest.h>

#include "tests/outside.h"
#include "tests/raytrace/test_scenes.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::PillboxDisc;

// Power on the 100 × 100 bins of the 0.5 m square about the origin at z = 0 (instance 0).
class SquareMap final : public Receiver {
 public:
  size_t bins() const override { return 10000; }
  void score(const Hits& hits, std::span<double> sums) const override {
    for (int i = 0; i < hits.count; ++i) {
      if (hits.instance[i] != 0) continue;
      const int ix = std::clamp(static_cast<int>((hits.position_m[0][i] + 0.25) * 200), 0, 99);
      const int iy = std::clamp(static_cast<int>((hits.position_m[1][i] + 0.25) * 200), 0, 99);
      sums[static_cast<size_t>(100 * iy + ix)] += hits.incident_W[0][i];
    }
  }
  Product product(const BinSums&) const override { return {}; }
};

struct MapCheck {
  double mean_square_z;  // of (map − reference)/error over lit bins
  double within_3;       // fraction of lit bins within 3 errors
  double rms_relative;   // over bins above 10 % of the peak
};

MapCheck compare(const BinSums& sums, const std::vector<double>& reference, double shift) {
  const double bin_area = 0.005 * 0.005;
  const double peak = *std::max_element(reference.begin(), reference.end());
  MapCheck check{0, 0, 0};
  int lit = 0;
  for (size_t i = 0; i < reference.size(); ++i) {
    if (reference[i] < 0.1 * peak) continue;
    const Estimate e = sums.estimate(i);
    // The reference is itself precise to 1e-4 of a bin.
    const double error = std::hypot(e.standard_error / bin_area, 3e-4 * reference[i]);
    const double difference = e.value / bin_area * (1 + shift) - reference[i];
    ++lit;
    check.mean_square_z += difference * difference / (error * error);
    check.within_3 += std::abs(difference) <= 3 * error;
    check.rms_relative += difference * difference / (reference[i] * reference[i]);
  }
  check.mean_square_z /= lit;
  check.within_3 /= lit;
  check.rms_relative = std::sqrt(check.rms_relative / lit);
  return check;
}

// A disc of 0.4 m at z = 1.5 m, pillbox of 1.5 deg, over a 0.5 m square with a black box between.
TEST(DiscOverSquare, MapAgreesWithTheReferenceWithinItsErrors) {
  const auto reference =
      outside::read_float32(outside::reference_data("optics") / "disc_angle.f32");
  ASSERT_EQ(reference.size(), 10000u);
  Scene scene;
  const auto black = grey_surface("black", 0, 0);
  add(scene, fixtures::rectangle(Vec3::Zero(), Vec3(0.5, 0, 0), Vec3(0, 0.5, 0)), black,
      "receiver");
  add(scene, fixtures::box(Vec3(0, -0.02, 0.5), Vec3(0.1, 0.08, 0.55)), black, "box");
  const TraceableScene traceable(std::move(scene));
  const auto emitter = std::make_shared<PillboxDisc>(1.0, 0.2, 1.5 * degree_rad);
  const Beam beam = fixtures::beam(emitter, Vec3(0, 0, 1.5), Vec3(0, 0, -1));
  const SquareMap map;
  const Receiver* const receivers[] = {&map};
  const TraceResult result =
      trace(traceable, {}, std::span(&beam, 1), receivers, {.rays = 1 << 24, .replicates = 32});
  const MapCheck check = compare(result.sums[0], reference, 0.0);
  // z² with errors from 32 replicates is F(1, 31): mean 31/29 = 1.069, fraction within 3: 99.5 %.
  EXPECT_NEAR(check.mean_square_z, 1.069, 0.12);
  EXPECT_GT(check.within_3, 0.985);
  EXPECT_LT(check.rms_relative, 0.025);
  // A map that is 2 % too bright is not accepted.
  EXPECT_GT(compare(result.sums[0], reference, 0.02).mean_square_z, 1.3);
  RecordProperty("mean_square_z", std::to_string(check.mean_square_z));
}

// Four oblique cases of a faceted spacecraft: ten facets, each lit on its front only, no mutual
// shadows (specular 0.9, diffuse 0.1). Force and torque about the body origin at 0.5 au,
// P = 1.825262728924288e-05 Pa, made with the facet law and the geometry of Basilisk's test of its
// faceted radiation-pressure effector.
struct FacetCase {
  double theta1_deg, theta2_deg;
  Vec3 force_N, torque_N_m;
};
const FacetCase facet_cases[] = {
    {-10.4,
     -28,
     {6.036444185e-05, -2.053871244e-03, -5.645261517e-04},
     {1.499236458e-03, -3.381159990e-03, 1.956073000e-03}},
    {45.2,
     45.2,
     {4.571910166e-05, -1.057611735e-03, -8.821648080e-04},
     {7.520418256e-04, 4.357480307e-03, -3.848435922e-03}},
    {90,
     -90,
     {4.085912732e-05, -1.168190062e-04, -7.791857153e-04},
     {4.644727904e-05, 2.090127557e-05, 0.0}},
    {180,
     180,
     {5.943803893e-05, -2.102010118e-03, -8.350869147e-05},
     {1.535340613e-03, 3.483545928e-05, 0.0}},
};

struct Facet {
  Vec3 normal, centre_m;
  double area_m2;
};

std::vector<Facet> facets(double theta1, double theta2) {
  std::vector<Facet> all;
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {1.0, -1.0})
      all.push_back({sign * Vec3::Unit(k), 0.75 * sign * Vec3::Unit(k), 2.25});
  }
  const Mat3 identity = Mat3::Identity();
  const Mat3 half_turn = Vec3(-1, -1, 1).asDiagonal();
  const double area = pi * 3.75 * 3.75;
  const auto array = [&](double theta, const Vec3& axis_F, const Mat3& c_F0B, const Vec3& centre) {
    // A passive rotation (direction cosines) of the facet frame about its own axis.
    const Mat3 c_FF0 = Eigen::AngleAxisd(theta, axis_F).toRotationMatrix().transpose();
    all.push_back({(c_FF0 * c_F0B).transpose() * Vec3::UnitY(), centre, area});
  };
  const Vec3 right(4.5, 0, 0.75), left(-4.5, 0, 0.75), x = Vec3::UnitX();
  array(theta1, x, identity, right);
  array(theta1, -x, half_turn, right);
  array(theta2, -x, identity, left);
  array(theta2, x, half_turn, left);
  return all;
}

// Parallel light of a given pressure through a parallelogram across the axis.
class Parallelogram final : public Emitter {
 public:
  Parallelogram(double pressure_Pa, const Vec3& u, const Vec3& v)
      : u_(u.x(), u.y(), 0),
        v_(v.x(), v.y(), 0),
        power_W_(pressure_Pa * speed_of_light_m_s * u_.cross(v_).norm()) {}
  double power_W() const override { return power_W_; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    for (int i = 0; i < ray_block; ++i) {
      const Vec3 at = (sobol_fraction(samples.bits[0][i]) - 0.5) * u_ +
                      (sobol_fraction(samples.bits[1][i]) - 0.5) * v_;
      fixtures::set_ray(rays, i, at, Vec3::UnitZ());
    }
  }
  double relative_intensity(double angle_rad) const override {
    return angle_rad == 0.0 ? 1.0 : 0.0;
  }

 private:
  Vec3 u_, v_;
  double power_W_;
};

TEST(FacetedSpacecraft, ForceAndTorqueOfFourArticulations) {
  const double pressure = 1.825262728924288e-05;
  const Vec3 light = Vec3(0.36, -0.8, -0.48).normalized();  // away from the Sun at the origin
  for (const FacetCase& c : facet_cases) {
    std::array<double, 6> total{}, variance{};
    for (const Facet& facet : facets(c.theta1_deg * degree_rad, c.theta2_deg * degree_rad)) {
      if (facet.normal.dot(light) >= -1e-12) continue;  // lit on the front only
      const Vec3 u = facet.normal.unitOrthogonal() * std::sqrt(facet.area_m2);
      const TraceableScene traceable(
          fixtures::scene_of_part(fixtures::rectangle(facet.centre_m, u, facet.normal.cross(u)),
                                  grey_surface("facet", 0.9, 0.1), "facet"));
      // Light that falls on a parallelogram 1.25 times the facet, edges parallel to the facet's.
      const RigidTransform lab_from_beam = frame_looking_along(light, facet.centre_m - 20 * light);
      const Quat beam_from_lab = lab_from_beam.rotation.conjugate();
      const auto emitter = std::make_shared<Parallelogram>(
          pressure, 1.25 * (beam_from_lab * u), 1.25 * (beam_from_lab * facet.normal.cross(u)));
      const Beam beam{"light", emitter, lab_from_beam, Spectrum{}};
      const fixtures::TotalWrench wrench;
      const Receiver* const receivers[] = {&wrench};
      const TraceResult result =
          trace(traceable, {}, std::span(&beam, 1), receivers, {.rays = 1 << 20, .max_depth = 1});
      for (size_t k = 0; k < 6; ++k) {
        const Estimate e = result.sums[0].estimate(k);
        total[k] += e.value;
        variance[k] += e.standard_error * e.standard_error;
      }
    }
    const double force_scale = c.force_N.norm(), torque_scale = pressure * 45 * 4.5;
    for (int k = 0; k < 3; ++k) {
      const auto f = static_cast<size_t>(k), t = static_cast<size_t>(3 + k);
      EXPECT_LE(std::abs(total[f] - c.force_N[k]),
                std::min(3 * std::sqrt(variance[f]) + 1e-6 * force_scale, 1e-4 * force_scale));
      EXPECT_LE(std::abs(total[t] - c.torque_N_m[k]),
                std::min(3 * std::sqrt(variance[t]) + 1e-6 * torque_scale, 1e-4 * torque_scale));
    }
  }
}

}  // namespace
}  // namespace photorque
