// The costly part of Catch2 (16 s), alone in one file.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
