// Lithium migrates through the battery: T = m s Q(t) × g_B, where Q is the charge drawn (eq.
// 30–34). Its displacement is from the mean position when charged to that when empty. Half a cell's
// length is the paper's upper bound; in wound cells it is smaller by orders of magnitude.
#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/mass/battery.h"

namespace photorque::kinds::battery_discharge {
namespace {

constexpr auto shift = VectorKey("shift_m_per_Ah",
                                 "displacement of the centre of mass per charge drawn, body axes; "
                                 "*or* `[[disturbance.cell]]`")
                           .optional();

namespace key {
constexpr Vec3Key electrodes(
    "electrodes_m",
    "displacement of the lithium from charged to empty, body axes; at most "
    "half a cell's length, in wound cells about 1/100 of that");
constexpr NumberKey charge_share(
    "charge_share", 1.0, Range::fraction(),
    "fraction of the battery's charge that flows through the cell: 1 in series, 1/n for n in "
    "parallel");
constexpr TablesKey cell("cell", "instead of `shift_m_per_Ah`: one table for every cell");
constexpr ChoiceKey lithium("lithium",
                            {{"exact", "Faraday's mass per charge"},
                             {"rounded", "the paper's 0.3 g/Ah"}},
                            0, "with cells: mass of the lithium that moves");
}  // namespace key

struct BatteryDischarge final : LawOf<BatteryDischarge> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.move_mass(now.charge_drawn_C * own[shift]);
  }
};

PlacedParameters shift_from_cells(const Settings& settings, double platform_mass_kg) {
  std::vector<BatteryCell> cells;
  for (const Settings& s : settings.get(key::cell)) {
    BatteryCell cell;
    cell.electrodes_body_m = s.get(key::electrodes);
    cell.charge_fraction = s.get(key::charge_share);
    cells.push_back(cell);
  }
  const bool rounded = settings.get(key::lithium) == 1;
  const Vec3 shift_m_C =
      com_shift_m_C(cells, platform_mass_kg, rounded ? lithium_as_published_kg_C : lithium_kg_C);
  return fixed_parameter(shift.name, {shift_m_C.data(), 3});
}

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  return make_disturbance<BatteryDischarge>(
      {settings.has(key::cell) ? shift_from_cells(settings, context.platform.mass_kg)
                               : parameters_of(settings, shift)},
      Stage::mass);
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "battery_discharge",
          .summary = "lithium moves inside the battery as it discharges",
          .read = read,
          .screening =
              {.parametrisations =
                   {{"the centre of mass moves in proportion to the charge drawn from the battery",
                     {EffectKey::vector(shift.name, 3e-6)}}},
               .needs = Requirement::charge,
               .confusable_kinds = {{"mass_shift", Requirement::charge},
                                    {"static_unbalance", Requirement::charge}}},
          .budget = {.paper_figure = "battery_torque_N_m"},
          .keys = {shift, key::cell.of({key::electrodes, key::charge_share}), key::lithium}};
}

}  // namespace photorque::kinds::battery_discharge
