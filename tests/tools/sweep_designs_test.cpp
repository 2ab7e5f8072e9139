// Designs: means, worst cases, constraints, the best, failures. A black plate at a tilt θ under the
// Sun takes P = E A cos θ; about a point h below it the light turns it with E A h sin θ cos θ / c.
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "scenes/experiment/document.h"
#include "scenes/experiment/toml.h"
#include "tests/tools/sweep_test.h"

namespace photorque {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Gathered light is integrated to 1e-5, and the Sun is a disc of half a degree.
constexpr double near_fraction = 3e-5;

class SweepDesigns : public SweepTest {
 protected:
  void SetUp() override {
    SweepTest::SetUp();
    write_plate();
  }
  static double power_W(double tilt_deg) {
    return sun_W_m2 * edge_m * edge_m * std::cos(tilt_deg * degree_rad);
  }
};

TEST_F(SweepDesigns, TakeEveryCombinationOfAGrid) {
  experiment(R"([sweep]
verb = "trace"
figures = ["power_on_plate_W"]
axis = [{ key = "attitude.tilt_deg", values = [0, 60] },
        { key = "source[0].irradiance_W_m2", from = 10, to = 1000, count = 3, spacing = "logarithmic" }]
)");
  ASSERT_EQ(sweep().status, 0);
  const auto table = csv_rows(at("out/sweep.csv"));
  ASSERT_EQ(table.size(), 7u);
  EXPECT_EQ(table[0][1], "attitude.tilt_deg");
  for (size_t i = 0; i < 6; ++i) {
    const double tilt_deg = i < 3 ? 0.0 : 60.0;
    const double irradiance_W_m2 = std::pow(10.0, 1.0 + static_cast<double>(i % 3));
    EXPECT_EQ(std::stod(table[i + 1][1]), tilt_deg);
    EXPECT_NEAR(std::stod(table[i + 1][2]), irradiance_W_m2, 1e-12 * irradiance_W_m2);
    const double exact_W = power_W(tilt_deg) * irradiance_W_m2 / sun_W_m2;
    EXPECT_NEAR(csv_column(at("out/sweep.csv"), "power_on_plate_W").at(i), exact_W,
                near_fraction * power_W(0) * irradiance_W_m2 / sun_W_m2);
  }
}

TEST_F(SweepDesigns, AverageOverAnIntervalIsItsIntegral) {
  experiment(R"([sweep]
verb = "trace"
figures = ["power_on_plate_W"]
axis = [{ key = "source[0].irradiance_W_m2", values = [1000, 500] }]
mean_over = [{ key = "attitude.tilt_deg", from = 0, to = 60, count = 4 }]
)");
  const Outcome got = sweep();
  ASSERT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out, HasSubstr("2 designs by `trace`, 4 runs each"));
  const auto mean_W = csv_column(at("out/sweep.csv"), "power_on_plate_W");
  ASSERT_EQ(mean_W.size(), 2u);
  const double sixty = 60 * degree_rad, exact_W = power_W(0) * std::sin(sixty) / sixty;
  EXPECT_NEAR(mean_W[0], exact_W, near_fraction * exact_W);
  EXPECT_NEAR(mean_W[1], 0.5 * exact_W, near_fraction * exact_W);
}

// Power E A and torque E A h sin θ cos θ/c are linear in E; with an edge known to 1 %, the power
// varies by 2 % more. Variances of independent inputs add up: the fractions are their parts.
TEST_F(SweepDesigns, SpreadIsThatOfTheUncertainInputs) {
  experiment(R"([sweep]
verb = "trace"
designs = 256
figures = ["power_on_plate_W"]
axis = [{ key = "source[0].irradiance_W_m2", name = "irradiance", mean = 1000, sigma = 30 },
        { key = "scene.metres_per_unit", name = "scale", mean = 1, sigma = 0.01 }]
)");
  const Outcome got = sweep();
  ASSERT_EQ(got.status, 0) << got.err;
  const double mean_W = csv_column(at("out/spread.csv"), "mean").front();
  const double spread_W = csv_column(at("out/spread.csv"), "standard_deviation").front();
  const double of_irradiance =
      csv_column(at("out/spread.csv"), "from source[0].irradiance_W_m2").front();
  const double of_scale = csv_column(at("out/spread.csv"), "from scene.metres_per_unit").front();
  // 3 % and twice 1 %: σ² = 9 + 4 in ten-thousandths, to second order in them.
  EXPECT_NEAR(mean_W, power_W(10.5), 1e-3 * power_W(10.5));
  EXPECT_NEAR(spread_W / mean_W, std::sqrt(13.0) * 1e-2, 0.02 * std::sqrt(13.0) * 1e-2);
  EXPECT_NEAR(of_irradiance, 9.0 / 13.0, 0.02);
  EXPECT_NEAR(of_scale, 4.0 / 13.0, 0.02);
  EXPECT_THAT(got.out, HasSubstr("irradiance"));
}

