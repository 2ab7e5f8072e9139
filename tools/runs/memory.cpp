#include "tools/runs/memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "core/text/format.h"

namespace photorque {

namespace fs = std::filesystem;

namespace {

constexpr double bytes_per_GB = 1e9;

std::optional<uint64_t> number_of_file(const fs::path& path) {
  std::ifstream in(path);
  uint64_t value = 0;
  if (in >> value) return value;
  return std::nullopt;
}

// Available memory from /proc/meminfo, which states kibibytes.
std::optional<uint64_t> available_bytes() {
  std::ifstream in("/proc/meminfo");
  std::string word;
  uint64_t kibibytes = 0;
  while (in >> word) {
    if (word == "MemAvailable:" && in >> kibibytes) return kibibytes * 1024;
  }
  return std::nullopt;
}

// This process's control group, which Linux states as a path after "0::".
std::string own_group() {
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("0::/")) return line.substr(4);
  }
  return "";
}

std::string in_GB(uint64_t bytes) {
  return printed("%.3g GB", static_cast<double>(bytes) / bytes_per_GB);
}

}  // namespace

std::optional<uint64_t> left_of_group_bytes(const fs::path& mount, const fs::path& group) {
  std::optional<uint64_t> left;
  for (fs::path inner = group;; inner = inner.parent_path()) {
    const auto most = number_of_file(mount / inner / "memory.max");
    const auto taken = number_of_file(mount / inner / "memory.current");
    if (most && taken) {
      const uint64_t rest = *most > *taken ? *most - *taken : 0;
      left = left ? std::min(*left, rest) : rest;
    }
    if (inner.empty()) return left;
  }
}

uint64_t memory_limit_bytes(std::optional<double> allowed_GB) {
  if (allowed_GB) return static_cast<uint64_t>(*allowed_GB * bytes_per_GB);
  constexpr uint64_t no_limit = std::numeric_limits<uint64_t>::max();
  const uint64_t free_bytes =
      std::min(available_bytes().value_or(no_limit),
               left_of_group_bytes("/sys/fs/cgroup", own_group()).value_or(no_limit));
  return free_bytes == no_limit ? no_limit : free_bytes / 10 * 9;
}

void set_memory_limit(std::optional<double> allowed_GB) {
  if (!allowed_GB) return;
  const rlimit limit{static_cast<rlim_t>(memory_limit_bytes(allowed_GB)), RLIM_INFINITY};
  ::setrlimit(RLIMIT_DATA, &limit);
}

void require_memory(std::optional<double> allowed_GB, uint64_t bytes, const InputLocation& where,
                    const std::string& what) {
  const uint64_t limit = memory_limit_bytes(allowed_GB);
  if (bytes <= limit) return;
  throw InputError(where, what, "what takes about " + in_GB(bytes),
                   "at most " + in_GB(limit) + " (--max-memory)");
}

}  // namespace photorque
