// Headers that most files need and that seldom change; compiled once.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <deque>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/constants.h"
#include "core/errors.h"
#include "core/settings/keys.h"
#include "core/settings/settings.h"
#include "core/settings/typed_keys.h"
#include "core/transform.h"
