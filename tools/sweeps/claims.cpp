#include "tools/sweeps/claims.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/errors.h"
#include "core/provenance.h"

namespace photorque {
namespace {

int64_t byte_of(const std::string& name) {
  constexpr size_t digits = 15;  // of 60 bits, because offsets are signed
  return static_cast<int64_t>(std::stoull(content_hash(name).substr(0, digits), nullptr, 16));
}

// These locks belong to the open file, not to the process, so that they also work between two users
// in one process.
bool lock_byte(int descriptor, int64_t byte, short how, bool wait) {
  struct flock range {};
  range.l_type = how;
  range.l_whence = SEEK_SET;
  range.l_start = byte;
  range.l_len = 1;
  int result = 0;
  do {
    result = ::fcntl(descriptor, wait ? F_OFD_SETLKW : F_OFD_SETLK, &range);
  } while (result != 0 && errno == EINTR);
  return result == 0 || (errno != EAGAIN && errno != EACCES);
}

}  // namespace

Claims::Claims(const std::filesystem::path& path)
    : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) {
    throw InputError({path.string()}, "", std::strerror(errno), "a file that can be written");
  }
}

Claims::~Claims() {
  ::close(descriptor_);
}

Claims::Claim Claims::held(int64_t byte) const {
  return {this,
          [byte](const Claims* claims) { lock_byte(claims->descriptor_, byte, F_UNLCK, false); }};
}

Claims::Claim Claims::take(const std::string& name) const {
  const int64_t byte = byte_of(name);
  return lock_byte(descriptor_, byte, F_WRLCK, false) ? held(byte) : nullptr;
}

Claims::Claim Claims::wait_for(const std::string& name) const {
  const int64_t byte = byte_of(name);
  lock_byte(descriptor_, byte, F_WRLCK, true);
  return held(byte);
}

}  // namespace photorque
