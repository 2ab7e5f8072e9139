#include "photovoltaics/array/design.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "core/text/parse.h"
#include "photovoltaics/array/keys.h"

namespace photorque {
namespace {

// Cells in the order in which they are joined.
std::vector<int> serpentine(int columns, int rows, bool along_columns) {
  std::vector<int> order;
  const int lines = along_columns ? columns : rows, length = along_columns ? rows : columns;
  for (int line = 0; line < lines; ++line) {
    for (int i = 0; i < length; ++i) {
      const int place = line % 2 == 0 ? i : length - 1 - i;
      order.push_back(along_columns ? place * columns + line : line * columns + place);
    }
  }
  return order;
}

// One level of a regular circuit: `count` equal parts in series or in parallel.
struct Level {
  CellGroup::Join join = CellGroup::Join::series;
  size_t count = 1;
  bool bypassed = false;  // a bypass diode beside each part
};

// Reads a level such as "series 3 bypass" or "parallel 2".
Level read_level(const Settings& array, const std::string& text) {
  const std::vector<std::string_view> words = words_of(text);
  Level level;
  const bool is_parallel = !words.empty() && words[0] == "parallel";
  const auto count = words.size() > 1 ? number_in(words[1]) : std::nullopt;
  const bool good = (words.size() == 2 || (words.size() == 3 && words[2] == "bypass")) &&
                    (is_parallel || words[0] == "series") && count && *count >= 1.0 &&
                    *count <= most_cells && *count == std::floor(*count);
  if (!good) {
    throw array.error(array_key::circuit, in_quotes(text),
                      "\"series N\", \"parallel N\" or either with \"bypass\" after it");
  }
  if (is_parallel) level.join = CellGroup::Join::parallel;
  level.count = static_cast<size_t>(*count);
  level.bypassed = words.size() == 3;
  return level;
}

// The circuit of the cells, which are cut into equal parts level by level.
CellGroup circuit_of(std::span<const int> cells, std::span<const Level> levels,
                     const Diode& bypass) {
  if (levels.empty()) return {cells[0]};
  const Level& level = levels[0];
  const size_t size = cells.size() / level.count;
  std::vector<CellGroup> parts;
  for (size_t i = 0; i < level.count; ++i) {
    CellGroup part = circuit_of(cells.subspan(i * size, size), levels.subspan(1), bypass);
    if (level.bypassed) {
      if (part.is_cell() || part.bypass.kind != Diode::Kind::none) {
        part = CellGroup(CellGroup::Join::series, {part});
      }
      part.bypass = bypass;
    }
    parts.push_back(std::move(part));
  }
  return {level.join, std::move(parts)};
}

ArrayWiring read_circuit(const Settings& array, const std::vector<int>& order, const Diode& bypass,
                         const Diode& blocking) {
  std::vector<Level> levels;
  size_t cells = 1;
  for (const std::string& text : array.get(array_key::circuit)) {
    levels.push_back(read_level(array, text));
    cells = std::min<size_t>(cells * levels.back().count, size_t{most_cells} + 1);
  }
  if (cells != order.size()) {
    throw array.error(array_key::circuit,
                      cells > most_cells ? "more than " + std::to_string(most_cells) + " cells"
                                         : std::to_string(cells) + " cells",
                      "the " + std::to_string(order.size()) +
                          " cells of the array, as the product of all numbers");
  }
  return wiring_of(circuit_of(order, levels, bypass), blocking);
}

template <class Kinds>
Diode read_diode(const Settings& array, const Kinds& kinds, const TableKey& table, double drop_V,
                 double temperature_K) {
  Diode diode;
  diode.kind = static_cast<Diode::Kind>(array.get(kinds));
  diode.drop_V = drop_V;
  diode.temperature_K = temperature_K;
  if (!array.has(table)) return diode;
  const Settings numbers = array.get(table);
  diode.drop_V = numbers.get(diode_key::drop.with_default(drop_V));
  diode.saturation_A = numbers.get(diode_key::saturation);
  diode.ideality = numbers.get(diode_key::ideality);
  diode.series_ohm = numbers.get(diode_key::series);
  return diode;
}

// Reads the key `wiring`. Every cell must be an integer in range and occur only once; anything else
// is an error.
class WiringReader {
 public:
  WiringReader(const Settings& array, int cells, const Diode& bypass)
      : array_(array), used_(static_cast<size_t>(cells), false), bypass_(bypass) {}