TEST_F(SweepDesigns, WeightsOfAMeanAreThoseGiven) {
  experiment(R"([sweep]
verb = "trace"
figures = ["power_on_plate_W"]
axis = [{ key = "source[0].irradiance_W_m2", values = [1000] }]
mean_over = [{ key = "attitude.tilt_deg", values = [0, 60], weights = [3, 1] }]
)");
  ASSERT_EQ(sweep().status, 0);
  const double exact_W = 0.75 * power_W(0) + 0.25 * power_W(60);
  EXPECT_NEAR(csv_column(at("out/sweep.csv"), "power_on_plate_W").at(0), exact_W,
              near_fraction * exact_W);
}

TEST_F(SweepDesigns, TheWorstIsTheOneThatHurts) {
  const std::string worst_over = "[[sweep.worst_over]]\nkey = \"attitude.tilt_deg\"\n";
  const std::string axis = "[[sweep.axis]]\nkey = \"source[0].irradiance_W_m2\"\nvalues = [1000]\n";
  experiment("[sweep]\nverb = \"trace\"\nmaximise = \"power_on_plate_W\"\n" + axis + worst_over +
             "values = [0, 50, 20]\n");
  ASSERT_EQ(sweep().status, 0);
  EXPECT_NEAR(figure("best_power_on_plate_W"), power_W(50), near_fraction * power_W(0));
  experiment("[sweep]\nverb = \"trace\"\nminimise = \"power_on_plate_W\"\n" + axis + worst_over +
             "values = [0, 50, 20]\n");
  ASSERT_EQ(sweep().status, 0);
  EXPECT_NEAR(figure("best_power_on_plate_W"), power_W(0), near_fraction * power_W(0));
}

constexpr const char* two_objectives = R"([sweep]
verb = "trace"
maximise = ["power_on_plate_W", "|torque_y_body_body_N_m|"]
axis = [{ key = "attitude.tilt_deg", values = [0, 20, 40, 60] }]
)";

TEST_F(SweepDesigns, NoneBeatsThoseOfTheParetoFront) {
  experiment(two_objectives, 65536);
  const Outcome got = sweep();
  ASSERT_EQ(got.status, 0) << got.err;
  // sin 2θ is 0, 0.64, 0.98, 0.87: more power and more torque at 40 than at 60.
  EXPECT_EQ(csv_column(at("out/sweep.csv"), "pareto"), (std::vector<double>{1, 1, 1, 0}));
  const auto torque_N_m = csv_column(at("out/sweep.csv"), "abs_torque_y_body_body_N_m");
  for (size_t i = 0; i < 4; ++i) {
    const double tilt = 20.0 * static_cast<double>(i) * degree_rad;
    const double exact_N_m =
        power_W(0) * height_m * std::sin(tilt) * std::cos(tilt) / speed_of_light_m_s;
    EXPECT_NEAR(torque_N_m[i], exact_N_m, 2e-3 * power_W(0) * height_m / speed_of_light_m_s);
  }
}

