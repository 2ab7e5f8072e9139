// The results of a run.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "images/drawing/style.h"
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

// The files that a run is written as.
struct RunFormats {
  std::vector<std::string> further = {};  // names of writer kinds, beside the usual files
  PictureStyle style = PictureStyle::page;
};

// Writes figures (PNG), tables (CSV), run.h5, the further files and summary.json into the folder,
// all together and in place of what `command` wrote there last (StagedFiles). Maps of irradiance
// are also written as EXR, TIFF and CSV; everything else in the further formats alone. Gives the
// paths of the product's files. InputError for a format that does not exist.
std::vector<std::filesystem::path> write_run(const RunResult& result,
                                             const std::filesystem::path& folder,
                                             const std::string& command = "run",
                                             const RunFormats& formats = {});

// The formats that `list`, "exr,svg", names; InputError as for write_run().
std::vector<std::string> formats_in(const std::string& list);

// Seconds since `start`, for RunCost.
class WallTime {
 public:
  double elapsed_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace photorque
