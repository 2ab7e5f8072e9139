// Maps as OpenEXR images of 32-bit floats, for further computation.
//
// Channels "value" and "standard_error". Named attributes photorque:unit, photorque:x_low, …; all
// metadata also as JSON in "comments".
#include "images/writers/image_file.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::exr {

WriterKind kind() {
  return {"exr", "Maps as OpenEXR images of 32-bit floats with their standard errors",
          [](const WriterJob& job) {
            const auto put = [&](const Map& map, const std::filesystem::path& path) {
              write_exr(path, map.width, map.height, map_channels(map),
                        map_metadata(map, job.provenance));
            };
            return job.each("exr", put, job.product.maps);
          }};
}

}  // namespace photorque::kinds::exr
