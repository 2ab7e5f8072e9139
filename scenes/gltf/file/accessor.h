// The numbers of a glTF accessor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/transform.h"
#include "scenes/gltf/file/document.h"

namespace photorque::gltf {

// Sizes within an element (section 3.6.2.4: columns of matrices start at multiples of 4 bytes).
struct ElementLayout {
  size_t component_bytes = 0;
  size_t components = 0;
  size_t element_bytes = 0;
};
ElementLayout layout_of(const tinygltf::Accessor& accessor);

// Reader of one accessor; valid as long as the document. The document must have passed
// validate_accessors(), so that every read is inside its buffer.
class AccessorReader {
 public:
  // Throws InputError if the bytes are absent (a placeholder buffer), or if the indices of a sparse
  // accessor do not rise or exceed its range.
  AccessorReader(const Document& document, int accessor, MemoryBudget* budget);

  size_t count() const { return count_; }

  // Component `component` of element `element` (below count()) as a real number; integers of
  // normalized accessors are scaled to [0, 1] or [−1, 1] (section 3.6.2.2).
  double number(size_t element, size_t component) const;

  // The first three components of an element.
  Vec3 vector3(size_t element) const {
    return {number(element, 0), number(element, 1), number(element, 2)};
  }

 private:
  // Address of an element; null for an element that is not stored and therefore zero.
  const unsigned char* address(size_t element) const;

  ElementLayout layout_;
  int component_type_ = 0;
  bool normalized_ = false;
  size_t count_ = 0;
  const unsigned char* base_ = nullptr;
  size_t stride_ = 0;
  std::vector<uint32_t> replaced_;  // elements that the sparse part replaces, rising
  const unsigned char* replacements_ = nullptr;
};

}  // namespace photorque::gltf
