// Power supplies of a platform: coils, microwaves, eddy currents and cables, compared with closed
// forms, Neumann's integral to 30 digits and published values.
#include <cmath>

#include "attitude/studies/cable.h"
#include "attitude/studies/coil_link.h"
#include "attitude/studies/microwave.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/quadrature.h"
#include "core/text/parse.h"
#include "tests/outside.h"

namespace photorque {
namespace {

// NIST Digital Library of Mathematical Functions, 19.6 and 19.7: values at k² = 1/2, and Legendre's
// relation E K' + E' K − K K' = π/2 at others.
TEST(Elliptic, HasItsKnownValues) {
  const EllipticIntegrals half = complete_elliptic(0.5, 0.5);
  EXPECT_NEAR(half.first, 1.8540746773013719, 4e-16);
  EXPECT_NEAR(half.second, 1.3506438810476755, 4e-16);
  for (const double m : {1e-12, 1e-6, 0.01, 0.3, 0.7, 0.99, 1.0 - 1e-9}) {
    const EllipticIntegrals a = complete_elliptic(m, 1.0 - m), b = complete_elliptic(1.0 - m, m);
    EXPECT_NEAR(a.second * b.first + b.second * a.first - a.first * b.first, 0.5 * pi, 1e-13) << m;
  }
  // Series of both combinations, to the second term.
  for (const double m : {1e-9, 1e-5, 1e-3}) {
    const EllipticIntegrals small = complete_elliptic(m, 1.0 - m);
    EXPECT_NEAR(small.potential / (pi * m * m / 32.0), 1.0 + 0.75 * m, 2.0 * m * m + 1e-15);
    EXPECT_NEAR(small.radial / (3.0 * pi * m * m / 32.0), 1.0 + 1.25 * m, 3.0 * m * m + 1e-15);
  }
}

TEST(Filaments, MutualInductanceIsNeumannsIntegral) {
  const NumberColumns cases =
      read_number_columns(outside::reference_data("coils") / "mutual.csv",
                          {"radius_1_m", "radius_2_m", "centre_x_m", "centre_y_m", "centre_z_m",
                           "normal_x", "normal_y", "normal_z", "mutual_H"});
  const auto& c = cases.columns;
  ASSERT_GE(c[0].size(), 9u);
  for (size_t i = 0; i < c[0].size(); ++i) {
    const CircularFilament first{Vec3::Zero(), Vec3::UnitZ(), c[0][i]};
    const CircularFilament second{
        {c[2][i], c[3][i], c[4][i]}, Vec3(c[5][i], c[6][i], c[7][i]).normalized(), c[1][i]};
    EXPECT_NEAR(mutual_inductance_H(first, second) / c[8][i], 1.0, 1e-11) << i;
    EXPECT_NEAR(mutual_inductance_H(second, first) / c[8][i], 1.0, 1e-11) << i;
  }
}

// Values as printed, with μ₀ = 4π 10⁻⁷: F. W. Grover, Inductance Calculations (1946), in the
// examples of S. Babic and others, IEEE Trans. Magn. 46 (2010) 3591, quoted at second hand
// (docs/supply.md): coaxial circles of 20 and 25 cm at 10 cm, 248.787 nH; circles of 16 and 10 cm
// inclined by 60 deg, 13.611 nH.
TEST(Filaments, MutualInductanceIsAsPublished) {
  const double units = 4e-7 * pi / vacuum_permeability_N_A2;
  const CircularFilament big{Vec3::Zero(), Vec3::UnitZ(), 0.2};
  EXPECT_NEAR(units * mutual_inductance_H(big, {{0, 0, 0.1}, Vec3::UnitZ(), 0.25}), 248.787e-9,
              0.5e-12);
  const CircularFilament lower{Vec3::Zero(), Vec3::UnitZ(), 0.16};
  const CircularFilament inclined{{0.0, 0.0433012702, 0.175}, Vec3(0, -std::sqrt(0.75), 0.5), 0.10};
  EXPECT_NEAR(units * mutual_inductance_H(lower, inclined), 13.611e-9, 0.5e-12);
}

TEST(Filaments, CoaxialCirclesHaveMaxwellsClosedForm) {
  for (const double distance_m : {0.003, 0.02, 0.1, 1.0, 30.0}) {
    for (const double radius_m : {0.02, 0.1, 0.25}) {
      const CircularFilament a{{0.1, 0.2, 0.3}, Vec3(1, 2, 2) / 3.0, 0.1};
      const CircularFilament b{a.centre_m + distance_m * a.normal, a.normal, radius_m};
      const double exact_H = coaxial_inductance_H(0.1, radius_m, distance_m);
      EXPECT_NEAR(mutual_inductance_H(a, b) / exact_H, 1.0, 1e-11) << distance_m << " " << radius_m;
    }
  }
  // Far away two dipoles: μ₀ π a² b²/(2 d³).
  const double far_H = vacuum_permeability_N_A2 * pi * 1e-2 * 1e-2 / (2.0 * 1e9);
  EXPECT_NEAR(coaxial_inductance_H(0.1, 0.1, 1e3) / far_H, 1.0, 1e-7);
  EXPECT_THROW(mutual_inductance_H({Vec3::Zero(), Vec3::UnitZ(), 0.1},
                                   {Vec3(0.1, 0, 0), Vec3::UnitX(), 1e-12}),
               NumericalError);
}

// Field of a closed polygon per ampere: the sum over the sides of μ₀/4π (a × b)(|a| + |b|) /
// (|a||b|(|a||b| + a·b)), where a and b are the vectors from the point to the ends of a side. This
// is Biot and Savart's law integrated along straight wires.
Vec3 polygon_field_T_A(const std::vector<Vec3>& corners_m, const Vec3& at_m) {
  Vec3 sum = Vec3::Zero();
  for (size_t i = 0; i < corners_m.size(); ++i) {
    const Vec3 a = corners_m[i] - at_m, b = corners_m[(i + 1) % corners_m.size()] - at_m;
    const double product = a.norm() * b.norm();
    sum += (a.norm() + b.norm()) / (product * (product + a.dot(b))) * a.cross(b);
  }
  return vacuum_permeability_N_A2 / (4.0 * pi) * sum;
}

// On the axis the field is μ₀ R²/(2 (R² + z²)^{3/2}). Elsewhere it is that of a polygon with many
// sides, whose error decreases with the square of their number, and the curl of the potential.
TEST(Filaments, FieldIsThatOfTheWire) {
  const CircularFilament loop{{0.01, 0.02, 0.03}, Vec3(2, -1, 2) / 3.0, 0.1};
  for (const double z_m : {0.0, 0.05, -0.3}) {
    const double exact_T =
        vacuum_permeability_N_A2 * 1e-2 / (2.0 * std::pow(1e-2 + z_m * z_m, 1.5));
    const Vec3 field_T = filament_field_T_A(loop, loop.centre_m + z_m * loop.normal);
    EXPECT_NEAR((field_T - exact_T * loop.normal).norm() / exact_T, 0.0, 1e-14);
  }
  const Vec3 u = loop.normal.unitOrthogonal(), v = loop.normal.cross(u);
  const auto polygon = [&](int sides, const Vec3& at_m) {
    std::vector<Vec3> corners;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * pi * i / sides;
      corners.push_back(loop.centre_m + 0.1 * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return polygon_field_T_A(corners, at_m);
  };
  for (const Vec3& at_m : {Vec3(0.1, 0.0, 0.1), Vec3(0.01, 0.02, 0.08), Vec3(-0.3, 0.2, 0.0),
                           Vec3(0.0101, 0.02, 0.03)}) {
    const Vec3 coarse = polygon(400, at_m), fine = polygon(800, at_m);
    const Vec3 limit = fine + (fine - coarse) / 3.0;
    const Vec3 field_T = filament_field_T_A(loop, at_m);
    EXPECT_LT((field_T - limit).norm(), 1e-8 * field_T.norm());
    constexpr double h = 1e-4;
    Mat3 slope;
    for (int k = 0; k < 3; ++k) {
      const Vec3 step = h * Vec3::Unit(k);
      slope.col(k) = (filament_potential_T_m_A(loop, at_m + step) -
                      filament_potential_T_m_A(loop, at_m - step)) /
                     (2.0 * h);
    }
    const Vec3 curl(slope(2, 1) - slope(1, 2), slope(0, 2) - slope(2, 0),
                    slope(1, 0) - slope(0, 1));
    EXPECT_LT((curl - field_T).norm(), 2e-5 * field_T.norm());
  }
}

// Force and torque are the derivatives of the mutual inductance by position and rotation. Action
// equals reaction.
TEST(Filaments, ForceAndTorqueAreDerivativesOfTheInductance) {
  const CircularFilament source{Vec3::Zero(), Vec3::UnitZ(), 0.1};
  const CircularFilament target{{0.02, -0.03, 0.06}, Vec3(0.3, 0.1, 0.9).normalized(), 0.07};
  const Vec3 about_m(0.01, 0.05, -0.02);
  const FilamentForce found = filament_force(source, target, about_m);
  constexpr double h = 1e-4;
  for (int k = 0; k < 3; ++k) {
    const auto moved = [&](double by) {
      CircularFilament other = target;
      other.centre_m += by * Vec3::Unit(k);
      return mutual_inductance_H(source, other);
    };
    const auto turned = [&](double by) {
      CircularFilament other = target;
      const Eigen::AngleAxisd turn(by, Vec3::Unit(k));
      other.centre_m = about_m + turn * (target.centre_m - about_m);
      other.normal = turn * target.normal;
      return mutual_inductance_H(source, other);
    };
    // Five-point differences.
    const auto slope = [&](const auto& f) {
      return (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12.0 * h);
    };
    EXPECT_NEAR(found.force_N_A2[k], slope(moved), 1e-8 * found.force_N_A2.norm()) << k;
    EXPECT_NEAR(found.torque_N_m_A2[k], slope(turned), 1e-8 * found.torque_N_m_A2.norm()) << k;
  }
  const FilamentForce back = filament_force(target, source, about_m);
  EXPECT_LT((found.force_N_A2 + back.force_N_A2).norm(), 1e-12 * found.force_N_A2.norm());
  EXPECT_LT((found.torque_N_m_A2 + back.torque_N_m_A2).norm(), 1e-12 * found.torque_N_m_A2.norm());
}

// H. A. Wheeler's formula for flat spirals (Proc. IRE 16 (1928) 1398), L[µH] = a² n²/(8 a + 11 c)
// in inches, good to a few per cent; c is the depth of the winding, a pitch for every turn.
TEST(CoilLink, SelfInductanceIsWheelers) {
  const SpiralCoil coil{0.06, 0.10, 12, 3e-6, 1.5};
  const double inch_m = 0.0254, a = 0.08 / inch_m, c = 0.04 / 11 * 12 / inch_m;
  EXPECT_NEAR(self_inductance_H(coil) / (1e-6 * a * a * 144 / (8 * a + 11 * c)), 1.0, 0.05);
  // Copper of 100 m and 1 mm²: 1.7241 Ω by definition of the standard.
  const SpiralCoil wire{50.0 / pi, 50.0 / pi + 1e-9, 1, 1e-6, 1.0};
  EXPECT_NEAR(resistance_ohm(wire), 1.7241, 1e-6);
}

TEST(CoilLink, EfficiencyIsKirchhoffsAndTheBestLoadIsBest) {
  CoilCircuit circuit;
  circuit.angular_frequency_rad_s = 2.0 * pi * 1e5;
  circuit.mutual_H = 3e-6;
  circuit.resistance_1_ohm = 0.1;
  circuit.resistance_2_ohm = 0.2;
  const double load_ohm = best_load_ohm(circuit), best = best_link_efficiency(circuit);
  const CoilCurrents currents = currents_for(circuit, load_ohm, 25.0);
  EXPECT_NEAR(currents.efficiency, best, 1e-13);
  EXPECT_NEAR(0.5 * currents.second_A * currents.second_A * load_ohm, 25.0, 1e-12);
  for (const double factor : {0.9, 1.1, 0.5, 2.0}) {
    EXPECT_LT(currents_for(circuit, factor * load_ohm, 25.0).efficiency, best);
  }
  // At resonance the phase between the currents is a quarter of a period.
  EXPECT_NEAR(currents.mean_product_A2, 0.0, 1e-12 * currents.first_A * currents.second_A);
  // Otherwise the cosine of the phase is X/|R₂ + R_L + jX|.
  circuit.reactance_2_ohm = 0.7;
  const CoilCurrents off = currents_for(circuit, load_ohm, 25.0);
  const double cosine = 0.7 / std::hypot(circuit.resistance_2_ohm + load_ohm, 0.7);
  EXPECT_NEAR(std::abs(off.mean_product_A2), 0.5 * off.first_A * off.second_A * cosine, 1e-10);
}

// Two limits. If the field penetrates the sphere, the loss is π σ ω² B² a⁵/15. If the current flows
// only in the skin, it is ½ Rₛ ∮ H_t² with H_t = 3/2 H sin θ, that is 3π a² (B/μ₀)²/(σ δ).
TEST(EddySphere, LosesLightAtItsLimits) {
  constexpr double a_m = 0.03, S_m = 2.5e7, field_T = 1e-3;
  const double slow = 2.0 * pi * 0.1;
  EXPECT_NEAR(sphere_eddy_loss_W(a_m, S_m, slow, field_T) /
                  (pi * S_m * slow * slow * field_T * field_T * std::pow(a_m, 5) / 15.0),
              1.0, 1e-3);
  const double fast = 2.0 * pi * 1e7;
  const double skin_m = std::sqrt(2.0 / (vacuum_permeability_N_A2 * S_m * fast));
  const double field_A_m = field_T / vacuum_permeability_N_A2;
  EXPECT_NEAR(sphere_eddy_loss_W(a_m, S_m, fast, field_T) /
                  (3.0 * pi * a_m * a_m * field_A_m * field_A_m / (S_m * skin_m)),
              1.0, 3.0 * skin_m / a_m);
  EXPECT_NEAR(sphere_polarisability(a_m, S_m, fast).real(), -1.5, 0.01);
  // The series for small spheres agrees with the closed form at its limit of use.
  const double at = 1e-4 / (vacuum_permeability_N_A2 * S_m * a_m * a_m);
  EXPECT_NEAR(sphere_polarisability(a_m, S_m, 0.4999 * at).imag() /
                  sphere_polarisability(a_m, S_m, 0.5001 * at).imag(),
              0.4999 / 0.5001, 1e-6);
}

TEST(Microwave, TransmissionIsFriissFarAwayAndWholeNearby) {
  MicrowaveBeam beam;
  beam.frequency_Hz = 5.8e9;
  beam.transmitter_area_m2 = 0.1257;
  beam.rectenna_area_m2 = 0.1037;
  beam.distance_m = 1000.0;
  // G_t G_r (λ/4πd)² with G = 4π A/λ².
  const double wavelength_m = 299792458.0 / 5.8e9;
  const double gain_t = 4.0 * pi * 0.1257 / (wavelength_m * wavelength_m);
  const double gain_r = 4.0 * pi * 0.1037 / (wavelength_m * wavelength_m);
  const double friis = gain_t * gain_r * std::pow(wavelength_m / (4.0 * pi * 1000.0), 2);
  EXPECT_NEAR(aperture_transmission(beam, 0.0) / friis, 1.0, 1e-5);
  // W. C. Brown's curve: 95 % at τ = 1.73, nearly all at 2.4.
  beam.distance_m =
      std::sqrt(beam.transmitter_area_m2 * beam.rectenna_area_m2) / wavelength_m / 1.73;
  EXPECT_NEAR(aperture_transmission(beam, 0.0), 0.95, 0.001);
  EXPECT_NEAR(aperture_transmission(beam, pi / 3), -std::expm1(-0.5 * 1.73 * 1.73), 1e-12);
}

// The gain is 1 along the normal and 0 along the dipole at grazing angles. Half of the power
// (Balanis's curves) is near 45 deg along the dipole and 60 deg across it.
TEST(Microwave, PatternsAreThoseOfADipoleOverAReflector) {
  EXPECT_NEAR(dipole_pattern_e(0.0), 1.0, 1e-15);
  EXPECT_NEAR(dipole_pattern_h(0.0), 1.0, 1e-15);
  EXPECT_NEAR(dipole_pattern_h(pi / 3), 0.5, 1e-12);  // sin²(π/4)
  EXPECT_NEAR(dipole_pattern_e(0.5 * pi), 0.0, 1e-12);
  const double own = std::cos(0.25 * pi) / std::cos(pi / 6);
  EXPECT_NEAR(dipole_pattern_e(pi / 6), own * own * dipole_pattern_h(pi / 6), 1e-12);
  EXPECT_EQ(element_capture(dipole_pattern_h(pi / 6), pi / 6), 1.0);
  EXPECT_LT(element_capture(dipole_pattern_e(pi / 6), pi / 6), 0.75);
}

// Absorbed power gives the force P/c along the beam, with the arm h sin θ. Reflected power gives a
// normal force, which has no arm.
TEST(Microwave, PressesAsLightDoes) {
  const BeamPressure taken = beam_pressure(30.0, 0.0, 0.5, 0.02);
  EXPECT_NEAR(taken.force_N, 30.0 / 299792458.0, 1e-20);
  EXPECT_NEAR(taken.torque_N_m, 0.02 * std::sin(0.5) * 30.0 / 299792458.0, 1e-22);
  EXPECT_EQ(beam_pressure(0.0, 30.0, 0.5, 0.02).torque_N_m, 0.0);
}

// One solid strand that fills its wire: bending 4 E π d⁴/64 L, twisting G π d⁴/32 L.
TEST(Cable, IsAsStiffAsBarsOfItsMaterials) {
  PowerCable bar;
  bar.length_m = 0.4;
  bar.wires = 1;
  bar.strands = 1;
  bar.strand_diameter_m = bar.insulation_diameter_m = 1e-3;
  const double second_m4 = pi / 64.0 * 1e-12;
  EXPECT_NEAR(bending_stiffness_N_m_rad(bar), 4.0 * 1.17e11 * second_m4 / 0.4, 1e-9);
  EXPECT_NEAR(twisting_stiffness_N_m_rad(bar), 1.17e11 / 2.68 * 2.0 * second_m4 / 0.4, 1e-9);
  EXPECT_NEAR(cable_mass_kg(bar), 8960.0 * 0.25 * pi * 1e-6 * 0.4, 1e-9);
  bar.wires = 2;
  EXPECT_NEAR(loop_resistance_ohm(bar), 2.0 * 1.7241e-8 * 0.4 / (0.25 * pi * 1e-6), 1e-12);
  // Strands of half the diameter that fill the same section are four times less stiff.
  PowerCable fine = bar;
  fine.strands = 4;
  fine.strand_diameter_m = 0.5e-3;
  EXPECT_NEAR(bending_stiffness_N_m_rad(fine) / bending_stiffness_N_m_rad(bar), 0.25, 1e-9);
}

}  // namespace
}  // namespace photorque
