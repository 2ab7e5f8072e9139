// photorque sweep: one command over many designs, and what they gave as one table.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/text/numbers.h"
#include "scenes/experiment/experiment.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"
#include "tools/guards/interruption.h"
#include "tools/guards/output_folder.h"
#include "tools/tasks/sweep_design.h"

namespace photorque {
namespace {

struct Shard {
  size_t first = 0, step = 1;
};

Shard read_shard(const std::string& text) {
  if (text.empty()) return {};
  unsigned k = 0, n = 0;
  int end = 0;
  if (std::sscanf(text.c_str(), "%u/%u%n", &k, &n, &end) != 2 ||
      end != static_cast<int>(text.size()) || k < 1 || k > n) {
    throw InputError({"--shard"}, "shard", '"' + text + '"', "K/N with 1 <= K <= N");
  }
  return {k - 1, n};
}

const Verb& verb_called(const std::vector<Verb>& verbs, const std::string& name) {
  const auto it = std::ranges::find_if(verbs, [&](const Verb& v) {
    return v.name == name && v.name != "sweep" && v.name != "prove" && v.writes;
  });
  if (it == verbs.end()) {
    throw InputError({}, "sweep.verb", '"' + name + '"', "a command that writes a summary: power");
  }
  return *it;
}

// A value as text, with the content of every file that it names.
std::string content_of(const SettingsNode& node, const std::filesystem::path& folder) {
  std::string all;
  if (const auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
    for (const auto& [key, value] : *table) all += key + "={" + content_of(value, folder) + "}\n";
  } else if (const auto* items = std::get_if<SettingsNode::Array>(&node.value)) {
    for (const SettingsNode& item : *items) all += '[' + content_of(item, folder) + ']';
  } else {
    all = toml_text(node);
    const auto* text = std::get_if<std::string>(&node.value);
    std::error_code failure;
    if (text != nullptr && std::filesystem::is_regular_file(folder / *text, failure)) {
      all += content_hash(read_file(folder / *text));
    }
  }
  return all;
}

// What every design follows from: the program, the experiment but its plan, the files that it names
// (not what these refer to).
std::string common_content(const ExperimentFile& file, const SweepPlan& plan,
                           const Provenance& build) {
  std::string all = plan.verb + '\n' + build.version + build.git_hash + '\n';
  for (const std::string& key : file.settings.keys()) {
    if (key == "sweep") continue;
    all += key + '=' + content_of(file.settings.raw(key), file.path.parent_path()) + '\n';
  }
  return content_hash(all);
}

double number_of(const nlohmann::json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

// The figures of one design, in the order of its summary. InputError that names the summary when it
// is not one that this program writes.
std::vector<Quantity> read_figures(const std::filesystem::path& summary) {
  const InputError damaged({summary.string()}, "", "a damaged summary of a design",
                           "one that the sweep wrote: delete it, and the design is run again");
  const auto json = nlohmann::ordered_json::parse(read_file(summary), nullptr, false);
  if (!json.is_object() || json.value("schema", nlohmann::ordered_json()) != summary_schema) {
    throw damaged;
  }
  std::vector<Quantity> figures;
  for (const auto& [name, value] : json.items()) {
    if (!value.is_object() || !value.contains("value")) continue;
    const double error = number_of(value.value("standard_error", nlohmann::ordered_json()));
    figures.push_back({name, {number_of(value["value"]), error}});
    if (std::isnan(figures.back().estimate.value)) throw damaged;
  }
  if (figures.empty()) throw damaged;
  return figures;
}

// The value of an axis as a column: numbers where all are numbers.
void add_axis(Table& table, const SweepPlan& plan, size_t axis) {
  std::vector<double> numbers;
  std::vector<std::string> texts;
  for (size_t d = 0; d < plan.designs(); ++d) {
    const std::string& text = plan.value(d, axis);
    if (const auto number = number_in(text)) numbers.push_back(*number);
    texts.push_back(text);
  }
  if (numbers.size() == texts.size()) {
    table.add(plan.axes[axis].key, numbers);
  } else {
    table.add(plan.axes[axis].key, texts);
  }
}

std::vector<std::string> chosen_figures(const SweepPlan& plan, const std::vector<Quantity>& first) {
  std::vector<std::string> names;
  for (const Quantity& q : first) names.push_back(q.name);
  if (plan.figures.empty()) return names;
  for (const std::string& name : plan.figures) {
    if (std::ranges::count(plan.figures, name) > 1) {
      throw InputError({}, "sweep.figures", '"' + name + "\" twice", "every figure once");
    }
    if (std::ranges::find(names, name) == names.end()) {
      const std::string suggestion = nearest(name, {names.begin(), names.end()});
      throw InputError({}, "sweep.figures", '"' + name + '"',
                       suggestion.empty()
                           ? "a figure of the command's summary.json"
                           : "a figure of the summary, perhaps \"" + suggestion + '"');
    }
  }
  return plan.figures;
}

constexpr const char* error_suffix = "_standard_error";

// Against the last axis, a curve for every combination of the others; of random plans, points.
Plot figure_plot(const SweepPlan& plan, const Table& table, const std::string& figure) {
  const size_t axes = plan.axes.size();
  const Table::Column& x = table.column(plan.axes.back().key);
  const Table::Column& y = table.column(figure);
  const Table::Column& error = table.column(figure + error_suffix);
  Plot plot{"sweep_" + y.name, y.name + " over " + x.name, x.name, y.name, {}, false, false, {}};
  const size_t along = plan.grid ? plan.axes.back().values.size() : plan.designs();
  for (size_t begin = 0; begin < plan.designs(); begin += along) {
    Plot::Curve curve;
    for (size_t axis = 0; plan.grid && axis + 1 < axes; ++axis) {
      curve.label += (axis > 0 ? ", " : "") + plan.axes[axis].key + " " + plan.value(begin, axis);
    }
    curve.markers = !plan.grid;
    for (size_t d = begin; d < begin + along; ++d) {
      curve.x.push_back(x.values[d]);
      curve.y.push_back(y.values[d]);
      curve.y_error.push_back(error.values[d]);
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

Product sweep_product(const SweepPlan& plan, const std::vector<std::vector<Quantity>>& designs) {
  const std::vector<std::string> names = chosen_figures(plan, designs.front());
  Table table = Table::of("sweep", "What " + plan.verb + " gave, design by design", {"design"});
  for (size_t d = 0; d < designs.size(); ++d) table.row().set("design", static_cast<double>(d + 1));
  for (size_t axis = 0; axis < plan.axes.size(); ++axis) add_axis(table, plan, axis);
  for (const std::string& name : names) {
    std::vector<double> values, errors;
    for (const std::vector<Quantity>& figures : designs) {
      const auto it = std::ranges::find(figures, name, &Quantity::name);
      const double nan = std::numeric_limits<double>::quiet_NaN();
      values.push_back(it == figures.end() ? nan : it->estimate.value);
      errors.push_back(it == figures.end() ? nan : it->estimate.standard_error);
    }
    table.add(name, values).add(name + error_suffix, errors);
  }
  Product product;
  constexpr size_t max_curves = 12;
  const size_t curves = plan.grid ? plan.designs() / plan.axes.back().values.size() : 1;
  const bool plots = !plan.figures.empty() && curves <= max_curves &&
                     !table.column(plan.axes.back().key).values.empty();
  if (plots) {
    for (const std::string& name : names) product.plots.push_back(figure_plot(plan, table, name));
  }
  product.quantities.push_back({"designs", {static_cast<double>(designs.size()), 0.0}});
  product.tables.push_back(std::move(table));
  return product;
}

// The same error, said of the plan: its values reach a design as if by --set.
InputError in_design(const CommandLine& line, size_t design, size_t count,
                     const InputError& error) {
  std::string text = error.what();
  constexpr std::string_view by_set = "--set: ";
  if (text.starts_with(by_set)) text.erase(0, by_set.size());
  return {{line.experiment.string()},
          "design " + std::to_string(design + 1) + " of " + std::to_string(count) + ": " + text,
          "",
          ""};
}

void run_sweep(const CommandLine& line) {
  const Console console = terminal(line);
  const ExperimentFile file = read_experiment_file(line.experiment, line.all_overrides());
  const auto tables = file.others("sweep");
  if (tables.empty()) throw file.settings.error("sweep", "none", "a table [sweep]");
  const SweepPlan plan = read_sweep_plan(tables.front());
  const std::vector<Verb> verbs = all_verbs();
  const Verb& verb = verb_called(verbs, plan.verb);
  const Shard shard = read_shard(line.shard);
  Provenance provenance = build_provenance();
  provenance.inputs = file.inputs;
  provenance.seed = file.trace.seed;

  const size_t count = plan.designs();
  const std::string common = common_content(file, plan, provenance);
  // Under the hash of all that a design follows from: what changed is run again, what did not is
  // not, and a plan may grow.
  const auto summary_of = [&](size_t design) {
    std::string all = common;
    for (const std::string& assignment : plan.overrides(design)) all += '\n' + assignment;
    return line.out_folder() / "designs" / content_hash(all) / "summary.json";
  };
  console.heading(std::to_string(count) + " designs by `" + plan.verb + '`');
  const auto progress = console.progress("designs");
  size_t kept = 0, run = 0;
  for (size_t design = shard.first; design < count; design += shard.step) {
    const auto summary = summary_of(design);
    std::optional<Interruption::Watch> watch;
    if (line.interruption != nullptr) watch.emplace(*line.interruption, summary.parent_path());
    std::optional<OutputFolder> own;
    if (!std::filesystem::exists(summary)) {
      own.emplace(summary.parent_path(), OutputFolder::Others::wait);
    }
    // Another run of this sweep may have made it while this one waited.
    if (std::filesystem::exists(summary)) {
      ++kept;
    } else {
      CommandLine one = line;
      one.verb = plan.verb;
      one.out = summary.parent_path();
      one.quiet = one.summary_only = true;
      one.json = false;
      const auto changes = plan.overrides(design);
      one.overrides.insert(one.overrides.end(), changes.begin(), changes.end());
      try {
        verb.run(one);
      } catch (const InputError& error) {
        throw in_design(line, design, count, error);
      }
      // A figure that no design has is told after the first, not after the last.
      if (++run == 1) chosen_figures(plan, read_figures(summary_of(design)));
    }
    if (progress) progress(static_cast<double>(design + 1) / static_cast<double>(count));
  }
  console.done();
  console.line("  " + std::to_string(run) + " run now, " + std::to_string(kept) +
               " kept from before");

  std::vector<std::vector<Quantity>> designs;
  for (size_t design = 0; design < count; ++design) {
    if (!std::filesystem::exists(summary_of(design))) {
      console.line("  not all shards are done; the table is written by the last");
      return;
    }
    designs.push_back(read_figures(summary_of(design)));
  }
  // The last of several shards may be two.
  const OutputFolder alone(line.out_folder() / "designs", OutputFolder::Others::wait);
  write_results(line, console, {sweep_product(plan, designs), provenance, {}});
}

}  // namespace

Verb sweep_verb() {
  Verb verb{"sweep", "One command over many designs: any keys of the experiment, one table",
            run_sweep, true};
  verb.takes_shard = true;
  return verb;
}

}  // namespace photorque
