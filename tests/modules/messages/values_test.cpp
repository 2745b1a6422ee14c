#include "modules/messages/values.h"

#include <catch2/catch.hpp>

#include "tests/modules/messages/random_messages.h"

namespace palpate::messages {
namespace {

using testing::Random;
using testing::random_message;

template <class Message>
void add_listed(Random& random, std::set<std::string_view>& names) {
  std::vector<Value> values;
  for (int round = 0; round < 50; ++round) {
    list_values(random_message<Message>(random), values);
    for (const Value& value : values) names.insert(value.field);
  }
}

}  // namespace

TEST_CASE("values: the names of fields are those that messages list, of lists' entries too",
          "[messages]") {
  // Oracle: what 50 random messages of each kind list.
  Random random(31);
  std::set<std::string_view> listed;
#define PALPATE_ADD(Message) add_listed<Message>(random, listed);
  PALPATE_MESSAGES(PALPATE_ADD)
#undef PALPATE_ADD
  CHECK(field_names() == listed);
  CHECK(listed.contains("rows.gap_m"));
}

}  // namespace palpate::messages
