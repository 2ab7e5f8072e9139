// What external_air.cpp reads of the platform's parts.
#include "attitude/disturbances/air/external_air.h"

namespace photorque {

Key air_parts_key() {
  const auto size = [](const char* name, const char* what) {
    return Key::number(name, Range::positive(), what);
  };
  const auto faces = [] { return Key::integer_or("faces", 2, 1, 2, "of it that are wetted"); };
  const auto distance = [] {
    return Key::number("distance_m", Range::not_negative(), "of its centre from the axis");
  };
  const auto drag = [] {
    return Key::number("drag_coefficient", Range::not_negative(),
                       "on the area that meets the flow");
  };
  const auto inner = [] {
    return Key::number_or("inner_m", 0.0, Range::not_negative(), "where it begins, from the axis");
  };
  return Key::tables(
      "part",
      {Key::choice(
           "shape",
           {{"disc", "friction: spins in its plane", {size("radius_m", "of the disc"), faces()}},
            {"plate",
             "friction: moves edgewise",
             {size("length_m", "along the flow"), size("area_m2", "of a face"), distance(),
              faces()}},
            {"swept_plate",
             "friction: a radial strip",
             {size("length_m", "along the flow"), inner(),
              size("outer_m", "where it ends, beyond `inner_m`").range_that_varies(), faces()}},
            {"sphere",
             "friction",
             {size("radius_m", "of the sphere"),
              Key::number_or("moment_coefficient", sphere_moment_howarth, Range::positive(),
                             "3.27 is also quoted")}},
            {"radial_cylinder",
             "pressure: its axis points outwards",
             {size("radius_m", "of the cylinder"), size("length_m", "of it"), inner(), drag()}},
            {"upright_cylinder",
             "pressure",
             {size("radius_m", "of the cylinder"), size("length_m", "of it"), distance(), drag()}},
            {"blunt_face",
             "pressure: a stiffener, a box",
             {size("area_m2", "that meets the flow"), distance(), drag()}}},
           "what it is like; a shape that counts in the other law adds nothing"),
       Key::text("name", "of the part").usually_is("the shape"),
       Key::number_or("count", 1.0, Range::not_negative(), "of such parts, fractions too")},
      "what stands in the air of `[environment]`");
}

}  // namespace photorque
