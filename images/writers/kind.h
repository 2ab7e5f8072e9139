// Formats of result files, and their writers.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "images/drawing/style.h"

namespace photorque {

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
  // Writes what the format can express of `product` into `folder` (made if absent), one file per
  // item, named after it; returns the paths in order. A format without content writes nothing. Each
  // file appears whole or not at all. Equal arguments give equal bytes, and every file carries the
  // provenance in a form that people and programs can read. InputError when an item's sizes
  // disagree or a file cannot be written.
  std::function<std::vector<std::filesystem::path>(
      const Product& product, const Provenance& provenance, const std::filesystem::path& folder,
      PictureStyle style)>
      write;
};

// Calls `put(item, path)` for every item of the lists; returns the paths.
template <class Put, class... Items>
std::vector<std::filesystem::path> write_each(const std::filesystem::path& folder,
                                              const std::string& extension, const Put& put,
                                              const std::vector<Items>&... lists) {
  std::vector<std::filesystem::path> paths;
  const auto write = [&](const auto& list) {
    for (const auto& item : list) {
      paths.push_back(file_in(folder, item.name, extension));
      put(item, paths.back());
    }
  };
  (write(lists), ...);
  return paths;
}

// Every kind named in images/CMakeLists.txt, in that order.
std::vector<WriterKind> all_writer_kinds();

}  // namespace photorque
