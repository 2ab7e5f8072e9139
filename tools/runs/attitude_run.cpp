#include "tools/runs/attitude_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/files.h"

namespace photorque {
namespace {

// What optical commands read of the same file.
constexpr const char* optical_tables[] = {"scene", "material",   "source", "receiver", "attitude",
                                          "trace", "torque_map", "camera", "effect"};

// The files that texts of the experiment name, relative to its folder.
void collect_files(const SettingsNode& node, const std::filesystem::path& folder,
                   std::vector<std::filesystem::path>& files) {
  if (const auto* text = std::get_if<std::string>(&node.value)) {
    std::error_code ignored;
    const std::filesystem::path path = folder / *text;
    if (!text->empty() && std::filesystem::is_regular_file(path, ignored)) files.push_back(path);
  } else if (const auto* items = std::get_if<SettingsNode::Array>(&node.value)) {
    for (const SettingsNode& item : *items) collect_files(item, folder, files);
  } else if (const auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
    for (const auto& [key, value] : *table) collect_files(value, folder, files);
  }
}

bool is_optical(const std::string& key) {
  return std::find(std::begin(optical_tables), std::end(optical_tables), key) !=
         std::end(optical_tables);
}

std::string brief(double value) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

// Characters, not bytes, of a text in UTF-8.
size_t width_of(const std::string& text) {
  return static_cast<size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

AttitudeExperiment::AttitudeExperiment(const RunOptions& options)
    : file_(
          read_experiment_text(options.experiment, options.experiment_text(), options.overrides)) {
  const Settings& root = file_.settings;
  for (const char* table : optical_tables) {
    if (root.has(table)) root.raw(table);
  }
  root.finish();
  std::vector<std::filesystem::path> files;
  for (const std::string& key : root.keys()) {
    if (!is_optical(key)) collect_files(root.raw(key), options.experiment.parent_path(), files);
  }
  for (const std::filesystem::path& file : files) add_input(file);
}

void AttitudeExperiment::add_input(const std::filesystem::path& path) {
  file_.inputs.emplace_back(path.filename().string(), content_hash(read_file(path)));
}

Provenance AttitudeExperiment::provenance(uint64_t seed) const {
  Provenance provenance = build_provenance();
  provenance.seed = seed;
  provenance.inputs = file_.inputs;
  return provenance;
}

void print_table(const Console& console, const Table& table,
                 const std::vector<PrintedColumn>& columns) {
  std::vector<std::vector<std::string>> cells;
  std::vector<bool> is_text;
  for (const PrintedColumn& wanted : columns) {
    const auto column = std::find_if(table.columns.begin(), table.columns.end(),
                                     [&](const auto& c) { return c.name == wanted.name; });
    if (column == table.columns.end()) continue;
    std::vector<std::string> texts = {wanted.title};
    is_text.push_back(!column->texts.empty());
    texts.insert(texts.end(), column->texts.begin(), column->texts.end());
    for (const double value : column->values) texts.push_back(brief(value));
    cells.push_back(std::move(texts));
  }
  if (cells.empty()) return;
  for (size_t row = 0; row < cells.front().size(); ++row) {
    std::string line;
    for (size_t c = 0; c < cells.size(); ++c) {
      size_t width = 0;
      for (const std::string& cell : cells[c]) width = std::max(width, width_of(cell));
      const std::string space(width - width_of(cells[c][row]), ' ');
      line += "  " + (is_text[c] ? cells[c][row] + space : space + cells[c][row]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    console.line(line);
  }
}

}  // namespace photorque
