// The program as a user meets it: exit statuses, messages, files.
#include <sstream>

#include "core/files.h"
#include "sources/photometry/ray_set.h"
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using testing::HasSubstr;

class CommandLine : public CommandTest {};

const std::string few_rays = " --set trace.rays=65536";

// Ten digits that no file of numbers holds by chance.
TEST_F(CommandLine, EveryFileCarriesProvenanceAndQuietPrintsNothing) {
  const std::string seed = "5915587277";
  const Outcome got =
      succeed("trace " + nominal_file + few_rays + " --quiet --seed " + seed + " --out " + at("o"));
  EXPECT_EQ(got.out + got.err, "");
  EXPECT_GT(files("o").size(), 10u);
  for (const auto& [file, bytes] : files("o")) {
    EXPECT_THAT(bytes, HasSubstr("photorque")) << file;
    EXPECT_THAT(bytes, HasSubstr(seed)) << file;
  }
}

TEST_F(CommandLine, JsonIsTheSummaryAndNothingElse) {
  const Outcome got = succeed("trace " + nominal_file + few_rays + " --json --out " + at("o"));
  EXPECT_EQ(got.out, file_text(folder_ / "o" / "summary.json"));
  EXPECT_THAT(got.out, HasSubstr("\"emitted_W\""));
}

// OpticalTruth.ShippedScenesRaiseNoWarning traces them.
TEST_F(CommandLine, EveryExperimentIsRendered) {
  for (const char* name : {"dumbbell/dumbbell.toml", "tabletop/tabletop.toml", "hollow/hollow.toml",
                           "spacecraft/spacecraft.toml"}) {
    succeed("render " + (shipped_scenes / name).string() + few_rays +
            " --set camera.width=160 --set camera.height=120 --out " + at("o"));
  }
}

// The Sun at azimuth 30, elevation 20 deg of the body is a source that shines from there on the
// body at rest.
TEST_F(CommandLine, TorqueMapTurnsTheBodyUnderTheSun) {
  const std::string craft = (shipped_scenes / "spacecraft" / "spacecraft.toml").string();
  succeed("torque-map " + craft +
          " --set torque_map={azimuth_deg=[30],elevation_deg=[20],rays=65536} --out " +
          at("turned"));
  const double cos_e = std::cos(20 * M_PI / 180), sin_e = std::sin(20 * M_PI / 180);
  std::ostringstream direction;
  direction << "[" << -cos_e * std::cos(M_PI / 6) << "," << -cos_e * std::sin(M_PI / 6) << ","
            << -sin_e << "]";
  succeed("torque-map " + craft + " --set source[0].direction=" + direction.str() +
          " --set torque_map={tilt_deg=[0],rays=65536} --seed 5 --out " + at("moved"));
  const auto turned = last_row(folder_ / "turned" / "wrench_table_body.csv");
  const auto moved = last_row(folder_ / "moved" / "wrench_table_body.csv");
  ASSERT_EQ(turned.size(), 14u);
  ASSERT_EQ(moved.size(), 14u);
  for (size_t i = 2; i < 8; ++i) {
    const double sigma = std::hypot(turned[i + 6], moved[i + 6]);
    EXPECT_GT(sigma, 0.0);
    EXPECT_NEAR(turned[i], moved[i], 4.0 * sigma) << i;
  }
}

double value_in(const std::string& summary, const std::string& key, const char* field) {
  const size_t at = summary.find(field, summary.find("\"" + key + "\""));
  return std::stod(summary.substr(summary.find(':', at) + 1));
}

