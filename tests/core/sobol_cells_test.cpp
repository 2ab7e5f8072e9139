#include "core/numerics/random.h"

#include <gtest/gtest.h>

#include <set>

namespace photorque {
namespace {

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
