// ZIP archives.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace photorque {

// A ZIP archive of files (name with '/', bytes) in this order, deflated, without dates: equal files
// give equal bytes. Source: PKWARE's APPNOTE 6.3.10, sections 4.3.7, 4.3.12 and 4.3.16.
// InputError for more than 65535 files or 4 GiB.
std::string zip_archive(const std::vector<std::pair<std::string, std::string>>& files);

}  // namespace photorque
