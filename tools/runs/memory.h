// Memory requirements of a run, checked before it starts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/errors.h"

namespace photorque {

// Memory that a process of the control group `group` may still use [bytes]: the smallest
// remaining amount of the group and of those above it, whose folders lie in `mount`; none without a
// limit.
std::optional<uint64_t> left_of_group_bytes(const std::filesystem::path& mount,
                                            const std::filesystem::path& group);

// Memory that a run may use [bytes]: the user's limit (--max-memory), otherwise nine tenths of the
// free memory of the machine or of the process's control group; unlimited if neither is known.
uint64_t memory_limit_bytes(std::optional<double> allowed_GB);

// Sets the user's limit for the process. An allocation beyond it ends the run with "not enough
// memory" and exit status 3.
void set_memory_limit(std::optional<double> allowed_GB);

// Throws InputError at `where` if about `bytes` for `what` exceed the limit.
void require_memory(std::optional<double> allowed_GB, uint64_t bytes, const InputLocation& where,
                    const std::string& what);

}  // namespace photorque
