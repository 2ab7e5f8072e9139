// An LED with its lens: a round aperture with a given angular profile.
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
  return {"led", "One LED: a round aperture with an angular profile", make,
          joined({{source_key::name.with_default("led"), source_key::power,
                   source_key::position.meaning("centre of the aperture, lab axes")},
                  {source_key::direction, source_key::aim},
                  lamp_keys()})};
}

}  // namespace photorque::kinds::led