  ArrayWiring read(const Diode& blocking) {
    ArrayWiring wiring;
    for (const SettingsNode& string : list(array_.raw(array_key::wiring), "strings")) {
      ArrayWiring::String joined{{}, blocking};
      for (const SettingsNode& substring : list(string, "substrings")) {
        std::vector<CellGroup> rows;
        for (const SettingsNode& row : list(substring, "cells")) {
          rows.push_back(read_group(row, CellGroup::Join::parallel, 0));
        }
        joined.substrings.push_back({std::move(rows), bypass_});
      }
      wiring.strings.push_back(std::move(joined));
    }
    return wiring;
  }

 private:
  const SettingsNode::Array& list(const SettingsNode& node, const char* what) const {
    const auto* array = std::get_if<SettingsNode::Array>(&node.value);
    if (array == nullptr || array->empty()) fail(node, std::string("an array of ") + what);
    return *array;
  }

  // Reads a cell, or a list whose members are joined in parallel and in series alternately.
  CellGroup read_group(const SettingsNode& node, CellGroup::Join join, int depth) {
    constexpr int deepest = 32;
    if (!node.is_array()) return {read_cell(node)};
    if (depth > deepest) fail(node, "at most 32 levels of joined cells");
    const bool is_parallel = join == CellGroup::Join::parallel;
    const SettingsNode::Array& members = list(node, "cells");
    CellGroup group(join, {});
    for (const SettingsNode& member : members) {
      const auto* word = std::get_if<std::string>(&member.value);
      if (word != nullptr && *word == "bypass" && &member == &members[0] && members.size() > 1) {
        group.bypass = bypass_;
        continue;
      }
      group.parts.push_back(read_group(
          member, is_parallel ? CellGroup::Join::series : CellGroup::Join::parallel, depth + 1));
    }
    return group;
  }

  int read_cell(const SettingsNode& node) {
    const auto* index = std::get_if<int64_t>(&node.value);
    const auto count = static_cast<int64_t>(used_.size());
    if (index == nullptr || *index < 0 || *index >= count) {
      fail(node, "the number of a cell, 0 to " + std::to_string(count - 1));
    }
    if (used_[static_cast<size_t>(*index)]) {
      throw InputError(node.where, array_.name() + ".wiring",
                       "cell " + std::to_string(*index) + " twice", "each cell at most once");
    }
    used_[static_cast<size_t>(*index)] = true;
    return static_cast<int>(*index);
  }

  [[noreturn]] void fail(const SettingsNode& node, const std::string& expected) const {
    throw InputError(node.where, array_.name() + ".wiring", describe(node), expected);
  }

