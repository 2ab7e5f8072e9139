// The short form of fuzzing, for compilers without libFuzzer and for every check: a fuzz target is
// fed the files named on the command line (folders: all files in them) and mutations of each, the
// same ones on every machine. Built with sanitizers, it stops at the first fault.
//
//   fuzz_READER [--mutations N] FILE_OR_FOLDER ...
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
// Defined by targets with mutations of structures.
extern "C" __attribute__((weak)) size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size,
                                                                size_t max_size, unsigned seed);

namespace {

namespace fs = std::filesystem;

// Where readers stumble: signs, extremes, words for numbers, ends of lines.
constexpr std::array<const char*, 14> tokens = {"-1",         "0",
                                                "1e308",      "-1e-320",
                                                "nan",        "inf",
                                                "4294967295", "18446744073709551616",
                                                "\n",         ",",
                                                "\"",         "{",
                                                "[",          "\xff\xff\xff\x7f"};

class Mutator {
 public:
  explicit Mutator(uint64_t seed) : random_(seed) {}

  std::string changed(std::string bytes) {
    for (size_t left = 1 + below(6); left > 0; --left) change(bytes);
    return bytes;
  }

 private:
  size_t below(size_t n) { return n == 0 ? 0 : static_cast<size_t>(random_() % n); }

  void change(std::string& bytes) {
    const size_t at = below(bytes.size() + 1);
    const size_t length = below(std::min<size_t>(bytes.size() - at, 64) + 1);
    switch (below(6)) {
      case 0:  // one bit
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(below(bytes.size() + 1), bytes.substr(at, length));
        break;
      case 3:
        bytes.insert(at, tokens[below(tokens.size())]);
        break;
      case 4:
        bytes.resize(at);
        break;
      default:  // a number becomes another
        replace_number(bytes, at);
    }
  }

  void replace_number(std::string& bytes, size_t from) {
    constexpr const char* digits = "+-.0123456789";
    const size_t begin = bytes.find_first_of(digits, from);
    if (begin == std::string::npos) return;
    const size_t end = std::min(bytes.find_first_not_of(digits, begin), bytes.size());
    bytes.replace(begin, end - begin, tokens[below(8)]);
  }

  std::mt19937_64 random_;
};

// The function that a custom mutator calls; the seed advances, the same on every machine.
uint64_t changes_of_bytes = 0;

std::string changed(const std::string& bytes, uint64_t seed) {
  if (LLVMFuzzerCustomMutator == nullptr) return Mutator(seed).changed(bytes);
  constexpr size_t room = 1024;
  std::string text = bytes + std::string(room, '\0');
  text.resize(LLVMFuzzerCustomMutator(reinterpret_cast<uint8_t*>(text.data()), bytes.size(),
                                      text.size(), static_cast<unsigned>(seed)));
  return text;
}

void try_one(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
}

std::vector<fs::path> files_of(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size) {
  std::string bytes(reinterpret_cast<const char*>(data), size);
  bytes = Mutator(++changes_of_bytes).changed(std::move(bytes));
  bytes.resize(std::min(bytes.size(), max_size));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(data));
  return bytes.size();
}

int main(int argc, char** argv) {
  uint64_t mutations = 1000, tried = 0;
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--mutations" && i + 1 < argc) {
      mutations = std::strtoull(argv[++i], nullptr, 10);
    } else {
      for (fs::path& file : files_of(word)) files.push_back(std::move(file));
    }
  }
  if (files.empty()) {
    std::cerr << argv[0] << ": no files to start from\n";
    return 2;
  }
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    if (!in) {
      std::cerr << file << ": cannot be read\n";
      return 2;
    }
    try_one(bytes);
    for (uint64_t k = 0; k < mutations; ++k, ++tried) try_one(changed(bytes, k));
  }
  std::cout << fs::path(argv[0]).filename().string() << ": " << files.size() << " files, " << tried
            << " mutations read or refused\n";
  return 0;
}
