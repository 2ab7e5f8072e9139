// Conversion of records into columns in vector registers.
#pragma once

#include <array>
#include <cstring>

namespace photorque {

// out[j · out_stride + i] = rows[i][j] for i, j in [0, 4). Any alignment.
template <class T>
void transpose_4x4(const std::array<const T*, 4>& rows, T* out, int out_stride) {
  using Four __attribute__((vector_size(4 * sizeof(T)))) = T;
  Four row[4];
  for (size_t i = 0; i < 4; ++i) std::memcpy(&row[i], rows[i], sizeof(Four));
  const Four even[2] = {__builtin_shufflevector(row[0], row[1], 0, 4, 2, 6),
                        __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6)};
  const Four odd[2] = {__builtin_shufflevector(row[0], row[1], 1, 5, 3, 7),
                       __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7)};
  const Four column[4] = {__builtin_shufflevector(even[0], even[1], 0, 1, 4, 5),
                          __builtin_shufflevector(odd[0], odd[1], 0, 1, 4, 5),
                          __builtin_shufflevector(even[0], even[1], 2, 3, 6, 7),
                          __builtin_shufflevector(odd[0], odd[1], 2, 3, 6, 7)};
  for (int j = 0; j < 4; ++j) std::memcpy(out + j * out_stride, &column[j], sizeof(Four));
}

// out[j · out_stride + i] = rows[i][j] for i in [0, 8), j in [0, 4). Any alignment.
inline void transpose_8x4(const std::array<const float*, 8>& rows, float* out, int out_stride) {
  transpose_4x4<float>({rows[0], rows[1], rows[2], rows[3]}, out, out_stride);
  transpose_4x4<float>({rows[4], rows[5], rows[6], rows[7]}, out + 4, out_stride);
}

// out[j · out_stride + i] = rows[i][j] for i, j in [0, 8). Any alignment.
inline void transpose_8x8(const std::array<const float*, 8>& rows, float* out, int out_stride) {
  using Eight = float __attribute__((vector_size(32)));
  Eight row[8], pair[8], quad[8];
  for (size_t i = 0; i < 8; ++i) std::memcpy(&row[i], rows[i], sizeof(Eight));
  for (int i = 0; i < 8; i += 2) {
    pair[i] = __builtin_shufflevector(row[i], row[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    pair[i + 1] = __builtin_shufflevector(row[i], row[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (int i = 0; i < 8; ++i) {
    const Eight &a = pair[i / 4 * 4 + i % 4 / 2], &b = pair[i / 4 * 4 + i % 4 / 2 + 2];
    quad[i] = i % 2 == 0 ? __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13)
                         : __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
  }
  for (int i = 0; i < 4; ++i) {
    const Eight low = __builtin_shufflevector(quad[i], quad[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    const Eight high = __builtin_shufflevector(quad[i], quad[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    std::memcpy(out + i * out_stride, &low, sizeof(Eight));
    std::memcpy(out + (i + 4) * out_stride, &high, sizeof(Eight));
  }
}

}  // namespace photorque
