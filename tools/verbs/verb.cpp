#include "tools/verbs/verb.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <sstream>

#include "core/errors.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "tools/coupling/couple.h"
#include "tools/pages/pages.h"

namespace photorque {
namespace {

// Limits the rate of an action: due() is true at most once per interval, or with `always`.
class Pace {
 public:
  explicit Pace(std::chrono::milliseconds least) : least_(least) {}
  bool due(bool always = false) {
    const std::scoped_lock lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < least_ && !always) return false;
    last_ = now;
    return true;
  }

 private:
  std::mutex mutex_;
  std::chrono::milliseconds least_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void draw_bar(const std::string& what, double fraction) {
  constexpr int width = 30;
  const int filled = static_cast<int>(std::lround(width * fraction));
  std::string bar;
  for (int i = 0; i < width; ++i) bar += i < filled ? "█" : "·";
  std::fprintf(stderr, "\r%s %s %3.0f %%\033[K", clean_text(what).c_str(), bar.c_str(),
               100.0 * fraction);
  std::fflush(stderr);
}

// Check of a positive number, at most `most`, of `unit`.
std::function<std::string(const std::string&)> above_zero(
    const char* unit, double most = std::numeric_limits<double>::infinity()) {
  return [unit, most](const std::string& text) {
    const std::optional<double> number = number_in(text);
    const bool good = number && *number > 0.0 && *number <= most;
    return good ? "" : "found " + text + ", expected a number of " + unit + " > 0";
  };
}

std::string unknown_format(const std::string& list) {
  try {
    formats_in(list);
    return "";
  } catch (const InputError& error) {
    const std::string text = error.what();
    return text.substr(text.find("found "));  // after the key, which the parser adds
  }
}

constexpr std::array<std::pair<const char*, PictureStyle>, 3> styles = {
    {{"page", PictureStyle::page}, {"paper", PictureStyle::paper}, {"slide", PictureStyle::slide}}};

std::string unknown_style(const std::string& name) {
  for (const auto& style : styles) {
    if (name == style.first) return "";
  }
  return "found " + name + ", expected page, paper or slide";
}

// Whether the results of a command are files and its text is only a summary. The text of other
// commands is the result.
bool is_brief(const std::string& verb) {
  constexpr std::array brief = {"trace",    "power",  "torque-map", "budget", "propagate", "sweep",
                                "optimise", "camera", "estimate",   "supply", "balance"};
  return std::ranges::find(brief, verb) != brief.end();
}

// Prints the first lines of a text. Of later sections, prints the heading and the first lines; of
// all, warnings.
class ShortText {
 public:
  explicit ShortText(std::function<void(const std::string&)> print) : print_(std::move(print)) {}
  ShortText(const ShortText&) = delete;
  ShortText& operator=(const ShortText&) = delete;
  ~ShortText() {
    if (left_out_ == 0) return;
    print_("… " + std::to_string(left_out_) + (left_out_ == 1 ? " line" : " lines") +
           " more with --verbose");
  }
  void take(const std::string& text) {
    std::istringstream lines(text + "\n");
    for (std::string line; std::getline(lines, line);) take_line(line);
  }

 private:
  void take_line(const std::string& line) {
    constexpr int whole = 23, of_section = 6;  // the latter with the empty line and the heading
    in_section_ = line.empty() ? 1 : in_section_ + 1;
    const size_t begin = std::min(line.find_first_not_of(' '), line.size());
    const bool warns =
        line.compare(begin, 7, "WARNING") == 0 || line.compare(begin, 7, "warning") == 0;
    if (printed_ >= whole && in_section_ > of_section && !warns) {
      ++left_out_;
      return;
    }
    ++printed_;
    print_(line);
  }

