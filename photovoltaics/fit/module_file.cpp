#include "photovoltaics/fit/module_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <vector>

#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "photovoltaics/fit/parts.h"

namespace photorque {
namespace module_file {
namespace {

constexpr double zero_celsius_K = 273.15;

// Values by key, from one place of a file.
class Listing {
 public:
  explicit Listing(InputLocation where) : where_(std::move(where)) {}

  void set(const std::string& key, std::string_view text) { texts_.emplace(key, text); }
  bool has(const std::string& key) const { return texts_.contains(key); }
  std::string text(const std::string& key) const { return has(key) ? texts_.at(key) : ""; }
  // The number of a key, which must be between `above` and `below`, the range of real modules.
  double number(const std::string& key, double above, double below) const {
    if (!has(key)) {
      throw InputError(where_, key, "nothing",
                       "a number; a datasheet's figures go into [[fit.datasheet]]");
    }
    const double value = require_number(texts_.at(key), where_, key);
    if (value > above && value < below) return value;
    throw InputError(
        where_, key, texts_.at(key),
        "a number above " + readable_number(above, 3) + " and below " + readable_number(below, 3));
  }
  int count(const std::string& key) const {
    const double value = number(key, 0.0, 10001.0);
    if (value != std::floor(value)) throw InputError(where_, key, text(key), "a whole number");
    return static_cast<int>(value);
  }
  const InputLocation& where() const { return where_; }

