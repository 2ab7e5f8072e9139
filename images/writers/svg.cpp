// Maps and plots as scalable pictures; their letters are text.
//
// <title> contains the title, <desc> the provenance as text, <metadata> the provenance as JSON.
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "images/drawing/map.h"
#include "images/drawing/plot.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::svg {
namespace {

// Inserts the metadata, which cairo does not write, directly after the opening tag of the root.
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

}  // namespace

WriterKind kind() {
  return {"svg", "Maps and plots as scalable pictures", [](const WriterJob& job) {
            const auto put = [&](const auto& item, const std::filesystem::path& path) {
              const std::string svg = page_of(item, job.provenance, job.style).svg();
              write_file_whole(path, with_metadata(svg, item.title, job.provenance));
            };
            return job.each("svg", put, job.product.maps, job.product.plots);
          }};
}

}  // namespace photorque::kinds::svg
