// Bytes as text that may stand in JSON, URIs and HTML.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace photorque {

// Source: RFC 4648, section 4, with padding.
std::string base64(std::span<const std::byte> bytes);

}  // namespace photorque
