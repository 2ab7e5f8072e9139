#include "core/parallel.h"

#if defined(__SANITIZE_THREAD__)
#define PHOTORQUE_WATCHED_THREADS
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define PHOTORQUE_WATCHED_THREADS
#endif
#endif

#ifdef PHOTORQUE_WATCHED_THREADS
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#else
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace photorque {

#ifdef PHOTORQUE_WATCHED_THREADS

// TBB is not compiled with ThreadSanitizer. The sanitizer therefore does not see that TBB passes
// work between threads in order, and reports every loop. The same loop on plain threads shows only
// the relevant errors: races between bodies.
void parallel_for(size_t count, int threads, const std::function<void(size_t)>& body) {
  if (threads == 1) {
    for (size_t i = 0; i < count; ++i) body(i);
    return;
  }
  std::atomic<size_t> next{0};
  std::mutex failing;
  std::exception_ptr failure;
  const auto work = [&] {
    for (size_t i = next++; i < count; i = next++) {
      try {
        body(i);
      } catch (...) {
        const std::lock_guard lock(failing);
        if (!failure) failure = std::current_exception();
        next = count;
      }
    }
  };
  std::vector<std::jthread> others;
  const size_t most = threads > 1 ? static_cast<size_t>(threads) : 2;
  for (size_t k = 1; k < std::min(most, count); ++k) others.emplace_back(work);
  work();
  others.clear();  // joins
  if (failure) std::rethrow_exception(failure);
}

#else

void parallel_for(size_t count, int threads, const std::function<void(size_t)>& body) {
  // A single thread does not use TBB. TBB's limit of threads is global, so a loop with one thread
  // within another loop would also limit the threads of the outer loop.
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
  // An arena alone never has more workers than the machine has cores; the control removes that
  // limit.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<size_t>(threads));
  tbb::task_arena(threads).execute(loop);
}

#endif

}  // namespace photorque
