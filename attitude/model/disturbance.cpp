#include "attitude/model/disturbance.h"

#include <algorithm>

#include "core/errors.h"
#include "core/settings/files.h"

namespace photorque {

namespace {

// The key under which the user wrote `key`: the same quantity, possibly in another unit.
std::string written_key(const Settings& settings, const std::string& key) {
  const KeyUnit wanted = unit_of_key(key);
  for (const std::string& other : settings.keys()) {
    const KeyUnit unit = unit_of_key(other);
    if (unit.stem == wanted.stem && unit.dimension == wanted.dimension) return other;
  }
  return key;
}

// Index of the first of the three numbers of the parameter `axis`; −1 if there is none.
int first_of_axis(const Disturbance& disturbance) {
  const auto at = std::ranges::find(disturbance.parameters, "axis", &Parameter::key);
  return at == disturbance.parameters.end() ? -1
                                            : static_cast<int>(at - disturbance.parameters.begin());
}

}  // namespace

std::vector<Switch> switches_at(std::span<const double> times_s) {
  std::vector<Switch> all;
  for (const double t_s : times_s) all.push_back({t_s});
  return all;
}

Vec3 vector_at(const Parameters& parameters, size_t first) {
  return {parameters.at(first).value, parameters.at(first + 1).value,
          parameters.at(first + 2).value};
}

Vec3 bound_axis(const Disturbance& disturbance, const ExtraState& state) {
  const int first = first_of_axis(disturbance);
  if (first < 0 || state.per_body_rate.isZero()) return state.per_body_rate;
  return vector_at(disturbance.parameters, static_cast<size_t>(first)).normalized();
}

double initial_value(const Disturbance& disturbance, const ExtraState& state,
                     const Vec3& rate_body_rad_s, double turned_rad) {
  return state.initial + bound_axis(disturbance, state).dot(rate_body_rad_s) +
         (state.is_turned_angle ? turned_rad : 0.0);
}

double bound_rate_slope(const Disturbance& disturbance, const ExtraState& state, int parameter,
                        const Vec3& rate_body_rad_s) {
  const int first = first_of_axis(disturbance), component = parameter - first;
  if (first < 0 || component < 0 || component > 2 || state.per_body_rate.isZero()) return 0.0;
  const Vec3 axis = vector_at(disturbance.parameters, static_cast<size_t>(first)),
             unit = axis.normalized();
  return (rate_body_rad_s[component] - unit[component] * unit.dot(rate_body_rad_s)) / axis.norm();
}

PlacedParameters direction_parameter(const Settings& settings, const VectorKey& key) {
  PlacedParameters axis = parameters_of(settings, key);
  if (!(vector_at(axis.parameters, 0).norm() > 0.0)) {
    throw settings.error(key.name, "a zero vector", "a direction");
  }
  return axis;
}

PlacedParameters array_parameter(const Settings& settings, const std::string& key, size_t size,
                                 int first) {
  const auto require_size = [&](const std::vector<double>& x) {
    if (x.size() != size) {
      throw settings.error(key, "an array of " + std::to_string(x.size()),
                           "an array of " + std::to_string(size) + " numbers");
    }
    return x;
  };
  // Settings reads uncertain numbers and triples; longer arrays are read here. The keys inside
  // their table carry no unit, so the unit's factor is applied here.
  const bool with_sigma = settings.raw(key).is_table();
  const double factor = with_sigma ? unit_of_key(written_key(settings, key)).to_SI : 1.0;
  const std::vector<double> value =
      require_size(with_sigma ? settings.table(key).numbers("value") : settings.numbers(key));
  const std::vector<double> sigma =
      with_sigma ? require_size(settings.table(key).numbers("sigma", Range::not_negative()))
                 : std::vector<double>(size, 0.0);
  Parameters all;
  for (size_t i = 0; i < size; ++i) {
    all.push_back({key, static_cast<int>(i), factor * value[i], factor * sigma[i]});
  }
  return {first, all};
}

size_t count_as_written(const Settings& settings, std::string_view key) {
  const SettingsNode* node = &settings.raw(key);
  if (const auto* table = std::get_if<SettingsNode::Table>(&node->value)) {
    const auto value = table->find("value");
    if (value == table->end()) return 0;
    node = &value->second;
  }
  const auto* array = std::get_if<SettingsNode::Array>(&node->value);
  if (array == nullptr) return 0;
  size_t count = 0;
  for (const SettingsNode& item : *array) {
    const auto* row = std::get_if<SettingsNode::Array>(&item.value);
    count += row == nullptr ? 1 : row->size();
  }
  return count;
}

std::filesystem::path file_of(const Settings& settings, std::string_view key) {
  return existing_file(settings, key, std::filesystem::path(settings.where().file).parent_path());
}

PlacedParameters fixed_parameter(const std::string& key, std::span<const double> values_SI,
                                 int first) {
  Parameters all;
  for (size_t i = 0; i < values_SI.size(); ++i) {
    all.push_back({key, values_SI.size() == 1 ? -1 : static_cast<int>(i), values_SI[i], 0.0});
  }
  return {first, all};
}

void append(Parameters& parameters, const PlacedParameters& group) {
  if (static_cast<size_t>(group.first) != parameters.size()) {
    throw NumericalError("a law looks for " + group.parameters.front().key + " elsewhere");
  }
  parameters.insert(parameters.end(), group.parameters.begin(), group.parameters.end());
}

}  // namespace photorque
