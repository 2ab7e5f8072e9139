#include "tools/proof/files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "attitude/recordings/text_lines.h"
#include "core/files.h"
#include "tools/proof/instruments.h"
#include "tools/proof/recipes.h"

namespace photorque {
namespace {

using namespace injected;
using Json = nlohmann::ordered_json;

constexpr double step_s = 0.01;
// A hundred kinks bent by this much are off by less than the instruments' noise after minutes.
constexpr double bend_rad_s = 2e-8;

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

Json number_or_array(const std::vector<double>& numbers) {
  return numbers.size() == 1 ? Json(numbers[0]) : Json(numbers);
}

// Where it is not as stated.
void add_noise(Json& json, const char* instrument, const InjectedNoise& noise) {
  if (noise.is_as_stated()) return;
  json[instrument] = {{"scale", noise.scale},
                      {"correlation_time_s", noise.time_s},
                      {"student_degrees", noise.student_degrees},
                      {"outlier_share", noise.outlier_share},
                      {"step_sigma", noise.step_sigma}};
}

std::string platform_text(const InjectedCase& c) {
  const auto& inertia = c.world.inertia_kg_m2;
  std::string text = "[platform]\ntopology = \"" + c.topology + "\"\n";
  text += print("mass_kg = %.6g\n", c.world.mass_kg);
  text += print("inertia_kg_m2 = [[%.6g, 0, 0], [0, %.6g, 0], [0, 0, %.6g]]\n", inertia[0][0],
                inertia[1][1], inertia[2][2]);
  text += print("\n[environment]\ngravity_m_s2 = %.7g\n", c.world.gravity_m_s2);
  text += "magnetic_field_T = " + array_text(c.world.magnetic_field_T) +
          "   # lab axes: east, north, up\n";
  return text + print("latitude_deg = %.6g\n", c.world.latitude_rad * 180.0 / pi);
}

}  // namespace

std::string injected_experiment(const InjectedCase& c, bool told_truth) {
  std::string text = "# The nominal model of this platform and its laboratory.\n";
  text += platform_text(c);
  const InjectedPriors& priors = c.priors;
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
  if (!c.sensors.has_gyro) return text;
  const std::string bias = print("%g", priors.gyro_bias_sigma_rad_s);
  text += print("\n[sensors.gyro]\nnoise_rad_s = %g\n", c.sensors.gyro_noise_rad_s);
  text += "bias_rad_s = " +
          with_sigma("[0, 0, 0]", "[" + bias + ", " + bias + ", " + bias + "]",
                     priors.gyro_bias_sigma_rad_s == 0.0) +
          "\n";
  return text;
}

std::string injected_truth_toml(const InjectedCase& c, size_t run_index) {
  for (const InjectedEffect& effect : c.world.effects) {
    if (is_outside_catalogue(effect.kind)) return "";
  }
  const auto exactly = [](const Triple& v) { return array_text(list(v), "%.15g"); };
  std::string text = "# What acted, and how it began.\n" + platform_text(c);
  text += "\n[[disturbance]]\nkind = \"" + std::string(nominal_unbalance) +
          "\"\noffset_m = " + exactly(c.world.offset_m) + "\n";
  text += "\n[[disturbance]]\nkind = \"" + std::string(nominal_drag) + "\"\n" +
          print("coefficient_N_m_s = %.15g\n", c.world.drag_N_m_s);
  for (const InjectedEffect& effect : c.world.effects) text += effect_text(effect);
  // At the clock's zero: the motion itself starts before.
  const InjectedRun& run = c.runs[run_index];
  const InjectedContext begin =
      injected_motion(c.world, run.commands, run.start, injected_start_s(c.world), {0.0}, step_s,
                      bend_rad_s)
          .front();
  text += "\n[sensors.camera]\nnoise_arcsec = [0, 0, 0]\n";
  text += print("\n[propagate]\nduration_s = %.9g\noutput_rate_Hz = %.9g\n", run.duration_s,
                c.sensors.rate_Hz);
  text +=
      "initial_attitude = " + array_text({begin.attitude.begin(), begin.attitude.end()}, "%.15g") +
      "\n";
  text += "initial_rate_rad_s = " + exactly(begin.rate_rad_s) + "\n";
  if (c.sensors.has_commands) text += print("commands = 'run%zu.csv.gz'\n", run_index + 1);
  return text;
}

std::string injected_recording(const InjectedCase& c, size_t run_index) {
  RandomDraw draw(c.seed, 100 + run_index);
  const InjectedRun& run = c.runs[run_index];
  Rows rows = draw_rows(draw, c.sensors, run.duration_s);
  const auto commands = on_rows(run.commands, rows);
  const auto motion_at = [&](const std::vector<double>& times_s) {
    return injected_motion(c.world, commands, run.start, injected_start_s(c.world), times_s, step_s,
                           bend_rad_s);
  };
  const auto moments = motion_at(rows.time_s);
  const double latency_s = std::min(0.49, injected_latency_s(c.world));
  std::vector<double> seen_s = rows.time_s;
  for (double& t_s : seen_s) t_s -= latency_s;
  const auto seen = latency_s == 0.0 ? moments : motion_at(seen_s);

  std::string text = c.sensors.dirty ? "# exported log, tracker and gyro on one clock\n" : "";
  text += "t_s,q_w,q_x,q_y,q_z";
  if (c.sensors.has_gyro) text += ",gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s";
  if (c.sensors.has_commands)
    text += ",command_x_N_m,command_y_N_m,command_z_N_m,battery_current_A";
  text += "\n";
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
    std::string row = print(time_format, rows.time_s[i]) + attitude + gyro;
    if (c.sensors.has_commands) {
      while (held + 1 < commands.size() && commands[held + 1].time_s <= rows.time_s[i] + 1e-9) {
        ++held;
      }
      const Triple& torque = commands[held].torque_N_m;
      row += print(",%.8e,%.8e,%.8e,%.4f", torque[0], torque[1], torque[2],
                   commands[held].battery_current_A);
    }
    row += "\n";
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
  json["maker"] = c.maker;
  json["chi2_gain"] = c.chi2_gain;
  json["dirty"] = c.sensors.dirty;
  json["rate_Hz"] = c.sensors.rate_Hz;
  json["camera_noise_arcsec"] = c.sensors.camera_noise_arcsec;
  Json noise = Json::object();
  add_noise(noise, "camera", c.sensors.camera);
  add_noise(noise, "gyro", c.sensors.gyro);
  if (!noise.empty()) json["noise"] = noise;
  json["platform"] = {{"mass", c.world.mass_kg},
                      {"inertia", c.world.inertia_kg_m2},
                      {"offset", c.world.offset_m},
                      {"drag", c.world.drag_N_m_s},
                      {"gyro_bias", c.world.gyro_bias_rad_s}};
  Json runs = Json::array();
  for (const InjectedRun& run : c.runs) {
    runs.push_back({{"t0", injected_start_s(c.world)},
                    {"q0", run.start.attitude},
                    {"w0", run.start.rate_rad_s}});
  }
  json["runs"] = runs;
  return json.dump(1) + "\n";
}

void write_injected_case(const InjectedCase& injected, const std::filesystem::path& folder) {
  write_file_whole(folder / "experiment.toml", injected_experiment(injected, false));
  write_file_whole(folder / "oracle.toml", injected_experiment(injected, true));
  write_file_whole(folder / "run1.csv.gz", gzip(injected_recording(injected, 0)));
  write_file_whole(folder / "run2.csv.gz", gzip(injected_recording(injected, 1)));
  for (size_t run = 0; run < 2; ++run) {
    const std::string truth = injected_truth_toml(injected, run);
    const std::string name = "truth" + std::to_string(run + 1) + ".toml";
    if (!truth.empty()) write_file_whole(folder / name, truth);
  }
  write_file_whole(folder / "truth.json", injected_truth_json(injected));
}

}  // namespace photorque