TEST_F(CommandLine, ResultsAreLeanAndTheTextIsShort) {
  const std::string few = "power " + nominal_file + " --set trace.rays=65536 --out " + at("o");
  const auto has = [this](const std::string& name) { return fs::exists(folder_ / "o" / name); };
  const Outcome usual = succeed(few);
  EXPECT_LE(std::ranges::count(usual.out, '\n'), 30) << usual.out;
  for (const char* name : {"summary.json", "run.h5", "iv.csv", "iv_curve.png", "cell_power.png",
                           "irradiance_solar_array.exr", "irradiance_solar_array.tiff",
                           "irradiance_solar_array.csv", "irradiance_solar_array.png"}) {
    EXPECT_TRUE(has(name)) << name;
  }
  for (const char* name : {"iv_curve.svg", "iv_curve.pdf", "cell_power.exr", "cell_power.csv",
                           "irradiance_solar_array.vtkhdf"}) {
    EXPECT_FALSE(has(name)) << name;
  }
  const Outcome full = succeed(few + " --format exr,csv,vtkhdf,svg,pdf --style paper --verbose");
  EXPECT_GT(std::ranges::count(full.out, '\n'), 50);
  for (const char* name : {"iv_curve.svg", "iv_curve.pdf", "cell_power.exr", "cell_power.csv",
                           "cell_power.svg", "irradiance_solar_array.vtkhdf"}) {
    EXPECT_TRUE(has(name)) << name;
  }
  EXPECT_FALSE(has("cell_power.tiff"));
  // Letters are text.
  EXPECT_THAT(file_text(folder_ / "o" / "iv_curve.svg"), HasSubstr(">voltage [V]</text>"));
  EXPECT_THAT(refused(few + " --format jpeg"), HasSubstr("exr, tiff, png"));
  EXPECT_EQ(run(few + " --style poster").status, 2);
}

TEST_F(CommandLine, DirectLightIsTheSameGatheredAndByRays) {
  const Outcome got =
      succeed("trace " + nominal_file +
              " --set attitude.tilt_deg=30 --set trace.rays=262144 --verbose --out " + at("o"));
  EXPECT_THAT(got.out, HasSubstr("quadrature and rays differ by"));
  const std::string summary = file_text(folder_ / "o" / "summary.json");
  const double gathered = value_in(summary, "direct_on_solar_array_W", "\"value\"");
  const double rays = value_in(summary, "direct_by_rays_on_solar_array_W", "\"value\"");
  const double error = value_in(summary, "direct_by_rays_on_solar_array_W", "\"standard_error\"");
  EXPECT_GT(gathered, 10.0);
  EXPECT_GT(error, 0.0);
  EXPECT_NEAR(gathered, rays, 4 * error + 1e-5 * gathered);
}

TEST_F(CommandLine, ManyPairsAreLeftToTheRaysWithANote) {
  const std::string few_rays =
      "trace " + nominal_file + " --set trace.rays=65536 --verbose --out " + at("o");
  // 49 lamps over 640 × 640 bins: 2.01 s at 0.1 µs a pair.
  const Outcome left = succeed(few_rays + " --set receiver[0].bins=[640,640]");
  EXPECT_THAT(left.out, HasSubstr("by rays alone"));
  EXPECT_THAT(left.out, testing::Not(HasSubstr("\n  direct light on solar_array: quadrature")));
  const Outcome gathered = succeed(few_rays);
  EXPECT_THAT(gathered.out, HasSubstr("\n  direct light on solar_array: quadrature"));
}

