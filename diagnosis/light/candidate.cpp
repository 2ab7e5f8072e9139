#include "diagnosis/light/candidate.h"

#include <algorithm>

namespace photorque {
namespace {

// Adds a candidate with the numbers of its kind, and the traits that follow from them.
void add(LightCandidate c, std::vector<LightCandidate>& all) {
  for (size_t p = 0; p < c.kind.parameters.size(); ++p) {
    const EffectParameter& e = c.kind.parameters[p];
    for (size_t k = 0; k < e.count; ++k) {
      const double start = e.starts.empty() ? 0.0 : e.starts.front();
      c.numbers.push_back({p, start, e.scale, e.lowest, e.highest,
                           e.step > 0.0 ? e.step : 0.02 * e.scale, e.is_strength && e.is_fitted,
                           e.is_fitted});
    }
  }
  const auto is_strength = [](const LightCandidate::Number& n) { return n.is_strength; };
  const auto is_fitted = [](const LightCandidate::Number& n) { return n.is_fitted; };
  c.parameters = static_cast<size_t>(std::ranges::count_if(c.numbers, is_fitted));
  c.has_strength = std::ranges::any_of(c.numbers, is_strength);
  c.is_linear = c.has_strength && std::ranges::all_of(c.numbers, [&](const auto& n) {
                  return is_strength(n) || !is_fitted(n);
                });
  c.has_place = c.kind.scan == LightEffectKind::Scan::shadow;
  if (c.kind.index != LightEffectKind::Index::none) c.kind_of_place = c.kind.name;
  all.push_back(std::move(c));
}

bool can_show(const LightEffectKind& kind, const std::vector<FittedRun>& runs) {
  return std::ranges::any_of(runs, [&](const FittedRun& r) {
    const LightRecording::Kind of = r.run->recording().kind;
    return of == LightRecording::Kind::scan    ? kind.in_scans
           : of == LightRecording::Kind::sweep ? kind.in_sweeps
                                               : kind.in_runs;
  });
}

}  // namespace

FittedRun prepared_run(LightRun run, const NominalLight& nominal) {
  FittedRun result;
  result.run = std::make_shared<const LightRun>(std::move(run));
  // Includes the light reflected by every wall, which most trials do not contain.
  LightState with_walls = nominal.state;
  with_walls.walls.clear();
  for (size_t w = 0; w < result.run->lab().walls().size(); ++w) {
    with_walls.walls.push_back({w, 1.0, 1.0});
  }
  result.nominal = std::make_shared<const LightFields>(result.run->fields(with_walls, nullptr));
  result.prior_slopes =
      std::make_shared<const Eigen::MatrixXd>(slopes_by_priors(*result.run, nominal.uncertain));
  return result;
}

FittedRun part_of(const FittedRun& whole, const std::vector<size_t>& rows,
                  const NominalLight& nominal) {
  // The knots of a run over time depend on its rows, so the part is prepared from its recording.
  const bool is_scan = whole.run->recording().kind == LightRecording::Kind::scan;
  if (!is_scan) return prepared_run(whole.run->part(rows), nominal);
  FittedRun result;
  result.run = std::make_shared<const LightRun>(whole.run->part(rows));
  result.nominal = std::make_shared<const LightFields>(LightRun::part(*whole.nominal, rows));
  const std::vector<Eigen::Index> at(rows.begin(), rows.end());
  result.prior_slopes =
      std::make_shared<const Eigen::MatrixXd>((*whole.prior_slopes)(at, Eigen::all));
  return result;
}

std::vector<double> LightCandidate::start() const {
  std::vector<double> x;
  for (const Number& n : numbers) x.push_back(n.start);
  return x;
}

LightCandidates light_candidates(const LightLab& lab, const NominalLight& nominal,
                                 const std::vector<FittedRun>& runs, const Thresholds& limits) {
  LightCandidates all{{}, limits, &lab, nominal};
  for (const LightEffectKind& kind : all_light_effect_kinds()) {
    if (!can_show(kind, runs)) continue;
    // A nominal tilt with a sigma is a nuisance parameter of every trial.
    const bool is_nominal = std::ranges::any_of(
        nominal.uncertain, [&](const LightPrior& p) { return p.key.starts_with(kind.name + "."); });
    if (is_nominal) continue;
    const size_t count = lab.parts().count_of(kind.index);
    // Cell circuits make the readings a nonlinear function of the numbers of a cell.
    const bool is_fitted_first = kind.index == LightEffectKind::Index::cell &&
                                 std::ranges::any_of(runs, [](const FittedRun& r) {
                                   return r.run->recording().kind != LightRecording::Kind::scan;
                                 });
    // If the only string is interrupted or the only diode is shorted, nothing can be measured.
    const bool is_only = count < 2 && (kind.index == LightEffectKind::Index::string);
    for (size_t i = 0; i < count && !is_only; ++i) {
      LightCandidate c;
      c.kind = kind;
      c.index = i;
      c.name = kind.name + (kind.is_numbered() ? "[" + std::to_string(i) + "]" : "");
      c.is_fitted_first = is_fitted_first;
      add(std::move(c), all.list);
    }
  }
  for (LightCandidate& c : empirical_light_candidates(runs)) add(std::move(c), all.list);
  return all;
}

}  // namespace photorque
