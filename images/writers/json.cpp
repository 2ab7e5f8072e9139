// The main figures as summary.json.
//
// Callers that know the wall time and the number of rays use summary_json().
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"
#include "images/writers/product.h"

namespace photorque {

std::string summary_json(const Product& product, const Provenance& provenance,
                         const RunCost& cost) {
  nlohmann::ordered_json summary = {{"schema", summary_schema},
                                    {"warnings", nlohmann::ordered_json::array()}};
  for (const std::string& warning : provenance.warnings) {
    summary["warnings"].push_back(clean_text(warning));
  }
  for (const auto& [name, estimate] : product.quantities) {
    const std::string key = clean_text(name);
    if (summary.contains(key) || key == "provenance") {
      throw InputError({}, name, "two results with this name", "different names");
    }
    summary[key] = {{"value", estimate.value}, {"standard_error", estimate.standard_error}};
  }
  nlohmann::ordered_json& made_by = summary["provenance"];
  made_by = provenance_json(provenance);
  if (cost.rays) made_by["rays"] = *cost.rays;
  if (cost.wall_time_s) made_by["wall_time_s"] = *cost.wall_time_s;
  return summary.dump(2) + "\n";
}

namespace kinds::json {
namespace {

std::vector<std::filesystem::path> write_summary(const WriterJob& job) {
  if (job.product.quantities.empty()) return {};
  const std::filesystem::path path = file_in(job.folder, "summary", "json");
  write_file_whole(path, summary_json(job.product, job.provenance));
  return {path};
}

}  // namespace

WriterKind kind() {
  return {"json", "Headline figures with their standard errors, as summary.json", write_summary};
}

}  // namespace kinds::json
}  // namespace photorque
