// `diagnose --guess`: an experiment for a recording of which nothing else is at hand.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "attitude/recordings/text_lines.h"
#include "core/constants.h"
#include "tests/outside.h"
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using testing::HasSubstr;

class GuessCommand : public CommandTest {
 protected:
  // A guess from a recording, then a diagnosis with it as it stands.
  nlohmann::json diagnosed(const fs::path& recording) const {
    succeed("diagnose --guess " + recording.string() + " --out " + at("guess"));
    fs::path name = recording.filename();
    while (name.has_extension()) name = name.stem();
    const Outcome got =
        succeed("diagnose " + at("guess/" + name.string() + ".toml") + " --recording " +
                recording.string() + " --json --quiet --out " + at("out"));
    fs::remove_all(at("guess"));
    return got.status == 0 ? nlohmann::json::parse(got.out) : nlohmann::json();
  }
  // A copy with one row of `of`, the header kept.
  fs::path thinned(const fs::path& recording, int of) const {
    TextLines lines(recording);
    std::string text;
    std::string_view line;
    for (int row = -1; lines.next(line);) {
      if (line.starts_with("#")) continue;
      if (row < 0 || row % of == 0) text += std::string(line) + "\n";
      ++row;
    }
    return write("thinned.csv", text);
  }
};

// A swing of 0.8 Hz with a decaying amplitude, as numbers alone: with a time, with frames that a
// camera dropped, and one reading per line.
TEST_F(GuessCommand, ReadsNumbersWithoutHeaderOrTime) {
  std::string timed, frames = "frame;theta (degrees)\n", bare;
  for (int i = 0; i < 1500; ++i) {
    const double t_s = 0.02 * i,
                 angle_deg = 30.0 * std::exp(-0.03 * t_s) * std::cos(2.0 * pi * 0.8 * t_s);
    const std::string angle = std::to_string(angle_deg);
    timed += std::to_string(t_s) + "\t" + angle + "\n";
    if (i % 7 != 3) frames += std::to_string(i) + ";" + angle + "\n";
    bare += angle + "\n";
  }
  // Stiffness over inertia and drag over inertia, by the diagnosis with the guess.
  const auto found_in = [&](const std::string& file, const std::string& options) {
    const std::string name = fs::path(file).stem().string(), folder = at("guess_" + name);
    succeed("diagnose --guess " + file + " " + options + " --out " + folder);
    const Outcome got = succeed("diagnose " + folder + "/" + name + ".toml --recording " + file +
                                " --json --quiet --out " + folder + "/out");
    std::map<std::string, double> found;
    const auto diagnosis = nlohmann::json::parse(got.out);
    for (const auto& effect : diagnosis["effects"]) {
      for (const auto& [key, parameter] : effect["parameters"].items()) {
        found[key] = parameter["value"];
      }
    }
    return found;
  };
  // θ = A exp(−δ t) cos ω t: stiffness ω² + δ², drag 2 δ.
  constexpr double omega = 2.0 * pi * 0.8, delta = 0.03;
  for (const auto& [file, options] : std::map<std::string, std::string>{
           {write("timed.txt", timed), "--columns t_s,angle_deg"},
           {write("frames.csv", frames), "--fps 50"},
           {write("bare.txt", bare), "--columns angle_deg --rate-Hz 50"}}) {
    const auto found = found_in(file, options);
    ASSERT_THAT(found, testing::SizeIs(3)) << file;
    EXPECT_NEAR(found.at("stiffness_N_m_per_rad"), omega * omega + delta * delta, 1e-3) << file;
    EXPECT_NEAR(found.at("coefficient_N_m_s"), 2.0 * delta, 1e-4) << file;
  }
  EXPECT_THAT(refused("diagnose --guess " + at("frames.csv")), HasSubstr("--rate-Hz 30"));
  EXPECT_THAT(
      refused("diagnose --guess " + at("timed.txt") + " --columns t_s,angle_deg --rate-Hz 50"),
      HasSubstr("only one of them"));
}

TEST_F(GuessCommand, PrintsItsFilesAndKeepsChangedOnes) {
  std::string rows = "t_s,angle_deg\n";
  for (int i = 0; i < 100; ++i) rows += std::to_string(i) + "," + std::to_string(i * i) + "\n";
  const std::string recording = write("disc.csv", rows);
  const Outcome first = succeed("diagnose --guess " + recording + " --out " + at("guess"));
  const std::string text = file_text(at("guess/disc.toml"));
  EXPECT_THAT(text, HasSubstr("topology = \"one_axis\""));
  EXPECT_EQ(first.out.substr(0, text.size()), text);
  EXPECT_THAT(first.out, HasSubstr("# photorque diagnose " + at("guess/disc.toml")));
  // A repeated guess is no loss; what was confirmed would be.
  succeed("diagnose --guess " + recording + " --out " + at("guess"));
  write("guess/disc.toml", text + "# confirmed\n");
  EXPECT_THAT(refused("diagnose --guess " + recording + " --out " + at("guess")),
              HasSubstr("another file of this name"));
  EXPECT_THAT(file_text(at("guess/disc.toml")), HasSubstr("# confirmed"));
}

// The printed text is an experiment whatever the name of the recording is, and the suggested
// command names the recording to a shell.
TEST_F(GuessCommand, PrintsNamesWithLineEndsOnOneLine) {
  std::string rows = "t_s,angle_deg\n";
  for (int i = 0; i < 100; ++i) rows += std::to_string(i) + "," + std::to_string(i * i) + "\n";
  write("a\n[evil]; b.csv", rows);
  const Outcome got = succeed("diagnose --guess \"$(printf '" + at("a") +
                              "\\n[evil]; b.csv')\" --out " + at("guess"));
  EXPECT_THAT(got.out, testing::Not(HasSubstr("\n[evil]")));
  EXPECT_THAT(got.out,
              HasSubstr("# photorque diagnose $'" + at("guess/a") + "\\012[evil]; b.toml'" +
                        " --recording $'" + at("a") + "\\012[evil]; b.csv'\n"));
}

