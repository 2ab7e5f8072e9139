// Fuzz target: any bytes as files.json, the list of what a command's last run wrote. Whatever it
// says, the new run's files appear and nothing outside of the folder is touched.
#include "images/writers/staged_files.h"

#include <fstream>

#include "core/files.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  namespace fs = std::filesystem;
  const fs::path& folder = fuzz::folder_in_memory();
  static const fs::path results = folder / "results";
  fs::remove_all(results);
  fs::create_directories(results);
  std::ofstream(folder / "precious") << "of others";
  std::ofstream(results / "mine.csv") << "of others";
  std::ofstream(results / "files.json") << fuzz::text_of(data, size);
  fuzz::may_refuse([&] {
    StagedFiles staged(results);
    std::ofstream(staged.path() / "summary.json") << "{}";
    is_result_of(results, "trace", "mine.csv");
    if (size % 2 == 0) std::ofstream(staged.path() / "mine.csv") << "a result";
    staged.publish_as("trace", {});
    if (!fs::exists(results / "summary.json")) std::abort();
    const std::string list = fuzz::text_of(data, size);
    const bool may_be_listed = list.find("mine") != list.npos || list.find('\\') != list.npos;
    const fs::path kept = results / (size % 2 == 0 ? "mine.csv~" : "mine.csv");
    if (!may_be_listed && read_file(kept) != "of others") std::abort();
  });
  if (!fs::exists(folder / "precious")) std::abort();
  return 0;
}
