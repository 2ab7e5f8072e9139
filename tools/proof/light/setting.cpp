// Lamps, plates, arrays and recordings as in a laboratory, drawn at random.
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "tools/proof/light/case.h"
#include "tools/proof/light/words.h"

namespace photorque::injected {
namespace {

// As the experiment file states it.
double rounded(double value, double to) {
  return std::round(value / to) * to;
}

bool any_of(const std::vector<std::string>& kinds, const std::vector<std::string>& of) {
  return std::ranges::any_of(
      kinds, [&](const auto& kind) { return std::ranges::find(of, kind) != of.end(); });
}

std::string beam_text(const InjectedLamp& lamp) {
  std::string text =
      printed("power_W = %.6g\naperture_diameter_m = %.6g\n", lamp.power_W, 2.0 * lamp.radius_m);
  const double fwhm_deg = lamp.fwhm_rad / degree_rad;
  switch (lamp.profile) {
    case InjectedLamp::Profile::gaussian:
      return text + printed("profile = \"gaussian\"\nfwhm_deg = %.6g\n", fwhm_deg);
    case InjectedLamp::Profile::super_gaussian:
      return text + printed("profile = \"super_gaussian\"\nfwhm_deg = %.6g\norder = %.6g\n",
                            fwhm_deg, lamp.order);
    case InjectedLamp::Profile::cosine_power:
      return text + printed("profile = \"cosine_power\"\nexponent = %.6g\n", lamp.exponent);
  }
  return text;
}

constexpr const char* spectrum = "wavelength_nm = 730\nspectral_fwhm_nm = 20\n";

struct Panel {
  std::string layout;        // its lines of the experiment
  std::vector<Triple> at_m;  // about its centre
};

Panel draw_panel(RandomDraw& draw) {
  Panel panel;
  const int layout = draw.below(4);
  if (layout == 0) {
    const int columns = 2 + draw.below(4), rows = 2 + draw.below(3);
    const double px = rounded(draw.uniform(0.045, 0.11), 1e-4),
                 py = rounded(draw.uniform(0.045, 0.08), 1e-4);
    panel.layout = printed("layout = \"grid\"\ncount = [%d, %d]\npitch_m = [%.4f, %.4f]\n", columns,
                           rows, px, py);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        panel.at_m.push_back(
            {(column - 0.5 * (columns - 1)) * px, (row - 0.5 * (rows - 1)) * py, 0.0});
      }
    }
  } else if (layout == 1) {
    const int count = 5 + draw.below(6);
    const double radius = rounded(draw.uniform(0.045, 0.09), 1e-4);
    panel.layout = printed("layout = \"ring\"\ncount = %d\nring_radius_m = %.4f\n", count, radius);
    for (int k = 0; k < count; ++k) {
      const double angle = 2.0 * pi * k / count;
      panel.at_m.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.0});
    }
  } else if (layout == 2) {
    const double pitch = rounded(draw.uniform(0.06, 0.09), 1e-4);
    panel.layout = printed("layout = \"hexagonal\"\ncount = 7\npitch_m = %.4f\n", pitch);
    panel.at_m.push_back({0, 0, 0});
    for (int k = 0; k < 6; ++k) {
      const double angle = pi / 3.0 * k;
      panel.at_m.push_back({pitch * std::cos(angle), pitch * std::sin(angle), 0.0});
    }
  } else {
    const int columns = 2 + draw.below(2), rows = 2 + draw.below(2);
    for (int k = 0; k < columns * rows; ++k) {
      const int column = k % columns, row = k / columns;
      const double x = (column - 0.5 * (columns - 1)) * 0.065 + draw.uniform(-0.01, 0.01),
                   y = (row - 0.5 * (rows - 1)) * 0.06 + draw.uniform(-0.01, 0.01);
      panel.at_m.push_back(
          {rounded(x, 1e-4), rounded(y, 1e-4), rounded(draw.uniform(-0.04, 0.04), 1e-4)});
    }
  }
  return panel;
}

