#include <gtest/gtest.h>

#include "core/sobol.h"
#include "core/transform.h"

TEST(Sobol, Placeholder) { EXPECT_LT(photorque::sobol_point({1, 2, 0}, 5)[0], 1.0); }
