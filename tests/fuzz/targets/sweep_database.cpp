// Fuzz target: any bytes as the database that a sweep kept: what is in it, a run kept in it, and
// now and then its runs taken over, its table of designs and a copy.
#include "core/files.h"
#include "tests/fuzz/target.h"
#include "tools/sweeps/database.h"

namespace {

using namespace photorque;
namespace fs = std::filesystem;

void write(const fs::path& path, const uint8_t* data, size_t size) {
  if (std::FILE* file = std::fopen(path.c_str(), "wb")) {
    std::fwrite(data, 1, size, file);
    std::fclose(file);
  }
}

RunRecord a_run() {
  RunRecord record;
  record.hash = "1";
  record.command = "power";
  record.program = "0";
  record.changes = {"a=1", "b=2"};
  record.outcome.figures = {{FigureName("power_W"), {1.5, 0.1}}};
  return record;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // In memory as well, but with a name: SQLite keeps a journal beside it.
  const fs::path& folder = fuzz::folder_in_memory();
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder)) fs::remove(entry.path(), ignored);
  const fs::path path = folder / "designs.sqlite";
  write(path, data, size);
  fuzz::may_refuse([&] {
    RunDatabase database(path);
    for (const std::string& hash : database.failed()) database.find(hash);
    database.find("0123456789abcdef0123456789abcdef");
    database.keep(a_run());
    if (size % 8 != 0) return;
    database.copy_to(folder / "copy.sqlite");
    database.write_designs({"designs", "", {{"name", {}, {"a"}}, {"power_W", {1.0}}}});
  });
  if (size % 8 == 0) {
    write(folder / "other.sqlite", data, size);
    fuzz::may_refuse(
        [&] { RunDatabase(folder / "into.sqlite").take_from(folder / "other.sqlite"); });
  }
  return 0;
}
