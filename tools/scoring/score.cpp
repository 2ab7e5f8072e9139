#include "tools/scoring/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <set>

#include "core/errors.h"
#include "core/files.h"
#include "tools/scoring/signs.h"

namespace photorque {
namespace {

using Json = nlohmann::json;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double number_or_nan(const Json& json, const std::string& key) {
  return json.contains(key) && json[key].is_number() ? json[key].get<double>() : nan;
}

std::vector<double> numbers_of(const Json& json) {
  if (json.is_number()) return {json.get<double>()};
  std::vector<double> numbers;
  if (!json.is_array()) return numbers;
  for (const Json& item : json) numbers.push_back(item.is_number() ? item.get<double>() : nan);
  return numbers;
}

std::vector<std::string> sorted(std::vector<std::string> names) {
  std::ranges::sort(names);
  return names;
}

Json parsed(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) {
    throw InputError({path.string(), 0}, "", "no JSON object", "one");
  }
  return json;
}

// Older cases write "attitude_latency_s" where the experiment's key is "latency_s".
const Json* true_number(const Json& effect, const std::string& key) {
  if (effect.contains(key)) return &effect[key];
  const size_t unit = key.find_last_of('_');
  if (unit == std::string::npos) return nullptr;
  const std::string with_kind = effect.value("kind", "") + key.substr(unit);
  return effect.contains(with_kind) ? &effect[with_kind] : nullptr;
}

// Whether a sinusoid was found with its amplitude turned round, half a period later: the same one.
bool is_turned_round(const Json& parameters, const Json& truth) {
  if (!parameters.contains("phase")) return false;
  for (const auto& [key, fitted] : parameters.items()) {
    const Json* wanted = true_number(truth, key);
    if (key == "phase" || wanted == nullptr || !fitted.is_object()) continue;
    const auto value = numbers_of(fitted.value("value", Json())), right = numbers_of(*wanted);
    if (right.size() != 3 || value.size() != 3) continue;
    return std::inner_product(value.begin(), value.end(), right.begin(), 0.0) < 0.0;
  }
  return false;
}

void add_pulls(const Json& found, const Json& truth, std::vector<double>& pulls) {
  if (!found.contains("parameters")) return;
  const bool turned = is_turned_round(found["parameters"], truth);
  for (const auto& [key, fitted] : found["parameters"].items()) {
    const Json* wanted = true_number(truth, key);
    // The sign and length of an axis mean nothing.
    if (wanted == nullptr || key == "axis" || !fitted.is_object()) continue;
    const auto value = numbers_of(fitted.value("value", Json())), right = numbers_of(*wanted);
    const auto sigma = numbers_of(fitted.value("sigma", Json()));
    if (value.size() != right.size() || sigma.size() != right.size()) continue;
    for (size_t i = 0; i < right.size(); ++i) {
      const bool amplitude = right.size() == 3;
      double miss = (turned && amplitude ? -value[i] : value[i]) - right[i];
      if (key == "phase") {
        miss = std::remainder(miss + (turned ? std::numbers::pi : 0.0), 2.0 * std::numbers::pi);
      }
      if (sigma[i] > 0.0 && std::isfinite(miss)) pulls.push_back(miss / sigma[i]);
    }
  }
}

// Adds "tether.stiffness_N_m_per_rad" where a fitted number is beyond physics.
void add_impossible(const Json& found, const std::string& nominal, CaseScore& score) {
  const std::string kind = found.at("kind");
  const bool is_nominal = nominal.find("\"" + kind + "\"") != std::string::npos;
  const Json parameters = found.value("parameters", Json::object());
  for (const auto& [key, fitted] : parameters.items()) {
    if (!fitted.is_object()) continue;
    if (!is_possible(kind, key, numbers_of(fitted.value("value", Json())), is_nominal)) {
      score.impossible.push_back(kind + "." + key);
    }
  }
}

// The index that an effect names, where truth says which are right.
void judge_index(const Json& found, const Json& truth, CaseScore& score) {
  const std::string kind = found.at("kind");
  const Json accepted = truth.value("accept_index", Json::object());
  const Json named = found.value("parameters", Json::object()).value("index", Json::object());
  if (!accepted.contains(kind) || !named.contains("value")) return;
  const auto right = numbers_of(accepted[kind]), value = numbers_of(named["value"]);
  ++score.indices;
  score.indices_right +=
      !value.empty() && std::ranges::find(right, value.front()) != right.end() ? 1 : 0;
}

// Whether the set of names, each swapped for itself or one of its doubles, can be `wanted`.
bool can_be(const std::vector<std::vector<std::string>>& doubles,
            const std::vector<std::string>& wanted) {
  if (doubles.size() != wanted.size()) return false;
  std::vector<size_t> order(wanted.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  do {
    bool fits = true;
    for (size_t i = 0; i < order.size(); ++i) {
      const auto& names = doubles[i];
      fits = fits && std::ranges::find(names, wanted[order[i]]) != names.end();
    }
    if (fits) return true;
  } while (std::ranges::next_permutation(order).found);
  return false;
}

// The verdict that goes with naming exactly these effects.
bool verdict_fits(const std::string& verdict, const std::vector<std::string>& names, bool outside) {
  if (outside) return verdict == "unexplained";
  return verdict == (names.empty() ? "consistent" : "missing_physics");
}

// The mean over the attitude's channels; NaN where the diagnosis states none.
double attitude_chi2(const Json& channels) {
  double sum = 0.0;
  int count = 0;
  for (const Json& channel : channels) {
    if (!channel.value("name", "").starts_with("attitude_")) continue;
    sum += number_or_nan(channel, "chi2_of_median");
    ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

void read_truth(const Json& truth, CaseScore& score) {
  score.true_verdict = truth.at("verdict").get<std::string>();
  for (const Json& effect : truth.at("effects")) score.true_kinds.push_back(effect.at("kind"));
  score.name = truth.value("name", score.name);
  score.family = truth.value("family", "case");
  score.maker = truth.value("maker", "");
  score.chi2_gain = number_or_nan(truth, "chi2_gain");
}

void judge(const Json& truth, const Json& diagnosis, const std::string& nominal, CaseScore& score) {
  const auto accept = truth.at("accept").get<std::vector<std::vector<std::string>>>();
  const bool outside = score.true_verdict == "unexplained";
  std::vector<std::vector<std::string>> doubles;
  std::set<std::string> acceptable;
  for (const auto& names : accept) acceptable.insert(names.begin(), names.end());
  for (const Json& effect : diagnosis.at("effects")) {
    const std::string kind = effect.at("kind");
    score.kinds.push_back(kind);
    doubles.push_back({kind});
    for (const Json& other : effect.value("indistinguishable_from", Json::array())) {
      doubles.back().push_back(other);
    }
    add_impossible(effect, nominal, score);
    const bool known = acceptable.contains(kind);
    score.wrong_name = score.wrong_name || !known;
    score.claims.emplace_back(number_or_nan(effect, "probability"), known);
    judge_index(effect, truth, score);
    for (const Json& t : truth.at("effects")) {
      if (t.at("kind") == kind) add_pulls(effect, t, score.pulls);
    }
  }
  score.verdict = diagnosis.at("verdict");
  score.confidence = number_or_nan(diagnosis, "confidence");
  for (const auto& names : accept) {
    if (!verdict_fits(score.verdict, names, outside)) continue;
    score.right = score.right || sorted(names) == sorted(score.kinds);
    score.right_within_group = score.right_within_group || can_be(doubles, names);
  }
  score.known_named = outside && score.right && !score.kinds.empty();
  // Below the limit, what acts may be said, or nothing.
  const bool either = std::ranges::any_of(accept, [](const auto& names) { return names.empty(); });
  score.verdict_right = score.verdict == score.true_verdict ||
                        (!outside && either && (score.right || score.verdict == "consistent"));
  score.false_alarm = score.true_verdict == "consistent" && !score.right;
  if (const Json& where = diagnosis.value("where", Json::object()); where.contains("depends_on")) {
    const auto wanted = truth.value("depends_on", std::vector<std::string>{});
    const Json& depends = where["depends_on"];
    score.dependence_right =
        !depends.empty() &&
        std::ranges::find(wanted, depends[0].value("variable", "")) != wanted.end();
  }
  const Json holdout = diagnosis.value("holdout", Json());
  if (holdout.is_object()) {
    score.holdout_chi2 = number_or_nan(holdout, "chi2_per_sample_after");
    score.predictive_chi2 = number_or_nan(holdout, "predictive_chi2_per_sample");
    score.expected_chi2 = number_or_nan(holdout, "expected_chi2_per_sample");
    score.predictive_sigma = number_or_nan(holdout, "predictive_sigma");
  }
  const Json fit = diagnosis.value("fit", Json::object());
  score.fit_chi2 = number_or_nan(fit, "chi2_per_sample_after");
  score.attitude_chi2 = attitude_chi2(fit.value("channels", Json::array()));
}

// What prove noted of the runs themselves.
void read_runs(const std::filesystem::path& folder, CaseScore& score) {
  if (std::filesystem::exists(folder / "error.txt")) {
    score.failure = read_file(folder / "error.txt");
  }
  if (!std::filesystem::exists(folder / "runs.json")) return;
  const Json runs = parsed(folder / "runs.json");
  score.processor_s = number_or_nan(runs, "processor_s");
  score.exit_status = runs.value("exit_status", 0);
  score.replay_status = number_or_nan(runs, "replay_status");
  score.replay_chi2 = number_or_nan(runs, "replay_chi2");
}

}  // namespace

CaseScore score_case(const std::filesystem::path& truth_folder,
                     const std::filesystem::path& diagnosis_folder,
                     const std::filesystem::path& oracle_folder) {
  CaseScore score;
  score.name = truth_folder.filename().string();
  score.holdout_chi2 = score.oracle_chi2 = score.predictive_chi2 = score.predictive_sigma = nan;
  score.expected_chi2 = score.fit_chi2 = score.attitude_chi2 = score.replay_status =
      score.replay_chi2 = score.confidence = nan;
  const Json truth = parsed(truth_folder / "truth.json");
  try {
    read_truth(truth, score);
  } catch (const Json::exception& error) {
    throw InputError({(truth_folder / "truth.json").string(), 0}, "", error.what(),
                     "verdict, effects and accept");
  }
  read_runs(diagnosis_folder, score);
  const auto experiment = truth_folder / "experiment.toml";
  const std::string nominal = std::filesystem::exists(experiment) ? read_file(experiment) : "";
  try {
    judge(truth, parsed(diagnosis_folder / "diagnosis.json"), nominal, score);
    score.answered = true;
  } catch (const Json::exception& error) {
    score.failure += error.what();
  } catch (const InputError& error) {
    if (score.failure.empty()) score.failure = error.what();
  }
  if (std::filesystem::exists(oracle_folder / "diagnosis.json")) {
    const Json oracle = parsed(oracle_folder / "diagnosis.json");
    const Json holdout = oracle.value("holdout", Json());
    if (holdout.is_object()) score.oracle_chi2 = number_or_nan(holdout, "chi2_per_sample_before");
  }
  return score;
}

}  // namespace photorque
