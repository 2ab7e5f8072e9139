// docs/proof.md from scores.
#pragma once

#include <string>
#include <vector>

#include "core/provenance.h"
#include "tools/scoring/score.h"

namespace photorque {

// A set of cases and how they were scored.
struct ProofSet {
  std::string title;        // "Injected cases of prove"
  std::string description;  // one paragraph
  std::vector<CaseScore> scores;
};

// The tables of one set in Markdown: headline counts with their intervals, figures, reliability, by
// kind, and every case that went wrong. Nothing in it depends on the machine but what is said to
// take time.
std::string proof_markdown(const ProofSet& set);

// `document` with the text between "<!-- NAME begin -->" and "<!-- NAME end -->" replaced;
// InputError when it has no such lines.
std::string with_section(const std::string& document, const std::string& name,
                         const std::string& text, const std::string& file);

}  // namespace photorque
