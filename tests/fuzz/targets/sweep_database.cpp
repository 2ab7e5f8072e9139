// Fuzz target: any bytes as the database that a sweep kept.
#include "core/files.h"
#include "tests/fuzz/target.h"
#include "tools/sweeps/store/database.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  // In memory as well, but with a name of its own: SQLite keeps a journal beside it.
  static const std::filesystem::path folder = [] {
    std::string name = "/dev/shm/photorque_fuzz_XXXXXX";
    if (mkdtemp(name.data()) == nullptr) std::abort();
    return std::filesystem::path(name);
  }();
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::filesystem::remove(entry.path(), ignored);
  }
  const std::filesystem::path path = folder / "designs.sqlite";
  if (std::FILE* file = std::fopen(path.c_str(), "wb")) {
    std::fwrite(data, 1, size, file);
    std::fclose(file);
  }
  fuzz::may_refuse([&] {
    RunDatabase database(path);
    for (const std::string& hash : database.failed()) database.find(hash);
    database.find("0123456789abcdef0123456789abcdef");
    RunRecord record;
    record.hash = "1";
    record.command = "power";
    record.program = "0";
    database.keep(record);
  });
  return 0;
}
