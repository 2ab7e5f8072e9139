// Compiles tinygltf's own code, with the macros of the seam.
#define TINYGLTF_IMPLEMENTATION
#include "scenes/tinygltf_seam.h"
