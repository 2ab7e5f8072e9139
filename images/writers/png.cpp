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
  return {"png", "Maps with colour bar and plots, as pictures", [](const WriterJob& job) {
            const auto put_map = [&](const Map& map, const std::filesystem::path& path) {
              write_png(path, page_of(map, job.provenance, job.style).pixels(),
                        map_metadata(map, job.provenance));
            };
            const auto put_plot = [&](const Plot& plot, const std::filesystem::path& path) {
              write_png(path, page_of(plot, job.provenance, job.style).pixels(),
                        picture_metadata(plot.title, job.provenance));
            };
            auto paths = job.each("png", put_map, job.product.maps);
            std::ranges::move(job.each("png", put_plot, job.product.plots),
                              std::back_inserter(paths));
            return paths;
          }};
}

}  // namespace photorque::kinds::png
