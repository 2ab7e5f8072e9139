// Force and torque of light that a surface scatters by Lambert's law.
//
// Scattered light does not depend on the direction of the incident light. The force and torque per
// watt of scattered light, including all later interactions, are therefore a field w(x) on the
// surfaces:
//
//   w(x) = ∫ cos θ/π [contact(y) + scattered fraction(y) w(y) + light continued by mirrors] dω,
//
// where y is the point that the direction ω from x meets. Rays from every patch of the surface give
// linear equations for w. They are solved for two independent sets of rays; the difference is the
// error. For the files of this folder only.
#pragma once

#include <span>
#include <vector>

#include "receivers/gather/bodies/facets.h"
#include "receivers/gather/bodies/onward.h"
#include "receivers/gather/bodies/outlines.h"
#include "receivers/gather/bodies/partition.h"

namespace photorque {

// Force and torque from each of the two sets of rays.
using TwofoldSum = Eigen::Array<double, 12, 1>;

class ScatteredLight {
 public:
  struct Effort {
    size_t patches = 1000;       // approximate number, of equal areas; at least one per facet
    uint64_t rays = 1ull << 23;  // approximate number in each set
    uint64_t seed = 1;
    int threads = 0;
  };

  // Sides of facets from which no surface is visible scatter into empty space.
  ScatteredLight(const TraceableScene& scene, const BodyShape& shape, const Vec3& about_m,
                 const Effort& effort);

  // Force and torque about the point, per watt of this band that leaves a piece of a side: the mean
  // over a whole cell, or the value of the patch at the piece's centre. Near lines(), the value
  // depends on whether another surface is close above the piece (`covered`).
  const TwofoldSum& per_watt(size_t side, const Piece& piece, bool covered, size_t band) const {
    const size_t node = piece.whole ? node_of(side, piece.cell.level, piece.cell.path)
                                    : node_at(side, piece.centre_uv);
    return per_watt_[band][node][covered ? 1 : 0];
  }
  // Edges of parts close above a side.
  std::span<const Line> lines(size_t side) const { return lines_[side]; }
  // Maximum area of a patch [m²].
  double patch_m2() const { return patch_m2_; }
  // Maximum distance [m] of a surface that counts as close above a piece.
  double close_m() const { return close_m_; }
  // For points where the arriving light is not traced: averaged with the covered fraction of the
  // patch.
  TwofoldSum per_watt_at(size_t side, const Vec2& uv, size_t band) const {
    const size_t node = node_at(side, uv);
    return mixed(per_watt_[band][node], nodes_[node].covered);
  }
  // Whether light from this side meets nothing.
  bool unseen(size_t side) const { return unseen_[side]; }

 private:
  // Node of the tree of cells of each side; undivided nodes are the patches.
  struct Node {
    uint32_t first_quarter = 0;  // 0: a patch
    bool crowded = false;        // both covered and clear points exist
    double covered = 0.0;        // fraction of its area with another surface close above
  };
  struct Patch {
    size_t side, node;
    Cell cell;
  };
  // Values for uncovered and for covered pieces.
  using Pair = std::array<TwofoldSum, 2>;
  static TwofoldSum mixed(const Pair& pair, double covered) {
    return (1.0 - covered) * pair[0] + covered * pair[1];
  }
  size_t node_of(size_t side, uint32_t level, uint64_t path) const;
  size_t node_at(size_t side, const Vec2& uv) const;
  void grow(size_t side, size_t node, const Cell& cell, std::span<const Trace> traces,
            const Facet& facet);
  void find_covered(const TraceableScene& scene, const Facets& facets, uint64_t seed);

  // Computation of the field of one band with one set of rays.
  struct Task {
    const TraceableScene& scene;
    const Facets& facets;
    Vec3 about_m;
    Effort effort;
    size_t band;
    int half;
  };
  // A patch and one kind of its points (1: covered). A crowded patch occurs twice, once per kind.
  struct Work {
    Patch patch;
    size_t kind;
  };
  // Results of the rays of some patches: the momentum left at the places that they met, and the
  // fractions that other patches scatter.
  struct Reached {
    struct Part {
      uint32_t patch;  // within the chunk
      size_t place;
      double fraction;
    };
    std::vector<WrenchSum> contact;
    std::vector<Part> parts;
  };
  std::vector<Work> work_of(const Task& task) const;
  void add_starts(const Task& task, const Work& one, uint64_t number, uint32_t count,
                  uint32_t owner, std::vector<OnwardRay>& rays) const;
  static void merge_places(std::vector<Reached::Part>& parts, size_t from);
  std::vector<Reached> send_out(const Task& task, const std::vector<Work>& work) const;
  void settle(const Task& task, const std::vector<Work>& work, const std::vector<Reached>& reached);
  void find_means(size_t band);

  double patch_m2_, close_m_;
  std::vector<uint32_t> root_;  // by side
  std::vector<bool> unseen_;    // by side
  std::vector<Node> nodes_;
  std::vector<Patch> patches_;
  std::vector<std::vector<Line>> lines_;     // by side
  std::vector<std::vector<Pair>> per_watt_;  // by band and node
};

}  // namespace photorque
