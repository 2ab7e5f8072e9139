// Maps and plots as PDF pages, whose text can be searched and copied.
//
// The document's title is the map's or plot's, its subject the provenance as JSON.
#include "core/files.h"
#include "images/drawing/map.h"
#include "images/drawing/plot.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::pdf {
namespace {

class PdfWriter final : public Writer {
 public:
  std::vector<std::filesystem::path> write(const Product& product, const Provenance& provenance,
                                           const std::filesystem::path& folder) const override {
    std::vector<std::filesystem::path> paths;
    const auto text_of = [&](const std::string& title) {
      return PdfText{title, ascii_line(provenance_json(provenance)),
                     provenance.program + " " + provenance.version};
    };
    for (const Map& map : product.maps) {
      paths.push_back(file_in(folder, map.name, "pdf"));
      write_file_whole(paths.back(), map_pdf(map, provenance, text_of(map.title), style));
    }
    for (const Plot& plot : product.plots) {
      paths.push_back(file_in(folder, plot.name, "pdf"));
      write_file_whole(paths.back(), plot_pdf(plot, provenance, text_of(plot.title), style));
    }
    return paths;
  }
};

}  // namespace

WriterKind kind() {
  return {"pdf", "Maps and plots as PDF pages", [] { return std::make_unique<PdfWriter>(); }};
}

}  // namespace photorque::kinds::pdf
