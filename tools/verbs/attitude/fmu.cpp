// photorque fmu: the platform for Simulink, OpenModelica and other importers of FMI 3.0 or 2.0.
#include <dlfcn.h>
#include <minizip/zip.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <pugixml.hpp>
#include <sstream>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/parse.h"
#include "scenes/experiment/document.h"
#include "scenes/experiment/named_files.h"
#include "scenes/experiment/toml.h"
#include "tools/fmi/standard.h"
#include "tools/fmi/unit.h"
#include "tools/runs/attitude_run.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::fmu {
namespace {

namespace fs = std::filesystem;

void set_attribute(pugi::xml_node element, const char* name, const std::string& value) {
  element.append_attribute(name).set_value(value.c_str());
}

// Writes the shortest text that is read back as the same number.
void set_attribute(pugi::xml_node element, const char* name, double value) {
  set_attribute(element, name, shortest(value));
}

constexpr std::string_view unit_definitions = R"(<UnitDefinitions>
  <Unit name="s"><BaseUnit s="1"/></Unit>
  <Unit name="rad"><BaseUnit rad="1"/><DisplayUnit name="deg" factor="57.29577951308232"/></Unit>
  <Unit name="rad/s"><BaseUnit s="-1" rad="1"/><DisplayUnit name="deg/s" factor="57.29577951308232"/></Unit>
  <Unit name="N.m"><BaseUnit kg="1" m="2" s="-2"/></Unit>
  <Unit name="A"><BaseUnit A="1"/></Unit>
  <Unit name="W"><BaseUnit kg="1" m="2" s="-3"/></Unit>
</UnitDefinitions>)";

constexpr std::string_view log_categories = R"(<LogCategories>
  <Category name="logEvents" description="output of the run"/>
  <Category name="logStatusDiscard" description="values that were refused"/>
  <Category name="logStatusError" description="what went wrong"/>
</LogCategories>)";

// In FMI 3.0 the type is the name of the variable's element, in 2.0 that of a child element.
void append_variable(pugi::xml_node variables, const UnitVariable& variable,
                     const UnitDescription& unit, bool is_2) {
  using Kind = UnitVariable::Kind;
  const bool is_flag = variable.kind == Kind::flag;
  const char* type_name = is_flag ? "Boolean" : is_2 ? "Real" : "Float64";
  pugi::xml_node element = variables.append_child(is_2 ? "ScalarVariable" : type_name);
  set_attribute(element, "name", variable.name);
  set_attribute(element, "valueReference", std::to_string(variable.reference));
  set_attribute(element, "description", variable.meaning);
  const char* causality = variable.kind == Kind::time    ? "independent"
                          : variable.kind == Kind::input ? "input"
                                                         : "output";
  set_attribute(element, "causality", causality);
  set_attribute(element, "variability", is_flag ? "discrete" : "continuous");
  if (causality == std::string_view("output")) set_attribute(element, "initial", "calculated");
  pugi::xml_node type = is_2 ? element.append_child(type_name) : element;
  if (!variable.unit.empty()) set_attribute(type, "unit", variable.unit);
  if (variable.kind == Kind::input) {
    set_attribute(type, "min", -unit.max_torque_N_m);
    set_attribute(type, "max", unit.max_torque_N_m);
    set_attribute(type, "start", 0.0);
  }
}

// Outputs at a tick do not depend on inputs at that tick. FMI 3.0 lists them by reference, 2.0 by
// their position among the variables, from 1.
void append_structure(pugi::xml_node root, const UnitDescription& unit, bool is_2) {
  pugi::xml_node structure = root.append_child("ModelStructure");
  for (const std::string name : {"Output", "InitialUnknown"}) {
    pugi::xml_node list = is_2 ? structure.append_child((name + "s").c_str()) : structure;
    for (size_t i = 0; i < unit.variables.size(); ++i) {
      const UnitVariable& variable = unit.variables[i];
      if (variable.kind != UnitVariable::Kind::output &&
          variable.kind != UnitVariable::Kind::flag) {
        continue;
      }
      pugi::xml_node element = list.append_child(is_2 ? "Unknown" : name.c_str());
      set_attribute(element, is_2 ? "index" : "valueReference",
                    std::to_string(is_2 ? i + 1 : variable.reference));
      set_attribute(element, "dependencies", "");
    }
  }
}

