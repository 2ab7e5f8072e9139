#include "tools/runs/result.h"

#include <chrono>
#include <cmath>

#include "core/errors.h"
#include "core/files.h"
#include "images/writers/product.h"
#include "images/writers/staged_files.h"

namespace photorque {
namespace {

int64_t now_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

}  // namespace

void check_figures(const RunResult& result) {
  for (const Quantity& figure : result.product.quantities) {
    if (!std::isfinite(figure.estimate.value)) {
      throw NumericalError(figure.name + " came out as no finite number");
    }
  }
}

std::vector<std::filesystem::path> write_run(const RunResult& result,
                                             const std::filesystem::path& folder,
                                             const std::string& command) {
  check_figures(result);
  StagedFiles staged(folder);
  std::vector<std::filesystem::path> paths =
      write_formats(result.product, result.provenance, staged.path());
  for (std::filesystem::path& path : paths) path = folder / path.filename();
  for (const RunFile& file : result.files) file.write(staged.path() / file.name);
  write_file_whole(staged.path() / "summary.json", result.summary());
  staged.publish_as(command, result.provenance);
  return paths;
}

WallTime::WallTime() : start_ns_(now_ns()) {}

double WallTime::elapsed_s() const {
  return 1e-9 * static_cast<double>(now_ns() - start_ns_);
}

}  // namespace photorque
