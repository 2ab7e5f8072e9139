#include "tools/pages/result.h"

#include <algorithm>
#include <memory>
#include <set>

#include "core/files.h"
#include "tools/sweeps/labels.h"

namespace photorque {
namespace {

PageFigure figure_of(const Quantity& quantity) {
  const AxisLabel label = label_of_figure(quantity.name);
  return {quantity.name, label.name, label.unit, quantity.estimate};
}

// Rows "stage", "lost_to", "power_W", "lost_W": what is left after each loss.
std::vector<PowerStage> stages_of_array(const Table& losses) {
  std::vector<PowerStage> stages;
  const auto& left_W = losses.column("power_W").values;
  for (size_t i = 0; i < left_W.size(); ++i) {
    if (i == 0) {
      stages.push_back({losses.column("stage").texts[i], {left_W[i], 0.0}, true});
    } else {
      stages.push_back(
          {losses.column("lost_to").texts[i], {losses.column("lost_W").values[i], 0.0}});
    }
  }
  if (left_W.size() > 1) {
    stages.push_back({losses.column("stage").texts.back(), {left_W.back(), 0.0}, true});
  }
  return stages;
}

// Instances on which light is measured.
std::set<uint32_t> measured(const Experiment& experiment) {
  std::set<uint32_t> instances;
  for (const NamedReceiver& receiver : experiment.receivers) {
    if (!receiver.flux_map) continue;
    const auto& of = receiver.flux_map->grid().instances;
    instances.insert(of.begin(), of.end());
  }
  return instances;
}

std::vector<PowerStage> stages_of_light(const OpticalRun& run, const OpticalResult& light) {
  const PowerBalance& balance = light.power_balance;
  const Scene& scene = run.experiment().scene;
  const std::vector<std::string>& names = run.wrench().part_names();
  const std::set<uint32_t> wanted = measured(run.experiment());
  std::vector<PowerStage> stages = {{"emitted by the lamps", {balance.emitted_W, 0.0}, true}};
  std::vector<PowerStage> losses, kept;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Estimate& absorbed_W = balance.absorbed_by_instance_W[i];
    if (!(absorbed_W.value > 0.0)) continue;
    auto& to = wanted.contains(static_cast<uint32_t>(i)) ? kept : losses;
    to.push_back({"absorbed by " + names[i], absorbed_W});
  }
  std::ranges::stable_sort(losses, std::greater{}, [](const auto& s) { return s.power_W.value; });
  constexpr size_t single = 8;  // parts with a line of their own
  if (losses.size() > single + 1) {
    double rest_W = 0.0, variance = 0.0;
    for (size_t i = single; i < losses.size(); ++i) {
      rest_W += losses[i].power_W.value;
      variance += losses[i].power_W.standard_error * losses[i].power_W.standard_error;
    }
    const std::string label =
        "absorbed by " + std::to_string(losses.size() - single) + " other parts";
    losses.resize(single);
    losses.push_back({label, {rest_W, std::sqrt(variance)}});
  }
  stages.push_back({"passes the scene or leaves it again", balance.escaped_W});
  stages.insert(stages.end(), losses.begin(), losses.end());
  if (balance.truncated_W.value > 1e-9 * balance.emitted_W) {
    stages.push_back({"no longer followed", balance.truncated_W});
  }
  for (PowerStage& stage : kept) stage.is_total = true;
  if (kept.size() == 1) {
    stages.push_back(kept.front());
  } else {
    // Several measured parts are no single end: they too hang from what is left.
    for (PowerStage& stage : kept) stage.is_total = false;
    stages.insert(stages.end(), kept.begin(), kept.end());
  }
  return stages;
}

}  // namespace

const Table* table_of(const Product& product, const std::string& name) {
  const auto at = std::ranges::find(product.tables, name, &Table::name);
  return at == product.tables.end() ? nullptr : &*at;
}

RunPage page_of(const RunResult& result, const std::string& title, const std::string& verb,
                const std::string& command, const std::vector<std::string>& headlines) {
  constexpr size_t most_headlines = 6;
  RunPage page;
  page.title = title;
  page.verb = verb;
  page.command = command;
  for (const Quantity& quantity : result.product.quantities) {
    page.figures.push_back(figure_of(quantity));
  }
  for (const std::string& wanted : headlines) {
    for (const PageFigure& figure : page.figures) {
      if (page.headlines.size() == most_headlines) break;
      if (figure.key.starts_with(wanted)) page.headlines.push_back(figure);
    }
  }
  page.product = result.product;
  page.provenance = result.provenance;
  page.rays = result.cost.rays;
  return page;
}

std::vector<PowerStage> power_stages(const OpticalRun& run, const OpticalResult& light,
                                     const Product& product) {
  const Table* losses = table_of(product, "losses");
  return losses != nullptr ? stages_of_array(*losses) : stages_of_light(run, light);
}

RunFile page_file(RunPage page) {
  const auto shared = std::make_shared<const RunPage>(std::move(page));
  return {
      "page.html",
      [shared](const std::filesystem::path& path) { write_file_whole(path, page_html(*shared)); },
      "the run to look at, in a browser"};
}

}  // namespace photorque
