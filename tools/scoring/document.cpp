#include "tools/scoring/document.h"

#include <cmath>
#include <cstdio>

#include "core/errors.h"

namespace photorque {
namespace {

std::string print(const char* format, double value) {
  if (!std::isfinite(value)) return "–";
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string percent(double fraction) {
  return print("%.1f %%", 100.0 * fraction);
}

std::string row(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

std::string ruler(size_t columns) {
  std::string text = "|";
  for (size_t i = 0; i < columns; ++i) text += i == 0 ? "---|" : "---:|";
  return text + "\n";
}

std::string headline(const std::vector<CaseScore>& scores) {
  std::string text = row({"question", "right", "fraction", "95 % interval", "aim"}) + ruler(5);
  for (const ProofRow& r : proof_rows(scores)) {
    const double fraction = static_cast<double>(r.fraction.hits) / r.fraction.of;
    text +=
        row({r.question, std::to_string(r.fraction.hits) + " of " + std::to_string(r.fraction.of),
             percent(fraction), percent(r.fraction.low()) + " to " + percent(r.fraction.high()),
             r.aim.empty() ? "" : r.aim});
  }
  return text;
}

std::string figures(const std::vector<CaseScore>& scores) {
  std::string text = row({"figure", "value"}) + ruler(2);
  for (const Quantity& q : proof_quantities(scores)) {
    std::string value = print("%.4g", q.estimate.value);
    if (q.estimate.standard_error > 0.0) value += " ± " + print("%.2g", q.estimate.standard_error);
    text += row({q.name, value});
  }
  return text;
}

std::string table_markdown(const Table& table, const char* format) {
  std::vector<std::string> names;
  size_t rows = 0;
  for (const Table::Column& c : table.columns) {
    names.push_back(c.name);
    rows = std::max(c.values.size(), c.texts.size());
  }
  if (rows == 0) return "(none)\n";
  std::string text = row(names) + ruler(names.size());
  for (size_t i = 0; i < rows; ++i) {
    std::vector<std::string> cells;
    for (const Table::Column& c : table.columns) {
      cells.push_back(c.texts.empty() ? print(format, c.values[i]) : c.texts[i]);
    }
    text += row(cells);
  }
  return text;
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::string wrong_cases(const std::vector<CaseScore>& scores) {
  const auto joined = [](const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : " + ") + name;
    return text.empty() ? std::string("–") : text;
  };
  std::string text;
  for (const CaseScore& s : scores) {
    if (s.right) continue;
    const std::string said =
        s.answered ? s.verdict + ": " + joined(s.kinds) : "no answer: " + first_line(s.failure);
    text += row(
        {s.name, s.true_verdict + ": " + joined(s.true_kinds), print("%.3g", s.chi2_gain), said});
  }
  if (text.empty()) return "None.\n";
  return row({"case", "truth", "χ² gain", "said"}) + ruler(4) + text;
}

}  // namespace

std::string proof_markdown(const ProofSet& set) {
  std::string text = "### " + set.title + "\n\n" + set.description + "\n\n";
  text += headline(set.scores) + "\n" + figures(set.scores) + "\n";
  text += "Stated probability of every effect named, beside how often the name was right:\n\n" +
          table_markdown(proof_reliability(set.scores), "%.3g") + "\n";
  text += "Stated confidence of every answer, beside how often verdict and names were right:\n\n" +
          table_markdown(proof_calibration(set.scores), "%.3g") + "\n";
  text += "By family and maker:\n\n" + table_markdown(proof_by_family(set.scores), "%.3g") + "\n";
  text += "By the injected effect:\n\n" + table_markdown(proof_by_kind(set.scores), "%.0f") + "\n";
  return text + "What went wrong:\n\n" + wrong_cases(set.scores);
}

std::string with_section(const std::string& document, const std::string& name,
                         const std::string& text, const std::string& file) {
  const std::string begin = "<!-- " + name + " begin -->\n", end = "<!-- " + name + " end -->";
  const size_t from = document.find(begin), to = document.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from) {
    throw InputError({file, 0}, "", "no lines \"<!-- " + name + " begin -->\" and end",
                     "a document with both");
  }
  return document.substr(0, from + begin.size()) + "\n" + text + "\n" + document.substr(to);
}

}  // namespace photorque
