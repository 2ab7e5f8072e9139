// Maps and plots as PDF pages; their text can be searched and copied.
//
// The document's title is that of the map or plot, its subject the provenance as JSON.
#include "core/files.h"
#include "images/drawing/map.h"
#include "images/drawing/plot.h"
#include "images/writers/kind.h"
#include "images/writers/metadata.h"

namespace photorque::kinds::pdf {

WriterKind kind() {
  return {"pdf", "Maps and plots as PDF pages", [](const WriterJob& job) {
            const auto put = [&](const auto& item, const std::filesystem::path& path) {
              const PdfText text{item.title, ascii_line(provenance_json(job.provenance)),
                                 job.provenance.program + " " + job.provenance.version};
              write_file_whole(path, page_of(item, job.provenance, job.style).pdf(text));
            };
            return job.each("pdf", put, job.product.maps, job.product.plots);
          }};
}

}  // namespace photorque::kinds::pdf