void draw_lamps(RandomDraw& draw, LightCase& c) {
  InjectedLamp lamp;
  lamp.radius_m = rounded(draw.uniform(0.005, 0.014), 5e-4);
  lamp.power_W = rounded(draw.uniform(2.0, 8.0), 0.01);
  const Triple centre = {rounded(draw.uniform(-0.02, 0.02), 1e-4),
                         rounded(draw.uniform(-0.02, 0.02), 1e-4),
                         rounded(draw.uniform(0.8, 1.15), 1e-4)};
  // Single lamps from the sides, or a panel above.
  if (draw.chance(0.15)) {
    const int count = 3 + draw.below(3);
    for (int k = 0; k < count; ++k) {
      InjectedLamp side = lamp;
      const double angle = 2.0 * pi * (k + draw.uniform(-0.2, 0.2)) / count,
                   out = draw.uniform(0.18, 0.32);
      side.position_m = {rounded(out * std::cos(angle), 1e-4), rounded(out * std::sin(angle), 1e-4),
                         rounded(draw.uniform(0.75, 1.0), 1e-4)};
      const Triple d = {rounded(-side.position_m[0] + draw.uniform(-0.05, 0.05), 1e-4),
                        rounded(-side.position_m[1] + draw.uniform(-0.05, 0.05), 1e-4),
                        rounded(0.04 - side.position_m[2], 1e-4)};
      side.axis = times(1.0 / length(d), d);
      side.power_W = rounded(draw.uniform(25.0, 45.0), 0.01);
      const int profile = draw.below(3);
      side.fwhm_rad = rounded(draw.uniform(18.0, 32.0), 0.1) * degree_rad;
      side.exponent = rounded(draw.uniform(10.0, 30.0), 0.1);
      side.order = 4.0;
      side.profile = profile == 0   ? InjectedLamp::Profile::gaussian
                     : profile == 1 ? InjectedLamp::Profile::super_gaussian
                                    : InjectedLamp::Profile::cosine_power;
      c.sources += printed("[[source]]\nkind = \"led\"\nname = \"lamp_%d\"\nposition_m = ", k) +
                   printed_list("%.6g", side.position_m) +
                   "\ndirection = " + printed_list("%.6g", d) + "\n" + beam_text(side) + spectrum +
                   "\n";
      c.believed.light.lamps.push_back(side);
    }
    return;
  }
  lamp.fwhm_rad = rounded(draw.uniform(4.5, 9.0), 0.01) * degree_rad;
  if (draw.chance(0.2)) lamp.profile = InjectedLamp::Profile::super_gaussian, lamp.order = 4.0;
  const Panel panel = draw_panel(draw);
  c.sources = "[[source]]\nkind = \"led_array\"\nname = \"lamps\"\n";
  const bool positions = panel.layout.empty();
  const bool converging = !positions && draw.chance(0.2);
  const Triple aim = {0.0, 0.0, rounded(-draw.uniform(0.3, 1.2), 1e-4)};  // lab
  std::string at_m;
  for (const Triple& place : panel.at_m) {
    lamp.position_m = plus(centre, place);
    if (positions) at_m += (at_m.empty() ? "" : ", ") + printed_list("%.6g", lamp.position_m);
    lamp.axis = {0, 0, -1};
    if (converging) {
      const Triple to = minus(aim, lamp.position_m);
      lamp.axis = times(1.0 / length(to), to);
    }
    c.believed.light.lamps.push_back(lamp);
  }
  c.sources += positions ? "layout = \"positions\"\npositions_m = [" + at_m + "]\n"
                         : panel.layout + "position_m = " + printed_list("%.6g", centre) + "\n";
  c.sources += beam_text(lamp) + spectrum + "direction = [0, 0, -1]\n";
  if (converging) {
    c.sources += "aim = \"converging\"\naim_m = " + printed_list("%.6g", aim) + "\n";
  }
  c.sources += "\n";
}

