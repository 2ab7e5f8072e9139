#include "core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace photorque {

void parallel_for(size_t count, int threads, const std::function<void(size_t)>& body) {
  // One thread takes no part in TBB: a loop within the work of another loop would hold up that
  // one's threads, whose number is one for the whole program.
  if (threads == 1) {
    for (size_t i = 0; i < count; ++i) body(i);
    return;
  }
  const auto loop = [&] {
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, count, 1),
        [&](const tbb::blocked_range<size_t>& range) {
          for (size_t i = range.begin(); i != range.end(); ++i) body(i);
        },
        tbb::simple_partitioner());
  };
  if (threads <= 0) {
    loop();
    return;
  }
  // An arena alone never gets more workers than the machine has; the control removes that limit.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<size_t>(threads));
  tbb::task_arena(threads).execute(loop);
}

}  // namespace photorque
