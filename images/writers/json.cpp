// The headline figures as summary.json.
//
// See summary_json; a caller that knows the wall time and the number of rays writes that itself.
#include "core/files.h"
#include "images/writers/kind.h"
#include "images/writers/summary.h"

namespace photorque::kinds::json {
namespace {

class JsonWriter final : public Writer {
 public:
  std::vector<std::filesystem::path> write(const Product& product, const Provenance& provenance,
                                           const std::filesystem::path& folder) const override {
    if (product.quantities.empty()) return {};
    const std::filesystem::path path = file_in(folder, "summary", "json");
    write_file_whole(path, summary_json(product, provenance));
    return {path};
  }
};

}  // namespace

WriterKind kind() {
  return {"json", "Headline figures with their standard errors, as summary.json",
          [] { return std::make_unique<JsonWriter>(); }};
}

}  // namespace photorque::kinds::json
