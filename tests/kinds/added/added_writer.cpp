// A format that the program does not have: the names of the headline figures, one a line.
#include "core/files.h"
#include "images/writers/kind.h"

namespace photorque::kinds::added_writer {
namespace {

class NamesWriter final : public Writer {
 public:
  std::vector<std::filesystem::path> write(const Product& product, const Provenance&,
                                           const std::filesystem::path& folder) const override {
    std::string text;
    for (const auto& quantity : product.quantities) text += quantity.name + "\n";
    const std::filesystem::path path = file_in(folder, "names", "added_writer");
    write_file_whole(path, text);
    return {path};
  }
};

}  // namespace

WriterKind kind() {
  return {"added_writer", "Names of the headline figures",
          [] { return std::make_unique<NamesWriter>(); }};
}

}  // namespace photorque::kinds::added_writer
