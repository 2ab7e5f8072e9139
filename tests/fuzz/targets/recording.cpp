// Fuzz target: any bytes as a recording of motion, plain or compressed, and as a file of commands;
// some are written and read again.
#include "attitude/recordings/recording.h"

#include <cmath>
#include <memory>

#include "scenes/experiment/toml.h"
#include "tests/fuzz/target.h"

namespace {

using namespace photorque;

void check(const Recording& recording) {
  for (const double time_s : recording.time_s) {
    if (!std::isfinite(time_s)) std::abort();
  }
  for (const Channel& channel : recording.channels) {
    if (channel.values.size() != recording.rows()) std::abort();
    for (const double value : channel.values) {
      if (std::isinf(value)) std::abort();
    }
  }
  if (recording.report.text().empty()) std::abort();
}

// One in 64, because written files are synced to the disk.
bool is_chosen(const uint8_t* data, size_t size) {
  uint32_t sum = 0;
  for (size_t i = 0; i < size; ++i) sum = 31 * sum + data[i];
  return sum % 64 == 0;
}

void write_and_read(const Recording& recording) {
  const std::filesystem::path path = fuzz::folder_in_memory() / "again.csv.gz";
  write_recording(path, recording, {"written"});
  if (read_recording(path).rows() != recording.rows()) std::abort();
}

RecordingOptions columns_of_another_program() {
  return read_recording_options(
      Settings(parse_toml("angle_sequence = \"zyx\"\nremove_outliers = false\n"
                          "columns = {gyro_x_deg_s = \"wx\", q_w = \"qw\", t_ms = \"time\"}",
                          "fuzz.toml")));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] {
    const Recording recording = read_recording(file.path(), {.max_cells = 1 << 20});
    check(recording);
    if (is_chosen(data, size)) fuzz::may_refuse([&] { write_and_read(recording); });
  });
  fuzz::may_refuse([&] { read_command_file(file.path()); });
  static const RecordingOptions renamed = columns_of_another_program();
  fuzz::may_refuse([&] { check(read_recording(file.path(), renamed)); });
  return 0;
}