  const Settings& array_;
  std::vector<bool> used_;
  const Diode& bypass_;
};

void read_size(const Settings& array, ArrayDesign& design) {
  const std::vector<double> size = array.numbers(array_key::cells, {1.0, most_cells});
  if (size.size() != 2 || size[0] != std::floor(size[0]) || size[1] != std::floor(size[1]) ||
      size[0] * size[1] > most_cells) {
    throw array.error(array_key::cells, "an array of " + std::to_string(size.size()) + " numbers",
                      "two whole numbers, at most 100000 cells");
  }
  design.columns = static_cast<int>(size[0]);
  design.rows = static_cast<int>(size[1]);
  design.gap_m = array.get(array_key::gap);
  design.margin_m = array.get(array_key::margin);
}

ArrayWiring read_wiring(const Settings& array, const ArrayDesign& design) {
  RegularWiring options;
  options.bypass = read_diode(array, array_key::bypass, array_key::bypass_diode, bypass_drop_V,
                              design.temperature_K);
  options.blocking =
      read_diode(array, array_key::blocking, array_key::blocking_diode, 0.0, design.temperature_K);
  if (options.bypass.kind == Diode::Kind::clamp && options.bypass.drop_V == 0.0) {
    throw array.error(array_key::bypass_diode, "drop_V = 0",
                      "a drop_V > 0 for an ideal bypass diode");
  }
  if (array.has(array_key::wiring)) {
    return WiringReader(array, design.cells(), options.bypass).read(options.blocking);
  }
  options.along_columns = array.get(array_key::series) == 0;
  if (array.has(array_key::circuit)) {
    return read_circuit(array, serpentine(design.columns, design.rows, options.along_columns),
                        options.bypass, options.blocking);
  }
  options.strings = static_cast<int>(array.get(array_key::strings.within(1, design.cells())));
  if (design.cells() % options.strings != 0) {
    throw array.error(array_key::strings, std::to_string(options.strings),
                      "a divisor of the " + std::to_string(design.cells()) + " cells");
  }
  const int length = design.cells() / options.strings;
  options.bypass_every =
      static_cast<int>(array.get_or(array_key::bypass_every.within(1, length), length));
  options.cross_tied = array.get(array_key::cross_tied);
  return regular_wiring(design.columns, design.rows, options);
}

// Replaces single numbers of a cell model. They refer to its reference area, if that is stated.
CellModel replaced(CellModel model, const Settings& s, bool area_is_stated) {
  CellParameters& p = model.reference;
  p.saturation_1_A = s.get_or(cell_key::saturation_1, p.saturation_1_A);
  p.ideality_1 = s.get_or(cell_key::ideality_1, p.ideality_1);
  p.saturation_2_A = s.get_or(cell_key::saturation_2, p.saturation_2_A);
  p.ideality_2 = s.get_or(cell_key::ideality_2, p.ideality_2);
  p.series_ohm = s.get_or(cell_key::series, p.series_ohm);
  p.shunt_ohm = s.get_or(cell_key::shunt, p.shunt_ohm);
  p.shunt_light_A = s.get_or(cell_key::shunt_photocurrent, p.shunt_light_A);
  p.shunt_dark_ohm = s.get_or(cell_key::shunt_dark, p.shunt_dark_ohm);
  p.shunt_exponent = s.get_or(cell_key::shunt_exponent, p.shunt_exponent);
  if (p.shunt_light_A == 0.0 && s.has(cell_key::shunt_dark)) {
    throw s.error(cell_key::shunt_dark, "no shunt_photocurrent_A > 0 beside it",
                  "the photocurrent at which the shunt is shunt_ohm");
  }
  p.breakdown_fraction = s.get_or(cell_key::breakdown_fraction, p.breakdown_fraction);
  p.breakdown_V = s.get_or(cell_key::breakdown, p.breakdown_V);
  p.breakdown_exponent = s.get_or(cell_key::breakdown_exponent, p.breakdown_exponent);
  model.gap_eV = s.get_or(cell_key::gap, model.gap_eV);
  model.gap_slope_1_K = s.get_or(cell_key::gap_slope, model.gap_slope_1_K);
  model.photocurrent_slope_1_K =
      s.get_or(cell_key::photocurrent_slope, model.photocurrent_slope_1_K);
  using namespace cell_key;
  for (const NumberKey& key :
       {saturation_1, saturation_2, series, shunt, shunt_photocurrent, shunt_dark}) {
    if (area_is_stated || !s.has(key)) continue;
    throw s.error(reference_area, "nothing beside " + std::string(key.name),
                  "the area of the cell that it was found on");
  }
  if (p.saturation_1_A + p.saturation_2_A == 0.0) {
    throw s.error(saturation_1, "0 in both diodes", "a saturation current > 0 in one of them");
  }
  return model;
}

NamedCell known_cell(const Settings& array) {
  const std::vector<NamedCell> known = known_cells();
  std::vector<std::string> names;
  for (const NamedCell& cell : known) names.push_back(cell.name);
  return known[array.choice_or("cell", names, 1)];
}

CellModel read_cell(const Settings& array) {
  CellModel model = known_cell(array).model;
  if (!array.has(array_key::cell_parameters)) return model;
  const Settings s = array.get(array_key::cell_parameters);
  model.reference_area_m2 = s.get_or(cell_key::reference_area, model.reference_area_m2);
  model.reference.temperature_K =
      s.get_or(cell_key::reference_temperature, model.reference.temperature_K);
  return replaced(model, s, s.has(cell_key::reference_area));
}

// The overrides in the order of their cells.
std::vector<CellOverride> read_overrides(const Settings& array, const ArrayDesign& design) {
  std::vector<CellOverride> overrides;
  if (!array.has(array_key::cell_override)) return overrides;
  const bool area_of_others = array.has(array_key::cell_parameters) &&
                              array.get(array_key::cell_parameters).has(cell_key::reference_area);
  std::set<int> known;
  for (const Settings& s : array.get(array_key::cell_override)) {
    CellOverride one;
    one.index = static_cast<int>(s.get(cell_key::index.within(0, design.cells() - 1)));
    if (!known.insert(one.index).second) {
      throw s.error(cell_key::index, std::to_string(one.index) + " a second time",
                    "each cell at most once");
    }
    one.photocurrent_factor = s.get(cell_key::photocurrent_factor);
    const bool own_area = s.has(cell_key::reference_area);
    CellModel others = design.cell;
    if (own_area) {
      others.reference_area_m2 = s.get(cell_key::reference_area);
      others.reference =
          parameters_at(design.cell, others.reference_area_m2, others.reference.temperature_K);
    }
    one.model = replaced(others, s, own_area || area_of_others);
    overrides.push_back(one);
  }
  std::ranges::sort(overrides, {}, &CellOverride::index);
  return overrides;
}

QuantumEfficiency read_efficiency(const Settings& array) {
  if (!array.has(array_key::quantum_efficiency)) {
    std::optional<double> peak;
    if (array.has(array_key::quantum_efficiency_peak)) {
      peak = array.get(array_key::quantum_efficiency_peak);
    }
    return quantum_efficiency_of(known_cell(array).name, peak);
  }
  const Settings table = array.get(array_key::quantum_efficiency);
  QuantumEfficiency read{table.get(array_key::wavelength), table.get(array_key::efficiency)};
  const bool ascending = std::ranges::adjacent_find(read.wavelength_m, std::greater_equal<>()) ==
                         read.wavelength_m.end();
  if (read.wavelength_m.size() < 2 || !ascending) {
    throw table.error(array_key::wavelength,
                      std::to_string(read.wavelength_m.size()) + " wavelengths",
                      "at least two, ascending");
  }
  if (read.efficiency.size() != read.wavelength_m.size()) {
    throw table.error(array_key::efficiency, std::to_string(read.efficiency.size()) + " numbers",
                      std::to_string(read.wavelength_m.size()) + ", one per wavelength");
  }
  return read;
}

}  // namespace

const CellOverride* ArrayDesign::override_of(size_t cell_index) const {
  const auto index = static_cast<int>(cell_index);
  const auto found = std::ranges::lower_bound(overrides, index, {}, &CellOverride::index);
  return found != overrides.end() && found->index == index ? &*found : nullptr;
}

ArrayWiring regular_wiring(int columns, int rows, const RegularWiring& options) {
  const std::vector<int> order = serpentine(columns, rows, options.along_columns);
  const auto count = static_cast<size_t>(options.strings);
  const auto every = static_cast<size_t>(options.bypass_every);
  const size_t length = order.size() / count;
  ArrayWiring wiring;
  for (size_t s = 0; s < (options.cross_tied ? 1 : count); ++s) {
    ArrayWiring::String string{{}, options.blocking};
    for (size_t i = 0; i < length; ++i) {
      std::vector<int> row = {order[s * length + i]};
      for (size_t k = 1; options.cross_tied && k < count; ++k) {
        row.push_back(order[k * length + i]);
      }
      if (i % every == 0) string.substrings.push_back({{}, options.bypass});
      string.substrings.back().rows.emplace_back(row);
    }
    wiring.strings.push_back(std::move(string));
  }
  return wiring;
}

ArrayDesign read_array_design(const Settings& array, std::optional<CellPlaces> places) {
  ArrayDesign design;
  if (places) {
    const size_t count = places->parts.size();
    if (count == 0 || count > most_cells) {
      throw array.error(
          array.has(array_key::rectangle) ? array_key::rectangle.name : array_key::cells.name,
          std::to_string(count) + " separate cells", "1 to 100000");
    }
    design.columns = places->columns;
    design.rows = places->rows;
    design.places = std::move(places);
  } else {
    read_size(array, design);
  }
  design.temperature_K = array.get_or(array_key::temperature, design.temperature_K);
  design.rated_temperature_K = array.get(array_key::rated_temperature);
  design.wiring = read_wiring(array, design);
  design.cell = read_cell(array);
  design.overrides = read_overrides(array, design);
  design.efficiency = read_efficiency(array);
  if (array.has(array_key::cover)) design.front = read_cell_front(array.get(array_key::cover));
  return design;
}

}  // namespace photorque