TEST_F(SweepDesigns, TheBestKeepsToTheConstraintsAndRunsAsItStands) {
  experiment(std::string(two_objectives) +
             "[[sweep.constraint]]\nfigure = \"power_on_plate_W\"\nat_most = " +
             std::to_string(0.5 * (power_W(20) + power_W(40))) + "\n");
  const Outcome got = sweep();
  ASSERT_EQ(got.status, 0) << got.err;
  EXPECT_EQ(csv_column(at("out/sweep.csv"), "feasible"), (std::vector<double>{0, 0, 1, 1}));
  EXPECT_THAT(got.out, HasSubstr("Best: design 3 of 4"));
  EXPECT_EQ(figure("best_design"), 3.0);
  EXPECT_NEAR(figure("nominal_power_on_plate_W"), power_W(10.5), near_fraction * power_W(0));
  succeed("trace " + at("out/best.toml") + " --out " + at("again"));
  EXPECT_EQ(figure("power_on_plate_W", "again"), figure("best_power_on_plate_W"));
  EXPECT_EQ(query(at("out/designs.sqlite"),
                  "SELECT \"attitude.tilt_deg\" FROM designs WHERE feasible = 1"),
            (std::vector<std::vector<std::string>>{{"40.0"}, {"60.0"}}));
}

// A text of an axis is a text of best.toml.
TEST_F(SweepDesigns, HostileTextsStayValues) {
  const std::string name = "a\"\n[evil]\nx = \"1\x1b[2J'''#";
  experiment(
      "[sweep]\nverb = \"trace\"\nmaximise = \"power_on_plate_W\"\n[[sweep.axis]]\n"
      "key = \"source[0].name\"\nvalues = [" +
      toml_value({name}) + "]\n");
  const Outcome got = sweep();
  ASSERT_EQ(got.status, 0) << got.err;
  const SettingsNode best = parse_toml(file_text(at("out/best.toml")), "best.toml");
  EXPECT_EQ(find_setting(best, "evil"), nullptr);
  const SettingsNode* written = find_setting(best, "source[0].name");
  ASSERT_NE(written, nullptr);
  EXPECT_EQ(std::get<std::string>(written->value), name);
}

TEST_F(SweepDesigns, ArePicturedWithNamesAndUnitsOfTheirAxes) {
  experiment(R"([sweep]
verb = "trace"
maximise = "power_on_plate_W"
minimise = "|torque_y_body_body_N_m|"
axis = [{ key = "attitude.tilt_deg", name = "lean", from = 0, to = 40, count = 3 },
        { key = "source[0].irradiance_W_m2", from = 500, to = 1000, count = 3 }]
)");
  ASSERT_EQ(sweep("--format svg,csv").status, 0);
  const auto has_picture = [this](const std::string& name) {
    return std::filesystem::exists(at("out/" + name + ".png"));
  };
  EXPECT_TRUE(has_picture("sweep_power_on_plate_W_map"));
  EXPECT_TRUE(has_picture("pareto_abs_torque_y_body_body_N_m"));
  // The title and the map's columns are text.
  EXPECT_THAT(file_text(at("out/sweep_power_on_plate_W.svg")),
              HasSubstr("<title>Power on plate over irradiance</title>"));
  EXPECT_EQ(
      csv_rows(at("out/sweep_power_on_plate_W_map.csv")).at(0),
      (std::vector<std::string>{"lean_deg", "irradiance_W_m2", "value_W", "standard_error_W"}));
  // The map's values are those of the table, the first axis along x.
  const auto table = csv_column(at("out/sweep.csv"), "power_on_plate_W");
  const auto map = csv_column(at("out/sweep_power_on_plate_W_map.csv"), "value_W");
  ASSERT_EQ(map.size(), 9u);
  for (size_t i = 0; i < 9; ++i) EXPECT_EQ(map[i], table[i % 3 * 3 + i / 3]);
  experiment(R"([sweep]
verb = "trace"
maximise = "power_on_plate_W"
designs = 8
axis = [{ key = "attitude.tilt_deg", from = 0, to = 40 },
        { key = "source[0].irradiance_W_m2", from = 500, to = 1000 }]
)");
  ASSERT_EQ(sweep().status, 0);
  EXPECT_TRUE(has_picture("sweep_power_on_plate_W_over_1"));
  EXPECT_TRUE(has_picture("sweep_power_on_plate_W_over_2"));
}

