// What every page has, from what every run gives; and the page as one of a run's files.
#pragma once

#include <string>
#include <vector>

#include "images/browser/run_page.h"
#include "tools/runs/optical_run.h"
#include "tools/runs/result.h"

namespace photorque {

// The page of a run without its stage: figures with names and units for people, of which those
// whose names begin with one of `headlines` stand at the top (at most six, in this order).
RunPage page_of(const RunResult& result, const std::string& title, const std::string& verb,
                const std::string& command, const std::vector<std::string>& headlines);

// The table of this name; null where there is none.
const Table* table_of(const Product& product, const std::string& name);

// The way of the power through a run: of the array's table "losses" where there is one, otherwise
// from the lamps to the parts that carry flux maps.
std::vector<PowerStage> power_stages(const OpticalRun& run, const OpticalResult& light,
                                     const Product& product);

// "page.html", made when it is written.
RunFile page_file(RunPage page);

}  // namespace photorque
