// Plots as scalable pictures.
//
// <title> holds the title, <desc> the provenance as text, <metadata> the same as JSON.
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "images/drawing/plot.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::svg {
namespace {

// cairo writes no metadata; it belongs directly behind the opening tag of the root.
std::string with_metadata(const std::string& svg, const Plot& plot, const Provenance& provenance) {
  const size_t root = svg.find("<svg");
  const size_t end = svg.find('>', root);
  if (root == std::string::npos || end == std::string::npos) {
    throw NumericalError("drawing failed: cairo made no SVG");
  }
  const std::string elements = "\n<title>" + xml_text(plot.title) + "</title>\n<desc>" +
                               xml_text(provenance.one_line()) + "</desc>\n<metadata>" +
                               xml_text(ascii_line(provenance_json(provenance))) + "</metadata>";
  return svg.substr(0, end + 1) + elements + svg.substr(end + 1);
}

class SvgWriter final : public Writer {
 public:
  std::vector<std::filesystem::path> write(const Product& product, const Provenance& provenance,
                                           const std::filesystem::path& folder) const override {
    std::vector<std::filesystem::path> paths;
    for (const Plot& plot : product.plots) {
      paths.push_back(file_in(folder, plot.name, "svg"));
      write_file_whole(paths.back(), with_metadata(plot_svg(plot, provenance), plot, provenance));
    }
    return paths;
  }
};

}  // namespace

WriterKind kind() {
  return {"svg", "Plots as scalable pictures", [] { return std::make_unique<SvgWriter>(); }};
}

}  // namespace photorque::kinds::svg
