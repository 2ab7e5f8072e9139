#include "core/old_names.h"

#include <algorithm>
#include <mutex>

namespace photorque {
namespace {

struct Notices {
  std::mutex mutex;
  std::vector<std::string> all;
};

Notices& notices() {
  static Notices kept;
  return kept;
}

}  // namespace

void note_old_name(const std::string& notice) {
  constexpr size_t most = 100;
  Notices& kept = notices();
  const std::scoped_lock lock(kept.mutex);
  if (kept.all.size() < most && std::ranges::find(kept.all, notice) == kept.all.end()) {
    kept.all.push_back(notice);
  }
}

std::vector<std::string> old_name_notices() {
  Notices& kept = notices();
  const std::scoped_lock lock(kept.mutex);
  return kept.all;
}

}  // namespace photorque
