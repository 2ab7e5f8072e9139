// Escapes of URIs.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace photorque {

// "a%20b" is "a b" (RFC 3986 section 2.1). A plus sign stays one: that it means a space holds in
// web forms, not in URIs. Nothing when an escape is malformed.
std::optional<std::string> percent_decoded(std::string_view text);

}  // namespace photorque
