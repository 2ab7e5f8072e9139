// The one way in which this program sees tinygltf: without image decoding and without access to
// files. Textures cannot matter to a tracer of light in bands, and whatever a model makes us open
// is opened (and recorded) by gltf_buffers alone. The macros change the class, so every source file
// must see the same ones.
#pragma once

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS

#include <tiny_gltf.h>
