// A format that the program does not have: the names of the headline figures, one a line.
#include "core/files.h"
#include "images/writers/kind.h"

namespace photorque::kinds::added_writer {

WriterKind kind() {
  return {"added_writer", "Names of the headline figures",
          [](const WriterJob& job) -> std::vector<std::filesystem::path> {
            std::string text;
            for (const auto& quantity : job.product.quantities) text += quantity.name + "\n";
            const std::filesystem::path path = file_in(job.folder, "names", "added_writer");
            write_file_whole(path, text);
            return {path};
          }};
}

}  // namespace photorque::kinds::added_writer
