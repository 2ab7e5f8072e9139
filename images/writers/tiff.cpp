// Maps as TIFF images of 32-bit floats, for further computation.
//
// Page 1 is "value", page 2 "standard_error" (DocumentName). ImageDescription is JSON with unit,
// extents and provenance.
#include "images/writers/image_file.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::tiff {

WriterKind kind() {
  return {"tiff", "Maps as TIFF images of 32-bit floats with their standard errors",
          [](const WriterJob& job) {
            const auto put = [&](const Map& map, const std::filesystem::path& path) {
              write_tiff(path, map.width, map.height, map_channels(map),
                         map_metadata(map, job.provenance));
            };
            return job.each("tiff", put, job.product.maps);
          }};
}

}  // namespace photorque::kinds::tiff
