// How products become files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"

namespace photorque {

// One format. Writers are pure: equal arguments give equal bytes, and every file carries the
// provenance in a form that people and programs can read.
class Writer {
 public:
  virtual ~Writer() = default;

  // Writes what the format can express of `product` into `folder` (made if absent), one file per
  // item, named after it; returns the paths in order. A format that has nothing to say writes
  // nothing. Each file appears whole or not at all. InputError when an item's sizes disagree or a
  // file cannot be written.
  virtual std::vector<std::filesystem::path> write(const Product& product,
                                                   const Provenance& provenance,
                                                   const std::filesystem::path& folder) const = 0;
};

// folder/name.extension, with everything but ASCII letters, digits, '.', '_' and '-' in `name`
// replaced by '_': names come from users' scenes and must not leave the folder.
std::filesystem::path file_in(const std::filesystem::path& folder, const std::string& name,
                              const std::string& extension);

}  // namespace photorque
