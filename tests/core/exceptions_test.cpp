#include <recurve/core/exceptions.h>

#include <catch2/catch.hpp>

TEST_CASE("every error is caught as the standard exception it derives from, with its message")
{
  CHECK_THROWS_WITH([] { throw recurve::Input_error("degree 7"); }(), "degree 7");
  CHECK_THROWS_AS([] { throw recurve::Input_error(""); }(), std::invalid_argument);
  CHECK_THROWS_AS([] { throw recurve::Format_error(""); }(), std::runtime_error);
  CHECK_THROWS_AS([] { throw recurve::Solver_error(""); }(), std::runtime_error);
  CHECK_THROWS_AS([] { throw recurve::Cancelled(); }(), std::runtime_error);
}
