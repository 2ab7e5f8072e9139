// Power by fields: the microwave beam and the inductive link.
#include <algorithm>
#include <cmath>
#include <optional>

#include "attitude/studies/coil_link.h"
#include "attitude/studies/microwave.h"
#include "core/constants.h"
#include "core/text/parse.h"
#include "core/transform.h"
#include "tools/supply/trade.h"

namespace photorque {
namespace {

namespace coil_key {
constexpr SpiralCoil usual{0.06, 0.10, 12, 3e-6, 1.5};

constexpr NumberKey inner_radius("inner_radius_m", usual.inner_radius_m, Range::positive(),
                                 "inner radius of the spiral");
constexpr NumberKey outer_radius("outer_radius_m", usual.outer_radius_m, Range::positive(),
                                 "outer radius of the spiral, above `inner_radius_m`");
constexpr IntegerKey turns("turns", usual.turns, 1, 200, "number of turns");
constexpr NumberKey copper_area("copper_area_mm2", usual.copper_area_m2, Range::positive(),
                                "copper cross-section of the wire");
constexpr NumberKey ac_factor("ac_factor", usual.ac_factor, {1.0, 1e3},
                              "resistance divided by that of direct current");
}  // namespace coil_key

namespace induction_key {
constexpr NumberKey transmitter_height("transmitter_height_m", -0.085, {},
                                       "height of the coil in the lab, lab axes");
constexpr NumberKey receiver_height("receiver_height_m", -0.02, {},
                                    "height of the coil on the platform, body axes");
constexpr NumberKey frequency("frequency_kHz", 1e5, Range::positive(), "frequency of the current");
constexpr UncertainNumberKey detuning(
    "detuning", {0.0, 0.005}, {},
    "relative detuning of the coil on the platform; the default is ± 0.005");
constexpr UncertainNumberKey inverter_efficiency(
    "inverter_efficiency", {0.93, 0.02}, conversion_range,
    "efficiency of the inverter; the default is ± 0.02");
constexpr UncertainNumberKey rectifier_efficiency(
    "rectifier_efficiency", {0.95, 0.02}, conversion_range,
    "efficiency of the rectifier; the default is ± 0.02");
constexpr NumberKey ball_radius("ball_radius_m", 0.03175, Range::positive(),
                                "radius of the ball of the bearing");
constexpr NumberKey ball_conductivity("ball_conductivity_S_m", 2.5e7, Range::positive(),
                                      "conductivity of the metal of the ball");
constexpr TableKey transmitter("transmitter", "the coil in the lab");
constexpr TableKey receiver("receiver", "the coil on the platform");
constexpr TableKey induction("induction", "inductive link of two coils");
}  // namespace induction_key

namespace microwave_key {
constexpr NumberKey frequency("frequency_GHz", Range::positive(), "frequency of the beam");
constexpr ChoiceKey plane("plane", {"E", "H"}, 0,
                          "plane of the tilt relative to the electric (E) or magnetic (H) field");
constexpr UncertainNumberKey transmitter_diameter("transmitter_diameter_m", {0.4, 0.0},
                                                  Range::positive(),
                                                  "diameter of the transmitting aperture");
constexpr UncertainNumberKey rectenna_side("rectenna_side_m", {0.322, 0.0}, Range::positive(),
                                           "side of the square rectenna on the platform");
constexpr UncertainNumberKey distance("distance_m", {1.0, 0.0}, Range::positive(),
                                      "distance between the apertures");
constexpr UncertainNumberKey height("height_m", {0.0238, 0.0}, {},
                                    "height of the rectenna above the centre of rotation");
constexpr UncertainNumberKey rectifier_efficiency("rectifier_efficiency", {0.82, 0.0},
                                                  conversion_range,
                                                  "efficiency of the rectifying elements");
constexpr UncertainNumberKey transmitter_efficiency(
    "transmitter_efficiency", {0.6, 0.1}, conversion_range,
    "efficiency from mains to beam; the default is ± 0.1");
constexpr UncertainNumberKey mass("mass_kg_m2", {2.0, 0.5}, Range::not_negative(),
                                  "mass of the rectenna per area; the default is ± 0.5");
constexpr TablesKey microwave("microwave", "a microwave beam");
}  // namespace microwave_key

// Fractions of the power at the rectenna: absorbed by its elements, and mirrored of the power that
// misses them.
struct RectennaAbsorption {
  double taken = 0.0, mirrored = 0.0;
};

RectennaAbsorption rectenna_takes(const MicrowaveBeam& beam, bool in_e_plane, double tilt_rad) {
  const double arrives = aperture_transmission(beam, tilt_rad);
  const double pattern = in_e_plane ? dipole_pattern_e(tilt_rad) : dipole_pattern_h(tilt_rad);
  const double taken = arrives * element_capture(pattern, tilt_rad);
  return {taken, arrives - taken};
}

std::string in_GHz(double frequency_Hz) {
  return shortest(std::round(1e-7 * frequency_Hz) / 100.0);
}

}  // namespace

SupplyOption microwave_option(const Settings& s, const SupplyTask& task) {
  UncertainInputs in;
  const double frequency_Hz = s.get(microwave_key::frequency);
  const bool in_e_plane = s.get(microwave_key::plane) == 0;
  const size_t diameter = in.add(s, microwave_key::transmitter_diameter);
  const size_t side = in.add(s, microwave_key::rectenna_side);
  const size_t distance = in.add(s, microwave_key::distance);
  const size_t height = in.add(s, microwave_key::height);
  const size_t rectifier = in.add(s, microwave_key::rectifier_efficiency);
  const size_t source = in.add(s, microwave_key::transmitter_efficiency);
  const size_t areal = in.add(s, microwave_key::mass);
  SupplyOption option = option_from(
      in, task,
      [&](const std::vector<double>& at) {
        MicrowaveBeam beam;
        beam.frequency_Hz = frequency_Hz;
        beam.transmitter_area_m2 = 0.25 * pi * at[diameter] * at[diameter];
        beam.rectenna_area_m2 = at[side] * at[side];
        beam.distance_m = at[distance];
        const double level = rectenna_takes(beam, in_e_plane, 0.0).taken;
        const double beam_W = task.load_W / (level * at[rectifier]);
        PlainOption plain;
        plain.mass_kg = at[areal] * beam.rectenna_area_m2;
        plain.source_W = beam_W / at[source];
        for (const double tilt_rad : task.tilt_rad) {
          const RectennaAbsorption takes = rectenna_takes(beam, in_e_plane, tilt_rad);
          plain.delivered_W.push_back(beam_W * takes.taken * at[rectifier]);
          plain.torque_N_m.push_back(
              beam_pressure(beam_W * takes.taken, beam_W * takes.mirrored, tilt_rad, at[height])
                  .torque_N_m);
        }
        plain.figures = {level, beam_W};
        return plain;
      },
      {"transmission", "beam_W"});
  option.name = "microwave " + in_GHz(frequency_Hz) + " GHz";
  option.symbol = "microwave_" + in_GHz(frequency_Hz) + "_GHz";
  std::ranges::replace(option.symbol, '.', '_');
  option.remarks = {std::string("tilts in the ") + (in_e_plane ? "E" : "H") +
                    " plane of its dipoles"};
  return option;
}

namespace {

SpiralCoil read_coil(const Settings& table, const TableKey& key) {
  SpiralCoil coil = coil_key::usual;
  if (!table.has(key)) return coil;
  const Settings s = table.get(key);
  coil.inner_radius_m = s.get(coil_key::inner_radius);
  coil.outer_radius_m = s.get(coil_key::outer_radius);
  if (coil.outer_radius_m <= coil.inner_radius_m) {
    throw s.error(coil_key::outer_radius, shortest(coil.outer_radius_m),
                  "more than inner_radius_m");
  }
  coil.turns = static_cast<int>(s.get(coil_key::turns));
  coil.copper_area_m2 = s.get(coil_key::copper_area);
  coil.ac_factor = s.get(coil_key::ac_factor);
  return coil;
}

// Coupling of the two coils at a tilt.
struct CoilPose {
  double mutual_H = 0.0;
  double torque_N_m_A2 = 0.0;  // on the platform, about the axis of the tilt
  Vec3 receiver_axis = Vec3::UnitZ();
};

std::vector<CoilPose> coil_poses(const SpiralCoil& transmitter, const SpiralCoil& receiver,
                                 double transmitter_height_m, double receiver_height_m,
                                 const SupplyTask& task) {
  const auto fixed = turns_of(transmitter, {0.0, 0.0, transmitter_height_m}, Vec3::UnitZ());
  std::vector<CoilPose> poses;
  for (const double tilt_rad : task.tilt_rad) {
    const Quat turn = lab_from_body_at(tilt_rad, 0.0).rotation;
    const Vec3 axis = turn * Vec3::UnitZ();
    const auto moving = turns_of(receiver, receiver_height_m * axis, axis);
    poses.push_back({mutual_inductance_H(fixed, moving),
                     coil_force(fixed, moving, Vec3::Zero()).torque_N_m_A2.y(), axis});
  }
  return poses;
}

// Minimum distance, over the tilts, between the turns of the moving coil and the ring of the fixed
// coil; empty if the coil would have to pass through it.
std::optional<double> coil_clearance_m(const SpiralCoil& transmitter, const SpiralCoil& receiver,
                                       double transmitter_height_m, double receiver_height_m,
                                       const SupplyTask& task) {
  constexpr int points = 180;
  const double side = receiver_height_m > transmitter_height_m ? 1.0 : -1.0;
  double least_m = 1e300;
  for (const double tilt_rad : task.tilt_rad) {
    const Quat turn = lab_from_body_at(tilt_rad, 0.0).rotation;
    for (int i = 0; i < points; ++i) {
      const double angle = 2.0 * pi * i / points;
      for (const double radius_m : {receiver.inner_radius_m, receiver.outer_radius_m}) {
        const Vec3 at_m =
            turn * Vec3(radius_m * std::cos(angle), radius_m * std::sin(angle), receiver_height_m);
        const double above_m = side * (at_m.z() - transmitter_height_m);
        const double distance_m = std::hypot(at_m.x(), at_m.y());
        const double beside_m = std::max({0.0, transmitter.inner_radius_m - distance_m,
                                          distance_m - transmitter.outer_radius_m});
        if (beside_m == 0.0 && above_m <= 0.0) return {};
        least_m = std::min(least_m, std::hypot(above_m, beside_m));
      }
    }
  }
  return least_m;
}

double area_turns_m2(const SpiralCoil& coil) {
  double sum_m2 = 0.0;
  for (const CircularFilament& turn : turns_of(coil, Vec3::Zero(), Vec3::UnitZ())) {
    sum_m2 += pi * turn.radius_m * turn.radius_m;
  }
  return sum_m2;
}

double field_on_ball_T_A(const SpiralCoil& coil, double height_m) {
  Vec3 sum_T = Vec3::Zero();
  for (const CircularFilament& turn : turns_of(coil, {0.0, 0.0, height_m}, Vec3::UnitZ())) {
    sum_T += filament_field_T_A(turn, Vec3::Zero());
  }
  return sum_T.norm();
}

}  // namespace

SupplyOption induction_option(const Settings& s, const SupplyTask& task) {
  UncertainInputs in;
  const SpiralCoil transmitter = read_coil(s, induction_key::transmitter);
  const SpiralCoil receiver = read_coil(s, induction_key::receiver);
  const double transmitter_m = s.get(induction_key::transmitter_height);
  const double receiver_m = s.get(induction_key::receiver_height);
  const std::optional<double> clearance_m =
      coil_clearance_m(transmitter, receiver, transmitter_m, receiver_m, task);
  if (!clearance_m) {
    throw s.error(
        induction_key::transmitter_height, shortest(transmitter_m),
        "room for the receiver to tilt by " + shortest(task.tilt_rad.back() / degree_rad) + " deg");
  }
  const double omega = 2.0 * pi * s.get(induction_key::frequency);
  const size_t detuning = in.add(s, induction_key::detuning);
  const size_t inverter = in.add(s, induction_key::inverter_efficiency);
  const size_t rectifier = in.add(s, induction_key::rectifier_efficiency);
  const double ball_m = s.get(induction_key::ball_radius);
  const double ball_S_m = s.get(induction_key::ball_conductivity);
  const std::vector<CoilPose> poses =
      coil_poses(transmitter, receiver, transmitter_m, receiver_m, task);
  CoilCircuit level;
  level.angular_frequency_rad_s = omega;
  level.mutual_H = poses.front().mutual_H;
  level.resistance_1_ohm = resistance_ohm(transmitter);
  level.resistance_2_ohm = resistance_ohm(receiver);
  const double load_ohm = best_load_ohm(level);
  const double self_1_H = self_inductance_H(transmitter), self_2_H = self_inductance_H(receiver);
  const Vec3 earth_T = task.model.environment.magnetic_field_lab_T;
  SupplyOption option = option_from(
      in, task,
      [&](const std::vector<double>& at) {
        PlainOption plain;
        CoilCircuit circuit = level;
        circuit.reactance_2_ohm = 2.0 * at[detuning] * omega * self_2_H;
        const CoilCurrents now = currents_for(circuit, load_ohm, task.load_W / at[rectifier]);
        plain.mass_kg = receiver.copper_mass_kg();
        plain.source_W = task.load_W / (at[rectifier] * now.efficiency * at[inverter]);
        for (const CoilPose& pose : poses) {
          // The current in the first coil is constant; that in the second follows from the mutual
          // inductance.
          const double ratio = pose.mutual_H / level.mutual_H;
          plain.delivered_W.push_back(task.load_W * ratio * ratio);
          plain.torque_N_m.push_back(ratio * now.mean_product_A2 * pose.torque_N_m_A2);
          const double second_A = std::abs(ratio) * now.second_A;
          plain.alternating_N_m.push_back(
              0.5 * now.first_A * second_A * std::abs(pose.torque_N_m_A2) +
              second_A * area_turns_m2(receiver) * pose.receiver_axis.cross(earth_T).norm());
        }
        const double on_ball_T = now.first_A * field_on_ball_T_A(transmitter, transmitter_m);
        plain.figures = {now.efficiency,
                         poses.front().mutual_H / std::sqrt(self_1_H * self_2_H),
                         omega * self_1_H / level.resistance_1_ohm,
                         omega * self_2_H / level.resistance_2_ohm,
                         now.first_A,
                         now.second_A,
                         sphere_eddy_loss_W(ball_m, ball_S_m, omega, on_ball_T),
                         best_link_efficiency({omega, poses.back().mutual_H, level.resistance_1_ohm,
                                               level.resistance_2_ohm}),
                         *clearance_m};
        return plain;
      },
      {"link_efficiency", "coupling", "quality_transmitter", "quality_receiver", "transmitter_A",
       "receiver_A", "ball_eddy_loss_W", "best_link_efficiency_tilted", "clearance_m"});
  option.name = option.symbol = "induction";
  option.remarks = {"the mean torque is zero at resonance; its error is due to the detuning"};
  return option;
}

Key microwave_table() {
  using namespace microwave_key;
  return microwave.of({frequency, plane, transmitter_diameter, rectenna_side, distance, height,
                       rectifier_efficiency, transmitter_efficiency, mass});
}

Key induction_table() {
  using namespace induction_key;
  using namespace coil_key;
  const std::vector<Key> coil_keys = {inner_radius, outer_radius, turns, copper_area, ac_factor};
  return induction.of({transmitter.of(coil_keys), receiver.of(coil_keys), transmitter_height,
                       receiver_height, frequency, detuning, inverter_efficiency,
                       rectifier_efficiency, ball_radius, ball_conductivity});
}

}  // namespace photorque
