// The results of a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "images/writers/product.h"

namespace photorque {

// A file beside those that the writers make of the product.
struct RunFile {
  std::string name;
  std::function<void(const std::filesystem::path&)> write;  // to this path, whole or not at all
  std::string remark = {};                                  // a remark, as printed
};

struct RunResult {
  Product product;
  Provenance provenance;
  RunCost cost;
  std::vector<RunFile> files = {};

  std::string summary() const { return summary_json(product, provenance, cost); }
};

// NumericalError for a headline figure that came out as no finite number.
void check_figures(const RunResult& result);

// Writes every item of the product, the further files and summary.json into the folder, all
// together and in place of what `command` wrote there last (StagedFiles); gives the paths of the
// first.
std::vector<std::filesystem::path> write_run(const RunResult& result,
                                             const std::filesystem::path& folder,
                                             const std::string& command = "run");

// Seconds since `start`, for RunCost.
class WallTime {
 public:
  WallTime();
  double elapsed_s() const;

 private:
  int64_t start_ns_;
};

}  // namespace photorque
