// Code for each protection: a buffer, a copy into it, a large frame, a function that is called by
// its address.
#include <cstdio>
#include <cstring>

namespace {

int into_a_buffer(const char* text) {
  char buffer[16];
  std::strcpy(buffer, text);
  return std::puts(buffer);
}

int with_a_large_frame(const char* text) {
  char frame[1 << 16];
  std::snprintf(frame, sizeof frame, "%s%s", text, text);
  return std::puts(frame);
}

}  // namespace

int main(int count, char** words) {
  int (*volatile called)(const char*) = count > 1 ? with_a_large_frame : into_a_buffer;
  return called(words[0]) < 0 ? 1 : 0;
}
