// improved.toml: the text of the user and the found effects, read back by the program.
#include "diagnosis/improved.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "attitude/propagation/run.h"
#include "core/constants.h"
#include "scenes/experiment/toml.h"
#include "tests/diagnosis/sample_diagnosis.h"

namespace photorque {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string written = R"(# My laboratory, as I know it.
[platform]
topology = "tabletop"
mass_kg = 8.7   # weighed twice
inertia_kg_m2 = [[0.116, 0, 0], [0, 0.119, 0], [0, 0, 0.183]]

[environment]
magnetic_field_T = [1.5e-6, 2e-5, -3.7e-5]

[[disturbance]]
kind = "static_unbalance"
offset_m = { value = [-8.7e-7, -2.7e-6, -4.3e-5], sigma = [5e-7, 5e-7, 3e-6] }

[sensors.camera]
noise_arcsec = [37, 37, 12]

[sensors.gyro]
noise_rad_s = 2e-4)";

Settings settings_from(const std::string& text) {
  return Settings(parse_toml(text, "improved.toml"));
}

std::string improved(const std::string& text, const Diagnosis& diagnosis) {
  return improved_experiment(TomlDocument(text, "written.toml"), diagnosis, ".");
}

TEST(Improved, KeepsTheUsersValuesAndComments) {
  Diagnosis d = sample_diagnosis();
  d.priors_refined.clear();
  d.effects.clear();
  d.replay.reset();
  const std::string text = improved(written, d);
  EXPECT_TRUE(same_values(parse_toml(text, "a"), parse_toml(written, "b")));
  EXPECT_THAT(text, StartsWith("# Written by photorque diagnose: " + d.sentence + "\n"));
  for (const char* kept : {"# My laboratory, as I know it.\n[platform]\n", "  # weighed twice\n"}) {
    EXPECT_THAT(text, HasSubstr(kept));
  }
}

// Names come from files of others: with any content they stay values of their keys.
TEST(Improved, HostileNamesAddNoTable) {
  for (const std::string name : {"wall\"\n[evil]\nx = \"1", "a'''\"\"\"\r\n[[evil]]",
                                 "\x1b[2J\x07\\", "# comment", "x\u0085\u2028y"}) {
    Diagnosis d = sample_diagnosis();
    d.sentence = d.effects[0].explanation = name;
    d.effects[0].indistinguishable_from = {name};
    d.effects[1] = {"wall_reflectance", 0.9, {{"factor", {0.5}, {0.1}}}, {name}, name};
    d.effects[1].table = "effect";
    d.effects[1].texts = {{"node", name}};
    d.priors_refined.push_back({name, {1.0}, {0.1}});
    d.replay->recording = name;
    d.replay->has_commands = true;
    EmpiricalTorque torque;
    torque.variable = torque.formula = torque.looks_like = name;
    d.empirical = {torque};
    const SettingsNode root = parse_toml(improved(written, d), "improved.toml");
    const auto& tables = std::get<SettingsNode::Table>(root.value);
    EXPECT_EQ(tables.size(), 6u) << name;  // those written, [[effect]] and [propagate]
    const SettingsNode* node = find_setting(root, "effect[0].node");
    ASSERT_NE(node, nullptr);
    EXPECT_EQ(std::get<std::string>(node->value), name);
    EXPECT_EQ(std::get<std::string>(find_setting(root, "propagate.commands")->value), name);
  }
}

// In an inline table, under a dotted key, in a table within a table.
TEST(Improved, FindsKeysWithoutAHeaderOfTheirOwn) {
  Diagnosis d = sample_diagnosis();
  d.effects.clear();
  d.replay.reset();
  d.priors_refined = {{"source[0].power_W", {3.5}, {0.25}}, {"array.loss.ohmic_W", {2.0}, {0.5}}};
  for (const char* text : {"source = [{ power_mW = { value = 3000, sigma = 200 }, name = \"a\" }]\n"
                           "array.loss.ohmic_W = 1\n",
                           "array = { loss = { ohmic_W = 1 } }\n[source]\npower_W = 3 # stated\n"
                           "name = '''\na'''\n"}) {
    const SettingsNode root = parse_toml(improved(text, d), "improved.toml");
    EXPECT_EQ(std::get<double>(find_setting(root, "source[0].power_W.value")->value), 3.5);
    EXPECT_EQ(std::get<int64_t>(find_setting(root, "array.loss.ohmic_W.value")->value), 2);
    EXPECT_EQ(find_setting(root, "source[0].power_mW"), nullptr);
    EXPECT_EQ(std::get<std::string>(find_setting(root, "source[0].name")->value), "a");
  }
}

