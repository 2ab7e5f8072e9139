// Effects of hostile numbers and names on a run: nothing but a result or one line.
#include <algorithm>

#include "core/text/format.h"
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

class Boundaries : public CommandTest {
 protected:
  // A plate in the light of a lamp of this name, and what else is to stand in the experiment.
  std::string plate(const std::string& lamp, const std::string& more) const {
    const std::filesystem::path tests = PHOTORQUE_SOURCE_DIR;
    return write("p.toml", "[scene]\nfile = \"" + (tests / "scenes/stasis/stasis.gltf").string() +
                               "\"\n[[source]]\nkind = \"led\"\nname = \"" + lamp +
                               "\"\npower_W = 1.0\naperture_diameter_mm = 20\n"
                               "profile = \"gaussian\"\nfwhm_deg = 6.0\nwavelength_nm = 730\n"
                               "position_m = [0.02, 0, 1.0]\naim_m = [0, 0, 0]\n"
                               "[[receiver]]\nnode = \"solar_array\"\nbins = [6, 6]\n"
                               "[trace]\nrays = 4096\n" +
                               more);
  }
};

// Embree asserted at 1e-300 deg and found no end at 1e-30 deg.
TEST_F(Boundaries, PicturesHaveALeastFieldOfView) {
  const std::string experiment = plate("lamp", "[camera]\nwidth = 32\nheight = 24\n");
  for (const char* angle : {"1e-300", "1e-30", "179.5"}) {
    EXPECT_THAT(refused("render " + experiment + " --set camera.field_of_view_deg=" + angle +
                        " --out " + at("o")),
                testing::HasSubstr("field_of_view_deg"))
        << angle;
  }
  succeed("render " + experiment + " --set camera.field_of_view_deg=0.001 --out " + at("o"));
}

// Titles, colours and the like of a terminal are not for names to set, nor formulae in CSV.
TEST_F(Boundaries, NamesReachTerminalsAndTablesClean) {
  const std::string name = "=\\u001b]0;PWNED\\u0007\\u001b[31m\\u009b31mRED";
  const std::string experiment =
      plate(name,
            "[array]\nreceiver = \"solar_array\"\ncells = [2, 2]\n[[published]]\n"
            "quantity = \"array_power_W\"\nvalue = 1\nsource = \"" +
                name + "\"\n");
  const Outcome outcome = succeed("power " + experiment + " --verbose --out " + at("o"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("PWNED"));
  const auto is_raw = [](unsigned char c) {
    return (c < 0x20 && c != '\n' && c != '\t') || c == 0x7f;
  };
  EXPECT_EQ(std::ranges::count_if(outcome.out, is_raw), 0);
  EXPECT_THAT(outcome.out, testing::Not(testing::HasSubstr("\u009b")));
  for (const auto& [file, text] : files("o")) {
    if (!file.ends_with(".csv")) continue;
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("\n="))) << file;
    EXPECT_THAT(text, testing::Not(testing::HasSubstr(",="))) << file;
  }
}

// Nor are command lines, files' names and the lists of check for terminals to obey.
TEST_F(Boundaries, ErrorsReachTerminalsCleanAndShort) {
  const std::string experiment = plate("lamp", "");
  const std::string name = "$(printf '\\033[31m\\233\\377')";
  for (const std::string& command :
       {"\"" + name + "\"", "trace \"--" + name + "\"", "trace " + experiment + " \"" + name + "\"",
        "trace \"" + at("") + name + ".toml\"", "schema --key \"" + name + "\"",
        "trace " + experiment + " --set \"" + name + "=1\"",
        "trace " + experiment + " --set \"source[0].name='" + name + "'\"",
        "trace " + experiment + " --out \"/etc/" + name + "\""}) {
    const std::string outcome = refused(command);
    EXPECT_EQ(clean_text(outcome), outcome.substr(0, outcome.size() - 1) + " ") << command;
  }
  refused("check " + experiment + " --set receiver[0].bins=[0,0]");
  std::string unknown;
  for (int i = 0; i < 2000; ++i) unknown += "[t" + std::to_string(i) + "]\n";
  const Outcome many = run("check " + plate("lamp", unknown));
  EXPECT_EQ(many.status, 2);
  EXPECT_THAT(many.err, testing::HasSubstr("more mistakes"));
  EXPECT_LT(std::ranges::count(many.err, '\n'), 60);
}

// 88 W of light over 5e-324 were infinitely many watts in losses.csv, with exit status 0.
TEST_F(Boundaries, EfficienciesKeepResultsFinite) {
  const std::string experiment =
      plate("lamp", "[array]\nreceiver = \"solar_array\"\ncells = [2, 2]\n");
  EXPECT_THAT(refused("power " + experiment +
                      " --set array.chain.wall_plug_efficiency=5e-324 --out " + at("o")),
              testing::HasSubstr("wall_plug_efficiency"));
}

