#include "attitude/model/keys.h"

#include "attitude/model/platform.h"
#include "core/constants.h"

namespace photorque {

Key platform_table() {
  const Platform usual;
  const auto mass = [] { return Key::number("mass_kg", Range::positive(), "of all that turns"); };
  const auto inertia = [](unsigned forms, const char* what) {
    return Key::other("inertia_kg_m2", forms, what);
  };
  const auto with_bearing = [&](const char* name, const char* what) {
    return Key::Choice{
        name,
        what,
        {mass(), inertia(Key::an_array | Key::a_table,
                         "3 × 3, symmetric, positive, body axes, about the centre of "
                         "rotation")}};
  };
  return Key::table(
      "platform",
      {Key::choice(
           "topology",
           {with_bearing("dumbbell", "two arms on an air bearing"),
            with_bearing("tabletop", "a plate on an air bearing"),
            with_bearing("hollow", "a ball around its payload"),
            {"free",
             "no bearing",
             {mass().usually_is("1"), inertia(Key::an_array | Key::a_table, "as above")}},
            {"one_axis",
             "bearings hold all but one axis",
             {Key::choice_or("axis", words({"x", "y", "z"}), 2, "the axis that is left"),
              mass().usually_is("1"),
              inertia(Key::a_number | Key::an_array | Key::a_table, "about that axis, or 3 × 3")
                  .usually_is("1")}},
            {"planar",
             "slides on a table: x and y in the lab, and a turn about the vertical",
             {mass().usually_is("1"),
              inertia(Key::a_number | Key::an_array | Key::a_table, "about the vertical, or 3 × 3")
                  .usually_is("1")}}},
           "what it is and what holds it"),
       Key::number("tilt_limit_deg", {0.0, pi, true, false}, "the bearing's stop: a run ends there")
           .usually_is("none"),
       Key::number("battery_capacity_Ah", Range::positive(), "only says when the battery is empty")
           .usually_is("never empty"),
       Key::number_or("battery_voltage_V", usual.battery_voltage_V, Range::positive(), "nominal")},
      "what turns");
}

}  // namespace photorque
