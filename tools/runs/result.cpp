#include "tools/runs/result.h"

#include <chrono>
#include <cmath>

#include "core/errors.h"
#include "core/files.h"
#include "images/writers/product.h"

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
                                             const std::filesystem::path& folder) {
  check_figures(result);
  const std::string summary = result.summary();
  auto paths = write_product(result.product, result.provenance, folder);
  write_file_whole(folder / "summary.json", summary);
  for (const RunFile& file : result.files) file.write(folder / file.name);
  return paths;
}

WallTime::WallTime() : start_ns_(now_ns()) {}

double WallTime::elapsed_s() const {
  return 1e-9 * static_cast<double>(now_ns() - start_ns_);
}

}  // namespace photorque
