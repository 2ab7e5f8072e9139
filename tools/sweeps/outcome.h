// The outcome of one run of a command, as a sweep stores it.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/product.h"

namespace photorque {

// "KEY=VALUE" for every key that a run changes.
using Changes = std::vector<std::string>;

// The name of a figure; copies share it.
class FigureName {
 public:
  explicit FigureName(std::string name)
      : name_(std::make_shared<const std::string>(std::move(name))) {}
  const std::string& text() const { return *name_; }
  friend bool operator==(const FigureName& a, const FigureName& b) { return a.text() == b.text(); }

 private:
  std::shared_ptr<const std::string> name_;
};

struct Figure {
  FigureName name;
  Estimate estimate;
};

inline std::vector<Figure> figures_of(std::span<const Quantity> quantities) {
  std::vector<Figure> figures;
  for (const Quantity& q : quantities) figures.push_back({FigureName(q.name), q.estimate});
  return figures;
}

// Figure of this name; null if there is none.
inline const Figure* find_figure(std::span<const Figure> figures, const std::string& name) {
  const auto at = std::ranges::find(
      figures, name, [](const Figure& f) -> const std::string& { return f.name.text(); });
  return at == figures.end() ? nullptr : &*at;
}

// Names that the runs of a sweep have in common, stored once for all runs.
class FigureNames {
 public:
  void share(std::vector<Figure>& figures) {
    for (Figure& f : figures) f.name = known_.try_emplace(f.name.text(), f.name).first->second;
  }

 private:
  std::map<std::string, FigureName> known_;
};

struct RunOutcome {
  std::vector<Figure> figures;  // of the summary; empty if the run failed
  int status = 0;               // exit status of the program: 2 wrong input, 3 numerical failure
  std::string error = {};       // one line
  bool failed() const { return status != 0; }
};

}  // namespace photorque
