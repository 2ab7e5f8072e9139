// Maps and plots as PNG pictures.
//
// "Description" is JSON with unit, extents and provenance.
#include "images/drawing/map.h"
#include "images/drawing/plot.h"
#include "images/writers/image_file.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::png {

WriterKind kind() {
  return {"png", "Maps with colour bar and plots, as pictures",
          [](const Product& product, const Provenance& provenance,
             const std::filesystem::path& folder, PictureStyle style) {
            const auto put_map = [&](const Map& map, const std::filesystem::path& path) {
              write_png(path, map_picture(map, provenance, style).picture,
                        map_metadata(map, provenance));
            };
            const auto put_plot = [&](const Plot& plot, const std::filesystem::path& path) {
              write_png(path, plot_picture(plot, provenance, style),
                        picture_metadata(plot.title, provenance));
            };
            auto paths = write_each(folder, "png", put_map, product.maps);
            std::ranges::move(write_each(folder, "png", put_plot, product.plots),
                              std::back_inserter(paths));
            return paths;
          }};
}

}  // namespace photorque::kinds::png