// 90.15 % of 88 W reach the array (docs/validation.md).
TEST_F(CommandLine, ArrivingRaysCarryThePowerOnTheSurface) {
  const Outcome done =
      succeed("trace " + nominal_file +
              " --set trace.rays=65536 --set trace.arriving_rays=100000 --out " + at("o"));
  EXPECT_THAT(done.out, HasSubstr("rays_solar_array.tm25ray"));
  const RaySet rays = read_tm25(read_file(at("o/rays_solar_array.tm25ray")), "rays");
  EXPECT_GT(rays.rays.size(), 80'000u);
  EXPECT_NEAR(rays.ray_flux(), 0.9015 * 88.0, 0.005 * 88.0);
  EXPECT_NEAR(rays.stated_radiant_flux_W.value(), rays.ray_flux(), 1e-4);
  double min_m = 1.0, max_m = -1.0;
  for (const RaySet::Ray& ray : rays.rays) {
    EXPECT_NEAR(ray.direction.norm(), 1.0, 1e-6);
    EXPECT_LT(ray.direction.z(), -0.9);
    EXPECT_NEAR(ray.wavelength_m, 730e-9, 1e-13);
    min_m = std::min(min_m, ray.origin_m.z());
    max_m = std::max(max_m, ray.origin_m.z());
  }
  EXPECT_LT(max_m - min_m, 1e-6);  // a flat array
}

TEST_F(CommandLine, RaysAreAddedUntilTheTargetErrorIsReached) {
  const std::string base =
      "trace " + nominal_file + " --set trace.rays=4096 --set trace.direct=rays";
  succeed(base + " --out " + at("few"));
  succeed(base + " --target-error 0.2 --max-time 60 --out " + at("more"));
  const auto error = [&](const char* name) {
    return value_in(file_text(folder_ / name / "summary.json"), "relative_error_solar_array",
                    "\"value\"");
  };
  EXPECT_GT(error("few"), 0.2);
  EXPECT_LT(error("more"), 0.2);
}

struct WrongCall {
  std::string arguments, message;
};

TEST_F(CommandLine, WrongInputIsOneLineStatusTwoAndNoFiles) {
  const std::string base = "trace " + nominal_file + few_rays + " ";
  const std::vector<WrongCall> calls = {
      {"", "found no command"},
      {"trace", "found no experiment, expected one: photorque trace EXPERIMENT.toml"},
      {"fly " + nominal_file, "fly"},
      {"trace /nowhere/lab.toml", "/nowhere/lab.toml"},
      {"trace " + nominal_file + " --max-time 5", "target_error"},
      {"trace " + nominal_file + " --target-error 2", "target-error"},
      {"trace " + nominal_file + " --set trace.direct=magic", "gather"},
      {"torque-map " + nominal_file + " --set torque_map={azimuth_deg=[0],elevation_deg=[0]}",
       "sun"},
      {"torque-map " + nominal_file + " --set torque_map={azimuth_step_deg=7,elevation_deg=[0]}",
       "whole fraction of 360"},
      {"torque-map " + nominal_file + " --set torque_map={azimuth_deg=[0],tilt_deg=[0]}",
       "beside directions of light"},
      {"trace " + shipped_scenes.string(), "folder"},
      {base + "--threads many", "many"},
      {base + "--threads -1", "-1"},
      {base + "--set trace.ryas=4", "rays"},
      {base + "--set source[7].power_W=1", "source[7].power_W: found index 7, expected index 0"},
      {base + "--set nonsense", "nonsense"},
      {base + "--sett trace.rays=4",
       "--sett: found an unknown option, expected a known one, perhaps --set"},
      {base + nominal_file, "nominal.toml, expected nothing more"},
      {base + "--format jpg", "--format: found \"jpg\", expected one of exr"},
      {"schema --key source.power_W --json", "--json: found with --key"},
      {"schema --key source.powr_W",
       "found \"source.powr_W\", expected a key with its table, perhaps "
       "source.power_W"},
      {"budget " + attitude_file + " --set 'disturbance={kind=\"bearing_drag\"}'",
       "disturbance.kind: found \"bearing_drag\" without its keys, expected also "
       "coefficient_N_m_s"},
      {"budget " + attitude_file +
           " --set 'disturbance={kind=\"radiation_pressure\",table=\"no.csv\"}'",
       "disturbance.table: found \"no.csv\", expected an existing file"},
      {"power " + nominal_file + few_rays + " --set array.strings=7", "strings"},
      {"power " + nominal_file + few_rays + " --set array.cell=banana", "banana"},
      {"power " + (shipped_scenes / "spacecraft" / "spacecraft.toml").string(), "array"},
      {base + "--out /proc/nowhere/o", "/proc/nowhere"},
  };
  for (const WrongCall& call : calls) {
    const bool own_folder =
        call.arguments.find("--out") != std::string::npos || call.arguments.empty();
    EXPECT_THAT(refused(call.arguments + (own_folder ? "" : " --out " + at("o"))),
                HasSubstr(call.message))
        << call.arguments;
    EXPECT_FALSE(fs::exists(folder_ / "o")) << call.arguments;
  }
}

TEST_F(CommandLine, HelpAndVersion) {
  succeed("--help");
  EXPECT_THAT(run("--help").out, HasSubstr("torque-map"));
  EXPECT_THAT(run("--version").out, HasSubstr("photorque 0."));
}

}  // namespace
}  // namespace photorque