  std::function<void(const std::string&)> print_;
  int printed_ = 0, in_section_ = 0, left_out_ = 0;
};

}  // namespace

std::filesystem::path CommandOptions::out_folder() const {
  if (out) return *out;
  return std::filesystem::path("out") / (name.empty() ? experiment.stem().string() : name) / verb;
}

void Command::add_common(CommandOptions& common) {
  add("--threads", common.threads, "Threads to use (default: all)").range =
      Option::Between<int>(0, 1024);
  add("--seed", common.seed, "Seed of all random numbers, instead of the seed in the experiment")
      .range = Option::Between<int64_t>(0, std::numeric_limits<int64_t>::max());
  Option& memory = add("--max-memory", common.max_memory_GB,
                       "Maximum memory in GB (default: nine tenths of the free memory)");
  memory.range = Option::Between<double>(0.5, 1e6);
  memory.mistake = [](const std::string& text) {
    return number_in(text) ? "" : text + " is no finite number";
  };
  add("--quiet", common.quiet, "Print only errors");
  add("--json", common.json, "Print the summary as JSON instead of text");
  add("--verbose", common.verbose, "Also print checks, reasons and long tables");
}

void Command::add_results(CommandOptions& common) {
  add("-o,--out", common.out, "Folder for the results (default: out/EXPERIMENT/VERB)");
  add("--format", common.format,
      "Additional formats, separated by commas: exr, tiff, csv, vtkhdf (maps); svg, pdf "
      "(pictures); "
      "png (of diagnose)")
      .mistake = unknown_format;
  add("--style", common.style,
      "Style of the pictures: page (default), paper (no title, large letters), slide (larger "
      "letters)")
      .mistake = unknown_style;
}

void Command::add_experiment(CommandOptions& common, Folder writes, bool required) {
  add("experiment", common.experiment, "Experiment file (TOML)").is_required = required;
  add("--set", common.overrides, "Change a key of the experiment: KEY=VALUE").is_one_each = true;
  folder = writes;
  if (writes != Folder::none) add_results(common);
  add_common(common);
}

void Command::add_traced_experiment(CommandOptions& common, Folder writes) {
  add_experiment(common, writes);
  add("--target-error", common.target_error,
      "Add rays until every bin above a tenth of the peak has this relative "
      "standard error (0.01: 1 %)")
      .range = Option::Between<double>(1e-6, 1.0);
  add("--max-time", common.max_time_s,
      "Maximum time of each trace in seconds; requires --target-error")
      .mistake = above_zero("seconds");
  add("--allow-outside", common.allow_outside,
      "Follow links and paths of the model that lead out of its folder");
}

void Command::add_recordings(std::vector<std::filesystem::path>& recordings) {
  add("--recording", recordings, "A recording (CSV); may be repeated").is_one_each = true;
}

void Command::add_page(CommandOptions& common) {
  add("--page", common.page,
      "Also write page.html, an interactive page with scene, maps and curves");
}

void Command::add_checkpoint(CommandOptions& common) {
  add("--checkpoint", common.checkpoint_min,
      "Interval in minutes at which the state is saved (VERB.checkpoint in the output folder); "
      "after "
      "an interruption, the same command resumes")
      .mistake = above_zero("minutes", 1e6);
}

void experiment_options(Command& command, CommandOptions& options) {
  command.add_experiment(options);
}

void traced_options(Command& command, CommandOptions& options) {
  command.add_traced_experiment(options);
}

void traced_page_options(Command& command, CommandOptions& options) {
  command.add_traced_experiment(options);
  command.add_page(options);
}

// Removes control characters except line ends and tabs: names may come from hostile files.
static std::string clean_lines(const std::string& text) {
  std::string clean;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find_first_of("\n\t", begin), text.size());
    clean += clean_text(std::string_view(text).substr(begin, end - begin));
    if (end < text.size()) clean += text[end];
    begin = end + 1;
  }
  return clean;
}