// Text of modelDescription.xml for FMI 2.0 or 3.0. `name` is the name of the model, `token`
// the instantiation token, `tool` the generating program.
std::string model_description(bool is_2, const UnitDescription& unit, const std::string& name,
                              const std::string& token, const std::string& tool) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  set_attribute(declaration, "version", "1.0");
  set_attribute(declaration, "encoding", "UTF-8");
  pugi::xml_node root = document.append_child("fmiModelDescription");
  set_attribute(root, "fmiVersion", is_2 ? "2.0" : "3.0");
  set_attribute(root, "modelName", name);
  set_attribute(root, is_2 ? "guid" : "instantiationToken", token);
  set_attribute(root, "description",
                "A free-floating platform under its disturbances and its light");
  set_attribute(root, "generationTool", tool);
  set_attribute(root, "variableNamingConvention", "flat");
  pugi::xml_node kind = root.append_child("CoSimulation");
  set_attribute(kind, "modelIdentifier", "photorque");
  set_attribute(kind, is_2 ? "canGetAndSetFMUstate" : "canGetAndSetFMUState", "true");
  set_attribute(kind, is_2 ? "canSerializeFMUstate" : "canSerializeFMUState", "true");
  set_attribute(kind, "canHandleVariableCommunicationStepSize", "true");
  if (!is_2) set_attribute(kind, "fixedInternalStepSize", 1.0 / unit.rate_Hz);
  root.append_buffer(unit_definitions.data(), unit_definitions.size());
  root.append_buffer(log_categories.data(), log_categories.size());
  pugi::xml_node experiment = root.append_child("DefaultExperiment");
  set_attribute(experiment, "startTime", unit.start_s);
  set_attribute(experiment, "stopTime", unit.stop_s);
  set_attribute(experiment, "stepSize", 1.0 / unit.rate_Hz);
  pugi::xml_node variables = root.append_child("ModelVariables");
  for (const UnitVariable& variable : unit.variables) {
    append_variable(variables, variable, unit, is_2);
  }
  append_structure(root, unit, is_2);
  std::ostringstream text;
  document.save(text, "  ", pugi::format_indent, pugi::encoding_utf8);
  return text.str();
}

// Writes a ZIP archive of files (name with '/', bytes) in this order. All have the same date, so
// that equal files give equal bytes.
void write_archive(const fs::path& path,
                   const std::vector<std::pair<std::string, std::string>>& files) {
  constexpr uLong first_day = 0x21UL << 16;  // 1 January 1980 at midnight, in the format of MS-DOS
  constexpr uLong made_on_unix = (3UL << 8) | 20, names_are_utf8 = 1UL << 11;
  constexpr uLong regular_file = 0100644UL << 16;
  constexpr size_t largest_plain = 0xffffffff;  // beyond: the ZIP64 format
  zipFile archive = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
  bool is_written = archive != nullptr;
  for (const auto& [name, bytes] : files) {
    if (!is_written) break;
    zip_fileinfo about{};
    about.dosDate = first_day;
    about.external_fa = regular_file;
    is_written =
        zipOpenNewFileInZip4_64(archive, name.c_str(), &about, nullptr, 0, nullptr, 0, nullptr,
                                Z_DEFLATED, Z_DEFAULT_COMPRESSION, 0, -MAX_WBITS, DEF_MEM_LEVEL,
                                Z_DEFAULT_STRATEGY, nullptr, 0, made_on_unix, names_are_utf8,
                                bytes.size() >= largest_plain ? 1 : 0) == ZIP_OK;
    // The size of one write is limited to an unsigned int.
    constexpr size_t at_once = size_t{1} << 30;
    for (size_t done = 0; is_written && done < bytes.size(); done += at_once) {
      const size_t size = std::min(at_once, bytes.size() - done);
      is_written =
          zipWriteInFileInZip(archive, bytes.data() + done, static_cast<unsigned>(size)) == ZIP_OK;
    }
    is_written = is_written && zipCloseFileInZip(archive) == ZIP_OK;
  }
  if (archive != nullptr) is_written = zipClose(archive, nullptr) == ZIP_OK && is_written;
  if (!is_written) {
    throw InputError({path.string()}, "", "an archive that cannot be written", "space for it");
  }
}

// The library must be beside the program or in its installation folder.
fs::path unit_library() {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& place : {program, program / PHOTORQUE_UNIT_FOLDER}) {
    fs::path library = place / "photorque_fmu.so";
    if (fs::is_regular_file(library)) return library;
  }
  throw InputError({program.string()}, "", "no photorque_fmu.so", "the library beside the program");
}

