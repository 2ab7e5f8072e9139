#include "tools/proof/light/effects.h"

#include <algorithm>

#include "core/constants.h"
#include "core/errors.h"

namespace photorque::injected {
namespace {

using Numbers = std::vector<double>;

void turn(InjectedLamp& lamp, double first_deg, double second_deg) {
  const auto made_normal = [&](Triple e) {
    e = minus(e, times(dot(e, lamp.axis), lamp.axis));
    return times(1.0 / length(e), e);
  };
  const Triple e1 = made_normal({1, 0, 0}), e2 = made_normal({0, 1, 0});
  const Triple d = plus(lamp.axis, plus(times(std::tan(first_deg * degree_rad), e1),
                                        times(std::tan(second_deg * degree_rad), e2)));
  lamp.axis = times(1.0 / length(d), d);
}

void widen(InjectedLight& light, double scale) {
  for (InjectedLamp& lamp : light.lamps) {
    lamp.fwhm_rad *= scale;
    lamp.exponent /= scale * scale;
  }
}

void shift(InjectedLight& light, const Numbers& by) {
  for (InjectedLamp& lamp : light.lamps) {
    lamp.position_m = plus(lamp.position_m, {by[0], by[1], by[2]});
  }
}

void dim_all(InjectedLight& light, double factor) {
  for (InjectedLamp& lamp : light.lamps) lamp.power_W *= factor;
}

// Acts of kinds that rivals fit too, from the numbers in their order.
using Act = std::function<void(LightWorld&, size_t, const Numbers&)>;

const std::map<std::string, Act>& acts() {
  static const std::map<std::string, Act> all = {
      {"led_derated",
       [](LightWorld& w, size_t i, const Numbers& x) { w.light.lamps[i].power_W *= x[0]; }},
      {"led_aim",
       [](LightWorld& w, size_t i, const Numbers& x) { turn(w.light.lamps[i], x[0], x[1]); }},
      {"beam_divergence", [](LightWorld& w, size_t, const Numbers& x) { widen(w.light, x[0]); }},
      {"source_shift", [](LightWorld& w, size_t, const Numbers& x) { shift(w.light, x); }},
      {"source_power", [](LightWorld& w, size_t, const Numbers& x) { dim_all(w.light, x[0]); }},
      {"led_droop", [](LightWorld& w, size_t,
                       const Numbers& x) { w.droop_depth = x[0], w.droop_time_s = x[1]; }},
      {"ambient_light",
       [](LightWorld& w, size_t, const Numbers& x) { w.light.ambient_W_m2 += x[0]; }},
      {"attitude_bias",
       [](LightWorld& w, size_t, const Numbers& x) {
         w.light.bias_rad = {x[0] * degree_rad, x[1] * degree_rad};
       }},
      {"detector_gain", [](LightWorld& w, size_t, const Numbers& x) { w.detector_gain *= x[0]; }},
      {"soiling", [](LightWorld& w, size_t, const Numbers& x) { w.circuit.soiling *= x[0]; }},
      {"angular_response",
       [](LightWorld& w, size_t, const Numbers& x) { w.light.glass_index = x[0]; }},
      {"cell_degraded",
       [](LightWorld& w, size_t i, const Numbers& x) { w.circuit.cell_current[i] *= x[0]; }},
      {"cell_shaded",
       [](LightWorld& w, size_t i, const Numbers& x) { w.circuit.cell_light[i] *= x[0]; }},
      {"series_resistance",
       [](LightWorld& w, size_t, const Numbers& x) { w.circuit.series_ohm += x[0]; }},
      // A rival's number is a conductance, which is 0 where there is none.
      {"shunt", [](LightWorld& w, size_t, const Numbers& x) { w.circuit.shunt_S += x[0]; }},
      {"temperature_coefficient",
       [](LightWorld& w, size_t, const Numbers& x) {
         w.circuit.photocurrent_per_K += x[0], w.circuit.voltage_V_per_K += x[1];
       }},
      {"string_open",
       [](LightWorld& w, size_t i, const Numbers&) { w.circuit.string_open[i] = true; }},
      {"bypass_shorted",
       [](LightWorld& w, size_t i, const Numbers&) { w.circuit.bypass_shorted[i] = true; }},
      {"interreflection",
       [](LightWorld& w, size_t i, const Numbers& x) {
         w.light.walls[i].diffuse = x[0], w.light.walls[i].specular = x[1];
       }},
  };
  return all;
}

double near(RandomDraw& draw, double centre, double half) {
  return draw.uniform(centre - half, centre + half);
}

// Laws outside the catalogue.
void act_outside(const LightEffect& e, LightWorld& world) {
  const auto number = [&](const char* key) { return e.numbers.at(key)[0]; };
  if (e.kind == "ripple") {
    const double depth = number("depth"), k = 2.0 * pi / number("period_m"),
                 angle_deg = number("direction_deg"), angle = angle_deg * degree_rad,
                 phase = number("phase");
    world.laws.push_back([=](const InjectedPlace& p) {
      return 1.0 +
             depth * std::cos(k * (p.u_m * std::cos(angle) + p.v_m * std::sin(angle)) + phase);
    });
  } else if (e.kind == "vignetting") {
    const double depth = number("depth"), u = e.numbers.at("centre_m")[0],
                 v = e.numbers.at("centre_m")[1], radius = number("radius_m");
    world.laws.push_back([=](const InjectedPlace& p) {
      const double r2 = ((p.u_m - u) * (p.u_m - u) + (p.v_m - v) * (p.v_m - v)) / (radius * radius);
      return 1.0 - depth * r2 * r2 / (1.0 + r2 * r2);
    });
  } else if (e.kind == "hair") {
    const double u = e.numbers.at("through_m")[0], v = e.numbers.at("through_m")[1],
                 angle_deg = number("direction_deg"), angle = angle_deg * degree_rad,
                 half = 0.5 * number("width_m"), depth = number("depth");
    world.laws.push_back([=](const InjectedPlace& p) {
      const double off = -(p.u_m - u) * std::sin(angle) + (p.v_m - v) * std::cos(angle);
      return std::abs(off) < half ? 1.0 - depth : 1.0;
    });
  } else if (e.kind == "slow_drift") {
    const double depth = number("depth"), period = number("period_s"), phase = number("phase");
    world.laws.push_back([=](const InjectedPlace& p) {
      const double a = 2.0 * pi * p.time_s / period;
      return 1.0 + depth * (std::sin(a + phase) + 0.5 * std::sin(2.3 * a));
    });
  } else if (e.kind == "flicker") {
    const double depth = number("depth"), w = 2.0 * pi * number("frequency_Hz"),
                 phase = number("phase");
    world.laws.push_back(
        [=](const InjectedPlace& p) { return 1.0 + depth * std::cos(w * p.time_s + phase); });
  } else {
    throw NumericalError("no effect \"" + e.kind + "\" to inject");
  }
}

using Keys = std::vector<std::pair<std::string, size_t>>;  // and how many numbers each has

const std::map<std::string, Keys>& keys_of() {
  static const std::map<std::string, Keys> all = {
      {"led_derated", {{"factor", 1}}},
      {"led_aim", {{"angles_deg", 2}}},
      {"beam_divergence", {{"scale", 1}}},
      {"source_shift", {{"offset_m", 3}}},
      {"source_power", {{"factor", 1}}},
      {"led_droop", {{"depth", 1}, {"time_constant_s", 1}}},
      {"ambient_light", {{"irradiance_W_m2", 1}}},
      {"attitude_bias", {{"bias_deg", 2}}},
      {"detector_gain", {{"factor", 1}}},
      {"soiling", {{"factor", 1}}},
      {"angular_response", {{"refractive_index", 1}}},
      {"cell_degraded", {{"factor", 1}}},
      {"cell_shaded", {{"factor", 1}}},
      {"series_resistance", {{"resistance_ohm", 1}}},
      {"temperature_coefficient", {{"photocurrent_per_K", 1}, {"voltage_V_per_K", 1}}},
      {"string_open", {}},
      {"bypass_shorted", {}},
  };
  return all;
}

}  // namespace

void act(const LightEffect& e, LightWorld& world) {
  const auto index = static_cast<size_t>(std::max(0, e.index));
  if (e.kind == "led_failed") {
    world.light.lamps[index].power_W = 0.0;
  } else if (e.kind == "shunt") {
    world.circuit.shunt_S += 1.0 / e.numbers.at("resistance_ohm")[0];
  } else if (e.kind == "tracker_trapped") {
    const Numbers& s = e.numbers.at("interval_s");
    world.trapped_s.push_back({s[0], s[1]});
  } else if (e.kind == "unmodelled_shadow") {
    const Numbers &low = e.numbers.at("low_m"), &high = e.numbers.at("high_m");
    world.light.boxes.push_back(
        {e.numbers.at("on_body")[0] > 0.0, {low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
  } else if (e.kind == "interreflection") {
    InjectedWall& wall = world.light.walls[index];
    if (e.numbers.contains("diffuse")) wall.diffuse = e.numbers.at("diffuse")[0];
    if (e.numbers.contains("specular")) wall.specular = e.numbers.at("specular")[0];
  } else if (keys_of().contains(e.kind)) {
    Numbers x;
    for (const auto& [key, count] : keys_of().at(e.kind)) {
      const Numbers& some = e.numbers.at(key);
      x.insert(x.end(), some.begin(), some.end());
    }
    acts().at(e.kind)(world, index, x);
  } else {
    act_outside(e, world);
  }
}

std::vector<Rival> light_rivals(const LightWorld& world, bool has_scans, bool has_circuit,
                                bool has_runs) {
  std::vector<Rival> all;
  const auto add = [&](const std::string& kind, int index, const RivalNumbers& numbers) {
    const Act& one = acts().at(kind);
    all.push_back({kind, index, numbers, [&one, index](LightWorld& w, const Numbers& x) {
                     one(w, static_cast<size_t>(std::max(0, index)), x);
                   }});
  };
  for (int l = 0; l < static_cast<int>(world.light.lamps.size()); ++l) {
    add("led_derated", l, {{1.0}, {-0.05}, {0.0}, {1.0}});
    add("led_aim", l, {{0.0, 0.0}, {0.1, 0.1}, {-8, -8}, {8, 8}});
  }
  add("beam_divergence", -1, {{1.0}, {0.01}, {0.5}, {2.0}});
  add("source_shift", -1, {{0, 0, 0}, {5e-4, 5e-4, 1e-3}, {-.05, -.05, -.05}, {.05, .05, .05}});
  add("source_power", -1, {{1.0}, {0.01}, {0.3}, {2.0}});
  add("ambient_light", -1, {{0.0}, {1.0}, {0.0}, {1e4}});
  add("attitude_bias", -1, {{0, 0}, {0.1, 0.1}, {-12, -12}, {12, 12}});
  for (size_t w = 0; w < world.light.walls.size() && !has_runs; ++w) {
    add("interreflection", static_cast<int>(w), {{0, 0}, {0.1, 0.1}, {0, 0}, {1, 1}});
  }
  if (has_scans) add("detector_gain", -1, {{1.0}, {0.01}, {0.3}, {2.0}});
  for (int c = 0; c < static_cast<int>(world.circuit.cells()); ++c) {
    add("cell_shaded", c, {{1.0}, {-0.03}, {0.0}, {1.0}});
    if (has_circuit) add("cell_degraded", c, {{1.0}, {-0.03}, {0.0}, {1.0}});
  }
  if (!has_circuit) return all;
  if (has_runs) add("led_droop", -1, {{0.0, 300.0}, {0.01, 20.0}, {0.0, 30.0}, {0.9, 3000.0}});
  add("soiling", -1, {{1.0}, {-0.01}, {0.1}, {1.0}});
  add("angular_response", -1, {{1.0001}, {0.3}, {1.0001}, {4.0}});
  add("series_resistance", -1, {{0.0}, {0.02}, {0.0}, {20.0}});
  add("shunt", -1, {{0.0}, {1e-3}, {0.0}, {2.0}});
  add("temperature_coefficient", -1, {{0, 0}, {1e-4, 1e-4}, {-.02, -.02}, {.02, .02}});
  for (int s = 0; s < world.circuit.strings && world.circuit.strings > 1; ++s) {
    add("string_open", s, {});
  }
  for (int b = 0; b < static_cast<int>(world.circuit.bypasses()); ++b) {
    add("bypass_shorted", b, {});
  }
  return all;
}

LightRecipe draw_light_effect(RandomDraw& draw, const LightWorld& world, const std::string& kind,
                              double duration_s) {
  const int lamps = static_cast<int>(world.light.lamps.size()),
            cells = static_cast<int>(world.circuit.cells());
  const InjectedPlate& plate = world.light.plate;
  const double wide = plate.u_high_m - plate.u_low_m, high = plate.v_high_m - plate.v_low_m,
               u_mid = 0.5 * (plate.u_low_m + plate.u_high_m),
               v_mid = 0.5 * (plate.v_low_m + plate.v_high_m);
  const double sign = draw.sign(), angle = draw.uniform(0.0, 2.0 * pi);
  LightEffect e{kind, -1, {}};
  const auto one = [&](const std::string& key, double none, double all) {
    return LightRecipe{kind, true, [=](double s) {
                         LightEffect at = e;
                         at.numbers[key] = {none + s * (all - none)};
                         return at;
                       }};
  };
  const auto list = [&](const std::string& key, const Numbers& full) {
    return LightRecipe{kind, true, [=](double s) {
                         LightEffect at = e;
                         for (const double x : full) at.numbers[key].push_back(s * x);
                         return at;
                       }};
  };
  const auto fixed = [&] { return LightRecipe{kind, false, [=](double) { return e; }}; };
  if (kind.starts_with("led_") && kind != "led_droop") e.index = draw.below(lamps);
  if (kind.starts_with("cell_")) e.index = draw.below(cells);
  if (kind == "string_open") e.index = draw.below(world.circuit.strings);
  if (kind == "bypass_shorted") e.index = draw.below(static_cast<int>(world.circuit.bypasses()));
  if (kind == "interreflection") e.index = 0;
  if (kind == "led_failed" || kind == "string_open" || kind == "bypass_shorted") return fixed();
  if (kind == "led_derated" || kind.starts_with("cell_")) return one("factor", 1.0, 0.05);
  if (kind == "led_aim") return list("angles_deg", {4 * std::cos(angle), 4 * std::sin(angle)});
  if (kind == "beam_divergence") return one("scale", 1.0, 1.0 + 0.25 * sign);
  if (kind == "source_shift") {
    return list("offset_m",
                {0.02 * std::cos(angle), 0.02 * std::sin(angle), draw.uniform(-0.02, 0.02)});
  }
  if (kind == "source_power") return one("factor", 1.0, 1.0 + 0.25 * sign);
  if (kind == "detector_gain") return one("factor", 1.0, 1.0 + 0.2 * sign);
  if (kind == "soiling") return one("factor", 1.0, 0.7);
  if (kind == "ambient_light") return one("irradiance_W_m2", 0.0, 60.0);
  if (kind == "attitude_bias") return list("bias_deg", {3 * std::cos(angle), 3 * std::sin(angle)});
  if (kind == "angular_response") return one("refractive_index", 1.0, 2.0);
  if (kind == "series_resistance") return one("resistance_ohm", 0.0, 1.0);
  if (kind == "interreflection") {
    return one(draw.chance(0.6) ? "diffuse" : "specular", 0.0, 0.9);
  }
  if (kind == "shunt") {
    return {kind, true, [=](double s) {
              LightEffect at = e;
              at.numbers["resistance_ohm"] = {3.0 / s};
              return at;
            }};
  }
  if (kind == "temperature_coefficient") {
    const double second = draw.sign();
    return {kind, true, [=](double s) {
              LightEffect at = e;
              at.numbers["photocurrent_per_K"] = {0.003 * sign * s};
              at.numbers["voltage_V_per_K"] = {0.002 * second * s};
              return at;
            }};
  }
  if (kind == "led_droop") {
    e.numbers["time_constant_s"] = {draw.log_uniform(0.1, 0.8) * duration_s};
    return one("depth", 0.0, 0.3);
  }
  if (kind == "tracker_trapped") {
    const double length = draw.uniform(0.1, 0.3) * duration_s;
    const double from = std::floor(draw.uniform(0.05, 0.6) * duration_s);
    e.numbers["interval_s"] = {from, std::floor(from + length)};
    return fixed();
  }
  if (kind == "unmodelled_shadow") {
    const bool body = draw.chance(0.5);
    const double u = near(draw, u_mid, 0.3 * wide), v = near(draw, v_mid, 0.3 * high),
                 z = plate.z_m + draw.uniform(0.08, 0.3), a = draw.uniform(0.6, 1.0),
                 b = draw.uniform(0.6, 1.0);
    e.numbers["on_body"] = {body ? 1.0 : 0.0};
    return {kind, true, [=](double s) {
              LightEffect at = e;
              const double half = 0.5 * std::clamp(0.06 * s, 0.004, 0.06);
              at.numbers["low_m"] = {u - a * half, v - b * half, z};
              at.numbers["high_m"] = {u + a * half, v + b * half, z + 0.006};
              return at;
            }};
  }
  if (kind == "ripple") {
    e.numbers = {{"period_m", {draw.uniform(0.015, 0.08)}},
                 {"direction_deg", {draw.uniform(0.0, 180.0)}},
                 {"phase", {angle}}};
    return one("depth", 0.0, 0.2);
  }
  if (kind == "vignetting") {
    e.numbers = {{"centre_m", {near(draw, u_mid, 0.1 * wide), near(draw, v_mid, 0.1 * high)}},
                 {"radius_m", {draw.uniform(0.3, 0.5) * std::max(wide, high)}}};
    return one("depth", 0.0, 0.5);
  }
  if (kind == "hair") {
    e.numbers = {{"through_m", {near(draw, u_mid, 0.2 * wide), near(draw, v_mid, 0.2 * high)}},
                 {"direction_deg", {draw.uniform(20.0, 70.0) + (sign > 0.0 ? 90.0 : 0.0)}},
                 {"width_m", {draw.uniform(0.003, 0.008)}}};
    return one("depth", 0.0, 0.8);
  }
  if (kind == "slow_drift") {
    e.numbers = {{"period_s", {draw.uniform(0.5, 1.5) * duration_s}}, {"phase", {angle}}};
    return one("depth", 0.0, 0.1);
  }
  if (kind == "flicker") {
    e.numbers = {{"frequency_Hz", {draw.log_uniform(0.01, 0.4)}}, {"phase", {angle}}};
    return one("depth", 0.0, 0.1);
  }
  throw NumericalError("no recipe for \"" + kind + "\"");
}

}  // namespace photorque::injected
