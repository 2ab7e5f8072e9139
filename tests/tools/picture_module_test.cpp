// The program loads the library of pictures when it needs it, not before; without it a run is
// refused before its work.
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using testing::HasSubstr;
using testing::Not;

const fs::path built = PHOTORQUE_BINARY_DIR;

class PictureModule : public CommandTest {
 protected:
  // The program in a separate folder.
  Outcome run_copy(const std::string& arguments, const std::string& environment = "") const {
    return shell(environment + at("bin/photorque") + " " + arguments);
  }
  void copy_program() const {
    fs::create_directories(at("bin"));
    fs::copy_file(built / "photorque", at("bin/photorque"));
  }
};

TEST_F(PictureModule, IsNotLinkedByTheProgram) {
  copy_program();
  const Outcome libraries = run_copy("", "LD_TRACE_LOADED_OBJECTS=1 ");
  EXPECT_THAT(libraries.out, HasSubstr("libhdf5"));
  EXPECT_THAT(libraries.out, Not(HasSubstr("OpenImageIO")));
  // Commands without pictures need no module.
  EXPECT_EQ(run_copy("--version").status, 0);
  EXPECT_EQ(run_copy("--man").status, 0);
}

TEST_F(PictureModule, IsMissedInOneLineBeforeTheWork) {
  copy_program();
  EXPECT_THAT(
      refusal_in(run_copy("trace " + nominal_file + " --set trace.rays=3e10 --out " + at("o"))),
      HasSubstr("found no photorque_pictures.so, expected"));
  EXPECT_FALSE(fs::exists(at("o")));
}

TEST_F(PictureModule, OfAnotherKindIsRefused) {
  copy_program();
  fs::copy_file(built / "photorque_fmu.so", at("bin/photorque_pictures.so"));
  EXPECT_THAT(
      refusal_in(run_copy("render " + nominal_file + " --set trace.rays=4096 --out " + at("o"))),
      HasSubstr("found another library"));
}

}  // namespace
}  // namespace photorque