 private:
  InputLocation where_;
  std::map<std::string, std::string> texts_;
};

// The cells of a line; commas inside quotes do not separate.
std::vector<std::string> quoted_cells(std::string_view line) {
  std::vector<std::string> cells(1);
  bool in_quotes = false;
  for (const char c : line) {
    if (c == '"') {
      in_quotes = !in_quotes;
    } else if (c == ',' && !in_quotes) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) cell = std::string(trimmed(cell));
  return cells;
}

// The name of a row in the notation of pvlib.
std::string underscored(std::string_view name) {
  std::string result(name);
  for (char& c : result) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return result;
}

// A row of the library, and how well it matches the requested name.
struct Row {
  std::vector<std::string> cells;
  int line = 0;
};

Listing listing_of(const std::vector<std::string>& header, const Row& row,
                   const std::string& file) {
  Listing listing({file, row.line});
  for (size_t i = 0; i < std::min(header.size(), row.cells.size()); ++i) {
    if (!row.cells[i].empty()) listing.set(header[i], row.cells[i]);
  }
  return listing;
}

Listing named_row(std::string_view text, const std::string& file, const std::string& name) {
  std::vector<std::string> header;
  std::vector<Row> exact, partial;
  size_t name_column = 0, cells_column = 0;
  int number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    std::vector<std::string> cells = quoted_cells(line);
    if (header.empty()) {
      const auto at = std::ranges::find(cells, "Name"), series = std::ranges::find(cells, "N_s");
      if (at == cells.end() || series == cells.end()) continue;
      name_column = static_cast<size_t>(at - cells.begin());
      cells_column = static_cast<size_t>(series - cells.begin());
      header = std::move(cells);
      continue;
    }
    // Rows of units and of variables' names have no number of cells.
    if (cells.size() <= std::max(name_column, cells_column) || !number_in(cells[cells_column])) {
      continue;
    }
    const std::string& found = cells[name_column];
    if (found == name || underscored(found) == name) {
      exact.push_back({std::move(cells), number});
    } else if (found.find(name) != std::string::npos) {
      partial.push_back({std::move(cells), number});
    }
  }
  if (header.empty()) {
    throw InputError({file, 1}, "", "neither a PAN file nor a library of modules",
                     "PVObject_=pvModule, or a line of columns with Name, N_s, a_ref, I_L_ref …");
  }
  const std::vector<Row>& rows = exact.empty() ? partial : exact;
  if (name.empty() || rows.size() != 1) {
    std::string examples;
    for (size_t i = 0; i < std::min<size_t>(3, rows.size()); ++i) {
      examples += (i > 0 ? ", " : ": ") + in_quotes(rows[i].cells[name_column]);
    }
    throw InputError({file}, "fit.module_name", name.empty() ? "nothing" : in_quotes(name),
                     std::to_string(rows.size()) + " modules have it" + examples +
                         "; module_name = \"…\" is the Name of one");
  }
  return listing_of(header, rows[0], file);
}

// The circuit of the whole module at the reference.
struct Circuit {
  double photocurrent_A, saturation_A, ideality, series_ohm, shunt_ohm;
};

void set_cell(const Circuit& module, ListedModule& listed) {
  const double series = listed.cells_in_series, parallel = listed.strings;
  CellParameters& p = listed.cell.reference;
  p.temperature_K = listed.rated.temperature_K;
  p.saturation_1_A = module.saturation_A / parallel;
  p.ideality_1 = module.ideality;
  p.series_ohm = module.series_ohm * parallel / series;
  p.shunt_ohm = module.shunt_ohm * parallel / series;
  listed.photocurrent_A = module.photocurrent_A / parallel;
  p.shunt_light_A = listed.photocurrent_A;
  if (listed.area_m2 > 0.0) listed.cell.reference_area_m2 = listed.area_m2 / (series * parallel);
}

double thermal_V(double temperature_K) {
  return boltzmann_J_K * temperature_K / elementary_charge_C;
}

ListedModule of_library(const Listing& row) {
  ListedModule m;
  m.name = row.text("Name");
  m.cells_in_series = row.count("N_s");
  m.area_m2 = row.number("A_c", 0.0, 1e3);
  m.rated = {1000.0,
             298.15,
             row.number("I_sc_ref", 0.0, 1e4),
             row.number("V_oc_ref", 0.0, 1e5),
             row.number("I_mp_ref", 0.0, 1e4),
             row.number("V_mp_ref", 0.0, 1e5)};
  const Circuit circuit{
      row.number("I_L_ref", 0.0, 1e4), row.number("I_o_ref", 0.0, 1.0),
      row.number("a_ref", 0.0, 1e4) / (m.cells_in_series * thermal_V(m.rated.temperature_K)),
      row.number("R_s", -1e-12, 1e6), row.number("R_sh_ref", 0.0, 1e9)};
  m.cell.gap_eV = silicon_gap_eV;
  m.cell.gap_slope_1_K = silicon_gap_slope_1_K;
  const double adjust = row.has("Adjust") ? row.number("Adjust", -1e3, 1e3) : 0.0;
  m.cell.photocurrent_slope_1_K =
      row.number("alpha_sc", -1.0, 1.0) * (1.0 - adjust / 100.0) / circuit.photocurrent_A;
  set_cell(circuit, m);
  return m;
}

double gap_of_technology_eV(const Listing& pan) {
  const std::string technology = pan.text("Technol");
  for (const auto& [word, gap_eV] : {std::pair{"mtCdTe", 1.5}, {"mtCIS", 1.03}}) {
    if (technology == word) return gap_eV;
  }
  if (technology.starts_with("mtSi") || technology == "mtHIT" || technology == "mtEFG") return 1.12;
  throw InputError(pan.where(), "Technol", technology.empty() ? "nothing" : technology,
                   "mtSi…, mtHIT or mtEFG (crystalline silicon), mtCdTe or mtCIS; a datasheet's "
                   "figures go into [[fit.datasheet]]");
}

// Sets the cell of a module with a recombination term, for which a cell here has no parameter: the
// diode of the stated Gamma with the rated figures. Its leak is proportional to the light as that
// recombination is. The gap gives the slope of the maximum power, muPmpReq, to which PVsyst adjusts
// muGamma; muVocSpec is only information there.
void fit_rated(const Listing& pan, ListedModule& m) {
  constexpr double of_milli = 1e-3, of_percent = 1e-2;
  const RatedPoint& rated = m.rated;
  const TemperatureSlopes slopes{of_milli * pan.number("muISC", -1e5, 1e5) / rated.short_circuit_A};
  const double one_V = m.cells_in_series * thermal_V(rated.temperature_K);
  const RatedFit fit = fit_rated_points(
      std::array{rated}, slopes, one_V * pan.number("Gamma", 0.1, 10.0), {}, ShuntLaw::inverse);
  const SingleDiode& d = fit.diode;
  const CellFigure power_W = [](const CellCurve& cell, double light_A) {
    return cell.maximum_power(light_A).power_W();
  };
  const double light_A = d.photocurrent_A.value;
  m.cell.gap_eV = gap_of_slope_eV(fit.model, light_A, slopes.short_circuit_1_K, power_W,
                                  of_percent * pan.number("muPmpReq", -5.0, 0.0) *
                                      power_W(CellCurve(fit.model.reference), light_A));
  m.cell.gap_slope_1_K = fit.model.gap_slope_1_K;
  m.cell.photocurrent_slope_1_K = fit.model.photocurrent_slope_1_K;
  set_cell({d.photocurrent_A.value, d.saturation_A.value, d.scale_V.value / one_V,
            d.series_ohm.value, d.shunt_ohm.value},
           m);
  m.notes.push_back(
      "D2MuTau = " + pan.text("D2MuTau") +
      ": a cell here has no such recombination; RSerie and RShunt were replaced by a fit to "
      "Isc, Voc, Imp and Vmp with the stated Gamma, the leak is proportional to the light, and "
      "the gap follows from muPmpReq");
}

// Parts of a PAN file that the circuit of the cells does not include.
std::string unused_parts(const Listing& pan) {
  std::string unused;
  for (const auto& [key, what] :
       {std::pair{"BRev", "BRev (reverse breakdown: breakdown_V)"},
        {"PVObject_IAM", "the IAM profile (angle of incidence: [array.cover])"},
        {"SubModuleLayout", "SubModuleLayout (wiring: array.circuit)"}}) {
    if (pan.has(key)) unused += (unused.empty() ? "" : ", ") + std::string(what);
  }
  return unused;
}

ListedModule of_pan(const Listing& pan) {
  ListedModule m;
  m.name = pan.text("Manufacturer") + " " + pan.text("Model");
  m.cells_in_series = pan.count("NCelS");
  m.strings = pan.has("NCelP") ? pan.count("NCelP") : 1;
  if (pan.has("Width") && pan.has("Height")) {
    m.area_m2 = pan.number("Width", 0.0, 100.0) * pan.number("Height", 0.0, 100.0);
  }
  if (pan.has("CellArea")) {  // in cm²
    m.area_m2 = 1e-4 * pan.number("CellArea", 0.0, 1e5) * m.cells_in_series * m.strings;
  }
  const std::string unused = unused_parts(pan);
  if (!unused.empty()) m.notes.push_back("not used: " + unused);
  const double T = zero_celsius_K + (pan.has("TRef") ? pan.number("TRef", -100.0, 200.0) : 25.0);
  const double light_W_m2 = pan.has("GRef") ? pan.number("GRef", 0.0, 1e5) : 1000.0;
  m.rated = {light_W_m2,
             T,
             pan.number("Isc", 0.0, 1e4),
             pan.number("Voc", 0.0, 1e5),
             pan.number("Imp", 0.0, 1e4),
             pan.number("Vmp", 0.0, 1e5)};
  if (pan.has("D2MuTau") && pan.number("D2MuTau", -1.0, 1e6) > 0.0) {
    fit_rated(pan, m);
    return m;
  }
  const double gap_V = gap_of_technology_eV(pan) * elementary_charge_C / boltzmann_J_K;
  const double n = pan.number("Gamma", 0.1, 10.0), N = m.cells_in_series;
  const double series_ohm = pan.number("RSerie", -1e-12, 1e6);
  const double shunt_ohm = pan.number("RShunt", 0.0, 1e9);
  const double a_V = n * N * thermal_V(T);
  const double isc = m.rated.short_circuit_A, voc = m.rated.open_circuit_V;
  const double at_short = std::expm1(isc * series_ohm / a_V), at_open = std::expm1(voc / a_V);
  const double sum_A = isc * (1.0 + series_ohm / shunt_ohm);
  const double saturation_A = (sum_A - voc / shunt_ohm) / (at_open - at_short);
  if (!(saturation_A > 0.0) || !std::isfinite(saturation_A)) {
    throw InputError(pan.where(), "RShunt", pan.text("RShunt"),
                     "resistances and Gamma of a diode with this Isc and Voc");
  }
  const double photocurrent_A = sum_A + saturation_A * at_short;
  set_cell({photocurrent_A, saturation_A, n, series_ohm, shunt_ohm}, m);
  CellParameters& p = m.cell.reference;
  p.shunt_dark_ohm = pan.number("Rp_0", 0.0, 1e9) * m.strings / N;
  if (pan.has("Rp_Exp")) p.shunt_exponent = pan.number("Rp_Exp", 0.01, 100.0);
  constexpr double ampere_of_mA = 1e-3;
  const double growth_1_K = ampere_of_mA * pan.number("muISC", -1e5, 1e5) / photocurrent_A;
  m.cell.photocurrent_slope_1_K = growth_1_K;
  // The open-circuit voltage by PVsyst's equations at a higher temperature.
  constexpr double step_K = 10.0;
  const double warm_K = T + step_K;
  const double warm_n = n + (pan.has("muGamma") ? pan.number("muGamma", -1.0, 1.0) : 0.0) * step_K;
  CellParameters warm = p;
  warm.temperature_K = warm_K;
  warm.ideality_1 = warm_n;
  warm.saturation_1_A *=
      std::pow(warm_K / T, 3) * std::exp(gap_V / warm_n * (1.0 / T - 1.0 / warm_K));
  const double warm_A = m.photocurrent_A * (1.0 + growth_1_K * step_K);
  const double slope_V_K =
      (CellCurve(in_light(warm, m.photocurrent_A)).open_circuit_V(warm_A) -
       CellCurve(in_light(p, m.photocurrent_A)).open_circuit_V(m.photocurrent_A)) /
      step_K;
  m.cell.gap_eV = gap_of_voltage_slope_eV(m.cell, m.photocurrent_A, growth_1_K, slope_V_K);
  m.cell.gap_slope_1_K = 0.0;
  return m;
}

}  // namespace
}  // namespace module_file

RatedPoint ListedModule::predict(double irradiance_W_m2, double temperature_K) const {
  const double light_A = photocurrent_A * irradiance_W_m2 / rated.irradiance_W_m2 *
                         photocurrent_factor(cell, temperature_K);
  RatedPoint point = rated_point_of(cell, light_A, irradiance_W_m2, temperature_K);
  for (double* current_A : {&point.short_circuit_A, &point.maximum_A}) *current_A *= strings;
  for (double* voltage_V : {&point.open_circuit_V, &point.maximum_V}) *voltage_V *= cells_in_series;
  return point;
}

ListedModule module_in(std::string_view text, const std::string& file, const std::string& name) {
  using namespace module_file;
  if (text.find("PVObject_=pvModule") == std::string_view::npos) {
    return of_library(named_row(text, file, name));
  }
  Listing pan({file});
  for (const std::string_view line : lines_of(text)) {
    const size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    pan.set(std::string(trimmed(line.substr(0, equals))), trimmed(line.substr(equals + 1)));
  }
  return of_pan(pan);
}

}  // namespace photorque
