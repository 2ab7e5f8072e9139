// A lit scene as one binary glTF file (GLB 2.0) that any viewer shows: light as textures and as
// vertex colours.
#pragma once

#include <string>

#include "core/product.h"
#include "core/provenance.h"
#include "images/browser/stage.h"

namespace photorque {

// The stage in its first state, with its first painting baked; `product` has the maps that its
// surfaces name. Scene 0 has each painted surface with its map as a texture, scene 1 the same as
// vertex colours, on triangles no larger than a bin; both have the parts in their colours. Colours
// are unlit (KHR_materials_unlit), on the scale of all maps together, whose ends stand in
// asset.extras.photorque with the colour map's name, unit and provenance. Vertices of scene 1 carry
// the value itself as the attribute _VALUE. Metres, +Y up: body (x, y, z) is glTF (x, z, −y).
// Equal input gives equal bytes. InputError where a surface names no map of the product.
std::string baked_glb(const SceneStage& stage, const Product& product,
                      const Provenance& provenance);

}  // namespace photorque
