// Maps as VTKHDF files (ImageData, version 1.0), for ParaView and VTK.
//
// Every bin has a point at its centre: PointData "value" and "standard_error". VTK's reader
// requires a volume (9.1 writes beyond its memory for a flat image, and misreads CellData).
// Therefore the map is stored as two equal layers, and a single row or column is duplicated, too.
// Further metadata are attributes of the group PointData: title, unit, labels of the axes. Source
// of the format: Kitware, "VTKHDF file format" (VTK documentation, release 9.1).
#include <algorithm>

#include "images/drawing/map.h"
#include "images/writers/hdf5_file.h"
#include "images/writers/kind.h"

namespace photorque::kinds::vtkhdf {
namespace {

// Sizes of the stored grid; a single row or column is duplicated.
struct Sheet {
  int width, height;
  static constexpr int layers = 2;
  explicit Sheet(const Map& map) : width(std::max(2, map.width)), height(std::max(2, map.height)) {}

  std::vector<double> values(const Map& map, const std::vector<double>& of_bins) const {
    std::vector<double> all;
    for (int layer = 0; layer < layers; ++layer) {
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const int row = std::min(y, map.height - 1), column = std::min(x, map.width - 1);
          all.push_back(of_bins[static_cast<size_t>(row) * static_cast<size_t>(map.width) +
                                static_cast<size_t>(column)]);
        }
      }
    }
    return all;
  }
  std::vector<int> extent() const { return {0, width - 1, 0, height - 1, 0, layers - 1}; }
  std::vector<size_t> shape() const {
    return {layers, static_cast<size_t>(height), static_cast<size_t>(width)};
  }
};

void write_map(const Map& map, const Provenance& provenance, const std::filesystem::path& path) {
  require_consistent(map);
  const double dx = (map.x_high - map.x_low) / map.width;
  const double dy = (map.y_high - map.y_low) / map.height;
  constexpr double thickness = 0.01;  // of a bin
  const Sheet sheet(map);
  Hdf5File file;
  file.group("/VTKHDF/PointData");
  file.group("/VTKHDF/CellData");
  file.attribute("/VTKHDF", "Version", std::vector<int>{1, 0});
  file.attribute("/VTKHDF", "Type", "ImageData");
  file.attribute("/VTKHDF", "WholeExtent", sheet.extent());
  file.attribute("/VTKHDF", "Origin",
                 std::vector<double>{map.x_low + 0.5 * dx, map.y_low + 0.5 * dy, 0.0});
  file.attribute("/VTKHDF", "Spacing", std::vector<double>{dx, dy, thickness * dx});
  file.attribute("/VTKHDF", "Direction", std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1});
  file.numbers("/VTKHDF/PointData/value", sheet.values(map, map.value), sheet.shape());
  if (!map.standard_error.empty()) {
    file.numbers("/VTKHDF/PointData/standard_error", sheet.values(map, map.standard_error),
                 sheet.shape());
  }
  file.attribute("/VTKHDF/PointData", "title", map.title);
  file.attribute("/VTKHDF/PointData", "unit", map.unit);
  file.attribute("/VTKHDF/PointData", "x_label", map.x_label);
  file.attribute("/VTKHDF/PointData", "y_label", map.y_label);
  file.stamp("/", provenance);
  file.write(path);
}
}  // namespace

WriterKind kind() {
  return {"vtkhdf", "Maps as VTKHDF images with their standard errors, for ParaView",
          [](const WriterJob& job) {
            const auto put = [&](const Map& map, const std::filesystem::path& path) {
              write_map(map, job.provenance, path);
            };
            return job.each("vtkhdf", put, job.product.maps);
          }};
}

}  // namespace photorque::kinds::vtkhdf