// Uncertain values act as fitted; as it was written it stays as a comment.
TEST(Improved, PutsFittedNominalValuesInTheirPlaces) {
  const std::string text = improved(written, sample_diagnosis());
  const Disturbance unbalance = read_attitude_model(settings_from(text)).model.disturbances.at(0);
  const double value[] = {1e-6, 2e-6, -3e-5};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(unbalance.parameters[i].value, value[i]);
    EXPECT_DOUBLE_EQ(unbalance.parameters[i].sigma, 1e-8);
  }
  EXPECT_THAT(text,
              HasSubstr("# before the fit: offset_m = { value = [-8.7e-07, -2.7e-06, -4.3e-05]"));
  for (const char* kept :
       {"mass_kg = 8.7  # weighed twice", "[sensors.gyro]\nnoise_rad_s = 2e-04"}) {
    EXPECT_THAT(text, HasSubstr(kept));
  }
}

// Nominal values of the second disturbance, in another unit, over several lines, beside comments
// and brackets in texts. Values in an unsupported form appear in a comment.
TEST(Improved, FindsNominalValuesHoweverTheyAreWritten) {
  const std::string many = R"([platform]
topology = "tabletop"
mass_kg = 8.7
inertia_kg_m2 = [[0.116, 0, 0], [0, 0.119, 0], [0, 0, 0.183]]
[[disturbance]]
kind = "bearing_drag"   # not [this]
coefficient_N_m_s = { value = 2e-5, sigma = 1e-6 }
[[ disturbance ]]
kind = "static_unbalance"
offset_um = [   # micrometres
  1, 2,         # across ]
  -40
]               # along
[environment]
latitude_deg = 40
)";
  Diagnosis d = sample_diagnosis();
  d.effects.clear();
  d.priors_refined = {{"disturbance[1].offset_m", {3e-6, 4e-6, -5e-5}, {1e-8, 1e-8, 1e-8}},
                      {"disturbance[7].scale", {1.5}, {0.5}}};
  const std::string text = improved(many, d);
  const AttitudeModel model = read_attitude_model(settings_from(text)).model;
  EXPECT_DOUBLE_EQ(model.disturbances.at(0).parameters[0].value, 2e-5);
  EXPECT_DOUBLE_EQ(model.disturbances.at(1).parameters[0].value, 3e-6);
  EXPECT_DOUBLE_EQ(model.disturbances.at(1).parameters[2].value, -5e-5);
  EXPECT_THAT(text, HasSubstr("# disturbance[7].scale = "));
  EXPECT_THAT(text, HasSubstr("# along\n"));
}

// Those of light: of the second source, of an override within the array, of the attitude.
TEST(Improved, FindsNominalValuesOfLight) {
  const std::string lamps = R"([[source]]
power_W = { value = 3, sigma = 0.2 }
[[source]]
kind = "led"
power_mW = { value = 4000, sigma = 200 }
[array]
receiver = "array"
[[array.cell_override]]
index = 2
shunt_ohm = { value = 9, sigma = 2 }
[ attitude ]
tilt_deg = { value = 12, sigma = 0.5 }
)";
  Diagnosis d = sample_diagnosis();
  d.effects.clear();
  d.replay.reset();
  d.priors_refined = {{"array.cell_override[0].shunt_ohm", {8.0}, {0.5}},
                      {"attitude.tilt_deg", {12.25}, {0.125}},
                      {"source[1].power_W", {3.75}, {0.0625}}};
  const SettingsNode refined = parse_toml(improved(lamps, d), "improved.toml");
  const auto number = [&](const std::string& key) {
    const SettingsNode* node = find_setting(refined, key);
    EXPECT_NE(node, nullptr) << key;
    if (node == nullptr) return 0.0;
    const auto* whole = std::get_if<int64_t>(&node->value);
    return whole != nullptr ? static_cast<double>(*whole) : std::get<double>(node->value);
  };
  EXPECT_EQ(number("source[0].power_W.value"), 3.0);
  EXPECT_EQ(number("source[1].power_W.value"), 3.75);
  EXPECT_EQ(number("source[1].power_W.sigma"), 0.0625);
  EXPECT_EQ(number("array.cell_override[0].shunt_ohm.value"), 8.0);
  EXPECT_EQ(number("attitude.tilt_deg.value"), 12.25);
  EXPECT_EQ(find_setting(refined, "source[1].power_mW"), nullptr);
}

