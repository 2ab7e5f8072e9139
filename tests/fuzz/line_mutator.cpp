// Changes of texts that are made of lines `key = value` and headers: whole values, keys and lines
// are put in place of others, so that most of the result is still understood and what is wrong is
// found behind the parser.
#include <array>
#include <vector>

#include "tests/fuzz/random_bytes.h"

namespace {

using photorque::fuzz::Chance;

constexpr std::array<const char*, 36> values = {"0",
                                                "1",
                                                "-1",
                                                "2",
                                                "1e-320",
                                                "1e308",
                                                "-1e308",
                                                "nan",
                                                "inf",
                                                "9223372036854775807",
                                                "4096",
                                                "0.5",
                                                "1e9",
                                                "1e-9",
                                                "true",
                                                "false",
                                                "\"\"",
                                                "\"body\"",
                                                "\"cell\"",
                                                "\"/\"",
                                                "\"model.gltf\"",
                                                "\"lamp.ies\"",
                                                "\"lamp.ldt\"",
                                                "\"lamp.ray\"",
                                                "[]",
                                                "[0]",
                                                "[1, 2]",
                                                "[0, 0, 1]",
                                                "[0, 0, 0]",
                                                "[1e30, 0, 0]",
                                                "[nan, 0, 0]",
                                                "[[]]",
                                                "{}",
                                                "1979-05-27",
                                                "[0, 30, 60, 90]",
                                                "\"front\""};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

// The part behind the sign "=", or nothing.
std::string value_of(const std::string& line) {
  const size_t sign = line.find('=');
  return sign == std::string::npos ? "" : line.substr(sign + 1);
}

void set_value(std::string& line, const std::string& value) {
  const size_t sign = line.find('=');
  if (sign != std::string::npos) line = line.substr(0, sign + 1) + " " + value;
}

void change(std::vector<std::string>& lines, Chance& chance) {
  if (lines.empty()) lines.emplace_back("x = 1");
  const size_t at = chance.below(lines.size());
  std::string& line = lines[at];
  const auto place = lines.begin() + static_cast<std::ptrdiff_t>(at);
  switch (chance.below(8)) {
    case 0:
      set_value(line, chance.one_of(values));
      break;
    case 1:
      set_value(line, value_of(std::string(chance.one_of(lines))));
      break;
    case 2:
      set_value(line, photorque::fuzz::with_bytes_changed(value_of(line)));
      break;
    case 3:
      lines.erase(place);
      break;
    case 4:
      lines.insert(place, std::string(chance.one_of(lines)));
      break;
    case 5:
      std::swap(line, lines[chance.below(lines.size())]);
      break;
    case 6: {  // the key of another line with another value
      const std::string key = std::string(chance.one_of(lines));
      lines.insert(place, key.substr(0, key.find('=')) + "= " + chance.one_of(values));
      break;
    }
    default:
      line = photorque::fuzz::with_bytes_changed(line);
  }
}

}  // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned seed) {
  Chance chance(seed);
  if (chance.below(6) == 0) return LLVMFuzzerMutate(data, size, max_size);
  std::vector<std::string> lines = lines_of(std::string(reinterpret_cast<const char*>(data), size));
  for (size_t left = 1 + chance.below(3); left > 0; --left) change(lines, chance);
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return photorque::fuzz::put(text, data, max_size);
}
