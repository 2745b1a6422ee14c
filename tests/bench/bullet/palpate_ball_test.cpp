// The pipeline beside the same ball with its contacts given.
#include "bench/bullet/palpate_ball.h"

#include <catch2/catch.hpp>

namespace palpate::bench {

TEST_CASE("palpate ball: a plate on 19,362 nodes holds as many as it touches") {
  // Oracle: the same springs and steps with a contact row for every node, no search, no messages:
  // 183 Pa. With the 1,024 deepest contacts alone it was 155 Pa, nodes 0.8 mm beyond the plate.
  const Ball ball = make_bench_ball(19'362);
  const Squeeze squeeze{0.5, 250, 250};
  PalpateBall direct(ball, {});
  PipelineBall pipeline(ball, squeeze);
  const Outcome given = run(direct, squeeze, [] {});
  const Outcome found = run(pipeline, squeeze, [] {});
  INFO(given.pressure << " Pa given, " << found.pressure << " Pa found, " << found.contacts
                      << " contacts, " << found.beyond << " m beyond");
  CHECK(given.pressure == Approx(183).epsilon(0.01));
  CHECK(found.pressure == Approx(given.pressure).epsilon(0.01));
  CHECK(found.beyond < 5e-5);
  CHECK(found.contacts_left_out == 0);
  CHECK(found.contacts > 4'000);
  CHECK(std::string(found.verdict()) == "stable");
}

}  // namespace palpate::bench