TEST(Improved, ActsWithTheFittedNumbersAndTheirErrors) {
  const std::string text = improved(written, sample_diagnosis());
  const AttitudeModel model = read_attitude_model(settings_from(text)).model;
  ASSERT_GE(model.disturbances.size(), 3u);
  const Disturbance& dipole = model.disturbances[1];
  ASSERT_EQ(dipole.kind, "magnetic_dipole");
  const double value[] = {0.0126, 0.0288, -0.0193}, sigma[] = {2e-4, 3e-4, 1.1e-3};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(dipole.parameters[i].value, value[i]);
    EXPECT_DOUBLE_EQ(dipole.parameters[i].sigma, sigma[i]);
  }
  const Disturbance& latency = model.disturbances[2];
  ASSERT_EQ(latency.kind, "attitude_latency");
  EXPECT_DOUBLE_EQ(latency.parameters[0].value, 0.08);
}

TEST(Improved, PropagatesTheFirstRecordingAgain) {
  const std::string text = improved(written, sample_diagnosis());
  const PropagationRun run = read_propagation(settings_from(text));
  EXPECT_DOUBLE_EQ(run.duration_s, 200.0);
  EXPECT_DOUBLE_EQ(run.initial.rate_body_rad_s.z(), 0.1);
  EXPECT_EQ(propagate(run).recording.rows(), 2001u);
}

// An appendage that swings begins as it was fitted, but in a run of the user's.
TEST(Improved, StartsWithTheAppendage) {
  Diagnosis d = sample_diagnosis();
  d.effects = {{"flexible_mode",
                0.9,
                {{"axis", {0, 0, 1}, {}},
                 {"frequency_Hz", {0.7}, {}},
                 {"damping", {0.01}, {}},
                 {"inertia_kg_m2", {0.01}, {}}},
                {},
                ""}};
  d.effects[0].initial_states = {{"initial_angle_deg", {0.5}, {}},
                                 {"initial_rate_rad_s", {-0.02}, {}}};
  const PropagationRun run = read_propagation(settings_from(improved(written, d)));
  ASSERT_EQ(run.initial.extra.size(), 2u);
  EXPECT_NEAR(run.initial.extra[0], 0.5 * pi / 180.0, 1e-12);
  EXPECT_NEAR(run.initial.extra[1], -0.02, 1e-12);
  const std::string own = written + "\n[propagate]\nduration_s = 5\n";
  EXPECT_EQ(read_propagation(settings_from(improved(own, d))).initial.extra[0], 0.0);
}

