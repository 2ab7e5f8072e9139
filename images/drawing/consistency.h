// Products are plain data; this is what drawing and writing rely on.
#pragma once

#include "core/product.h"

namespace photorque {

// InputError that names the item if sizes of its parts disagree or it is empty.
void require_consistent(const Map& map);
void require_consistent(const Table& table);
void require_consistent(const Plot& plot);

}  // namespace photorque