TEST_F(SweepDesigns, ThatFailAreNamedWithTheirError) {
  experiment(
      "[sweep]\nverb = \"trace\"\nmaximise = \"power_on_plate_W\"\n[[sweep.axis]]\n"
      "key = \"source[0].irradiance_W_m2\"\nvalues = [1, -3, 2]\n");
  const Outcome got = sweep();
  ASSERT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out, HasSubstr("WARNING: 1 of 3 designs failed"));
  EXPECT_THAT(file_text(at("out/sweep.csv")), HasSubstr("source[0].irradiance_W_m2: found -3"));
  EXPECT_THAT(std::string(summary()["warnings"][0]), HasSubstr("design 2: source[0]"));
  EXPECT_EQ(figure("best_design"), 3.0);
  // It may have been a full disk: the next run repeats only the failed runs.
  EXPECT_THAT(sweep().out, HasSubstr("1 run now, 3 kept from before"));
}

TEST_F(SweepDesigns, ThatAllFailLeaveNothing) {
  experiment(
      "[sweep]\nverb = \"trace\"\n[[sweep.axis]]\nkey = \"source[0].irradiance_W_m2\"\n"
      "values = [-1, -3]\n");
  EXPECT_THAT(refusal_in(sweep()),
              HasSubstr("e.toml: design 1 of 2: source[0].irradiance_W_m2: found -1"));
  EXPECT_FALSE(std::filesystem::exists(at("out")));
}

TEST_F(SweepDesigns, PlansThatMakeNoSenseAreOneLine) {
  const std::string begin = "[sweep]\nverb = \"trace\"\n",
                    key = "[[sweep.axis]]\nkey = \"attitude.tilt_deg\"\n",
                    axis = key + "values = [1]\n";
  const auto refuses = [&](const std::string& table, const std::string& words,
                           const std::string& options = "") {
    experiment(table);
    EXPECT_THAT(refusal_in(sweep(options)), HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(at("out"))) << table;
  };
  refuses("", "sweep");
  refuses(begin, "axis");
  refuses("[sweep]\nverb = \"tracee\"\n" + axis, "tracee");
  refuses(begin + "figurs = [\"a\"]\n" + axis, "figures");
  refuses(begin + key + "values = []\n", "values");
  refuses(begin + key + "values = [1, [2, nan]]\n", "finite");
  refuses(begin + key + "from = 0\nto = 2\ncount = 3\nspacing = \"logarithmic\"\n", "above zero");
  refuses(begin + key + "from = 0\nto = 2\ncount = 1\n", "count");
  refuses(begin + "[[sweep.axis]]\nkey = \"source[0].power_w\"\nvalues = [1]\n", "power_w");
  refuses(begin + "designs = 4\n" + key + "values = [1, 2]\n",
          "found a list, in a plan with random designs");
  refuses(begin + axis, "K/N", "--shard 3/2");
  refuses(begin + axis + "[[sweep.axis]]\nkey = \"attitude.tilt_rad\"\nvalues = [0.1]\n",
          "every quantity once");
  refuses(begin + axis + "[[sweep.worst_over]]\nkey = \"trace.seed\"\nvalues = [1, 2]\n",
          "no objective and no constraint");
  refuses(begin + axis + "[[sweep.mean_over]]\nkey = \"attitude.tilt_deg\"\nvalues = [1, 2]\n",
          "twice");
  refuses(begin + axis +
              "[[sweep.mean_over]]\nkey = \"trace.seed\"\nvalues = [1, 2]\nweights = "
              "[1]\n",
          "weights");
  refuses(begin + axis + "[[sweep.constraint]]\nfigure = \"emitted_W\"\n", "at_least");
  refuses(
      begin + axis + "[[sweep.constraint]]\nfigure = \"emitted_W\"\nat_least = 2\nat_most = 1\n",
      "at_most");
  refuses(begin + "maximise = \"power_on_plat_W\"\n" + axis, "perhaps \"power_on_plate_W\"");
  refuses(begin + "maximise = \"emitted_W\"\nminimise = \"emitted_W\"\n" + axis, "twice");
}

}  // namespace
}  // namespace photorque
