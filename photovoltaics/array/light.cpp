#include "photovoltaics/array/light.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/errors.h"

namespace photorque {
namespace {

// Overlap of [low, high] with the cells of a regular division of [start, end] into `count`.
struct Overlap {
  int index;
  double fraction;  // fraction of the division's cell
};

std::vector<Overlap> overlaps(double low, double high, double start, double end, int count) {
  const double width = (end - start) / count;
  const double from = (low - start) / width, to = (high - start) / width;
  std::vector<Overlap> parts;
  const int first = std::clamp(static_cast<int>(std::floor(from)), 0, count - 1);
  for (int i = first; i < count && i < to; ++i) {
    const double fraction = std::min(to, i + 1.0) - std::max(from, static_cast<double>(i));
    if (fraction > 0) parts.push_back({i, fraction});
  }
  return parts;
}

}  // namespace

ArrayLight array_light(const FluxMapReceiver& receiver, const BinSums& sums, const BinSums& entry) {
  const SurfaceGrid& grid = receiver.grid();
  ArrayLight light{grid, receiver.bands().count(), {}, entry};
  light.power_W = {grid.bins() * static_cast<size_t>(light.bands), sums.replicates, {}, {}};
  const size_t bounced = receiver.direct_entries();
  for (int r = 0; r < sums.replicates; ++r) {
    const auto all = sums.of(r);
    for (size_t bin = 0; bin < grid.bins(); ++bin) {
      for (size_t band = 0; band < static_cast<size_t>(light.bands); ++band) {
        const size_t incident = receiver.entry(bin, band);
        light.power_W.sums.push_back(all[incident] + all[bounced + incident]);
        if (r == 0) light.power_W.bound.push_back(sums.bound_of(incident));
      }
    }
  }
  return light;
}

void add_back_light(ArrayLight& light, const ArrayLight& back, double fraction) {
  constexpr double rounding_m2 = 1e-9;
  bool is_alike = light.grid.width == back.grid.width && light.grid.height == back.grid.height &&
                  light.power_W.sums.size() == back.power_W.sums.size();
  for (size_t bin = 0; is_alike && bin < light.grid.bins(); ++bin) {
    is_alike = std::abs(light.grid.area_m2[bin] - back.grid.area_m2[bin]) <= rounding_m2;
  }
  if (!is_alike) {
    throw InputError({}, "array.back.receiver", "another grid than that of array.receiver",
                     "a flux_map of the same node, axes and bins with side = \"back\"");
  }
  const size_t bins = light.power_W.bins;
  BinSums& entry = light.entry;
  if (entry.bins == 0) {  // all light of the front enters
    entry = {2 * bins, light.power_W.replicates, {}, {}};
    for (int r = 0; r < entry.replicates; ++r) {
      const auto front = light.power_W.of(r);
      for (int half = 0; half < 2; ++half) {
        entry.sums.insert(entry.sums.end(), front.begin(), front.end());
      }
    }
  }
  for (int r = 0; r < entry.replicates; ++r) {
    const auto from_back = back.power_W.of(r);
    const size_t all = static_cast<size_t>(r) * entry.bins, entering = all + bins;
    for (size_t bin = 0; bin < bins; ++bin) {
      entry.sums[all + bin] += from_back[bin];
      entry.sums[entering + bin] += fraction * from_back[bin];
    }
  }
  for (size_t i = 0; i < back.power_W.sums.size(); ++i) {
    light.power_W.sums[i] += back.power_W.sums[i];
  }
  for (size_t i = 0; i < light.power_W.bound.size(); ++i) {
    light.power_W.bound[i] += back.power_W.bound_of(i);
  }
}

std::vector<CellRectangle> cell_rectangles(const SurfaceGrid& grid, int columns, int rows,
                                           double gap, double margin) {
  const auto side = [&](double length, int count, const char* name) {
    const double cell = (length - 2 * margin - (count - 1) * gap) / count;
    if (!(cell > 0)) {
      throw InputError({}, "array",
                       "gaps and margins wider than the receiver's " + std::string(name) + " of " +
                           std::to_string(length),
                       "room for " + std::to_string(count) + " cells");
    }
    return cell;
  };
  const double du = side(grid.u_high - grid.u_low, columns, "length along u");
  const double dv = side(grid.v_high - grid.v_low, rows, "length along v");
  std::vector<CellRectangle> cells;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double u = grid.u_low + margin + column * (du + gap);
      const double v = grid.v_low + margin + row * (dv + gap);
      cells.push_back({u, u + du, v, v + dv});
    }
  }
  return cells;
}

std::vector<BinPart> parts_of_rectangle(const CellRectangle& cell, const SurfaceGrid& grid) {
  std::vector<BinPart> parts;
  for (const Overlap& v : overlaps(cell.v_low, cell.v_high, grid.v_low, grid.v_high, grid.height)) {
    for (const Overlap& u :
         overlaps(cell.u_low, cell.u_high, grid.u_low, grid.u_high, grid.width)) {
      parts.push_back(
          {static_cast<uint32_t>(v.index * grid.width + u.index), u.fraction * v.fraction});
    }
  }
  return parts;
}

CellCover::CellCover(const ArrayLight& light, std::span<const std::vector<BinPart>> cells)
    : bands_(static_cast<size_t>(light.bands)), first_{0} {
  for (const std::vector<BinPart>& parts : cells) {
    double area_m2 = 0.0;
    for (const BinPart& part : parts) area_m2 += part.fraction * light.grid.area_m2[part.bin];
    parts_.insert(parts_.end(), parts.begin(), parts.end());
    first_.push_back(parts_.size());
    area_m2_.push_back(area_m2);
  }
}

std::vector<double> CellCover::gather(std::span<const double> power_W) const {
  std::vector<double> sums(cells() * bands_, 0.0);
  for (size_t cell = 0; cell < cells(); ++cell) {
    for (size_t p = first_[cell]; p < first_[cell + 1]; ++p) {
      for (size_t band = 0; band < bands_; ++band) {
        sums[cell * bands_ + band] += parts_[p].fraction * power_W[parts_[p].bin * bands_ + band];
      }
    }
  }
  return sums;
}

}  // namespace photorque
