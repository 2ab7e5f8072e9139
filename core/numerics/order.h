#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace photorque {

// The numbers 0 … count − 1, sorted by `less`; numbers that it does not distinguish keep their
// order. Indices are sorted instead of values because values may contain quaternions: the buffer of
// std::stable_sort ignores alignments above 16 bytes in libstdc++ 12 (GCC bug 105258).
template <class Less>
std::vector<size_t> sorted_indices(size_t count, Less less) {
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, less);
  return order;
}

}  // namespace photorque
