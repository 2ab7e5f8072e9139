#include "diagnosis/json.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "core/text/format.h"

namespace photorque {
namespace {

using Json = nlohmann::ordered_json;

// A single number is written without an array. Non-finite numbers become null.
Json numbers(const std::vector<double>& values) {
  return values.size() == 1 ? Json(values.front()) : Json(values);
}

Json vectors(const std::vector<Vec3>& values) {
  Json array = Json::array();
  for (const Vec3& v : values) array.push_back(numbers({v.x(), v.y(), v.z()}));
  return array;
}

Json parameters_json(const std::vector<FittedParameter>& parameters) {
  Json table = Json::object();
  for (const FittedParameter& p : parameters) {
    table[p.key] = {{"value", numbers(p.value)}};
    if (!p.sigma.empty()) table[p.key]["sigma"] = numbers(p.sigma);
  }
  return table;
}

template <class Item, class Convert>
Json list(const std::vector<Item>& items, const Convert& convert) {
  Json array = Json::array();
  for (const Item& item : items) array.push_back(convert(item));
  return array;
}

Json misfit_json(const Where::ChannelMisfit& channel) {
  Json json = {{"name", channel.name}, {"chi2_per_sample", channel.chi2_per_sample}};
  if (channel.chi2_of_median > 0.0) json["chi2_of_median"] = channel.chi2_of_median;
  return json;
}

Json where_json(const Where& where) {
  Json intervals = Json::array();
  for (const auto& i : where.intervals_s) intervals.push_back(numbers({i.from, i.to}));
  Json depends = Json::array();
  for (const auto& d : where.depends_on) {
    Json one = {{"variable", d.variable}};
    if (d.strength > 0.0) one["strength"] = d.strength;
    // This schema calls the yaw "heading".
    if (d.variable == "yaw") {
      one["variable"] = "heading";
      one["quantity"] = "yaw_deg";
    }
    depends.push_back(one);
  }
  Json json = {{"channels", list(where.channels, misfit_json)}, {"intervals_s", intervals}};
  json["band_Hz"] = where.band_Hz ? numbers({where.band_Hz->from, where.band_Hz->to}) : Json();
  json["depends_on"] = depends;
  return json;
}

Json effect_json(const FoundEffect& effect) {
  Json parameters = parameters_json(effect.parameters);
  for (const auto& [key, text] : effect.texts) parameters[key] = {{"value", text}};
  return {{"kind", effect.kind},
          {"probability", effect.probability},
          {"parameters", parameters},
          {"indistinguishable_from", effect.indistinguishable_from},
          {"explanation", effect.explanation},
          {"known_together", effect.known_together}};
}

Json domain_json(const DomainAnswer& answer) {
  return {{"of", answer.of},
          {"verdict", name_of(answer.verdict)},
          {"confidence", answer.confidence},
          {"sentence", answer.sentence}};
}

Json empirical_json(const EmpiricalTorque& torque) {
  return {{"variable", torque.variable},
          {"formula", torque.formula.empty() ? Json() : Json(torque.formula)},
          {"looks_like", torque.looks_like},
          {"parameters", parameters_json(torque.parameters)},
          {"unit", torque.unit},
          {"axes", torque.about_lab_axes ? "lab" : "body"},
          {"at", numbers(torque.at)},
          {"torque_N_m", vectors(torque.torque_N_m)},
          {"standard_error_N_m", vectors(torque.standard_error_N_m)}};
}

Json holdout_json(const Holdout& holdout) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();  // null
  const auto predictive = holdout.predictive.value_or(inference::Predictive{unknown, unknown});
  return {{"predictive_chi2_per_sample", predictive.chi2_per_sample},
          {"expected_chi2_per_sample", predictive.expected_chi2_per_sample},
          {"predictive_sigma", predictive.sigma},
          {"explained_fraction", holdout.explained_fraction},
          {"rms_before", holdout.rms_before},
          {"rms_after", holdout.rms_after},
          {"chi2_per_sample_before", holdout.chi2_per_sample_before},
          {"chi2_per_sample_after", holdout.chi2_per_sample_after},
          {"samples", holdout.samples}};
}

// "kind" joins several kinds with " + ". It is "none" if nothing is missing, and the label if the
// kinds do not describe the explanation completely.
Json alternative_json(const Alternative& alternative) {
  std::string kind = joined_text(alternative.kinds, " + ");
  if (!alternative.label.empty()) kind = alternative.label;
  if (kind.empty()) kind = "none";
  Json json = {{"kind", kind}, {"log_evidence_relative", alternative.log_evidence_relative}};
  json["holdout_chi2_per_sample"] =
      alternative.holdout_chi2_per_sample ? Json(*alternative.holdout_chi2_per_sample) : Json();
  if (!alternative.remark.empty()) json["remark"] = alternative.remark;
  if (!alternative.of.empty()) json["of"] = alternative.of;
  return json;
}

Json provenance_json(const Provenance& provenance) {
  Json inputs = Json::object();
  for (const auto& [file, hash] : provenance.inputs) inputs[file] = hash;
  return {{"program", provenance.program},
          {"version", provenance.version},
          {"git_hash", provenance.git_hash},
          {"seed", provenance.seed},
          {"inputs", inputs}};
}

Json manoeuvre_json(const Manoeuvre& manoeuvre) {
  return {{"separates", manoeuvre.separates},
          {"text", manoeuvre.text},
          {"log_evidence_expected", manoeuvre.log_evidence_expected}};
}

Json instrument_json(const InstrumentFinding& finding) {
  return {{"channel", finding.channel},
          {"what", finding.what},
          {"value", finding.value},
          {"sigma", finding.sigma},
          {"text", finding.text}};
}

Json body_json(const BodyOfRecordings& body) {
  return {{"recordings", body.recordings},
          {"inertia_relative",
           {{"value", numbers(body.inertia_relative)},
            {"sigma", numbers(body.inertia_relative_sigma)}}}};
}

}  // namespace

std::string diagnosis_json(const Diagnosis& d, const Provenance& provenance) {
  Json json;
  json["schema"] = "photorque.diagnosis/1";
  json["verdict"] = name_of(d.verdict);
  json["confidence"] = d.confidence;
  json["sentence"] = d.sentence;
  json["because"] = d.because;
  if (!d.domains.empty()) json["domains"] = list(d.domains, domain_json);
  json["where"] = where_json(d.where);
  json["effects"] = list(d.effects, effect_json);
  json["fit"] = {{"chi2_per_sample_before", d.chi2_per_sample_before},
                 {"chi2_per_sample_after", d.chi2_per_sample_after},
                 {"samples", d.samples},
                 {"channels", list(d.channels_after, misfit_json)}};
  json["holdout"] = d.holdout ? holdout_json(*d.holdout) : Json();
  json["alternatives"] = list(d.alternatives, alternative_json);
  json["empirical_torque"] = list(d.empirical, empirical_json);
  json["manoeuvres"] = list(d.manoeuvres, manoeuvre_json);
  json["beliefs_refined"] = parameters_json(d.priors_refined);
  json["instruments"] = list(d.instruments, instrument_json);
  json["different_bodies"] = list(d.bodies, body_json);
  json["warnings"] = d.warnings;
  json["data"] = {{"rows", d.data.rows},
                  {"used", d.data.used},
                  {"rejected", d.data.rejected},
                  {"mended", d.data.repaired},
                  {"median_interval_s", d.data.median_interval_s},
                  {"jitter_s", d.data.jitter_s},
                  {"longest_gap_s", d.data.max_gap_s}};
  json["provenance"] = provenance_json(provenance);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace photorque
