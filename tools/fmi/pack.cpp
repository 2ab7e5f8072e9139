#include "tools/fmi/pack.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "core/errors.h"
#include "core/files.h"
#include "scenes/experiment/named_files.h"
#include "scenes/experiment/toml.h"
#include "tools/fmi/archive.h"
#include "tools/fmi/description.h"
#include "tools/fmi/standard.h"
#include "tools/runs/attitude_run.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// Beside the program, or where it was installed to.
fs::path unit_library() {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& place : {program, program / PHOTORQUE_UNIT_FOLDER}) {
    fs::path library = place / "photorque_fmu.so";
    if (fs::is_regular_file(library)) return library;
  }
  throw InputError({program.string()}, "", "no photorque_fmu.so", "the library beside the program");
}

// A folder that goes when it is not needed any more.
struct StagingFolder {
  fs::path path;
  StagingFolder() {
    std::string name = (fs::temp_directory_path() / "photorque-fmu-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw InputError({name}, "", "a folder that cannot be made", "a place for temporary files");
    }
    path = name;
  }
  ~StagingFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;
};

// Texts that name files name them from the experiment's own folder, wherever they stood.
void name_beside(SettingsNode& node, const fs::path& folder) {
  if (auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
    for (auto& [key, item] : *table) name_beside(item, folder);
  } else if (auto* items = std::get_if<SettingsNode::Array>(&node.value)) {
    for (SettingsNode& item : *items) name_beside(item, folder);
  } else if (auto* text = std::get_if<std::string>(&node.value)) {
    if (!fs::path(*text).is_absolute() || named_file(folder, *text).empty()) return;
    *text = fs::path(*text).lexically_normal().lexically_relative(folder).generic_string();
  }
}

fs::path common_folder(fs::path folder, const std::set<fs::path>& files) {
  for (const fs::path& file : files) {
    while (*file.lexically_relative(folder).begin() == "..") folder = folder.parent_path();
  }
  return folder;
}

bool has_lit_scene(const SettingsNode& root) {
  return find_setting(root, "scene") != nullptr && find_setting(root, "source") != nullptr;
}

void copy_resources(const RunOptions& options, const fs::path& resources,
                    const std::string& token) {
  SettingsNode root = parse_toml(options.experiment_text(), options.experiment.string());
  for (const std::string& one : options.all_overrides()) apply_override(root, one);
  if (options.seed) apply_override(root, "propagate.seed=" + std::to_string(*options.seed));
  const fs::path experiment = fs::absolute(options.experiment).lexically_normal();
  const fs::path folder = experiment.parent_path();
  const std::set<fs::path> files = all_named_files(root, folder);
  name_beside(root, folder);
  const fs::path from = common_folder(folder, files);
  const auto place = [&](const fs::path& file) {
    return fs::path("model") / file.lexically_relative(from);
  };
  for (const fs::path& file : files) {
    fs::create_directories((resources / place(file)).parent_path());
    fs::copy_file(file, resources / place(file));
  }
  const fs::path own = place(experiment);
  fs::create_directories((resources / own).parent_path());
  write_file_whole(resources / own, toml_document(std::get<SettingsNode::Table>(root.value)));
  write_file_whole(resources / "unit", token + "\n" + own.generic_string() + "\n" +
                                           (has_lit_scene(root) ? "light" : "dark") + "\n");
}

