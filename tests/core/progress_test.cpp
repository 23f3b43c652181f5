#include <recurve/core/progress.h>

#include <catch2/catch.hpp>

#include <string>

using namespace recurve;

TEST_CASE("progress without a callback is nothing")
{
  CHECK_NOTHROW(report_progress({}, "read", 0.5));
}

TEST_CASE("progress hands on stage and fraction, and a callback that returns false cancels")
{
  std::string seen;
  const Progress_callback callback = [&](std::string_view stage, double fraction) {
    seen += std::string(stage) + (fraction < 1 ? "..." : "!");
    return fraction < 1;
  };
  CHECK_NOTHROW(report_progress(callback, "fit", 0));
  CHECK_THROWS_AS(report_progress(callback, "fit", 1), Cancelled);
  CHECK(seen == "fit...fit!");
}
