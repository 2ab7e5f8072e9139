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

// Throws InputError with the name of the table if its columns differ in length.
void require_consistent(const Table& table);

// The path folder/name.extension. Characters of `name` other than ASCII letters, digits, '.', '_'
// and '-' become '_': names come from users' scenes and must not leave the folder.
std::filesystem::path file_in(const std::filesystem::path& folder, const std::string& name,
                              const std::string& extension);

// Content and destination of a file.
struct WriterJob {
  const Product& product;
  const Provenance& provenance;
  std::filesystem::path folder;
  PictureStyle style = PictureStyle::page;

  // Calls `put(item, path)` for every item of the lists; returns the paths.
  template <class Put, class... Items>
  std::vector<std::filesystem::path> each(const std::string& extension, const Put& put,
                                          const std::vector<Items>&... lists) const {
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
};

// One format: "exr".
struct WriterKind {
  std::string name;     // also the extension of its files
  std::string summary;  // one sentence, no full stop
  // Writes those items of the product that the format supports into the folder (created if
  // missing), one file per item, named after it; returns the paths in order. Each file is written
  // completely or not at all. Equal jobs give equal bytes. Every file contains the provenance in
  // readable form. Throws InputError if an item's sizes disagree or a file cannot be written.
  std::function<std::vector<std::filesystem::path>(const WriterJob& job)> write;
};

// All kinds listed in images/CMakeLists.txt, in that order.
std::vector<WriterKind> all_writer_kinds();

}  // namespace photorque
