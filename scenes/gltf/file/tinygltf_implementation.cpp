// Compiles the implementation of tinygltf with the macros of document.h.
#include <fstream>  // version 2.7 needs it in its writer, and leaves it out with TINYGLTF_NO_FS
#include <nlohmann/json.hpp>  // before tinygltf includes it, which would hide its classes

#define TINYGLTF_IMPLEMENTATION
#include "scenes/gltf/file/document.h"