// A temporary folder that is removed by the destructor.
struct StagingFolder {
  fs::path path;
  StagingFolder() {
    std::string name = (fs::temp_directory_path() / "photorque-fmu-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw InputError({name}, "", "a folder that cannot be made", "a folder for temporary files");
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

// Changes file names in texts so that the files are in the experiment's folder of the unit.
void name_beside(SettingsNode& root, const fs::path& folder) {
  for_each_node(root, [&](SettingsNode& node) {
    auto* text = std::get_if<std::string>(&node.value);
    if (text == nullptr || !fs::path(*text).is_absolute() || named_file(folder, *text).empty()) {
      return;
    }
    *text = fs::path(*text).lexically_normal().lexically_relative(folder).generic_string();
  });
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

// Loads the unit as an importer does and makes one step, which also creates its table of light.
void try_unit(const Console& console, const fs::path& library, const std::string& token,
              const fs::path& resources, double tick_s) {
  const std::unique_ptr<void, int (*)(void*)> loaded(
      ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL), ::dlclose);
  if (!loaded)
    throw InputError({library.string()}, "", ::dlerror(), "a library that can be loaded");
  const auto function = [&]<typename Signature>(const char* name, Signature*) {
    return reinterpret_cast<Signature*>(::dlsym(loaded.get(), name));
  };
  struct LogMessages {
    const Console* console;
    std::string error;
  } messages{&console, {}};
  const auto log = [](fmi3InstanceEnvironment to, fmi3Status status, fmi3String,
                      fmi3String message) {
    auto* all = static_cast<LogMessages*>(to);
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
      nullptr, 0, &messages, log, nullptr);
  bool works = unit != nullptr;
  bool event = false, end = false, early = false;
  double reached_s = 0.0;
  works = works && function("fmi3EnterInitializationMode", (Enter*)nullptr)(unit, false, 0.0, 0.0,
                                                                            true, tick_s) == fmi3OK;
  works = works && function("fmi3ExitInitializationMode", (Plain*)nullptr)(unit) == fmi3OK;
  works = works && function("fmi3DoStep", (Step*)nullptr)(unit, 0.0, tick_s, true, &event, &end,
                                                          &early, &reached_s) == fmi3OK;
  if (unit != nullptr) function("fmi3FreeInstance", (Free*)nullptr)(unit);
  if (!works) throw NumericalError("the unit does not work: " + messages.error);
}

// All files below a folder, sorted by name.
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

struct FmuOptions : CommandOptions {
  int fmi = 3;
};

void add_options(Command& command, FmuOptions& options) {
  command.add_experiment(options);
  command.add("--fmi", options.fmi, "Version of the Functional Mock-up Interface: 3 or 2").range =
      Option::Between<int>(2, 3);
}

// Writes NAME.fmu: modelDescription.xml, the library, the experiment with its overrides, every file
// that it names, and the table of its light. Before it is packed, the unit is loaded and makes one
// step, which also computes this table. Throws InputError if the experiment cannot run or a file is
// missing.
RunResult pack_unit(const FmuOptions& options, const Console& console) {
  const WallTime wall;
  const bool is_2 = options.fmi == 2;
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
  const fs::path binaries = staging.path / "binaries" / (is_2 ? "linux64" : "x86_64-linux");
  fs::create_directories(binaries);
  fs::copy_file(library, binaries / "photorque.so");
  copy_resources(options, resources, token);
  write_file_whole(staging.path / "modelDescription.xml",
                   model_description(is_2, unit, name, token, tool));
  try_unit(console, binaries / "photorque.so", token, resources, 1.0 / unit.rate_Hz);
  const fs::path packed = staging.path / "unit.fmu";
  write_archive(packed, files_below(staging.path));
  const std::string archive = read_file(packed);
  result.files.push_back({name + ".fmu",
                          [archive](const fs::path& path) { write_file_whole(path, archive); },
                          is_2 ? "for importers of FMI 2.0" : "for importers of FMI 3.0"});
  result.product.quantities.push_back({"ticks_Hz", {unit.rate_Hz, 0.0}});
  result.product.quantities.push_back({"start_s", {unit.start_s, 0.0}});
  result.product.quantities.push_back({"stop_s", {unit.stop_s, 0.0}});
  result.cost = {wall.elapsed_s(), {}};
  return result;
}

}  // namespace

Verb kind() {
  return {
      "fmu",
      "Export of the platform as a co-simulation unit (FMI 3.0 or 2.0) for other programs",
      command_that_writes(add_options, pack_unit),
      {"platform", "environment", "disturbance", "sensors", "propagate", "serve", "light", "array"},
      "[platform]"};
}

}  // namespace photorque::verbs::fmu
