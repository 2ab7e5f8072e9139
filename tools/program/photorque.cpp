// The program: parses the command line, runs one verb, converts exceptions to exit statuses.
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include "core/errors.h"
#include "core/text/format.h"
#include "images/writers/loading.h"
#include "images/writers/staged_files.h"
#include "tools/program/command_line.h"
#include "tools/runs/memory.h"
#include "tools/runs/output_folder.h"

namespace photorque {
namespace {

constexpr const char* no_thread =
    "numerical failure: not enough memory for another thread (ulimit -v, -u)\n";

// Prints one line on standard error. It is cleaned, because names in it may come from hostile files
// and command lines.
void print_error(const std::string& line) {
  std::fprintf(stderr, "%s\n", clean_text(line).c_str());
}

// Runs a command in its output folder. Signals do not leave incomplete files in it.
void run_in_folder(const Command& command, const Program& program) {
  const CommandOptions& options = *command.options;
  const std::filesystem::path out = options.out_folder();
  const auto others = command.folder == Command::Folder::shared ? OutputFolder::Others::share
                                                                : OutputFolder::Others::refuse;
  // A reader of the text that exits early (such as `head`) must not change the results.
  std::signal(SIGPIPE, SIG_IGN);
  const Interruption::Watch watch(*program.interruption, out);
  const OutputFolder folder(out, others);
  const std::string input = options.experiment.filename().string();
  std::error_code none;
  if (std::filesystem::equivalent(options.experiment, out / input, none) &&
      is_result_of(out, options.verb, input)) {
    throw InputError({}, "--out", out.string() + ", whose " + input + " the run would replace",
                     "another folder than that of the input");
  }
  command.run(program);
}

// Runs a command. An error without a file is reported as an error of the experiment.
int run_command(const Command& command, const Program& program) {
  const std::filesystem::path& experiment = command.options->experiment;
  try {
    if (command.folder == Command::Folder::none) {
      command.run(program);
    } else {
      require_pictures();
      run_in_folder(command, program);
    }
    return 0;
  } catch (const InputError& error) {
    const std::string what = error.what();
    if (error.names_file() || experiment.empty() || what.starts_with("--")) throw;
    print_error(experiment.string() + ": " + what);
    return 2;
  }
}

void require_stack() {
  constexpr rlim_t least = rlim_t{256} << 10;
  rlimit stack{};
  if (::getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur < least) {
    throw InputError({"photorque"}, "", "a stack of less than 256 kB",
                     "a larger one (ulimit -s 8192)");
  }
}

int run(int argc, char** argv, Interruption& interruption) {
  require_stack();
  const std::vector<Verb> verbs = all_verbs();
  const CommandLine line = read_command_line(argc, argv, verbs);
  if (line.status) return *line.status;
  const CommandOptions& options = *line.command.options;
  std::error_code failure;
  if (std::filesystem::current_path(failure).empty()) {
    throw InputError({"photorque"}, "", "a working directory that was removed",
                     "an existing one (cd)");
  }
  if (options.out && options.out->empty()) throw InputError({"--out"}, "", "nothing", "a folder");
  set_memory_limit(options.max_memory_GB);
  return run_command(line.command, {verbs, &interruption});
}

// Signal handler for faults in a library or in this program: prints one line and exits with a
// documented status. Calls only functions that are allowed in a handler.
[[noreturn]] void end_after_fault(int) {
  // Libraries that do not check their allocations crash without memory; the message depends on it.
  constexpr size_t some = size_t{256} << 20;
  const bool has_memory = ::mmap(nullptr, some, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS,
                                 -1, 0) != MAP_FAILED;
  const std::string_view line =
      has_memory ? "numerical failure: a fault of the program ended this run; please report its "
                   "command and files\n"
                 : "numerical failure: not enough memory\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
  ::_exit(3);
}

// Ends the program if memory is exhausted in a thread or a destructor, from which no exception
// reaches main().
[[noreturn]] void end_without_memory() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    std::fputs("numerical failure: not enough memory\n", stderr);
    std::_Exit(3);
  } catch (const std::system_error&) {
    std::fputs(no_thread, stderr);
    std::_Exit(3);
  } catch (...) {
    end_after_fault(SIGABRT);
  }
  end_after_fault(SIGABRT);
}

// Installs handlers for faults, except for signals that have one already (as with sanitizers). They
// run on a separate stack, because the ordinary one may be exhausted.
void catch_faults() {
  alignas(16) static std::array<std::byte, 1 << 16> room;
  const stack_t stack{room.data(), 0, room.size()};
  ::sigaltstack(&stack, nullptr);
  for (const int fault : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) {
    struct sigaction had {
    }, wanted{};
    wanted.sa_handler = end_after_fault;
    wanted.sa_flags = SA_ONSTACK | static_cast<int>(SA_RESETHAND);
    if (::sigaction(fault, nullptr, &had) == 0 && had.sa_handler == SIG_DFL) {
      ::sigaction(fault, &wanted, nullptr);
    }
  }
}

}  // namespace
}  // namespace photorque

int main(int argc, char** argv) {
  photorque::catch_faults();
  std::set_terminate(photorque::end_without_memory);
  // Exceeding the limit of the file size becomes a write error instead of a signal.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    photorque::Interruption interruption;
    const int status = photorque::run(argc, argv, interruption);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      std::fputs(
          "standard output: found a write that failed, expected space, permission and a reader\n",
          stderr);
      return status == 0 ? 2 : status;
    }
    return status;
  } catch (const photorque::InputError& error) {
    photorque::print_error(error.what());
    return 2;
  } catch (const photorque::NumericalError& error) {
    photorque::print_error(std::string("numerical failure: ") + error.what());
    return 3;
  } catch (const std::filesystem::filesystem_error& error) {
    photorque::print_error(error.path1().string() + ": found \"" + error.code().message() +
                           "\", expected a file or folder that exists and is accessible");
    return 2;
  } catch (const std::bad_alloc&) {
    // Not a normal exit: threads of libraries that are short of memory may never be ready to be
    // joined.
    std::fputs("numerical failure: not enough memory\n", stderr);
    std::_Exit(3);
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::resource_unavailable_try_again) {
      photorque::print_error(std::string("numerical failure: ") + error.what());
      return 3;
    }
    std::fputs(photorque::no_thread, stderr);
    std::_Exit(3);
  } catch (const std::exception& error) {
    photorque::print_error(std::string("numerical failure: ") + error.what());
    return 3;
  }
}
