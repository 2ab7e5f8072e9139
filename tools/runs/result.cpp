#include "tools/runs/result.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/parse.h"
#include "images/writers/product.h"
#include "images/writers/staged_files.h"

namespace photorque {
namespace {

bool is_one_of(const std::string& name, const std::vector<std::string>& names) {
  return std::ranges::find(names, name) != names.end();
}

// The maps of irradiance, which users process with scripts, and on request the tables.
Product with_irradiance_alone(const Product& product, bool tables) {
  Product part;
  for (const Map& map : product.maps) {
    if (map.name.starts_with("irradiance_")) part.maps.push_back(map);
  }
  if (tables) part.tables = product.tables;
  return part;
}

}  // namespace

void check_figures(const RunResult& result) {
  for (const Quantity& figure : result.product.quantities) {
    if (!std::isfinite(figure.estimate.value)) {
      throw NumericalError(figure.name + " came out as no finite number");
    }
  }
}

std::vector<std::string> formats_in(const std::string& list) {
  const std::vector<std::string_view> words = words_of(list, ",");
  const std::vector<std::string> formats(words.begin(), words.end());
  require_formats(formats);
  return formats;
}

std::vector<std::filesystem::path> write_run(const RunResult& result,
                                             const std::filesystem::path& folder,
                                             const std::string& command,
                                             const RunFormats& formats) {
  check_figures(result);
  require_formats(formats.further);
  StagedFiles staged(folder);
  std::vector<std::filesystem::path> paths;
  const auto write = [&](const Product& product, const std::vector<std::string>& names) {
    const auto written =
        write_formats(product, result.provenance, staged.path(), names, formats.style);
    paths.insert(paths.end(), written.begin(), written.end());
  };
  std::vector<std::string> whole = {"png", "h5"}, irradiance;
  for (const char* name : {"exr", "tiff", "csv"}) {
    (is_one_of(name, formats.further) ? whole : irradiance).emplace_back(name);
  }
  for (const std::string& name : formats.further) {
    if (!is_one_of(name, whole) && name != "json") whole.push_back(name);
  }
  write(result.product, whole);
  write(with_irradiance_alone(result.product, is_one_of("csv", irradiance)), irradiance);
  for (std::filesystem::path& path : paths) path = folder / path.filename();
  for (const RunFile& file : result.files) file.write(staged.path() / file.name);
  write_file_whole(staged.path() / "summary.json", result.summary());
  staged.publish_as(command, result.provenance);
  return paths;
}

}  // namespace photorque