// The address space ends before the libraries of pictures are loaded, or (at 620 MB) would end
// while they start threads, for which one of them waited without end.
TEST_F(Boundaries, LittleMemoryIsOneLineAndStatusThree) {
  const std::string experiment = plate("lamp", "");
  for (const int kibibytes : {620000, 450000, 400000}) {
    const Outcome got =
        shell("(ulimit -v " + std::to_string(kibibytes) + "; exec " + program_file + " trace " +
              experiment + " --quiet --threads 1 --out " + at("o") + ")");
    if (got.status == 0) continue;
    EXPECT_EQ(got.status, 3) << kibibytes << got.err;
    EXPECT_THAT(got.err, testing::AnyOf(testing::StartsWith("numerical failure: not enough memory"),
                                        testing::HasSubstr("Embree")))
        << kibibytes;
  }
}

// Too little memory for the stacks of threads was reported as too few threads.
TEST_F(Boundaries, LittleMemoryForDataIsNoLackOfThreads) {
  const Outcome got = shell("(ulimit -d 100000; exec " + program_file + " trace " +
                            plate("lamp", "") + " --quiet --threads 1 --out " + at("o") + ")");
  EXPECT_EQ(got.status, 3);
  EXPECT_THAT(got.err, testing::StartsWith("numerical failure: not enough memory"));
}

// The error of an earlier call of the system stood as the reason, and names of temporary folders.
TEST_F(Boundaries, FilesBeyondTheLimitAreNamedAsResults) {
  const std::string trace =
      "; exec " + program_file + " trace " + plate("lamp", "") + " --quiet --out " + at("o") + ")";
  EXPECT_THAT(refusal_in(shell("(ulimit -f 1" + trace)), testing::HasSubstr("(File too large)"));
  const std::string refusal = refusal_in(shell("(ulimit -f 16" + trace));
  EXPECT_THAT(refusal, testing::StartsWith(at("o/")));
  EXPECT_THAT(refusal, testing::Not(testing::HasSubstr(".part")));
}

// The limit does not hold for the superuser. Libraries of pictures aborted, or waited without end.
TEST_F(Boundaries, TooFewThreadsAreOneLineAndStatusThree) {
  const std::string other = ::geteuid() == 0 ? "setpriv --reuid=65534 --clear-groups " : "";
  if (std::system((other + program_file + " --version >/dev/null 2>&1").c_str()) != 0) {
    GTEST_SKIP() << "no other user can run the program";
  }
  const Outcome got = shell(other + "prlimit --nproc=8 " + program_file + " trace " +
                            plate("lamp", "") + " --quiet --out " + at("o"));
  EXPECT_EQ(got.status, 3);
  EXPECT_THAT(got.err, testing::ContainsRegex("^numerical failure: not enough .*\\(.*-u\\)\n$"));
}

TEST_F(Boundaries, ASmallStackIsRefused) {
  const Outcome got = shell("(ulimit -s 64; exec " + program_file + " trace " + plate("lamp", "") +
                            " --quiet --out " + at("o") + ")");
  EXPECT_EQ(got.status, 2);
  EXPECT_THAT(got.err, testing::HasSubstr("ulimit -s"));
}

// Integrals over the aperture of a lamp had a tolerance of zero, and no end.
TEST_F(Boundaries, NumbersBelowAllSizesAreRefused) {
  const std::string walls = source_folder + "/tests/data/keys/walls.toml";
  const std::string outcome = refused("check " + walls + " --set source[0].power_W=5e-324");
  EXPECT_THAT(outcome, testing::HasSubstr("power_W"));
  EXPECT_THAT(outcome, testing::HasSubstr("1e-100"));
  succeed("check " + walls + " --set source[0].power_W=1e-100");
}

// The last resort: faults that would end the program by a signal.
TEST_F(Boundaries, FaultsAreOneLineAndStatusThree) {
  const std::string command = program_file + " serve " + source_folder +
                              "/docs/realtime/stasis.toml --set serve.port=0 --out " + at("o") +
                              " >" + at("stdout") + " 2>" + at("err") +
                              " & p=$!; for i in $(seq 300); do"
                              " grep -q serving " +
                              at("stdout") +
                              " && break; sleep 0.1; done;"
                              " kill -ABRT $p; wait $p";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3);
  EXPECT_THAT(file_text(at("err")), testing::HasSubstr("numerical failure: a fault"));
}

// The short form of the campaign over all numeric keys; docs/reliability.md has the long one.
TEST_F(Boundaries, HostileNumbersEndWithOneLineOrAResult) {
  EXPECT_EQ(std::system(("python3 " + source_folder + "/tools/hostile " + program_file +
                         " --runs 12 --seed 1 --timeout 600 >" + at("said") + " 2>&1")
                            .c_str()),
            0)
      << file_text(at("said"));
}

}  // namespace
}  // namespace photorque
