#include "tools/proof/files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "attitude/recordings/text_lines.h"
#include "core/files.h"
#include "tools/proof/recipes.h"

namespace photorque {
namespace {

using namespace injected;
using Json = nlohmann::ordered_json;

constexpr double start_s = -0.5;  // the motion starts before the clock, so that a camera may lag
constexpr double step_s = 0.01;
constexpr double arcsecond = pi / 180.0 / 3600.0;

template <class... Numbers>
std::string print(const char* format, Numbers... numbers) {
  char text[512];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

std::string array_text(const std::vector<double>& numbers, const char* format) {
  std::string text;
  for (const double x : numbers) text += (text.empty() ? "" : ", ") + print(format, x);
  return numbers.size() == 1 ? text : "[" + text + "]";
}
std::string array_text(const Triple& v) {
  return array_text({v.begin(), v.end()}, "%.6g");
}

std::string with_sigma(const std::string& value, const std::string& sigma, bool exact) {
  return exact ? value : "{ value = " + value + ", sigma = " + sigma + " }";
}

std::string effect_text(const InjectedEffect& effect) {
  std::string text = "\n[[disturbance]]\nkind = \"" + effect.kind + "\"\n";
  for (const auto& [key, numbers] : effect.parameters) {
    text += key + " = " + array_text(numbers, "%.12g") + "\n";
  }
  return text;
}

// When the rows are taken, and which of them are lost.
struct Rows {
  std::vector<double> time_s;
  std::vector<bool> lost;
};

Rows draw_rows(RandomDraw& draw, const InjectedSensors& sensors, double duration_s) {
  Rows rows;
  const double interval_s = 1.0 / sensors.rate_Hz;
  const auto count = static_cast<size_t>(std::llround(duration_s * sensors.rate_Hz));
  for (size_t i = 0; i < count; ++i) {
    const double jitter = sensors.dirty ? std::clamp(0.05 * draw.normal(), -0.3, 0.3) : 0.0;
    const double t_s = (static_cast<double>(i) + jitter) * interval_s;
    rows.time_s.push_back(i == 0 ? 0.0 : std::round(1e6 * t_s) / 1e6);
  }
  rows.lost.assign(count, false);
  if (!sensors.dirty) return rows;
  for (size_t i = 1; i < count; ++i) rows.lost[i] = draw.chance(0.003);
  for (int gap = 0; gap < 2; ++gap) {
    const double from_s = draw.uniform(0.1, 0.9) * duration_s, length_s = draw.uniform(1.0, 8.0);
    for (size_t i = 1; i < count; ++i) {
      const double into_s = rows.time_s[i] - from_s;
      if (into_s >= 0.0 && into_s < length_s) rows.lost[i] = true;
    }
  }
  return rows;
}

// Commands begin with a row, and that row is never lost: what the log says is what was done.
std::vector<InjectedCommand> on_rows(std::vector<InjectedCommand> commands, Rows& rows) {
  for (InjectedCommand& c : commands) {
    const auto at = std::ranges::lower_bound(rows.time_s, c.time_s - 1e-9);
    if (at == rows.time_s.end()) continue;
    c.time_s = *at;
    rows.lost[static_cast<size_t>(at - rows.time_s.begin())] = false;
  }
  return commands;
}

// The readings of one row as cells.
class Instruments {
 public:
  Instruments(RandomDraw& draw, const InjectedSensors& sensors) : draw_(draw), sensors_(sensors) {}

  std::string attitude(const Quaternion& seen, size_t row) {
    Triple noise;
    for (size_t k = 0; k < 3; ++k) {
      noise[k] = sensors_.camera_noise_arcsec[k] * arcsecond * draw_.normal();
    }
    if (sensors_.dirty && draw_.chance(0.002)) {
      noise = times(draw_.log_uniform(0.01, 0.3), draw_.direction());
    }
    Quaternion q = product(quaternion_of(noise), seen);
    if (sensors_.dirty && draw_.chance(0.01)) side_ = -side_;
    if (side_ * q[0] < 0.0 && !sensors_.dirty) side_ = -side_;  // most trackers report w ≥ 0
    const bool due = row % static_cast<size_t>(sensors_.camera_every) == 0;
    const bool seen_at_all = !(sensors_.dirty && draw_.chance(0.01));
    if (!due || !seen_at_all) return ",,,";
    for (double& x : q) x *= side_;
    return print("%.9f,%.9f,%.9f,%.9f", q[0], q[1], q[2], q[3]);
  }

  std::string gyro(Triple rate_rad_s) {
    rate_rad_s = plus(rate_rad_s, draw_.normals(sensors_.gyro_noise_rad_s));
    if (sensors_.dirty && draw_.chance(0.001)) {
      rate_rad_s = plus(rate_rad_s, times(draw_.log_uniform(0.02, 1.0), draw_.direction()));
    }
    if (sensors_.dirty && draw_.chance(0.003)) return ",,";
    return print("%.7e,%.7e,%.7e", rate_rad_s[0], rate_rad_s[1], rate_rad_s[2]);
  }

 private:
  RandomDraw& draw_;
  InjectedSensors sensors_;
  double side_ = 1.0;
};

Json number_or_array(const std::vector<double>& numbers) {
  return numbers.size() == 1 ? Json(numbers[0]) : Json(numbers);
}

}  // namespace

std::string injected_experiment(const InjectedCase& c, bool told_truth) {
  const InjectedPriors& priors = c.priors;
  const auto& inertia = c.world.inertia_kg_m2;
  std::string text = "# The nominal model of this platform and its laboratory.\n[platform]\n";
  text += "topology = \"" + c.topology + "\"\n";
  text += print("mass_kg = %.6g\n", c.world.mass_kg);
  text += print("inertia_kg_m2 = [[%.6g, 0, 0], [0, %.6g, 0], [0, 0, %.6g]]\n", inertia[0][0],
                inertia[1][1], inertia[2][2]);
  text += print("\n[environment]\ngravity_m_s2 = %.7g\n", c.world.gravity_m_s2);
  text += "magnetic_field_T = " + array_text(c.world.magnetic_field_T) +
          "   # lab axes: east, north, up\n";
  text += print("latitude_deg = %.6g\n", c.world.latitude_rad * 180.0 / pi);
  text += "\n[[disturbance]]\nkind = \"" + std::string(nominal_unbalance) + "\"\noffset_m = " +
          with_sigma(array_text(priors.offset_m), array_text(priors.offset_sigma_m),
                     priors.offset_sigma_m[0] == 0.0) +
          "\n";
  text += "\n[[disturbance]]\nkind = \"" + std::string(nominal_drag) + "\"\ncoefficient_N_m_s = " +
          with_sigma(print("%.6g", priors.drag_N_m_s), print("%.3g", priors.drag_sigma_N_m_s),
                     priors.drag_sigma_N_m_s == 0.0) +
          "\n";
  if (told_truth) {
    for (const InjectedEffect& effect : c.world.effects) text += effect_text(effect);
  }
  text += "\n[sensors.camera]\nnoise_arcsec = " + array_text(c.sensors.camera_noise_arcsec) +
          "   # about lab x, y (out of plane) and z (in plane)\n";
  const std::string bias = print("%g", priors.gyro_bias_sigma_rad_s);
  text += print("\n[sensors.gyro]\nnoise_rad_s = %g\n", c.sensors.gyro_noise_rad_s);
  text += "bias_rad_s = " +
          with_sigma("[0, 0, 0]", "[" + bias + ", " + bias + ", " + bias + "]",
                     priors.gyro_bias_sigma_rad_s == 0.0) +
          "\n";
  return text;
}

std::string injected_recording(const InjectedCase& c, size_t run_index) {
  RandomDraw draw(c.seed, 100 + run_index);
  const InjectedRun& run = c.runs[run_index];
  Rows rows = draw_rows(draw, c.sensors, run.duration_s);
  const auto commands = on_rows(run.commands, rows);
  const auto moments = injected_motion(c.world, commands, run.start, start_s, rows.time_s, step_s);
  std::vector<double> seen_s = rows.time_s;
  for (double& t_s : seen_s) t_s -= std::min(0.49, injected_latency_s(c.world));
  const auto seen = injected_motion(c.world, commands, run.start, start_s, seen_s, step_s);

  std::string text = c.sensors.dirty ? "# exported log, tracker and gyro on one clock\n" : "";
  text +=
      "t_s,q_w,q_x,q_y,q_z,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,"
      "command_x_N_m,command_y_N_m,command_z_N_m,battery_current_A\n";
  Instruments instruments(draw, c.sensors);
  size_t held = 0;
  // As many digits as the times have: a pulse 50 µs off shows after minutes.
  const double interval_ten_us = 1e5 / c.sensors.rate_Hz;
  const bool few = !c.sensors.dirty && std::remainder(interval_ten_us, 10.0) == 0.0;
  const char* const time_format = few ? "%.4f," : "%.6f,";
  for (size_t i = 0; i < moments.size(); ++i) {
    const std::string attitude = instruments.attitude(seen[i].camera, i);
    const std::string gyro = instruments.gyro(moments[i].gyro_rad_s);
    if (rows.lost[i]) continue;
    while (held + 1 < commands.size() && commands[held + 1].time_s <= rows.time_s[i] + 1e-9) ++held;
    const Triple& torque = commands[held].torque_N_m;
    const std::string row = print(time_format, rows.time_s[i]) + attitude + "," + gyro +
                            print(",%.8e,%.8e,%.8e,%.4f\n", torque[0], torque[1], torque[2],
                                  commands[held].battery_current_A);
    text += row;
    if (c.sensors.dirty && draw.chance(0.001)) text += row;  // written twice
  }
  return text;
}

std::string injected_truth_json(const InjectedCase& c) {
  Json json;
  json["verdict"] = c.verdict;
  Json effects = Json::array();
  for (const InjectedEffect& effect : c.world.effects) {
    Json e = {{"kind", effect.kind}};
    for (const auto& [key, numbers] : effect.parameters) e[key] = number_or_array(numbers);
    effects.push_back(e);
  }
  json["effects"] = effects;
  json["accept"] = c.accept;
  json["depends_on"] = c.depends_on;
  json["name"] = c.name;
  json["family"] = c.family;
  json["chi2_gain"] = c.chi2_gain;
  json["dirty"] = c.sensors.dirty;
  json["rate_Hz"] = c.sensors.rate_Hz;
  json["platform"] = {{"mass", c.world.mass_kg},
                      {"inertia", c.world.inertia_kg_m2},
                      {"offset", c.world.offset_m},
                      {"drag", c.world.drag_N_m_s},
                      {"gyro_bias", c.world.gyro_bias_rad_s}};
  Json runs = Json::array();
  for (const InjectedRun& run : c.runs) {
    runs.push_back({{"t0", start_s}, {"q0", run.start.attitude}, {"w0", run.start.rate_rad_s}});
  }
  json["runs"] = runs;
  return json.dump(1) + "\n";
}

void write_injected_case(const InjectedCase& injected, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_file_whole(folder / "experiment.toml", injected_experiment(injected, false));
  write_file_whole(folder / "oracle.toml", injected_experiment(injected, true));
  write_file_whole(folder / "run1.csv.gz", gzip(injected_recording(injected, 0)));
  write_file_whole(folder / "run2.csv.gz", gzip(injected_recording(injected, 1)));
  write_file_whole(folder / "truth.json", injected_truth_json(injected));
}

}  // namespace photorque
