#include "scenes/gltf/file/accessor.h"

#include <algorithm>
#include <cstring>

namespace photorque::gltf {
namespace {

template <typename Number>
Number load(const unsigned char* bytes) {
  Number value;  // glTF is little-endian, as are all supported machines
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

double load_component(const unsigned char* bytes, int component_type, bool normalized) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return normalized ? std::max(load<int8_t>(bytes) / 127.0, -1.0) : load<int8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<uint8_t>(bytes) / (normalized ? 255.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return normalized ? std::max(load<int16_t>(bytes) / 32767.0, -1.0) : load<int16_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<uint16_t>(bytes) / (normalized ? 65535.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<uint32_t>(bytes);
    default:
      return load<float>(bytes);
  }
}

// Address at `offset` in a bufferView.
const unsigned char* bytes_at(const Document& document, int view, size_t offset,
                              const std::string& where) {
  const tinygltf::BufferView& buffer_view = document.model.bufferViews[static_cast<size_t>(view)];
  const Buffer& buffer = document.buffers[static_cast<size_t>(buffer_view.buffer)];
  if (!buffer.bytes) {
    throw document.wrong(where, "buffer " + std::to_string(buffer_view.buffer) + " without bytes",
                         "a buffer with a uri (is the model compressed?)");
  }
  return reinterpret_cast<const unsigned char*>(buffer.bytes->data()) + buffer_view.byteOffset +
         offset;
}

}  // namespace

ElementLayout layout_of(const tinygltf::Accessor& accessor) {
  const auto component = static_cast<size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType)));
  const auto components =
      static_cast<size_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)));
  size_t columns = 1;
  if (accessor.type == TINYGLTF_TYPE_MAT2) columns = 2;
  if (accessor.type == TINYGLTF_TYPE_MAT3) columns = 3;
  if (accessor.type == TINYGLTF_TYPE_MAT4) columns = 4;
  size_t column_bytes = components / columns * component;
  if (columns > 1) column_bytes = (column_bytes + 3) / 4 * 4;
  return {component, components, columns * column_bytes};
}

AccessorReader::AccessorReader(const Document& document, int accessor, MemoryBudget* budget) {
  const tinygltf::Accessor& from = document.model.accessors[static_cast<size_t>(accessor)];
  const std::string where = pointer("accessors", accessor);
  layout_ = layout_of(from);
  component_type_ = from.componentType;
  normalized_ = from.normalized;
  count_ = from.count;
  if (from.bufferView >= 0) {
    base_ = bytes_at(document, from.bufferView, from.byteOffset, where + "/bufferView");
    const size_t stride =
        document.model.bufferViews[static_cast<size_t>(from.bufferView)].byteStride;
    stride_ = stride > 0 ? stride : layout_.element_bytes;
  }
  if (!from.sparse.isSparse) return;

  const auto& [indices, values] = std::pair(from.sparse.indices, from.sparse.values);
  const std::string indices_where = where + "/sparse/indices";
  const unsigned char* const index_bytes =
      bytes_at(document, indices.bufferView, static_cast<size_t>(indices.byteOffset),
               indices_where + "/bufferView");
  replacements_ = bytes_at(document, values.bufferView, static_cast<size_t>(values.byteOffset),
                           where + "/sparse/values/bufferView");
  const auto index_size = static_cast<size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(indices.componentType)));
  const auto replaced_count = static_cast<size_t>(from.sparse.count);
  budget->charge(replaced_count, sizeof(uint32_t), indices_where);
  replaced_.resize(replaced_count);
  for (size_t i = 0; i < replaced_count; ++i) {
    replaced_[i] = static_cast<uint32_t>(
        load_component(index_bytes + i * index_size, indices.componentType, false));
    if (replaced_[i] >= count_ || (i > 0 && replaced_[i] <= replaced_[i - 1])) {
      throw document.wrong(indices_where, std::to_string(replaced_[i]) + " at " + std::to_string(i),
                           "rising indices below " + std::to_string(count_));
    }
  }
}

const unsigned char* AccessorReader::address(size_t element) const {
  if (!replaced_.empty()) {
    const auto found = std::lower_bound(replaced_.begin(), replaced_.end(), element);
    if (found != replaced_.end() && *found == element) {
      return replacements_ + static_cast<size_t>(found - replaced_.begin()) * layout_.element_bytes;
    }
  }
  return base_ == nullptr ? nullptr : base_ + element * stride_;
}

double AccessorReader::number(size_t element, size_t component) const {
  const unsigned char* const start = address(element);
  if (start == nullptr) return 0.0;
  return load_component(start + component * layout_.component_bytes, component_type_, normalized_);
}

}  // namespace photorque::gltf
