#include "deformation/contact/gauss_seidel.h"

#include "deformation/contact/contact_solve.h"

#include <catch2/catch.hpp>
#include <vector>

namespace palpate::deformation {
namespace {

struct Row {
  Vec3 normal = Vec3::UnitZ();
  double normal_impulse = 0, friction = 0.5;
  Vec3 tangential_impulse = Vec3::Zero();
};

TEST_CASE("gauss seidel: a contact presses until it parts no more, and never pulls") {
  // Oracle: by hand, 0.5 kg: 0.4 m/s of approach take 0.2 N·s; 1 m/s of parting gives back all.
  Row row;
  CHECK(press(row, 0.1, 0.5) == 0);
  CHECK(press(row, -0.4, 0.5) == Approx(0.2));
  CHECK(press(row, 0.1, 0.5) == Approx(-0.05));
  CHECK(press(row, 1, 0.5) == Approx(-0.15));
  CHECK(row.normal_impulse == 0);
}

TEST_CASE("gauss seidel: where what is fixed yields, too, a contact presses less") {
  // Oracle: by hand, 0.5 kg and 2/kg: 0.4 m/s of approach take 0.1 N·s, those of 1 m/s more, which
  // are withheld, would take 0.35 N·s together, the 0.4 m/s alone 0.2 N·s, which is less.
  Row row;
  CHECK(press(row, -0.4, 0.5, Yielding{2, 0}) == Approx(0.1));
  CHECK(press(row, -0.2, 0.5, Yielding{2, 0}) == Approx(0).margin(1e-15));
  CHECK(press(row, 1, 0.5, Yielding{2, 0}) == Approx(-0.1));
  CHECK(press(row, -0.4, 0.5, Yielding{2, 1}) == Approx(0.2));
  CHECK(press(row, 0.1, 0.5, Yielding{}) == Approx(-0.05));
}

TEST_CASE("gauss seidel: rubbing stops what slides, up to the cone") {
  // Oracle: by hand, 0.5 kg, friction 0.5 of 0.2 N·s; motion along the normal does not count.
  Row row;
  CHECK_FALSE(may_rub(row));
  row.normal_impulse = 0.2;
  REQUIRE(may_rub(row));
  CHECK((rub(row, Vec3(0.1, 0, 9), 0.5) - Vec3(-0.05, 0, 0)).norm() < 1e-15);
  rub(row, Vec3(0, 3, 0), 0.5);
  CHECK(row.tangential_impulse.norm() == Approx(0.1));
  CHECK(row.tangential_impulse.y() < 0);
  row.tangential_impulse = Vec3(0.3, 0, 0.4);
  take_guess(row);
  CHECK((row.tangential_impulse - Vec3(0.1, 0, 0)).norm() < 1e-15);
  row.normal_impulse = 0;
  clamp_to_cone(row);
  CHECK(row.tangential_impulse.isZero(0));
}

TEST_CASE(
    "gauss seidel: all are visited but those that nothing moves, friction where there is some") {
  // Oracle: the visits written down.
  struct Prepared {
    double tangential_inverse_mass;
  };
  std::vector<Row> rows(3);
  rows[2].friction = 0;
  const std::vector<Prepared> prepared{{1}, {0}, {1}};
  std::vector<std::size_t> pressed, rubbed;
  const auto note = [](std::vector<std::size_t>& visits, double change) {
    return [&visits, change](std::size_t r) {
      visits.push_back(r);
      return change * static_cast<double>(r + 1);
    };
  };
  CHECK(visit_all(rows, prepared, note(pressed, 1), note(rubbed, 10)) == 10);
  CHECK(pressed == std::vector<std::size_t>{0, 2});
  CHECK(rubbed == std::vector<std::size_t>{0});
}

}  // namespace
}  // namespace palpate::deformation
