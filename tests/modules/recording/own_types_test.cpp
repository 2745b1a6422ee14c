#include "modules/recording/own_types.h"

#include <catch2/catch.hpp>

#include "modules/bus/topics.h"
#include "modules/recording/foxglove_messages.h"
#include "modules/recording/idl_text.h"

namespace palpate::recording {

TEST_CASE("own types: each topic's own is, and no other") {
  // Oracle: the topics, and one change of each field by hand.
  for (const bus::TopicInfo& topic : bus::all_topics()) {
    const std::string type(topic.type->wire_name);
    const McapSchema schema{1, type, "omgidl", std::string(idl_text_of(*topic.type))};
    const McapChannel channel{1, 1, std::string(topic.name), "cdr", {}};
    CHECK(why_foreign(schema).empty());
    CHECK(why_foreign(channel, type).empty());
    McapSchema other = schema;
    other.data.insert(other.data.rfind('}'), "x");
    CHECK_THAT(why_foreign(other), Catch::Contains("differs from the present one"));
    other = schema;
    other.name += 'x';
    CHECK(why_foreign(other) == "type '" + type + "x' is not one of Palpate's (palpate::idl::…)");
    McapChannel moved = channel;
    moved.topic = "qrobe_state";
    CHECK(why_foreign(moved, type) == "topic 'qrobe_state' is not one of Palpate's");
    moved = channel;
    moved.message_encoding = "json";
    CHECK_THAT(why_foreign(moved, type), Catch::EndsWith("is encoded as 'json'; allowed: cdr"));
    CHECK_THAT(why_foreign(channel, ""), Catch::EndsWith("must be of type '" + type + "'"));
  }
}

TEST_CASE("own types: a translation is left alone") {
  // Oracle: definition.
  for (const auto& type : foxglove::kTypes) {
    CHECK(is_translation(std::string(type)));
    CHECK(why_foreign(McapSchema{1, std::string(type), "omgidl", "any"}).empty());
    CHECK(why_foreign(McapChannel{1, 1, "/any", "cdr", {}}, std::string(type)).empty());
  }
}

}  // namespace palpate::recording
