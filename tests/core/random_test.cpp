#include <gtest/gtest.h>
#include <set>

#include "core/numerics/random.h"

namespace photorque {
namespace {

// The elementary interval of a pair of dimensions that a point lies in: 2^a × 2^b cells.
uint32_t cell(double x, double y, int a, int b) {
  return (static_cast<uint32_t>(x * (1u << a)) << b) | static_cast<uint32_t>(y * (1u << b));
}

// The first 2^m points of dimensions 0 and 1 are a (0, m, 2)-net in base 2: one point in every
// elementary interval of area 2^−m (Sobol' 1967), and scrambling keeps that (Owen 1995).
TEST(Sobol, FirstTwoDimensionsAreANet) {
  const int m = 8;
  for (const uint32_t group : {0u, 1u, 5u}) {
    const SobolSequence sequence({7, 3, group});
    for (int a = 0; a <= m; ++a) {
      std::set<uint32_t> cells;
      for (uint32_t i = 0; i < (1u << m); ++i) {
        const auto p = sequence.point(i);
        cells.insert(cell(p[0], p[1], a, m - a));
      }
      EXPECT_EQ(cells.size(), 1u << m) << "group " << group << ", " << a << " bits of x";
    }
  }
}

TEST(Sobol, EveryDimensionIsStratified) {
  for (const uint32_t group : {0u, 2u}) {
    const SobolSequence sequence({1, 2, group});
    for (int d = 0; d < sobol_dimensions; ++d) {
      std::set<uint32_t> strata;
      for (uint32_t i = 4096; i < 8192; ++i) {
        strata.insert(static_cast<uint32_t>(sequence.point(i)[static_cast<size_t>(d)] * 4096));
      }
      EXPECT_EQ(strata.size(), 4096u) << "dimension " << d;
    }
  }
}

TEST(Sobol, BlocksAndSinglePointsAgree) {
  const SobolStream stream{42, 9, 0};
  const SobolSequence sequence(stream);
  std::array<std::array<uint32_t, sobol_block>, sobol_dimensions> block;
  for (const uint32_t first : {0u, 256u, 77824u, 0xffffff00u}) {
    sobol_points(stream, first,
                 {block[0].data(), block[1].data(), block[2].data(), block[3].data()});
    for (uint32_t i = 0; i < sobol_block; ++i) {
      const auto point = sequence.point(first + i);
      for (size_t d = 0; d < sobol_dimensions; ++d) {
        ASSERT_EQ(point[d], sobol_fraction(block[d][i]));
      }
    }
  }
}

// The integral of a product of smooth functions over the 4-cube: 16 replicates of 4096 points must
// be unbiased within their errors and at least 20 times better than random points.
TEST(Sobol, IntegratesASmoothFunctionUnbiasedAndFast) {
  const auto f = [](const std::array<double, 4>& p) {
    double product = 1.0;
    for (size_t d = 0; d < 4; ++d) product *= 1.0 + 0.5 * (p[d] - 0.5) * static_cast<double>(d + 1);
    return product;
  };
  double variance = 1.0;  // of f: Π (1 + c²/12) − 1, c = (d + 1)/2
  for (int d = 0; d < 4; ++d) variance *= 1.0 + 0.25 * (d + 1) * (d + 1) / 12.0;
  variance -= 1.0;
  const int replicates = 16, points = 4096;
  double sum = 0.0, squares = 0.0;
  for (int r = 0; r < replicates; ++r) {
    const SobolSequence sequence({5, static_cast<uint64_t>(r), 0});
    double mean = 0.0;
    for (uint32_t i = 0; i < points; ++i) mean += f(sequence.point(i)) / points;
    sum += mean;
    squares += (mean - 1.0) * (mean - 1.0);
  }
  const double error = std::sqrt(squares / replicates);  // of one replicate
  EXPECT_LT(std::abs(sum / replicates - 1.0), 4 * error / std::sqrt(replicates));
  EXPECT_LT(error, std::sqrt(variance / points) / 20);
}

TEST(Sobol, StreamsDiffer) {
  std::set<double> first;
  for (uint64_t seed : {1u, 2u}) {
    for (uint64_t stream : {1u, 2u}) {
      for (uint32_t group : {0u, 1u})
        first.insert(SobolSequence({seed, stream, group}).point(0)[0]);
    }
  }
  EXPECT_EQ(first.size(), 8u);
}

// Every bit of the hash flips with probability one half when any bit of the input does.
TEST(Hash, Avalanches) {
  for (int in = 0; in < 64; in += 7) {
    std::array<int, 64> flips{};
    const int trials = 2000;
    for (uint64_t i = 0; i < trials; ++i) {
      const uint64_t change = mix_bits(i * 77) ^ mix_bits((i * 77) ^ (1ull << in));
      for (int out = 0; out < 64; ++out) flips[static_cast<size_t>(out)] += (change >> out) & 1;
    }
    for (const int count : flips) EXPECT_NEAR(count / static_cast<double>(trials), 0.5, 0.06);
  }
}

struct Block {
  std::array<std::array<uint32_t, sobol_block>, sobol_dimensions> bits;
  std::array<uint32_t, sobol_block> index;
};

Block block_of(const SobolCells& cells, const SobolStream& stream, uint32_t cell, uint32_t first) {
  Block block;
  cells.points(
      stream, cell, first,
      {block.bits[0].data(), block.bits[1].data(), block.bits[2].data(), block.bits[3].data()},
      block.index.data());
  return block;
}

TEST(SobolCells, HoldEveryPointOfTheSequenceOnce) {
  const SobolStream stream{7, 3, 0};
  const SobolSequence sequence(stream);
  const SobolCells cells(14, {1, 2, 1, 2});
  EXPECT_EQ(cells.cells() * cells.points_per_cell(), 1u << 14);
  std::set<uint32_t> seen;
  for (uint32_t cell = 0; cell < cells.cells(); ++cell) {
    for (uint32_t first = 0; first < cells.points_per_cell(); first += sobol_block) {
      const Block block = block_of(cells, stream, cell, first);
      for (size_t i = 0; i < sobol_block; ++i) {
        seen.insert(block.index[i]);
        const auto expected = sequence.point(block.index[i]);
        for (size_t d = 0; d < sobol_dimensions; ++d) {
          ASSERT_EQ(sobol_fraction(block.bits[d][i]), expected[d]);
        }
      }
    }
  }
  EXPECT_EQ(seen.size(), 1u << 14);
  EXPECT_EQ(*seen.rbegin(), (1u << 14) - 1);
}

TEST(SobolCells, PointsOfACellShareTheirLeadingBits) {
  const std::array<int, sobol_dimensions> shared = {1, 3, 0, 2};
  const SobolCells cells(15, shared);
  std::set<std::array<uint32_t, sobol_dimensions>> places;
  for (uint32_t cell = 0; cell < cells.cells(); ++cell) {
    std::set<std::array<uint32_t, sobol_dimensions>> here;
    for (uint32_t first = 0; first < cells.points_per_cell(); first += sobol_block) {
      const Block block = block_of(cells, {5, 1, 0}, cell, first);
      for (size_t i = 0; i < sobol_block; ++i) {
        std::array<uint32_t, sobol_dimensions> place{};
        for (size_t d = 0; d < sobol_dimensions; ++d) {
          place[d] = shared[d] > 0 ? block.bits[d][i] >> (32 - shared[d]) : 0;
        }
        here.insert(place);
      }
    }
    ASSERT_EQ(here.size(), 1u);
    places.insert(*here.begin());
  }
  EXPECT_EQ(places.size(), cells.cells());
}

TEST(SobolCells, WithoutSharedBitsThePointsComeInTheirOrder) {
  const SobolCells cells(9, {});
  ASSERT_EQ(cells.cells(), 1u);
  const Block block = block_of(cells, {}, 0, sobol_block);
  for (uint32_t i = 0; i < sobol_block; ++i) EXPECT_EQ(block.index[i], sobol_block + i);
}

// Up to eight bits fewer than the index has, all leading bits are independent: the first four
// dimensions are a (3, 4)-sequence.
TEST(SobolCells, EverySplitGivesAllItsCells) {
  for (int a = 0; a <= 3; ++a) {
    for (int b = 0; b <= 3; ++b) {
      for (int c = 0; c <= 3; ++c) {
        for (int d = 0; d <= 3; ++d) {
          const SobolCells cells(a + b + c + d + 8, {a, b, c, d});
          EXPECT_EQ(cells.cells(), 1u << (a + b + c + d)) << a << b << c << d;
          EXPECT_EQ(cells.points_per_cell(), sobol_block) << a << b << c << d;
        }
      }
    }
  }
}

}  // namespace

}  // namespace photorque
