// Maps as TIFF images of 32-bit floats, for further computation.
//
// Page 1 is "value", page 2 "standard_error" (DocumentName). ImageDescription is JSON with unit,
// extents and provenance.
#include "images/writers/image_file.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::tiff {
namespace {

class TiffWriter final : public Writer {
 public:
  std::vector<std::filesystem::path> write(const Product& product, const Provenance& provenance,
                                           const std::filesystem::path& folder) const override {
    std::vector<std::filesystem::path> paths;
    for (const Map& map : product.maps) {
      paths.push_back(file_in(folder, map.name, "tiff"));
      write_tiff(paths.back(), map.width, map.height, map_channels(map),
                 map_metadata(map, provenance));
    }
    return paths;
  }
};

}  // namespace

WriterKind kind() {
  return {"tiff", "Maps as TIFF images of 32-bit floats with their standard errors",
          [] { return std::make_unique<TiffWriter>(); }};
}

}  // namespace photorque::kinds::tiff