// Nothing carries what turns in an inertial frame.
TEST_F(GuessCommand, AnAttitudeInSpaceIsThatOfAFreeBody) {
  const auto topology = [&](const std::string& frame) {
    std::string text =
        "CCSDS_AEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = TEST\nMETA_START\n"
        "OBJECT_NAME = A\nOBJECT_ID = B\nREF_FRAME_A = " +
        frame +
        "\nREF_FRAME_B = SC_BODY_1\nTIME_SYSTEM = UTC\nSTART_TIME = 2026-01-01T00:00:00\n"
        "STOP_TIME = 2026-01-01T00:01:00\nATTITUDE_TYPE = QUATERNION\nMETA_STOP\nDATA_START\n";
    for (int i = 0; i < 60; ++i) {
      const double half = 0.01 * i + 0.1 * std::sin(0.3 * i);
      char row[120];
      std::snprintf(row, sizeof row, "2026-01-01T00:00:%02d 0 %.9f 0 %.9f\n", i, std::sin(half),
                    std::cos(half));
      text += row;
    }
    const fs::path file = write(frame + ".aem", text + "DATA_STOP\n");
    succeed("diagnose --guess " + file.string() + " --out " + at("guess"));
    return file_text(at("guess/" + frame + ".toml"));
  };
  EXPECT_THAT(topology("J2000"), HasSubstr("topology = \"free\""));
  EXPECT_THAT(topology("LAB"), HasSubstr("topology = \"tabletop\""));
  const fs::path orbit = write("states.oem", "CCSDS_OEM_VERS = 2.0\n");
  EXPECT_THAT(refused("diagnose --guess " + orbit.string()), HasSubstr("a CCSDS message OEM"));
}

TEST_F(GuessCommand, NeedsOneOfTheTwo) {
  EXPECT_THAT(run("diagnose").err, HasSubstr("experiment is required, or --guess RECORDING"));
  const Outcome both = run("diagnose a.toml --guess b.csv");
  EXPECT_EQ(both.status, 2);
  EXPECT_THAT(both.err, HasSubstr("both an experiment and --guess"));
  EXPECT_EQ(run("diagnose --guess " + at("none.csv") + " --out " + at("guess")).status, 2);
  EXPECT_FALSE(fs::exists(at("guess")));
}

TEST_F(GuessCommand, ACurveThatOneDiodeDoesNotDescribeIsNotConsistentWithItself) {
  // Two thirds of a string in the light, one in half of it behind a bypass diode: a step at 14 V.
  std::string rows = "voltage_V,current_A\n";
  for (int i = 0; i <= 120; ++i) {
    const double volt = 0.175 * i;
    const double bright = 5.0 - 2.5 * std::min(1.0, std::exp((volt - 14.0) / 0.4));
    const double dim = 2.5 * std::exp((volt - 21.0) / 0.6);
    rows += std::to_string(volt) + "," + std::to_string(bright - dim) + "\n";
  }
  const nlohmann::json answer = diagnosed(write("stepped.csv", rows));
  EXPECT_EQ(answer.at("verdict"), "unexplained");
  EXPECT_THAT(answer.at("because").get<std::string>(), HasSubstr("its own reference"));
}

// Recordings of other machines (docs/real.md): what their guess says is taken as it is.
TEST_F(GuessCommand, RealRecordingsAreDiagnosedByTheirGuess) {
  PHOTORQUE_NEEDS_THIRD_PARTY("recordings");
  const fs::path real = photorque::outside::third_party("recordings");
  using testing::Contains;
  // 4000 rows a second would take five times as long and say no more.
  EXPECT_THAT(kinds_in(diagnosed(thinned(real / "throw_flywheel/body_37.csv.gz", 8))),
              Contains("wheel_momentum"));
  EXPECT_THAT(kinds_in(diagnosed(real / "racquet_tumble/flight_081.csv.gz")),
              Contains("air_pressure_drag"));
  EXPECT_THAT(kinds_in(diagnosed(real / "wheel_coastdown/grandprix406_left_120psi.csv.gz")),
              Contains("air_pressure_drag"));
  EXPECT_EQ(diagnosed(real / "pv_iv_shading/curve_058.csv.gz").at("verdict"), "consistent");
  EXPECT_EQ(diagnosed(real / "pv_iv_shading/curve_067.csv.gz").at("verdict"), "unexplained");
  EXPECT_EQ(diagnosed(real / "pv_cracked/module_before.csv").at("verdict"), "consistent");
  const nlohmann::json roll = diagnosed(real / "k2_roll/roll_days_0_50.csv.gz");
  EXPECT_EQ(roll.at("verdict"), "unexplained");
  // It turns about one axis: torques about the others are not fitted and have no error. Cosines are
  // at most 1: about that axis the error is at most the sum of those of the coefficients.
  const nlohmann::json& torque = roll.at("empirical_torque").at(0);
  double most_N_m = 0.0;
  for (const double sigma_N_m : torque.at("parameters").at("coefficients_N_m").at("sigma")) {
    most_N_m += sigma_N_m;
  }
  for (const nlohmann::json& error_N_m : torque.at("standard_error_N_m")) {
    EXPECT_EQ(std::count(error_N_m.begin(), error_N_m.end(), 0.0), 2);
    EXPECT_LE(*std::max_element(error_N_m.begin(), error_N_m.end()), most_N_m);
  }
}

}  // namespace
}  // namespace photorque
