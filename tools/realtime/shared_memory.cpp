// Packets in POSIX shared memory: a measurement and a command, each with a lock that counts.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <memory>

#include "core/errors.h"
#include "tools/realtime/clock.h"
#include "tools/realtime/transport.h"

namespace photorque {
namespace {

// The memory, unmapped and unlinked with its last owner. The file is locked as long as it is
// served.
struct SharedBlock {
  std::string name;
  int file = -1;
  photorque_shared_memory* memory = nullptr;
  uint64_t seen = 0;  // the command lock when a packet was taken last

  SharedBlock() = default;
  SharedBlock(const SharedBlock&) = delete;
  SharedBlock& operator=(const SharedBlock&) = delete;
  ~SharedBlock() {
    if (memory != nullptr) ::munmap(memory, sizeof *memory);
    if (!name.empty()) ::shm_unlink(name.c_str());
    if (file >= 0) ::close(file);
  }
};

// Removes what a run that was killed left under the name. Throws InputError where the name is that
// of a run that goes on, or of something that no run made.
void remove_left_over(const std::string& path, const std::string& key) {
  const int file = ::shm_open(path.c_str(), O_RDWR | O_CLOEXEC, 0);
  if (file < 0 && errno == ENOENT) return;
  photorque_shared_memory kept{};
  struct stat about {};
  const bool is_ours = file >= 0 && ::fstat(file, &about) == 0 &&
                       about.st_size == static_cast<off_t>(sizeof kept) &&
                       ::pread(file, &kept, sizeof kept, 0) == static_cast<ssize_t>(sizeof kept) &&
                       (kept.magic == PHOTORQUE_MAGIC || kept.magic == 0);
  const bool is_served = is_ours && ::flock(file, LOCK_EX | LOCK_NB) != 0;
  if (is_ours && !is_served) ::shm_unlink(path.c_str());
  if (file >= 0) ::close(file);
  const std::string where = "/dev/shm" + path;
  if (!is_ours) throw InputError({}, key, where + ", which no run of serve made", "another name");
  if (is_served) throw InputError({}, key, where + ", which another run serves", "another name");
}

void put_measurement(photorque_shared_memory& memory, const photorque_measurement_packet& packet) {
  const std::atomic_ref<uint64_t> lock(memory.measurement_lock);
  const uint64_t before = lock.load(std::memory_order_relaxed);
  lock.store(before + 1, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  std::memcpy(&memory.measurement, &packet, sizeof packet);
  lock.store(before + 2, std::memory_order_release);
}

// A packet that is whole and was not taken yet.
std::optional<ReceivedBytes> take_command(SharedBlock& block) {
  const std::atomic_ref<uint64_t> lock(block.memory->command_lock);
  const uint64_t before = lock.load(std::memory_order_acquire);
  if (before == block.seen || before % 2 != 0) return {};
  photorque_command_packet packet;
  std::memcpy(&packet, &block.memory->command, sizeof packet);
  std::atomic_thread_fence(std::memory_order_acquire);
  if (lock.load(std::memory_order_relaxed) != before) return {};
  block.seen = before;
  ReceivedBytes got;
  // What the packet calls its size; the gate looks whether it is that of its kind.
  got.size = packet.header.size;
  std::memcpy(got.bytes.data(), &packet, sizeof packet);
  return got;
}

std::optional<ReceivedBytes> take_until(SharedBlock& block, int64_t until_ns, int64_t spin_ns) {
  constexpr int64_t nap_ns = 20'000;
  for (;;) {
    if (std::optional<ReceivedBytes> got = take_command(block)) return got;
    const int64_t left_ns = until_ns - monotonic_ns();
    if (left_ns <= 0) return {};
    if (left_ns <= spin_ns) continue;
    const timespec nap{0, std::min(nap_ns, left_ns - spin_ns)};
    ::nanosleep(&nap, nullptr);
  }
}

}  // namespace

Transport shared_memory_transport(const std::string& name, int64_t spin_ns) {
  const auto block = std::make_shared<SharedBlock>();
  const std::string path = "/" + name;
  const std::string key = "serve.shared_memory";
  const auto fail = [&] {
    return InputError({}, key, "\"" + name + "\", " + std::strerror(errno),
                      "a name for which /dev/shm has room");
  };
  remove_left_over(path, key);
  const int file = ::shm_open(path.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) throw fail();
  block->name = path;
  block->file = file;
  ::flock(file, LOCK_EX | LOCK_NB);
  constexpr size_t size = sizeof(photorque_shared_memory);
  const bool has_room = ::ftruncate(file, size) == 0;
  void* memory =
      has_room ? ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0) : MAP_FAILED;
  if (memory == MAP_FAILED) throw fail();
  block->memory = static_cast<photorque_shared_memory*>(memory);
  block->memory->version = PHOTORQUE_VERSION;
  std::atomic_ref<uint32_t>(block->memory->magic).store(PHOTORQUE_MAGIC, std::memory_order_release);
  Transport transport;
  transport.where = "/dev/shm" + path;
  transport.send = [block](const photorque_measurement_packet& packet, uint64_t) {
    put_measurement(*block->memory, packet);
  };
  transport.receive = [block, spin_ns](int64_t until_ns) {
    return take_until(*block, until_ns, spin_ns);
  };
  return transport;
}

}  // namespace photorque
