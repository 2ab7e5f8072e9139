// Arrays of numbers inside of JSON: a fifth of the length of decimals, and read at once.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

namespace photorque {

// {"f32": "…"}, {"f64": "…"}, {"u32": "…"}: little-endian numbers in base64. NaN stays NaN.
nlohmann::ordered_json packed(std::span<const float> numbers);
nlohmann::ordered_json packed(std::span<const double> numbers);
nlohmann::ordered_json packed(std::span<const uint32_t> numbers);
// As {"f32": …}, rounded.
nlohmann::ordered_json packed_rounded(std::span<const double> numbers);
// {"u16": "…", "low", "step"}: value = low + step · n for n < 65535, which stands for NaN; within
// half a step, 1/131068 of the range.
nlohmann::ordered_json packed_coarse(std::span<const double> numbers, double low, double high);

// `json` as text that may stand between <script> and </script>: no character of it can end the
// element or begin a comment.
std::string script_text(const nlohmann::ordered_json& json);

}  // namespace photorque
