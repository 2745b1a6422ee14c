#include "modules/core/state_archive.h"

#include <catch2/catch.hpp>
#include <limits>
#include <tuple>

#include "modules/core/touch_state.h"

namespace palpate {
namespace {

struct Remembering {
  bool flag = true;
  double number = -0.1;
  Vec3 point = Vec3(1, 2, std::numeric_limits<double>::infinity());
  Quat turn = Quat(0.5, -0.5, 0.5, 0.5);
  std::optional<int> some = 7, none;
  std::vector<Vec3> points{Vec3(4, 5, 6), Vec3(7, 8, 9)};
  std::vector<std::optional<float>> mixed{1.5F, std::nullopt};
  std::deque<std::array<std::uint32_t, 2>> pairs{{1, 2}};
  std::string text = "name";
  Eigen::VectorXd numbers = Eigen::VectorXd::LinSpaced(3, 0, 1);
  LocalLaw law;
  void exchange(StateArchive& archive) {
    archive(flag, number, point, turn, some, none, points, mixed, pairs, text, numbers, law);
  }
};

}  // namespace

TEST_CASE("state archive: what is read is what was written, bit for bit") {
  // Oracle: the bytes of what was read, written again; some members by their values.
  Remembering first;
  first.law.rows.resize(2);
  first.law.rows[1].gap = 0.25;
  StateArchive written;
  written(first);

  Remembering second;
  second = {};
  second.flag = false;
  second.none = 3;
  second.points.clear();
  StateArchive reading(written.bytes());
  reading(second);
  CHECK(reading.left().empty());
  CHECK(second.flag);
  CHECK_FALSE(second.none);
  CHECK(second.points == first.points);
  CHECK(second.law.rows.at(1).gap == 0.25);
  StateArchive again;
  again(second);
  CHECK(again.bytes() == written.bytes());
}

TEST_CASE("state archive: whatever is cut off, and lists that cannot be, are refused") {
  // Oracle: InputError at every length; no memory for what is not there.
  Remembering value;
  StateArchive written;
  written(value);
  for (std::size_t size = 0; size < written.bytes().size(); ++size) {
    StateArchive reading(std::span(written.bytes()).first(size));
    Remembering into;
    REQUIRE_THROWS_AS(reading(into), InputError);
  }
  std::vector<Vec3> points(1);
  StateArchive one;
  one(points);
  std::vector<std::uint8_t> huge = one.bytes();
  std::fill_n(huge.begin() + 4, 8, std::uint8_t{0xFF});  // the count, behind the fingerprint
  StateArchive reading(huge);
  CHECK_THROWS_WITH(reading(points), "its state ends early");
  StateArchive counted;
  counted.same(5);
  StateArchive other(counted.bytes());
  CHECK_THROWS_AS(other.same(6), InputError);
}

namespace {

template <class... Members>
struct Laid {
  std::tuple<Members...> members;
  void exchange(StateArchive& archive) {
    std::apply([&](Members&... each) { archive(each...); }, members);
  }
};
template <class... Members>
struct Outer {  // what is inside of a state may differ, too
  std::vector<Laid<Members...>> several{1};
  int behind = 0;
  void exchange(StateArchive& archive) {
    archive(behind);
    for (auto& each : several) each.exchange(archive);
  }
};

template <class Into, class From>
std::string refusal_of(From from) {
  StateArchive written;
  written.same(1);
  from.exchange(written);
  StateArchive reading(written.bytes());
  reading.same(1);
  try {
    Into into;
    into.exchange(reading);
    return reading.left().empty() ? "" : "left over";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("state archive: what was laid out otherwise is refused before any of it is read") {
  // Oracle: the definition; members added, taken away, exchanged, of another size or kind.
  using Own = Outer<double, std::int32_t, Vec3>;
  CHECK(refusal_of<Own>(Own{}) == "");
  CHECK(refusal_of<Own>(Outer<double, std::int32_t>{}) == StateArchive::kOtherLayout);
  CHECK(refusal_of<Own>(Outer<double, std::int32_t, Vec3, bool>{}) == StateArchive::kOtherLayout);
  CHECK(refusal_of<Own>(Outer<double, Vec3, std::int32_t>{}) == StateArchive::kOtherLayout);
  CHECK(refusal_of<Own>(Outer<double, std::uint32_t, Vec3>{}) == StateArchive::kOtherLayout);
  CHECK(refusal_of<Own>(Outer<double, std::int64_t, Vec3>{}) == StateArchive::kOtherLayout);
  CHECK(refusal_of<Own>(Outer<double, std::int32_t, std::array<double, 3>>{}) ==
        StateArchive::kOtherLayout);
  struct Nothing {
    void exchange(StateArchive& /*archive*/) {}
  };
  CHECK(refusal_of<Own>(Nothing{}) == StateArchive::kOtherLayout);
}

}  // namespace palpate