// Loads the unit as an importer would and makes one step, which also makes its table of light.
void try_unit(const Console& console, const fs::path& library, const std::string& token,
              const fs::path& resources, double tick_s) {
  const std::unique_ptr<void, int (*)(void*)> loaded(
      ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL), ::dlclose);
  if (!loaded)
    throw InputError({library.string()}, "", ::dlerror(), "a library that can be loaded");
  const auto function = [&]<typename Signature>(const char* name, Signature*) {
    return reinterpret_cast<Signature*>(::dlsym(loaded.get(), name));
  };
  struct Heard {
    const Console* console;
    std::string error;
  } heard{&console, {}};
  const auto hear = [](fmi3InstanceEnvironment to, fmi3Status status, fmi3String,
                       fmi3String message) {
    auto* all = static_cast<Heard*>(to);
    if (status == fmi3OK) {
      all->console->line(message);
    } else {
      all->error = message;
    }
  };
  using Instantiate =
      fmi3Instance(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                   fmi3Boolean, const fmi3ValueReference*, size_t, fmi3InstanceEnvironment,
                   fmi3LogMessageCallback, fmi3IntermediateUpdateCallback);
  using Enter =
      fmi3Status(fmi3Instance, fmi3Boolean, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Float64);
  using Plain = fmi3Status(fmi3Instance);
  using Step = fmi3Status(fmi3Instance, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Boolean*,
                          fmi3Boolean*, fmi3Boolean*, fmi3Float64*);
  using Free = void(fmi3Instance);
  const fmi3Instance unit = function("fmi3InstantiateCoSimulation", (Instantiate*)nullptr)(
      "trial", token.c_str(), (resources.string() + "/").c_str(), false, true, false, false,
      nullptr, 0, &heard, hear, nullptr);
  bool works = unit != nullptr;
  bool event = false, end = false, early = false;
  double reached_s = 0.0;
  works = works && function("fmi3EnterInitializationMode", (Enter*)nullptr)(unit, false, 0.0, 0.0,
                                                                            true, tick_s) == fmi3OK;
  works = works && function("fmi3ExitInitializationMode", (Plain*)nullptr)(unit) == fmi3OK;
  works = works && function("fmi3DoStep", (Step*)nullptr)(unit, 0.0, tick_s, true, &event, &end,
                                                          &early, &reached_s) == fmi3OK;
  if (unit != nullptr) function("fmi3FreeInstance", (Free*)nullptr)(unit);
  if (!works) throw NumericalError("the unit does not work: " + heard.error);
}

// All files below a folder, in order of their names.
std::vector<std::pair<std::string, std::string>> files_below(const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files.emplace_back(entry.path().lexically_relative(folder).generic_string(),
                       read_file(entry.path()));
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

RunResult pack_unit(const RunOptions& options, const Console& console) {
  const WallTime wall;
  const UnitDescription unit = describe_unit(options);
  RunResult result;
  result.provenance = AttitudeExperiment(options).provenance(options.seed.value_or(1));
  const fs::path library = unit_library();
  const std::string code = read_file(library);
  const std::string token =
      "{" + content_hash(result.provenance.one_line() + content_hash(code)) + "}";
  const StagingFolder staging;
  const fs::path resources = staging.path / "resources";
  const std::string name = options.experiment.stem().string();
  const std::string tool = "photorque " + result.provenance.version;
  fs::create_directories(staging.path / "binaries" / "x86_64-linux");
  fs::copy_file(library, staging.path / "binaries" / "x86_64-linux" / "photorque.so");
  copy_resources(options, resources, token);
  write_file_whole(staging.path / "modelDescription.xml",
                   model_description(unit, name, token, tool));
  try_unit(console, staging.path / "binaries" / "x86_64-linux" / "photorque.so", token, resources,
           1.0 / unit.rate_Hz);
  const std::string archive = zip_archive(files_below(staging.path));
  result.files.push_back({name + ".fmu",
                          [archive](const fs::path& path) { write_file_whole(path, archive); },
                          "for importers of FMI 3.0"});
  result.product.quantities.push_back({"ticks_Hz", {unit.rate_Hz, 0.0}});
  result.product.quantities.push_back({"start_s", {unit.start_s, 0.0}});
  result.product.quantities.push_back({"stop_s", {unit.stop_s, 0.0}});
  result.cost = {wall.elapsed_s(), {}};
  return result;
}

}  // namespace photorque
