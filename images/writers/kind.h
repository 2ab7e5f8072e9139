// How products become files, and which formats there are.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "images/drawing/style.h"

namespace photorque {

// One format. Writers are pure: equal arguments give equal bytes, and every file carries the
// provenance in a form that people and programs can read.
class Writer {
 public:
  virtual ~Writer() = default;

  PictureStyle style = PictureStyle::page;  // of drawings

  // Writes what the format can express of `product` into `folder` (made if absent), one file per
  // item, named after it; returns the paths in order. A format without content writes nothing. Each
  // file appears whole or not at all. InputError when an item's sizes disagree or a file cannot be
  // written.
  virtual std::vector<std::filesystem::path> write(const Product& product,
                                                   const Provenance& provenance,
                                                   const std::filesystem::path& folder) const = 0;
};

// InputError that names the table if its columns differ in length.
void require_consistent(const Table& table);

// folder/name.extension, with everything but ASCII letters, digits, '.', '_' and '-' in `name`
// replaced by '_': names come from users' scenes and must not leave the folder.
std::filesystem::path file_in(const std::filesystem::path& folder, const std::string& name,
                              const std::string& extension);

// One format: "exr".
struct WriterKind {
  std::string name;     // also the extension of its files
  std::string summary;  // one sentence, no full stop
  std::function<std::unique_ptr<Writer>()> make;
};

// Every kind named in images/CMakeLists.txt, in that order.
std::vector<WriterKind> all_writer_kinds();

}  // namespace photorque
