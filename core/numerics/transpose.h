// Conversion of records into columns in vector registers.
#pragma once

#include <array>

#ifdef __AVX__
#include <immintrin.h>
#endif

namespace photorque {

// out[j · out_stride + i] = rows[i][j] for i, j in [0, 8). Any alignment.
inline void transpose_8x8(const std::array<const float*, 8>& rows, float* out, int out_stride) {
#ifdef __AVX__
  __m256 row[8], pair[8], quad[8];
  for (int i = 0; i < 8; ++i) row[i] = _mm256_loadu_ps(rows[static_cast<size_t>(i)]);
  for (int i = 0; i < 8; i += 2) {
    pair[i] = _mm256_unpacklo_ps(row[i], row[i + 1]);
    pair[i + 1] = _mm256_unpackhi_ps(row[i], row[i + 1]);
  }
  for (int i = 0; i < 8; i += 4) {
    quad[i] = _mm256_shuffle_ps(pair[i], pair[i + 2], 0x44);
    quad[i + 1] = _mm256_shuffle_ps(pair[i], pair[i + 2], 0xee);
    quad[i + 2] = _mm256_shuffle_ps(pair[i + 1], pair[i + 3], 0x44);
    quad[i + 3] = _mm256_shuffle_ps(pair[i + 1], pair[i + 3], 0xee);
  }
  for (int i = 0; i < 4; ++i) {
    _mm256_storeu_ps(out + i * out_stride, _mm256_permute2f128_ps(quad[i], quad[i + 4], 0x20));
    _mm256_storeu_ps(out + (i + 4) * out_stride,
                     _mm256_permute2f128_ps(quad[i], quad[i + 4], 0x31));
  }
#else
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) out[j * out_stride + i] = rows[static_cast<size_t>(i)][j];
  }
#endif
}

// out[j · out_stride + i] = rows[i][j] for i in [0, 8), j in [0, 4). Any alignment.
inline void transpose_8x4(const std::array<const float*, 8>& rows, float* out, int out_stride) {
#ifdef __AVX__
  __m256 row[4];  // rows i and i + 4
  for (size_t i = 0; i < 4; ++i) {
    row[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(rows[i])),
                                  _mm_loadu_ps(rows[i + 4]), 1);
  }
  const __m256 low[2] = {_mm256_unpacklo_ps(row[0], row[1]), _mm256_unpacklo_ps(row[2], row[3])};
  const __m256 high[2] = {_mm256_unpackhi_ps(row[0], row[1]), _mm256_unpackhi_ps(row[2], row[3])};
  _mm256_storeu_ps(out, _mm256_shuffle_ps(low[0], low[1], 0x44));
  _mm256_storeu_ps(out + out_stride, _mm256_shuffle_ps(low[0], low[1], 0xee));
  _mm256_storeu_ps(out + 2 * out_stride, _mm256_shuffle_ps(high[0], high[1], 0x44));
  _mm256_storeu_ps(out + 3 * out_stride, _mm256_shuffle_ps(high[0], high[1], 0xee));
#else
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 4; ++j) out[j * out_stride + i] = rows[static_cast<size_t>(i)][j];
  }
#endif
}

// out[j · out_stride + i] = rows[i][j] for i, j in [0, 4). Any alignment.
inline void transpose_4x4(const std::array<const double*, 4>& rows, double* out, int out_stride) {
#ifdef __AVX__
  const __m256d row[4] = {_mm256_loadu_pd(rows[0]), _mm256_loadu_pd(rows[1]),
                          _mm256_loadu_pd(rows[2]), _mm256_loadu_pd(rows[3])};
  const __m256d even[2] = {_mm256_unpacklo_pd(row[0], row[1]), _mm256_unpacklo_pd(row[2], row[3])};
  const __m256d odd[2] = {_mm256_unpackhi_pd(row[0], row[1]), _mm256_unpackhi_pd(row[2], row[3])};
  _mm256_storeu_pd(out, _mm256_permute2f128_pd(even[0], even[1], 0x20));
  _mm256_storeu_pd(out + out_stride, _mm256_permute2f128_pd(odd[0], odd[1], 0x20));
  _mm256_storeu_pd(out + 2 * out_stride, _mm256_permute2f128_pd(even[0], even[1], 0x31));
  _mm256_storeu_pd(out + 3 * out_stride, _mm256_permute2f128_pd(odd[0], odd[1], 0x31));
#else
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) out[j * out_stride + i] = rows[static_cast<size_t>(i)][j];
  }
#endif
}

}  // namespace photorque
