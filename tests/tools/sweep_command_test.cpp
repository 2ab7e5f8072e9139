// The command sweep as a user meets it.
#include <cmath>

#include "tests/tools/sweep_test.h"

namespace photorque {
namespace {

using testing::HasSubstr;

class Sweep : public CommandTest {
 protected:
  // `photorque sweep` of a small experiment with a lamp far above STASIS, and this table [sweep].
  int sweep(const std::string& table, const std::string& options = "") {
    const std::string file = write(
        "e.toml",
        "[scene]\nfile = \"" PHOTORQUE_SOURCE_DIR
        "/scenes/stasis/stasis.gltf\"\n"
        "[trace]\nrays = 4096\n[[source]]\nkind = \"led\"\npower_W = 10\n"
        "aperture_diameter_mm = 20\nprofile = \"gaussian\"\nfwhm_deg = 3\n"
        "wavelength_nm = 730\nspectral_fwhm_nm = 30\nposition_m = [0, 0, 1]\naim_m = [0, 0, 0]\n"
        "[[receiver]]\nnode = \"solar_array\"\nbins = [10, 10]\n" +
            table);
    outcome_ = run("sweep " + file + " --out " + at("out") + " " + options);
    return outcome_.status;
  }
  std::string output() const { return outcome_.out; }
  std::string complained() const { return outcome_.err; }

 private:
  Outcome outcome_;
};

constexpr const char* grid = R"([sweep]
verb = "trace"
figures = ["emitted_W", "power_on_solar_array_W"]
axis = [{ key = "source[0].fwhm_deg", values = [1, 30] },
        { key = "source[0].power_W", from = 1, to = 100, count = 3, spacing = "logarithmic" }]
)";

TEST_F(Sweep, TakesEveryCombinationOfAGrid) {
  ASSERT_EQ(sweep(grid), 0) << complained();
  const auto table = csv_rows(folder_ / "out/sweep.csv");
  ASSERT_EQ(table.size(), 7u);
  EXPECT_EQ(table[0][1], "source[0].fwhm_deg");
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(std::stod(table[i + 1][1]), i < 3 ? 1.0 : 30.0);
    const double power_W = std::pow(10.0, static_cast<double>(i % 3));
    EXPECT_NEAR(std::stod(table[i + 1][2]), power_W, 1e-12 * power_W);
    EXPECT_NEAR(std::stod(table[i + 1][3]), power_W, 1e-12 * power_W);
    // A wide lamp loses light beside the array; light is linear in power, all else being equal.
    const double fraction = std::stod(table[i + 1][5]) / power_W;
    EXPECT_NEAR(fraction, std::stod(table[i < 3 ? 1 : 4][5]), 1e-9);
  }
  EXPECT_LT(std::stod(table[4][5]), 0.5 * std::stod(table[1][5]));
  EXPECT_TRUE(fs::exists(folder_ / "out/sweep_power_on_solar_array_W.png"));
}

TEST_F(Sweep, GoesOnWhereItStopped) {
  ASSERT_EQ(sweep(grid, "--shard 1/2"), 0) << complained();
  EXPECT_THAT(output(), HasSubstr("3 run now, 0 kept"));
  EXPECT_FALSE(fs::exists(folder_ / "out/sweep.csv"));
  ASSERT_EQ(sweep(grid), 0);
  EXPECT_THAT(output(), HasSubstr("3 run now, 3 kept"));
  const std::string first = file_text(folder_ / "out/sweep.csv");
  // Another experiment is another set of designs.
  ASSERT_EQ(sweep(grid, "--seed 9"), 0);
  EXPECT_THAT(output(), HasSubstr("6 run now, 0 kept"));
  EXPECT_NE(file_text(folder_ / "out/sweep.csv"), first);
}

TEST_F(Sweep, DrawsFromDistributions) {
  const std::string plan = R"([sweep]
verb = "trace"
designs = 64
figures = ["emitted_W"]
axis = [{ key = "source[0].power_W", mean = 10, sigma = 0.5 },
        { key = "source[0].fwhm_deg", from = 2, to = 4 }]
)";
  ASSERT_EQ(sweep(plan, "--set trace.direct='\"rays\"'"), 0) << complained();
  const auto table = csv_rows(folder_ / "out/sweep.csv");
  ASSERT_EQ(table.size(), 65u);
  double sum = 0.0, squares = 0.0, widths = 0.0;
  for (size_t i = 1; i < table.size(); ++i) {
    const double power_W = std::stod(table[i][1]), fwhm_deg = std::stod(table[i][2]);
    sum += power_W;
    squares += std::pow(power_W - 10.0, 2);
    widths += fwhm_deg;
    EXPECT_GT(fwhm_deg, 2.0);
    EXPECT_LT(fwhm_deg, 4.0);
  }
  // Far better than independent draws: 0.5/√64 = 0.06 would be their standard error.
  EXPECT_NEAR(sum / 64, 10.0, 0.02);
  EXPECT_NEAR(std::sqrt(squares / 64), 0.5, 0.05);
  EXPECT_NEAR(widths / 64, 3.0, 0.02);
}

TEST_F(Sweep, WrongInputIsOneLine) {
  const auto refuses = [&](const std::string& table, const std::string& word,
                           const std::string& options = "") {
    EXPECT_EQ(sweep(table, options), 2) << table;
    const std::string text = complained();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    EXPECT_THAT(text, HasSubstr(word));
    EXPECT_FALSE(fs::exists(folder_ / "out")) << table;
  };
  const std::string axis = "[[sweep.axis]]\nkey = \"source[0].power_W\"\n";
  refuses("", "sweep");
  refuses("[sweep]\nverb = \"trace\"\n", "axis");
  refuses("[sweep]\nverb = \"tracee\"\n" + axis + "values = [1]\n", "tracee");
  refuses("[sweep]\nverb = \"trace\"\nfigurs = [\"a\"]\n" + axis + "values = [1]\n", "figures");
  refuses("[sweep]\nverb = \"trace\"\n" + axis + "values = []\n", "values");
  refuses("[sweep]\nverb = \"trace\"\n" + axis + "values = [1, [2, nan]]\n", "finite");
  refuses("[sweep]\nverb = \"trace\"\n" + axis +
              "from = 0\nto = 2\ncount = 3\nspacing = \"logarithmic\"\n",
          "above zero");
  refuses("[sweep]\nverb = \"trace\"\n" + axis + "from = 0\nto = 2\ncount = 1\n", "count");
  refuses("[sweep]\nverb = \"trace\"\n[[sweep.axis]]\nkey = \"source[0].power_w\"\nvalues = [1]\n",
          "power_w");
  refuses("[sweep]\nverb = \"trace\"\ndesigns = 4\n" + axis + "values = [1, 2]\n",
          "found a list, in a plan with random designs");
  refuses(grid, "K/N", "--shard 3/2");
}

}  // namespace
}  // namespace photorque
