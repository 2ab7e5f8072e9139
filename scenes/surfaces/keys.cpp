// The optical keys of a material, which settings.cpp reads.
#include "scenes/surfaces/settings.h"

namespace photorque {
namespace {

Key fraction_key(const std::string& name, const std::string& what) {
  return Key::number(name, Range::fraction(), what).one_or_several().optional();
}

std::vector<Key> side_keys() {
  return {
      fraction_key("absorptance", "fraction of the incident power; a number or one per band"),
      fraction_key("specular", "fraction that is mirrored"),
      fraction_key("diffuse", "fraction that is scattered by Lambert's law"),
      fraction_key("transmittance",
                   "fraction that goes straight through; of the four one may be left out: they sum "
                   "to 1"),
      fraction_key("retroreflectance", "a fifth fraction, back where it came from"),
      Key::number("roughness", {0.0, 1.0, true},
                  "as in glTF: the specular fraction leaves by GGX microfacets of alpha = "
                  "roughness², Smith masking, with light reflected more than once given back, so "
                  "that `specular` stays the reflectance at every angle")
          .optional(),
      Key::number("slope_error_mrad", {1e-6, 0.2},
                  "instead: a mirror whose normal leans by Gaussian slopes of this standard "
                  "deviation along each axis; reflected rays stray by twice that")
          .optional(),
      Key::number("refractive_index", {1.0, 10.0},
                  "glass in front, by Fresnel's law for unpolarised light; the fractions are those "
                  "behind it")
          .optional(),
      Key::text("brdf_file", "instead of the fractions: measured scattering").optional(),
      Key::number_or("brdf_scale", 1.0, Range::positive(),
                     "a factor on it; a number or one per band")
          .one_or_several()};
}

}  // namespace

std::vector<Key> sheet_keys() {
  return joined(
      {side_keys(),
       {Key::table("back", side_keys(), "the same for the other side").usually_is("as the front"),
        Key::number_or("reemitted", 0.0, Range::fraction(),
                       "of the sheet: this fraction of the absorbed power leaves at once as heat, "
                       "by Lambert's law, from both sides in proportion to their emissivities. In "
                       "forces and torques only: the power stays booked as absorbed, and no part "
                       "is lit by another's heat"),
        Key::number_or("emissivity_front", 1.0, Range::fraction(), "of that heat"),
        Key::number_or("emissivity_back", 1.0, Range::fraction(), "of that heat")}});
}

}  // namespace photorque
