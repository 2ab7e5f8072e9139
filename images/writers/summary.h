// The headline figures of a run, for programs.
#pragma once

#include <optional>
#include <string>

#include "core/product.h"
#include "core/provenance.h"

namespace photorque {

inline constexpr const char* summary_schema = "photorque.summary/1";

// What a run cost; left out where unknown. The wall time is the only number that differs between
// two equal runs, and stands on a line of its own.
struct RunCost {
  std::optional<double> wall_time_s = {};
  std::optional<uint64_t> rays = {};
};

// {"schema": "photorque.summary/1",
//  "warnings": ["…"],  one line for each of the run's own checks that failed; [] where none did
//  "power_on_array_W": {"value": 27.1, "standard_error": 0.002}, …,
//  "provenance": {"program", "version", "git_hash", "seed", "inputs", "rays", "wall_time_s"}}
// Numbers read back as the same doubles; what is not finite is null. Ends in a line break.
// InputError if two quantities share a name or take one of the three names above.
std::string summary_json(const Product& product, const Provenance& provenance,
                         const RunCost& cost = {});

}  // namespace photorque
