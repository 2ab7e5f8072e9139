// Writes products to files in several formats.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "images/drawing/style.h"

namespace photorque {

// Throws InputError for a name that is not a writer kind.
void require_formats(const std::vector<std::string>& formats);

// Writes `product` in each of `formats` (names of writer kinds; empty: all) and returns the paths.
// Throws InputError for an unknown format, and if two items would share a file. After an error
// `folder` may contain some of the files; use a folder that is published as a whole (StagedFiles).
std::vector<std::filesystem::path> write_formats(const Product& product,
                                                 const Provenance& provenance,
                                                 const std::filesystem::path& folder,
                                                 const std::vector<std::string>& formats = {},
                                                 PictureStyle style = PictureStyle::page);

inline constexpr const char* summary_schema = "photorque.summary/1";

// Cost of a run; unknown values are omitted. The wall time is the only number that differs between
// equal runs; it has a separate line.
struct RunCost {
  std::optional<double> wall_time_s = {};
  std::optional<uint64_t> rays = {};
};

// {"schema": "photorque.summary/1",
//  "warnings": ["…"],  one line for each of the run's own checks that failed; [] where none did
//  "power_on_array_W": {"value": 27.1, "standard_error": 0.002}, …,
//  "provenance": {"program", "version", "git_hash", "seed", "inputs", "rays", "wall_time_s"}}
// Numbers read back as the same doubles; others than finite ones are null. Ends in a line break.
// InputError if two quantities share a name or take one of the three names above.
std::string summary_json(const Product& product, const Provenance& provenance,
                         const RunCost& cost = {});

}  // namespace photorque
