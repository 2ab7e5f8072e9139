// An LED with its lens: a round aperture with a given angular profile.
#include "sources/lamps/keys.h"
#include "sources/lamps/settings.h"

namespace photorque::kinds::led {
namespace {

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  const std::string name = settings.get(source_key::name.with_default("led"));
  const Vec3 position_m = settings.get(source_key::position);
  const Vec3 direction = read_direction(settings, position_m);
  const double power_W = settings.get(source_key::power);
  const Lamp lamp = read_lamp(settings, context, name, power_W);
  return {{name, lamp.emitter, frame_looking_along(direction, position_m), lamp.spectrum,
           lamp.aperture}};
}

}  // namespace

SourceKind kind() {
  return {"led",
          "One LED: a round aperture with an angular profile",
          make,
          {{"power_W", {2.0}},
           {"aperture_diameter_m", {0.02}},
           {"profile", {"gaussian"}},
           {"fwhm_deg", {3.0}},
           {"halo_fraction", {0.2}},
           {"halo_fwhm_deg", {12.0}},
           {"wavelength_nm", {730.0}},
           {"position_m", {SettingsNode::Array{{0.0}, {0.0}, {1.5}}}},
           {"aim_m", {SettingsNode::Array{{0.0}, {0.0}, {0.0}}}}},
          joined({{source_key::name.with_default("led"), source_key::power,
                   source_key::position.meaning("centre of the aperture, lab axes")},
                  {source_key::direction, source_key::aim},
                  lamp_keys()})};
}

}  // namespace photorque::kinds::led
