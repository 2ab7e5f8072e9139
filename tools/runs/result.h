// Results of a run.
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

// A file in addition to those that the writers make from the product.
struct RunFile {
  std::string name;
  // Writes to this path, completely or not at all.
  std::function<void(const std::filesystem::path&)> write;
  std::string remark = {};  // printed with the file name
};

struct RunResult {
  Product product;
  Provenance provenance;
  RunCost cost;
  std::vector<RunFile> files = {};

  std::string summary() const { return summary_json(product, provenance, cost); }
};

// Throws NumericalError if a main figure is not a finite number.
void check_figures(const RunResult& result);

// Formats in which a run is written.
struct RunFormats {
  std::vector<std::string> further = {};  // names of writer kinds, in addition to the usual files
  PictureStyle style = PictureStyle::page;
};

// Writes figures (PNG), tables (CSV), run.h5, the additional formats and summary.json into the
// folder as a whole, replacing the last files of `command` there (StagedFiles). Maps of irradiance
// are also written as EXR, TIFF and CSV; all else only in the additional formats. Returns the paths
// of the product's files. Throws InputError for an unknown format.
std::vector<std::filesystem::path> write_run(const RunResult& result,
                                             const std::filesystem::path& folder,
                                             const std::string& command = "run",
                                             const RunFormats& formats = {});

// Formats named in `list`, such as "exr,svg". Throws InputError like write_run().
std::vector<std::string> formats_in(const std::string& list);

// Measures the time since its construction [s], for RunCost.
class WallTime {
 public:
  double elapsed_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace photorque
