// Loops over threads. The only place that uses TBB.
//
// Results must not depend on the number of threads: cut the work into a fixed number of items,
// let each item write only its own output, and combine the outputs in order of the items.
#pragma once

#include <cstddef>
#include <functional>

namespace photorque {

// Calls `body(i)` once for every i in [0, count), in any order, on at most `threads` threads
// (0: one per hardware thread; may exceed the hardware). An exception from `body` is rethrown here.
void parallel_for(size_t count, int threads, const std::function<void(size_t)>& body);

}  // namespace photorque
