// Maps as OpenEXR images of 32-bit floats, for further computation.
//
// Channels "value" and "standard_error". Named attributes photorque:unit, photorque:x_low, … and,
// as "comments", all of it as JSON.
#include "images/writers/image_file.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::exr {
namespace {

class ExrWriter final : public Writer {
 public:
  std::vector<std::filesystem::path> write(const Product& product, const Provenance& provenance,
                                           const std::filesystem::path& folder) const override {
    std::vector<std::filesystem::path> paths;
    for (const Map& map : product.maps) {
      paths.push_back(file_in(folder, map.name, "exr"));
      write_exr(paths.back(), map.width, map.height, map_channels(map),
                map_metadata(map, provenance));
    }
    return paths;
  }
};

}  // namespace

WriterKind kind() {
  return {"exr", "Maps as OpenEXR images of 32-bit floats with their standard errors",
          [] { return std::make_unique<ExrWriter>(); }};
}

}  // namespace photorque::kinds::exr
