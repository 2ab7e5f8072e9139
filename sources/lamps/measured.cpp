#include "sources/lamps/measured.h"

#include "core/files.h"
#include "core/provenance.h"
#include "sources/lamps/settings.h"

namespace photorque {

SourceFile read_source_file(const Settings& settings, const SourceContext& context) {
  const std::filesystem::path given = settings.text("file");
  if (context.within) {
    if (const auto bytes = context.within(given.string())) {
      if (context.input) context.input(given.string(), content_hash(*bytes));
      return {given.string(), *bytes};
    }
  }
  const std::filesystem::path path = context.folder / given;
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) {
    throw settings.error("file", "\"" + given.string() + "\"",
                         "a file that exists beside the experiment");
  }
  SourceFile file{path.string(), read_file(path)};
  if (context.input) context.input(given.filename().string(), content_hash(file.bytes));
  return file;
}

std::vector<Beam> place_lamps(const Settings& settings, const std::string& name,
                              const std::shared_ptr<const Emitter>& lamp, const Spectrum& spectrum,
                              const std::optional<UniformAperture>& aperture) {
  const bool several = settings.has("positions_m");
  if (several && settings.has("position_m")) {
    throw settings.error("positions_m", "also position_m", "only one of the two");
  }
  const std::vector<Vec3> positions_m = several ? settings.vectors3("positions_m")
                                                : std::vector<Vec3>{settings.vector3("position_m")};
  const double turn_rad = settings.number_or("turn_deg", 0.0);
  const RigidTransform turn{Quat(Eigen::AngleAxisd(turn_rad, Vec3::UnitZ())), Vec3::Zero()};
  std::vector<Beam> beams;
  for (size_t i = 0; i < positions_m.size(); ++i) {
    const Vec3 direction = read_direction(settings, positions_m[i]);
    beams.push_back({several ? name + "[" + std::to_string(i) + "]" : name, lamp,
                     frame_looking_along(direction, positions_m[i]) * turn, spectrum, aperture});
  }
  return beams;
}

}  // namespace photorque