void draw_plate(RandomDraw& draw, LightCase& c, const std::vector<std::string>& kinds) {
  InjectedCircuit& a = c.believed.circuit;
  a.columns = 3 + draw.below(4);
  a.rows = 2 + draw.below(3);
  a.along_columns = draw.chance(0.7);
  const bool several = any_of(kinds, {"string_open"}) || draw.chance(0.15);
  if (several) {
    a.strings = a.columns % 2 == 0 ? 2 : a.rows % 2 == 0 ? 2 : a.columns % 3 == 0 ? 3 : 1;
    if (a.strings == 1) a.rows = 2, a.strings = 2;
  }
  const int of_string = a.columns * a.rows / a.strings;
  const int line = a.along_columns ? a.rows : a.columns;
  const bool diodes = any_of(kinds, {"bypass_shorted", "tracker_trapped"}) || draw.chance(0.8);
  a.bypass_every = diodes && line < of_string ? line
                   : diodes                   ? std::max(1, of_string / 2)
                                              : of_string;
  a.blocking = a.strings > 1 && draw.chance(0.5);
  const double side = rounded(draw.uniform(0.04, 0.058), 1e-3);
  InjectedPlate& p = c.believed.light.plate;
  p.u_low_m = rounded(-0.5 * side * a.columns + draw.uniform(-0.015, 0.015), 1e-4);
  p.v_low_m = rounded(-0.5 * side * a.rows + draw.uniform(-0.015, 0.015), 1e-4);
  p.u_high_m = p.u_low_m + side * a.columns;
  p.v_high_m = p.v_low_m + side * a.rows;
  p.z_m = rounded(draw.uniform(0.02, 0.05), 1e-4);
  a.drop_V = rounded(draw.uniform(0.35, 0.6), 0.01);
  a.efficiency = rounded(draw.uniform(0.84, 0.95), 1e-3);
  a.cell_area_m2 = side * side;
  // As stated for 25 cm²; a larger cell is several of these beside one another.
  const double size = a.cell_area_m2 / 0.0025;
  a.cell.saturation_A = size * rounded(draw.uniform(0.8, 1.8), 0.01) * 1e-11;
  a.cell.ideality = rounded(draw.uniform(1.0, 1.15), 1e-3);
  a.cell.series_ohm = rounded(draw.uniform(0.005, 0.015), 1e-4) / size;
  a.cell.shunt_ohm = rounded(draw.uniform(60.0, 300.0), 0.1) / size;
  a.cell_current.assign(a.cells(), 1.0);
  a.cell_light.assign(a.cells(), 1.0);
  a.string_open.assign(static_cast<size_t>(a.strings), false);
  a.bypass_shorted.assign(a.bypasses(), false);
  if (!any_of(kinds, {"interreflection"}) && !draw.chance(0.1)) return;
  InjectedWall wall;
  wall.axis = draw.chance(0.5) ? 0 : 1;
  wall.facing = draw.sign();
  const double gap = rounded(draw.uniform(0.006, 0.03), 1e-4);
  const std::array<double, 2> low = {p.u_low_m, p.v_low_m}, high = {p.u_high_m, p.v_high_m};
  wall.at_m = wall.facing > 0.0 ? low[wall.axis] - gap : high[wall.axis] + gap;
  wall.from_m = low[1 - wall.axis] - 0.02;
  wall.to_m = high[1 - wall.axis] + 0.02;
  wall.bottom_m = p.z_m - 0.005;
  wall.top_m = wall.bottom_m + rounded(draw.uniform(0.15, 0.25), 1e-3);
  c.believed.light.walls.push_back(wall);
}

Quaternion attitude_at(double tilt_deg, double heading_deg) {
  const double h = heading_deg * degree_rad;
  return quaternion_of(times(tilt_deg * degree_rad, Triple{-std::sin(h), std::cos(h), 0.0}));
}

using Attitudes = std::vector<std::array<double, 2>>;  // tilt and heading, degrees

LightRows scan_rows(const LightWorld& world, const Attitudes& attitudes, int side, bool first) {
  LightRows rows;
  rows.kind = LightRows::Kind::scan;
  rows.first = first;
  const InjectedPlate& p = world.light.plate;
  const double edge = 0.005;
  for (const auto& [tilt, heading] : attitudes) {
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const double u = p.u_low_m + edge + (p.u_high_m - p.u_low_m - 2 * edge) * i / (side - 1),
                     v = p.v_low_m + edge + (p.v_high_m - p.v_low_m - 2 * edge) * j / (side - 1);
        rows.u_m.push_back(rounded(u, 1e-5));
        rows.v_m.push_back(rounded(v, 1e-5));
        rows.attitude.push_back(attitude_at(tilt, heading));
        rows.tilt_deg.push_back(tilt);
        rows.heading_deg.push_back(heading);
        rows.temperature_K.push_back(298.15);
      }
    }
  }
  return rows;
}

struct SweepAt {
  double tilt_deg, heading_deg, temperature_K;
};

LightRows sweep_rows(const LightWorld& world, const std::vector<SweepAt>& sweeps, int points,
                     bool first) {
  LightRows rows;
  rows.kind = LightRows::Kind::sweep;
  rows.first = first;
  for (size_t s = 0; s < sweeps.size(); ++s) {
    const auto& at = sweeps[s];
    const Quaternion q = attitude_at(at.tilt_deg, at.heading_deg);
    const LitCircuit circuit(world.circuit, light_on_cells(world, q), at.temperature_K);
    const double open_V = circuit.open_voltage_V();
    for (int i = 0; i < points; ++i) {
      rows.attitude.push_back(q);
      rows.tilt_deg.push_back(at.tilt_deg);
      rows.heading_deg.push_back(at.heading_deg);
      rows.temperature_K.push_back(at.temperature_K);
      rows.voltage_V.push_back(1.003 * open_V * i / (points - 1));
      rows.sweep.push_back(static_cast<int>(s));
    }
  }
  return rows;
}

