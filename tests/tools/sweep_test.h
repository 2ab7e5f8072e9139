// Shared by the tests of sweeps: a black plate in sunlight, whose figures have closed forms.
#pragma once

#include <sqlite3.h>

#include "tests/tools/command_test.h"

namespace photorque {

// The column of a CSV file by its name, as numbers.
inline std::vector<double> csv_column(const std::filesystem::path& path, const std::string& name) {
  return csv_table(path).at(name);
}

// The result of a query of a database, a text for every cell; one row of the error where it fails.
inline std::vector<std::vector<std::string>> query(const std::string& path,
                                                   const std::string& sql) {
  sqlite3* database = nullptr;
  std::vector<std::vector<std::string>> rows;
  const auto add = [](void* all, int count, char** cells, char**) {
    auto& row = static_cast<std::vector<std::vector<std::string>>*>(all)->emplace_back();
    for (int i = 0; i < count; ++i) row.emplace_back(cells[i] == nullptr ? "" : cells[i]);
    return 0;
  };
  if (sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READWRITE, nullptr) != SQLITE_OK ||
      sqlite3_exec(database, sql.c_str(), add, &rows, nullptr) != SQLITE_OK) {
    rows = {{sqlite3_errmsg(database)}};
  }
  sqlite3_close(database);
  return rows;
}

class SweepTest : public CommandTest {
 protected:
  static constexpr double edge_m = 0.4, height_m = 0.1, sun_W_m2 = 1000.0;

  // The experiment with this table [sweep]; `rays` of the sun.
  std::string experiment(const std::string& table, int rays = 4096) const {
    return write("e.toml",
                 "[scene]\nfile = \"plate.gltf\"\n[trace]\nrays = " + std::to_string(rays) +
                     "\n[[source]]\nkind = \"sun\"\nirradiance_W_m2 = 1000\n"
                     "angular_radius_deg = 0.27\ndirection = [0, 0, -1]\n"
                     "[attitude]\ntilt_deg = 10.5\n"
                     "[[receiver]]\nnode = \"plate\"\nbins = [8, 8]\n" +
                     table);
  }

  Outcome sweep(const std::string& options = "", const std::string& out = "out") const {
    return run("sweep " + at("e.toml") + " --out " + at(out) + " " + options);
  }

  // `photorque sweep` on its own, as another process.
  pid_t start(const std::string& options, const std::string& out = "out",
              const std::string& output_file = "/dev/null") const {
    return CommandTest::start("sweep " + at("e.toml") + " --out " + at(out) + " " + options,
                              output_file);
  }
};

}  // namespace photorque
