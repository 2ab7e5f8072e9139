#include "tools/coupling/checkpoint_file.h"

#include <fstream>

#include "core/errors.h"
#include "core/files.h"
#include "core/provenance.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

constexpr const char* checkpoint_format = "photorque checkpoint 1";
constexpr uint64_t largest_checkpoint_bytes = 1ull << 36;

// The text up to the next end of a line, which `text` then begins behind.
std::string next_line(const std::string& text, size_t& at) {
  const size_t end = text.find('\n', at);
  if (end == std::string::npos) return {};
  std::string line = text.substr(at, end - at);
  at = end + 1;
  return line;
}

std::string hash_of_run(const std::string& identity, const std::string& tilt) {
  return content_hash(identity + tilt);
}

}  // namespace

CheckpointFile::CheckpointFile(std::filesystem::path path, double every_s)
    : path_(std::move(path)),
      every_(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
          std::chrono::duration<double>(every_s))) {
  wait();
}

void CheckpointFile::wait() {
  next_ = std::chrono::steady_clock::now() + every_;
}

std::optional<CheckpointFile::Kept> CheckpointFile::read(const std::string& identity) {
  std::error_code none;
  if (!std::filesystem::exists(path_, none)) return {};
  std::string all = read_file(path_, largest_checkpoint_bytes);
  const auto refuse = [&](const char* found) {
    throw InputError({path_.string()}, "", found,
                     "a checkpoint of this run (another --out, or none there, begins anew)");
  };
  size_t at = 0;
  if (next_line(all, at) != checkpoint_format) refuse("another file");
  const std::string tilt = next_line(all, at);
  const std::optional<double> tilt_rad = number_in(tilt);
  if (next_line(all, at) != hash_of_run(identity, tilt)) {
    refuse("a checkpoint of another program, experiment, seed or input file");
  }
  const std::string hash = next_line(all, at);
  all.erase(0, at);
  if (!tilt_rad || content_hash(all) != hash) refuse("a damaged checkpoint");
  return Kept{*tilt_rad, std::move(all)};
}

void CheckpointFile::write(const std::string& identity, double table_tilt_rad,
                           const std::string& state) {
  const std::string tilt = shortest(table_tilt_rad);
  const std::string head = std::string(checkpoint_format) + "\n" + tilt + "\n" +
                           hash_of_run(identity, tilt) + "\n" + content_hash(state) + "\n";
  // Not at once again if this fails.
  wait();
  write_file_whole(path_, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    for (const std::string* part : {&head, &state}) {
      out.write(part->data(), static_cast<std::streamsize>(part->size()));
    }
    out.close();
    if (!out) throw InputError({path_.string()}, "", "a write that failed", "space and permission");
  });
  wait();
}

}  // namespace photorque
