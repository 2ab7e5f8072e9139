#include "diagnosis/light/nominal_light.h"

#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "scenes/effects/stated.h"
#include "scenes/experiment/document.h"

namespace photorque {
namespace {

// A lab together with the experiment that it refers to.
struct OwnedLab {
  Experiment experiment;
  LightLab lab;
  explicit OwnedLab(Experiment read) : experiment(std::move(read)), lab(experiment) {}
};

LightPrior::Side side_of(Experiment experiment, double errors) {
  const auto owned = std::make_shared<const OwnedLab>(std::move(experiment));
  return {std::shared_ptr<const LightLab>(owned, &owned->lab),
          stated_effects(owned->experiment, owned->lab.parts()), errors};
}

std::string assignment_of(const UncertainKey& key, const std::vector<double>& values) {
  SettingsNode node{values.front(), {}};
  if (key.is_array) {
    SettingsNode::Array all;
    for (const double v : values) all.push_back({v, {}});
    node.value = std::move(all);
  }
  return key.path + "=" + toml_value(node);
}

LightPrior prior_of(const UncertainKey& key, size_t component, const LightPrior::Side& itself,
                    const std::function<Experiment(const std::string&)>& reread) {
  bool refused = false;
  const auto side = [&](double errors) {
    std::vector<double> values = key.value;
    values[component] += errors * key.sigma[component];
    try {
      return side_of(reread(assignment_of(key, values)), errors);
    } catch (const InputError&) {
      // One side may be out of range. If both sides are, the value cannot be varied.
      if (refused) {
        throw InputError({itself.lab->experiment().file.path.string()}, key.path,
                         readable_number(key.value[component], 6) + " with a sigma of " +
                             readable_number(key.sigma[component], 3),
                         "a number that can be off by a tenth of its sigma");
      }
      refused = true;
      return itself;
    }
  };
  LightPrior::Side low = side(-LightPrior::part), high = side(LightPrior::part);
  return {key.path, key.value, component, key.sigma[component], std::move(low), std::move(high)};
}

}  // namespace

NominalLight nominal_light(const LightLab& lab, const std::vector<UncertainKey>& uncertain,
                           const std::function<Experiment(const std::string&)>& reread) {
  NominalLight nominal{stated_effects(lab.experiment(), lab.parts()), {}};
  const LightPrior::Side itself{std::shared_ptr<const LightLab>(std::shared_ptr<void>(), &lab),
                                nominal.state, 0.0};
  for (const UncertainKey& key : uncertain) {
    for (size_t i = 0; i < key.value.size(); ++i) {
      if (key.sigma[i] > 0.0) nominal.uncertain.push_back(prior_of(key, i, itself, reread));
    }
  }
  return nominal;
}

void add_tilt_prior(const LightLab& lab, const Vec2& bias_rad, const Vec2& sigma_rad,
                    NominalLight& nominal) {
  nominal.state.attitude_bias_rad += bias_rad;
  const std::shared_ptr<const LightLab> same(std::shared_ptr<void>(), &lab);
  const Vec2 bias_deg = bias_rad / degree_rad;
  for (int k = 0; k < 2; ++k) {
    const auto side = [&](double errors) {
      LightPrior::Side s{same, nominal.state, errors};
      s.state.attitude_bias_rad[k] += errors * sigma_rad[k];
      return s;
    };
    nominal.uncertain.push_back({tilt_prior,
                                 {bias_deg.x(), bias_deg.y()},
                                 static_cast<size_t>(k),
                                 sigma_rad[k] / degree_rad,
                                 side(-LightPrior::part),
                                 side(LightPrior::part)});
  }
}

Eigen::MatrixXd slopes_by_priors(const LightRun& run, const std::vector<LightPrior>& priors) {
  Eigen::MatrixXd slopes(static_cast<Eigen::Index>(run.samples()),
                         static_cast<Eigen::Index>(priors.size()));
  const auto residuals = [&](const LightPrior::Side& side) {
    const LightRun there = run.in(*side.lab);
    return there.residuals(side.state, there.signals(side.state, there.fields(side.state, nullptr)),
                           nullptr);
  };
  for (size_t k = 0; k < priors.size(); ++k) {
    const LightPrior::Side &low = priors[k].low, &high = priors[k].high;
    slopes.col(static_cast<Eigen::Index>(k)) =
        (residuals(low) - residuals(high)) / (high.errors - low.errors);
  }
  return slopes;
}

}  // namespace photorque