LightRows run_rows(RandomDraw& draw, double duration_s, bool first) {
  LightRows rows;
  rows.kind = LightRows::Kind::run;
  rows.first = first;
  const double wide = draw.uniform(0.04, 0.14), yaw = draw.uniform(0.1, 0.6),
               base_K = draw.uniform(293.0, 303.0), warm_K = draw.uniform(0.0, 8.0);
  std::array<double, 6> w, phase;
  for (size_t k = 0; k < 6; ++k) {
    w[k] = 2.0 * pi / draw.uniform(30.0, 140.0);
    phase[k] = draw.uniform(0.0, 2.0 * pi);
  }
  for (double t = 0.0; t < duration_s; t += 1.0) {
    const double x = wide * (std::sin(w[0] * t + phase[0]) + 0.5 * std::sin(w[1] * t + phase[1])),
                 y = wide * (std::sin(w[2] * t + phase[2]) + 0.5 * std::sin(w[3] * t + phase[3])),
                 z = yaw * std::sin(0.5 * w[4] * t + phase[4]);
    Quaternion q = product(quaternion_of({x, y, 0.0}), quaternion_of({0.0, 0.0, z}));
    for (double& part : q) part = rounded(part, 1e-7);
    rows.attitude.push_back(normalised(q));
    rows.time_s.push_back(t);
    rows.temperature_K.push_back(
        rounded(base_K + warm_K * (1.0 - std::exp(-t / 200.0)) + std::sin(w[5] * t), 0.01));
  }
  return rows;
}

}  // namespace

void draw_light_setting(RandomDraw& draw, LightCase& c, const std::vector<std::string>& kinds) {
  draw_plate(draw, c, kinds);
  draw_lamps(draw, c);
  c.noise = {rounded(draw.log_uniform(1.5, 8.0), 0.1), rounded(draw.log_uniform(0.003, 0.02), 1e-4),
             rounded(draw.log_uniform(0.003, 0.012), 1e-4),
             rounded(draw.log_uniform(0.002, 0.008), 1e-4), 0.0};
  if (draw.chance(0.2)) c.noise.relative = 0.0;
  const std::vector<std::string> circuit = {
      "soiling", "angular_response",  "cell_degraded",          "string_open", "bypass_shorted",
      "shunt",   "series_resistance", "temperature_coefficient"};
  const bool needs_run = any_of(kinds, {"led_droop", "tracker_trapped", "slow_drift", "flicker"});
  const bool needs_circuit = any_of(kinds, circuit);
  const bool needs_scan =
      any_of(kinds, {"detector_gain", "ripple", "vignetting", "hair", "interreflection"});
  const bool no_run = needs_scan ||
                      any_of(kinds, {"unmodelled_shadow", "string_open", "bypass_shorted"}) ||
                      !c.believed.light.walls.empty();
  const bool run = needs_run || (!no_run && draw.chance(0.18));
  const bool scan = !run && (needs_scan || draw.chance(needs_circuit ? 0.4 : 0.85));
  const bool sweep = !run && (needs_circuit || !scan || draw.chance(0.35));
  if (run) {
    const double duration_s = 300.0 + 100.0 * draw.below(5);
    c.recordings.push_back({"run1", run_rows(draw, duration_s, true)});
    c.recordings.push_back({"run2", run_rows(draw, 300.0, false)});
    return;
  }
  Attitudes first = {{0.0, 0.0}};
  if (draw.chance(0.4) || any_of(kinds, {"angular_response", "interreflection"})) {
    first.push_back({rounded(draw.uniform(6.0, 20.0), 1.0), rounded(draw.uniform(0, 360), 1.0)});
  }
  if (draw.chance(0.15)) first.push_back({25.0, rounded(draw.uniform(0, 360), 1.0)});
  const Attitudes second = {{12.0, 60.0}};
  if (scan) {
    const int side = 24 + draw.below(24);
    c.recordings.push_back({"scan1", scan_rows(c.believed, first, side, true)});
    c.recordings.push_back({"scan2", scan_rows(c.believed, second, 31, false)});
  }
  if (sweep) {
    const bool warm = any_of(kinds, {"temperature_coefficient"}) || draw.chance(0.4);
    std::vector<SweepAt> at, held = {{12.0, 60.0, 298.15}};
    for (const auto& [tilt, heading] : first) at.push_back({tilt, heading, 298.15});
    if (warm) {
      at.push_back({0.0, 0.0, rounded(draw.uniform(308.0, 328.0), 0.01)});
      held.push_back({0.0, 0.0, rounded(draw.uniform(303.0, 318.0), 0.01)});
    }
    const int points = 150 + 50 * draw.below(6);
    c.recordings.push_back({"iv1", sweep_rows(c.believed, at, points, true)});
    c.recordings.push_back({"iv2", sweep_rows(c.believed, held, 300, false)});
  }
}

}  // namespace photorque::injected
