// Plots as PDF pages, whose text can be searched and copied.
//
// The document's title is the plot's, its subject the provenance as JSON.
#include "core/files.h"
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
    for (const Plot& plot : product.plots) {
      paths.push_back(file_in(folder, plot.name, "pdf"));
      const PdfText text{plot.title, ascii_line(provenance_json(provenance)),
                         provenance.program + " " + provenance.version};
      write_file_whole(paths.back(), plot_pdf(plot, provenance, text));
    }
    return paths;
  }
};

}  // namespace

WriterKind kind() {
  return {"pdf", "Plots as PDF pages", [] { return std::make_unique<PdfWriter>(); }};
}

}  // namespace photorque::kinds::pdf