Console terminal(const CommandOptions& options) {
  if (options.quiet || options.json) return Console();
  ConsoleSinks sinks;
  // Flushed immediately, also to a pipe: a program may wait for the line with the address of a run.
  const auto print = [](const std::string& text) {
    std::printf("%s\n", clean_lines(text).c_str());
    std::fflush(stdout);
  };
  sinks.has_details = options.verbose;
  sinks.line = print;
  if (!options.verbose && is_brief(options.verb)) {
    const auto few = std::make_shared<ShortText>(print);
    sinks.line = [few](const std::string& text) { few->take(text); };
  }
  if (::isatty(STDERR_FILENO) != 0) {
    const auto pace = std::make_shared<Pace>(std::chrono::milliseconds(100));
    sinks.progress = [pace](const std::string& what, double fraction) {
      if (pace->due(fraction >= 1.0)) draw_bar(what, fraction);
    };
    sinks.done = [] { std::fprintf(stderr, "\r\033[K"); };
  } else {
    const auto pace = std::make_shared<Pace>(std::chrono::seconds(10));
    sinks.note = [pace](const std::string& text) {
      if (pace->due()) std::fprintf(stderr, "%s\n", clean_lines(text).c_str());
    };
  }
  return Console(std::move(sinks));
}

RunFormats formats_of(const CommandOptions& options) {
  RunFormats formats{formats_in(options.format)};
  for (const auto& [name, style] : styles) {
    if (options.style == name) formats.style = style;
  }
  return formats;
}

void write_results(const CommandOptions& options, const Console& console, const RunResult& result) {
  const auto folder = options.out_folder();
  const auto paths = write_run(result, folder, options.verb, formats_of(options));
  if (options.json) std::fputs(result.summary().c_str(), stdout);
  console.heading("Written to " + folder.string());
  const auto count = [&](const char* extension) {
    return std::ranges::count_if(paths, [&](const auto& p) { return p.extension() == extension; });
  };
  const auto pictures = count(".png"), tables = count(".csv");
  const auto others = static_cast<std::ptrdiff_t>(paths.size()) - pictures - tables;
  const auto counted = [](std::ptrdiff_t number, const std::string& what, const char* kind = "") {
    if (number == 0) return std::string();
    return ", " + std::to_string(number) + " " + what + (number == 1 ? "" : "s") + kind;
  };
  console.line("  summary.json" + counted(pictures, "picture", " (PNG)") +
               counted(tables, "table", " (CSV)") + counted(others, "other file"));
  for (const auto& path : paths) {
    if (path.extension() == ".png") console.details().line("  " + path.filename().string());
  }
  std::string names;
  for (const RunFile& file : result.files) {
    if (file.remark.empty()) names += (names.empty() ? "" : ", ") + file.name;
  }
  if (!names.empty()) console.line("  " + names);
  for (const RunFile& file : result.files) {
    if (!file.remark.empty()) console.line("  " + file.name + ": " + file.remark);
  }
}

std::unique_ptr<CheckpointFile> checkpoint_of(const CommandOptions& options) {
  if (!options.checkpoint_min) return nullptr;
  return std::make_unique<CheckpointFile>(options.out_folder() / (options.verb + ".checkpoint"),
                                          60.0 * *options.checkpoint_min);
}

PageHead page_head(const CommandOptions& options,
                   const std::vector<std::filesystem::path>& recordings,
                   const std::vector<std::filesystem::path>& holdouts) {
  std::string command =
      "photorque " + options.verb + " " + shell_word(options.experiment.filename().string());
  const auto add = [&command](const char* option, const std::string& word) {
    command += std::string(" ") + option + " " + shell_word(word);
  };
  for (const std::string& change : options.overrides) add("--set", change);
  for (const auto& path : recordings) add("--recording", path.filename().string());
  for (const auto& path : holdouts) add("--holdout", path.filename().string());
  if (options.seed) command += " --seed " + std::to_string(*options.seed);
  if (options.target_error) command += " --target-error " + show(*options.target_error);
  if (options.max_time_s) command += " --max-time " + show(*options.max_time_s);
  if (options.allow_outside) command += " --allow-outside";
  return {options.experiment.stem().string(), options.verb, command + " --page"};
}

}  // namespace photorque
