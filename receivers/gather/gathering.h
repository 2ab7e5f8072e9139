// Which bins nothing can shade, lamp by lamp, and which something may. For the files of this folder
// only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "receivers/gather/plane.h"

namespace photorque {

// The side of a flat grid that light is gathered on.
struct GatherSide {
  const SurfaceGrid& grid;
  const Bands& bands;
  Side side;  // front or back
};

// A tile that nothing can shade for one lamp, and a ball that holds it.
struct OpenTile {
  BinTile tile;
  Ball ball;
  uint32_t lamp;
};

// What was found of one square of bins, the item of parallel work.
struct TileSight {
  std::vector<OpenTile> open;      // lamp by lamp
  std::vector<ShadedPair> shaded;  // likewise
};

// The surface, the lamps and what is between them, at one attitude.
class Gathering {
 public:
  static constexpr int tile_side = 16;  // bins

  // With `tables`, lights that many bins see get a table of their irradiance.
  Gathering(const TraceableScene& scene, const RigidTransform& lab_from_body,
            std::span<const Beam> beams, const GatherSide& side, int threads, bool tables);

  const GatherPlane& plane() const { return plane_; }
  const GatherLamp& lamp(uint32_t index) const { return lamps_[index]; }
  const std::vector<TileSight>& sights() const { return sights_; }
  size_t shaded_pairs() const;  // of a bin and a lamp

 private:
  void make_table(const DiscLight& light, int threads);
  std::vector<BinTile> tiles() const;
  std::vector<uint32_t> in_shaft(const Ball& ball, const GatherLamp& lamp,
                                 std::span<const uint32_t> candidates) const;
  void descend(const BinTile& tile, uint32_t lamp, std::span<const uint32_t> candidates,
               TileSight& sight) const;

  GatherPlane plane_;
  std::vector<TriangleCorners> triangles_;
  std::vector<GatherLamp> lamps_;
  std::vector<TileSight> sights_;
};

// What stops gathering: anything but one flat surface and lamps with uniform apertures.
bool is_gatherable(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams);

}  // namespace photorque
