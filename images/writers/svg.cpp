// Maps and plots as scalable pictures, whose letters are text.
//
// <title> holds the title, <desc> the provenance as text, <metadata> the same as JSON.
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "images/drawing/map.h"
#include "images/drawing/plot.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::svg {
namespace {

// cairo writes no metadata; it belongs directly behind the opening tag of the root.
std::string with_metadata(const std::string& svg, const std::string& title,
                          const Provenance& provenance) {
  const size_t root = svg.find("<svg");
  const size_t end = svg.find('>', root);
  if (root == std::string::npos || end == std::string::npos) {
    throw NumericalError("drawing failed: cairo made no SVG");
  }
  const std::string elements = "\n<title>" + xml_text(title) + "</title>\n<desc>" +
                               xml_text(provenance.one_line()) + "</desc>\n<metadata>" +
                               xml_text(ascii_line(provenance_json(provenance))) + "</metadata>";
  return svg.substr(0, end + 1) + elements + svg.substr(end + 1);
}

class SvgWriter final : public Writer {
 public:
  std::vector<std::filesystem::path> write(const Product& product, const Provenance& provenance,
                                           const std::filesystem::path& folder) const override {
    std::vector<std::filesystem::path> paths;
    const auto put = [&](const std::string& name, const std::string& title,
                         const std::string& svg) {
      paths.push_back(file_in(folder, name, "svg"));
      write_file_whole(paths.back(), with_metadata(svg, title, provenance));
    };
    for (const Map& map : product.maps) put(map.name, map.title, map_svg(map, provenance, style));
    for (const Plot& plot : product.plots) {
      put(plot.name, plot.title, plot_svg(plot, provenance, style));
    }
    return paths;
  }
};

}  // namespace

WriterKind kind() {
  return {"svg", "Maps and plots as scalable pictures",
          [] { return std::make_unique<SvgWriter>(); }};
}

}  // namespace photorque::kinds::svg
