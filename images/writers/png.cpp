// Maps and plots as PNG pictures.
//
// "Description" is JSON with unit, extents and provenance.
#include "core/text/format.h"
#include "images/drawing/map.h"
#include "images/drawing/plot.h"
#include "images/writers/image_file.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::png {
namespace {

class PngWriter final : public Writer {
 public:
  std::vector<std::filesystem::path> write(const Product& product, const Provenance& provenance,
                                           const std::filesystem::path& folder) const override {
    std::vector<std::filesystem::path> paths;
    for (const Map& map : product.maps) {
      paths.push_back(file_in(folder, map.name, "png"));
      write_png(paths.back(), map_picture(map, provenance, style).picture,
                map_metadata(map, provenance));
    }
    for (const Plot& plot : product.plots) {
      paths.push_back(file_in(folder, plot.name, "png"));
      write_png(paths.back(), plot_picture(plot, provenance, style),
                picture_metadata(plot.title, provenance));
    }
    return paths;
  }
};

}  // namespace

WriterKind kind() {
  return {"png", "Maps with colour bar and plots, as pictures",
          [] { return std::make_unique<PngWriter>(); }};
}

}  // namespace photorque::kinds::png
