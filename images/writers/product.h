// Products to files in several formats at once.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"

namespace photorque {

// Writes `product` in each of `formats` (names of writer kinds; empty: all of them) and returns the
// paths. InputError for an unknown format, and when two items would share a file. When anything
// fails, nothing is written, and no folder left that was not there.
std::vector<std::filesystem::path> write_product(const Product& product,
                                                 const Provenance& provenance,
                                                 const std::filesystem::path& folder,
                                                 const std::vector<std::string>& formats = {});

// The same straight into `folder`, which may then hold a part when something fails: for folders
// that are published as one (StagedFiles).
std::vector<std::filesystem::path> write_formats(const Product& product,
                                                 const Provenance& provenance,
                                                 const std::filesystem::path& folder,
                                                 const std::vector<std::string>& formats = {});

}  // namespace photorque
