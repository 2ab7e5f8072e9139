#include "tools/fmi/archive.h"

#include <cstdint>

#include "attitude/recordings/text_lines.h"
#include "core/errors.h"

namespace photorque {
namespace {

void put16(std::string& to, uint32_t value) {
  to += static_cast<char>(value & 0xff);
  to += static_cast<char>((value >> 8) & 0xff);
}

void put32(std::string& to, uint64_t value) {
  put16(to, static_cast<uint32_t>(value & 0xffff));
  put16(to, static_cast<uint32_t>((value >> 16) & 0xffff));
}

constexpr uint32_t version = 20, deflated = 8, first_day = 0x21;  // 1 January 1980

// What the local header and the directory have in common: version to size of the name.
std::string common(const std::string& checksum, size_t packed, size_t size, size_t name) {
  std::string head;
  put16(head, version);
  put16(head, 1u << 11);  // names are UTF-8
  put16(head, deflated);
  put16(head, 0);
  put16(head, first_day);
  head += checksum;
  put32(head, packed);
  put32(head, size);
  put16(head, static_cast<uint32_t>(name));
  put16(head, 0);
  return head;
}

}  // namespace

std::string zip_archive(const std::vector<std::pair<std::string, std::string>>& files) {
  constexpr size_t most_files = 0xffff, gzip_head = 10, gzip_tail = 8;
  constexpr uint64_t largest = 0xffffffff;
  std::string archive, directory;
  for (const auto& [name, bytes] : files) {
    // The gzip format is the same stream between a head and the checksum.
    const std::string packed = gzip(bytes);
    const std::string checksum = packed.substr(packed.size() - gzip_tail, 4);
    const size_t size = packed.size() - gzip_head - gzip_tail;
    const std::string head = common(checksum, size, bytes.size(), name.size());
    put32(directory, 0x02014b50);
    put16(directory, version | (3u << 8));  // made on Unix
    directory += head;
    put16(directory, 0);
    put16(directory, 0);
    put16(directory, 0);
    put32(directory, 0100644ull << 16);
    put32(directory, archive.size());
    directory += name;
    put32(archive, 0x04034b50);
    archive += head + name;
    archive.append(packed, gzip_head, size);
    if (bytes.size() > largest || archive.size() > largest || files.size() > most_files) {
      throw InputError({name}, "", "files beyond 4 GiB or 65535", "less for one archive");
    }
  }
  const size_t begin = archive.size();
  archive += directory;
  put32(archive, 0x06054b50);
  put32(archive, 0);
  put16(archive, static_cast<uint32_t>(files.size()));
  put16(archive, static_cast<uint32_t>(files.size()));
  put32(archive, directory.size());
  put32(archive, begin);
  put16(archive, 0);
  return archive;
}

}  // namespace photorque