// Every effect that a diagnosis may name, as it would be written.
TEST(Improved, HoldsEveryKindWithNumbers) {
  const std::string seen_by_markers = std::regex_replace(
      written, std::regex("noise_arcsec = .*"),
      "markers_m = [[0, 0, 0.03], [0.08, 0, 0.03], [0, 0.08, 0.03]]\nintensity_W_sr = 17e-6\n"
      "focal_length_mm = 8\npixel_um = 4.8\nresolution = [1280, 1024]\nexposure_s = 45e-6\n"
      "position_m = [0, 0, 1]");
  const std::vector<std::pair<std::string, std::vector<FittedParameter>>> found = {
      {"static_unbalance", {{"offset_m", {1e-6, 2e-6, 3e-6}, {1e-8, 1e-8, 1e-8}}}},
      {"mass_shift", {{"time_s", {31.0}, {0.1}}, {"offset_m", {1e-6, 0, 0}, {1e-8, 1e-8, 1e-8}}}},
      {"battery_discharge", {{"shift_m_per_Ah", {1e-6, 0, 0}, {1e-8, 1e-8, 1e-8}}}},
      {"elastic_sag", {{"compliance_s2", {1e-8, 1e-8, 1e-8}, {1e-9, 1e-9, 1e-9}}}},
      {"bearing_drag", {{"coefficient_N_m_s", {1e-5}, {1e-7}}}},
      {"turbine_torque", {{"torque_N_m", {1e-6}, {1e-8}}}},
      {"dry_friction", {{"torque_N_m", {1e-6}, {1e-8}}}},
      {"air_friction", {{"coefficient", {1e-5}, {1e-7}}}},
      {"air_pressure_drag", {{"coefficient_N_m_s2", {1e-4}, {1e-6}}}},
      {"room_draft", {{"torque_lab_N_m", {1e-6, 0, 0}, {1e-8, 1e-8, 1e-8}}}},
      {"eddy_damping", {{"coefficient_N_m_s_per_T2", {1e3}, {1e2}}}},
      {"gravity_gradient", {}},
      {"earth_rotation", {}},
      {"rotor_momentum", {{"momentum_N_m_s", {1e-3, 0, 0}, {1e-5, 1e-5, 1e-5}}}},
      {"tether", {{"stiffness_N_m_per_rad", {1e-5}, {1e-7}}}},
      {"floor_vibration",
       {{"acceleration_m_s2", {0.01, 0, 0}, {1e-3, 1e-3, 1e-3}},
        {"frequency_Hz", {0.7}, {1e-4}},
        {"phase", {0.3}, {0.01}}}},
      {"periodic_torque",
       {{"torque_N_m", {1e-5, 0, 0}, {1e-7, 1e-7, 1e-7}},
        {"frequency_Hz", {0.7}, {1e-4}},
        {"phase", {0.3}, {0.01}}}},
      {"flexible_mode",
       {{"axis", {0, 0, 1}, {0, 0.01, 0.01}},
        {"frequency_Hz", {0.7}, {1e-4}},
        {"damping", {0.01}, {1e-3}},
        {"inertia_kg_m2", {0.01}, {1e-4}}}},
      {"actuator_gain", {{"gain_error", {0.1}, {0.01}}}},
      {"inertia_error",
       {{"delta_kg_m2", {1e-3, 0, 0, 0, 0, 0}, {1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4}}}},
      {"gravity_tilt", {{"tilt_rad", {1e-3, 0}, {1e-5, 1e-5}}}},
      {"gyro_bias", {{"bias_rad_s", {1e-3, 0, 0}, {1e-5, 1e-5, 1e-5}}}},
      {"gyro_scale", {{"scale", {1e-3, 0, 0}, {1e-5, 1e-5, 1e-5}}}},
      {"gyro_misalignment", {{"misalignment_rad", {1e-3, 0, 0}, {1e-5, 1e-5, 1e-5}}}},
      {"camera_misalignment", {{"misalignment_rad", {1e-3, 0, 0}, {1e-5, 1e-5, 1e-5}}}},
      {"marker_positions", {{"marker", {2}, {}}, {"error_m", {1e-4, 0, 0}, {1e-5, 1e-5, 1e-5}}}},
  };
  for (const auto& [kind, parameters] : found) {
    Diagnosis d = sample_diagnosis();
    d.effects = {{kind, 0.9, parameters, {}, ""}};
    const std::string text = improved(seen_by_markers, d);
    EXPECT_NO_THROW({
      const AttitudeModel model = read_attitude_model(settings_from(text)).model;
      EXPECT_EQ(model.disturbances.at(1).kind, kind);
    }) << kind;
  }
}

// A torque without a law is written as the disturbance that was fitted.
TEST(Improved, HoldsAnEmpiricalTorque) {
  Diagnosis d = sample_diagnosis();
  d.effects.clear();
  d.unnamed = {{"turbine_torque", 0.5, {{"torque_N_m", {1e-6}, {1e-8}}}, {}, ""}};
  EmpiricalTorque torque;
  torque.variable = "tilt";
  torque.formula = "T = a\nb";
  torque.shape = {{"axes", "[\"lean\", \"vertical\"]"}, {"tilt_reference_deg", "5.5"}};
  torque.parameters = {{"tilt_exponent", {2.9}, {0.1}},
                       {"coefficients_N_m", {1e-6, -2e-6}, {1e-8, 2e-8}}};
  d.empirical = {torque};
  const std::string text = improved(written, d);
  const AttitudeModel model = read_attitude_model(settings_from(text)).model;
  ASSERT_EQ(model.disturbances.size(), 3u);
  EXPECT_EQ(model.disturbances[1].kind, "turbine_torque");
  const Disturbance& found = model.disturbances[2];
  ASSERT_EQ(found.kind, "empirical_torque");
  const double value[] = {2.9, 1e-6, -2e-6}, sigma[] = {0.1, 1e-8, 2e-8};
  ASSERT_EQ(found.parameters.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(found.parameters[i].value, value[i]);
    EXPECT_DOUBLE_EQ(found.parameters[i].sigma, sigma[i]);
  }
}

}  // namespace
}  // namespace photorque
