// Cells in series from one table, four at a time in vector registers.
#include "photovoltaics/cell/table_quad.h"

namespace photorque {
namespace {

// {slope, curvature} of one cell after the other.
void store(Quad slope_ohm, Quad curvature_V_A2, JunctionState* states) {
  static_assert(sizeof(JunctionState) == 2 * sizeof(double));
  const Quad low = __builtin_shufflevector(slope_ohm, curvature_V_A2, 0, 4, 1, 5);
  const Quad high = __builtin_shufflevector(slope_ohm, curvature_V_A2, 2, 6, 3, 7);
  std::memcpy(&states[0].slope_ohm, &low, sizeof low);
  std::memcpy(&states[2].slope_ohm, &high, sizeof high);
}

}  // namespace

DiodeVoltage DiodeVoltageTable::series_one_by_one(std::span<const double> photocurrents_A,
                                                  std::span<const double> copies, double current_A,
                                                  std::span<JunctionState> states) const {
  DiodeVoltage sum;
  for (size_t i = 0; i < photocurrents_A.size(); ++i) {
    const DiodeVoltage v = at(photocurrents_A[i] - current_A);
    states[i] = {v.slope_ohm, v.curvature_V_A2};
    sum.value_V += copies[i] * v.value_V;
    sum.slope_ohm += copies[i] * v.slope_ohm;
    sum.curvature_V_A2 += copies[i] * v.curvature_V_A2;
    sum.third_V_A3 += copies[i] * v.third_V_A3;
  }
  return sum;
}

DiodeVoltage DiodeVoltageTable::series_at(std::span<const double> photocurrents_A,
                                          std::span<const double> copies, double current_A,
                                          std::span<JunctionState> states) const {
  Quad value_V{}, slope_ohm{}, curvature_V_A2{}, third_V_A3{};
  QuadBits any_outside{};
  for (size_t i = 0; i < photocurrents_A.size(); i += lanes) {
    const QuadVoltage v = quad_at_dark(quad_at(&photocurrents_A[i]) - current_A);
    const Quad weight = quad_at(&copies[i]);
    any_outside |= v.outside;
    value_V = multiply_add(weight, v.value_V, value_V);
    slope_ohm = multiply_add(weight, v.slope_ohm, slope_ohm);
    curvature_V_A2 = multiply_add(weight, v.curvature_V_A2, curvature_V_A2);
    third_V_A3 = multiply_add(weight, v.third_V_A3, third_V_A3);
    store(v.slope_ohm, v.curvature_V_A2, &states[i]);
  }
  if (any_of(any_outside)) {
    return series_one_by_one(photocurrents_A, copies, current_A, states);
  }
  return {sum_of(value_V), sum_of(slope_ohm), sum_of(curvature_V_A2), sum_of(third_V_A3)};
}

}  // namespace photorque
