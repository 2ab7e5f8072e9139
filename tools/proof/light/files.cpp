#include "tools/proof/light/files.h"

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "attitude/recordings/text_lines.h"
#include "core/constants.h"
#include "core/files.h"
#include "core/text/format.h"
#include "tools/proof/light/words.h"

namespace photorque {
namespace {

using namespace injected;
using Json = nlohmann::ordered_json;

// Corners counter-clockwise as the surface is seen; body axes.
struct Rectangle {
  std::string name;
  std::array<Triple, 4> corners;
};

// As glTF 2.0 with its buffer inside; its axes are y up.
std::string scene_text(const std::vector<Rectangle>& rectangles) {
  std::vector<std::byte> bytes;
  const auto put = [&](const auto& value) {
    const auto raw = std::bit_cast<std::array<std::byte, sizeof value>>(value);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  Json scene = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  Json nodes = Json::array(), meshes = Json::array(), materials = Json::array(),
       accessors = Json::array(), views = Json::array(), list = Json::array();
  for (size_t i = 0; i < rectangles.size(); ++i) {
    const Rectangle& r = rectangles[i];
    std::array<float, 3> low = {1e30f, 1e30f, 1e30f}, high = {-1e30f, -1e30f, -1e30f};
    const size_t vertices_at = bytes.size();
    for (const Triple& corner : r.corners) {
      const std::array<float, 3> v = {static_cast<float>(corner[0]), static_cast<float>(corner[2]),
                                      static_cast<float>(-corner[1])};
      for (size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], v[k]);
        high[k] = std::max(high[k], v[k]);
        put(v[k]);
      }
    }
    const size_t indices_at = bytes.size();
    for (const uint16_t index : {0, 1, 2, 0, 2, 3}) put(index);
    views.push_back({{"buffer", 0}, {"byteOffset", vertices_at}, {"byteLength", 48}});
    views.push_back({{"buffer", 0}, {"byteOffset", indices_at}, {"byteLength", 12}});
    accessors.push_back({{"bufferView", 2 * i},
                         {"componentType", 5126},
                         {"count", 4},
                         {"type", "VEC3"},
                         {"min", low},
                         {"max", high}});
    accessors.push_back(
        {{"bufferView", 2 * i + 1}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
    materials.push_back({{"name", r.name + "_surface"},
                         {"doubleSided", true},
                         {"extras", {{"photorque", {{"absorptance", 1}}}}}});
    meshes.push_back({{"name", r.name},
                      {"primitives", Json::array({{{"attributes", {{"POSITION", 2 * i}}},
                                                   {"indices", 2 * i + 1},
                                                   {"material", i}}})}});
    nodes.push_back({{"name", r.name}, {"mesh", i}});
    list.push_back(i);
  }
  scene["scenes"] = Json::array({{{"nodes", list}}});
  scene["nodes"] = nodes;
  scene["meshes"] = meshes;
  scene["materials"] = materials;
  scene["accessors"] = accessors;
  scene["bufferViews"] = views;
  scene["buffers"] =
      Json::array({{{"byteLength", bytes.size()},
                    {"uri", "data:application/octet-stream;base64," + base64(std::span(bytes))}}});
  return scene.dump() + "\n";
}

std::string wall_name(const LightWorld& world, size_t wall) {
  return world.light.walls.size() == 1 ? "wall" : "wall_" + std::to_string(wall);
}

std::string scene_of(const LightWorld& world) {
  const InjectedPlate& p = world.light.plate;
  std::vector<Rectangle> all = {{"array",
                                 {{{p.u_low_m, p.v_low_m, p.z_m},
                                   {p.u_high_m, p.v_low_m, p.z_m},
                                   {p.u_high_m, p.v_high_m, p.z_m},
                                   {p.u_low_m, p.v_high_m, p.z_m}}}}};
  for (size_t w = 0; w < world.light.walls.size(); ++w) {
    const InjectedWall& wall = world.light.walls[w];
    const auto corner = [&](double along, double up) {
      Triple at = {};
      at[wall.axis] = wall.at_m;
      at[1 - wall.axis] = along;
      at[2] = up;
      return at;
    };
    all.push_back({wall_name(world, w),
                   {corner(wall.from_m, wall.bottom_m), corner(wall.to_m, wall.bottom_m),
                    corner(wall.to_m, wall.top_m), corner(wall.from_m, wall.top_m)}});
  }
  return scene_text(all);
}

std::string experiment_text(const LightCase& c) {
  const InjectedCircuit& a = c.believed.circuit;
  const double size = a.cell_area_m2 / 0.0025;
  std::string text =
      "# What is believed about the light, the array and the instruments.\n[scene]\n";
  text += "file = \"scene.gltf\"\n\n" + c.sources;
  text += printed("[[receiver]]\nkind = \"flux_map\"\nnode = \"array\"\nbins = [%d, %d]\n",
                  20 * a.columns, 20 * a.rows);
  text += "facing = [0, 0, 1]\n\n";
  text += printed("[array]\nreceiver = \"array\"\ncells = [%d, %d]\ngap_m = 0\nmargin_m = 0\n",
                  a.columns, a.rows);
  text += std::string("series = \"") + (a.along_columns ? "columns" : "rows") + "\"\n";
  text +=
      printed("strings = %d\nbypass_every = %d\nbypass = \"ideal\"\n", a.strings, a.bypass_every);
  text += std::string("blocking = \"") + (a.blocking ? "ideal" : "none") + "\"\n";
  text += printed("temperature_K = 298.15\n\n[array.bypass_diode]\ndrop_V = %.6g\n\n", a.drop_V);
  text += "[array.quantum_efficiency]\nwavelength_nm = [600, 860]\n";
  text += printed("efficiency = [%.6g, %.6g]\n\n", a.efficiency, a.efficiency);
  text += "[array.cell_parameters]\nreference_area_m2 = 0.0025\nreference_temperature_K = 298.15\n";
  text += printed("saturation_1_A = %.9g\nsaturation_2_A = 0\nideality_1 = %.9g\n",
                  a.cell.saturation_A / size, a.cell.ideality);
  text += printed("series_ohm = %.9g\nshunt_ohm = %.9g\nbreakdown_fraction = 0\n",
                  a.cell.series_ohm * size, a.cell.shunt_ohm * size);
  text += printed("gap_eV = %.9g\ngap_slope_per_K = %.9g\nphotocurrent_slope_per_K = %.9g\n\n",
                  a.cell.gap_eV, a.cell.gap_slope_per_K, a.cell.photocurrent_slope_per_K);
  text += "[attitude]\ntilt_deg = 0\nheading_deg = 0\n\n[sensors.irradiance]\n";
  text += printed("noise_W_m2 = %.6g\nrelative_noise = %.6g\n\n[sensors.array]\n",
                  c.noise.irradiance_W_m2, c.noise.relative);
  text += printed("voltage_noise_V = %.6g\ncurrent_noise_A = %.6g\n", c.noise.voltage_V,
                  c.noise.current_A);
  if (c.voltage_is_set()) text += printed("tracker_step_V = %.6g\n", c.noise.tracker_step_V);
  return text;
}

// Empty where the experiment has no key for what acts.
std::string oracle_text(const LightCase& c) {
  std::string text = experiment_text(c);
  for (const LightEffect& e : c.effects) {
    text += "\n[[effect]]\nkind = \"" + e.kind + "\"\n";
    if (e.kind == "interreflection") {
      text += "node = \"" + wall_name(c.believed, static_cast<size_t>(e.index)) + "\"\n";
    } else if (e.index >= 0) {
      text += printed("index = %d\n", e.index);
    }
    if (e.kind == "unmodelled_shadow") {
      const auto &low = e.numbers.at("low_m"), &high = e.numbers.at("high_m");
      const std::vector<double> centre = {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]),
                                          0.5 * (low[2] + high[2])},
                                size = {high[0] - low[0], high[1] - low[1]};
      text += std::string("axes = \"") + (e.numbers.at("on_body")[0] > 0.0 ? "body" : "lab") +
              "\"\nopacity = 1\ncentre_m = " + printed_list("%.9g", centre) +
              "\nsize_m = " + printed_list("%.9g", size) + "\n";
      continue;
    }
    for (const auto& [key, numbers] : e.numbers) {
      text +=
          key + " = " +
          (numbers.size() == 1 ? printed("%.12g", numbers[0]) : printed_list("%.12g", numbers)) +
          "\n";
    }
    if (e.kind == "tracker_trapped") text += "recording = 0\n";
  }
  return text;
}

std::string recording_text(const LightCase& c, size_t which) {
  const LightRows& rows = c.recordings[which].rows;
  RandomDraw draw(c.seed, 50 + which);
  const auto readings = injected_readings(c.truth(), rows, c.voltage_is_set());
  std::string text = c.dirty ? "# as it came from the instrument\n# operator: -\n" : "";
  const auto wild = [&] { return c.dirty && draw.chance(0.002) ? draw.uniform(2.0, 4.0) : 1.0; };
  const auto lost = [&] { return c.dirty && draw.chance(0.03); };
  bool moves = false, warms = false;
  for (size_t i = 1; i < rows.size(); ++i) {
    moves = moves || rows.attitude[i] != rows.attitude[0];
    warms = warms || rows.temperature_K[i] != rows.temperature_K[0];
  }
  moves = moves || (!rows.tilt_deg.empty() && rows.tilt_deg[0] != 0.0);
  switch (rows.kind) {
    case LightRows::Kind::scan:
      text +=
          moves ? "u_m,v_m,irradiance_W_m2,tilt_deg,heading_deg\n" : "u_m,v_m,irradiance_W_m2\n";
      break;
    case LightRows::Kind::sweep:
      text += "voltage_V,current_A,sweep,tilt_deg,heading_deg,cell_temperature_K\n";
      break;
    case LightRows::Kind::run:
      text += "t_s,q_w,q_x,q_y,q_z,array_voltage_V,array_current_A,array_power_W,";
      text += "cell_temperature_K,led_current_A\n";
      break;
  }
  for (size_t i = 0; i < rows.size(); ++i) {
    std::string row;
    if (rows.kind == LightRows::Kind::scan) {
      const double E = readings[i];
      const double read =
          (E + std::hypot(c.noise.irradiance_W_m2, c.noise.relative * E) * draw.normal()) * wild();
      row = printed("%.5f,%.5f,%.2f", rows.u_m[i], rows.v_m[i], read);
      if (moves) row += printed(",%g,%g", rows.tilt_deg[i], rows.heading_deg[i]);
    } else if (rows.kind == LightRows::Kind::sweep) {
      const double v = rows.voltage_V[i] + c.noise.voltage_V * draw.normal(),
                   current = (readings[i] + c.noise.current_A * draw.normal()) * wild();
      row = printed("%.4f,%.5f,%d,%g,%g,%.2f", v, current, rows.sweep[i], rows.tilt_deg[i],
                    rows.heading_deg[i], rows.temperature_K[i]);
    } else {
      const double v = readings[2 * i] + c.noise.voltage_V * draw.normal(),
                   current = (readings[2 * i + 1] + c.noise.current_A * draw.normal()) * wild();
      const Quaternion& q = rows.attitude[i];
      row = printed("%g,%.7f,%.7f,%.7f,%.7f,%.4f,%.5f,%.5f,%.2f,0.700", rows.time_s[i], q[0], q[1],
                    q[2], q[3], v, current, v * current, rows.temperature_K[i]);
    }
    if (!lost()) text += row + "\n";
  }
  return text;
}

std::string truth_text(const LightCase& c) {
  Json json = {{"verdict", c.verdict}};
  Json effects = Json::array();
  for (const LightEffect& e : c.effects) {
    Json one = {{"kind", e.kind}};
    if (e.kind == "interreflection") {
      one["node"] = wall_name(c.believed, static_cast<size_t>(e.index));
    } else if (e.index >= 0) {
      one["index"] = e.index;
    }
    for (const auto& [key, numbers] : e.numbers) {
      if (key == "on_body") {
        one["axes"] = numbers[0] > 0.0 ? "body" : "lab";
      } else if (numbers.size() == 1) {
        one[key] = numbers[0];
      } else {
        one[key] = numbers;
      }
    }
    effects.push_back(one);
  }
  json["effects"] = effects;
  json["accept"] = c.accept;
  json["accept_index"] = c.accept_index;
  json["below_detection"] = c.below;
  json["depends_on"] = c.depends_on;
  json["name"] = c.name;
  json["family"] = c.family;
  json["chi2_gain"] = c.chi2_gain;
  json["dirty"] = c.dirty;
  Json first = Json::array(), second = Json::array();
  for (const auto& recording : c.recordings) {
    (recording.rows.first ? first : second).push_back(recording.name + ".csv.gz");
  }
  json["recordings"] = first;
  json["holdouts"] = second;
  return json.dump(1) + "\n";
}

}  // namespace

void write_light_case(const LightCase& c, const std::filesystem::path& folder) {
  write_file_whole(folder / "experiment.toml", experiment_text(c));
  if (c.verdict != "unexplained") write_file_whole(folder / "oracle.toml", oracle_text(c));
  write_file_whole(folder / "scene.gltf", scene_of(c.believed));
  for (size_t i = 0; i < c.recordings.size(); ++i) {
    write_file_whole(folder / (c.recordings[i].name + ".csv.gz"), gzip(recording_text(c, i)));
  }
  write_file_whole(folder / "truth.json", truth_text(c));
}

}  // namespace photorque
