// Memory: the memory that a run needs, reported before it starts.
#pragma once

#include <cstdint>
#include <optional>

#include "core/errors.h"

namespace photorque {

// Memory that a run may use [bytes]: what the user allows (--max-memory), else nine tenths of what
// the machine, or the control group that the process lives in, has free; no limit where neither is
// known.
uint64_t memory_limit_bytes(std::optional<double> allowed_GB);

// Sets the memory allowed by the user as a limit of the process. An allocation beyond it ends the
// run with "not enough memory" and exit status 3.
void set_memory_limit(std::optional<double> allowed_GB);

// Throws InputError at `where` if about `bytes` for `what` exceed the limit.
void require_memory(std::optional<double> allowed_GB, uint64_t bytes, const InputLocation& where,
                    const std::string& what);

}  // namespace photorque
