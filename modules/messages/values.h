// Every value of a message, one after the other: for comparing messages of any kind.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "modules/messages/message_types.h"

namespace palpate::messages {

struct Value {
  enum class Kind { kReal, kWhole, kNegative, kText };

  std::string_view field;  ///< "positions_m", "contacts.gap_m"
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t entry = kNone;  ///< which entry of a list the field is of
  std::size_t index = kNone;  ///< which number of a vector or list
  Kind kind = Kind::kReal;    ///< a whole number below zero is kNegative, its magnitude in `whole`
  double real = 0;            ///< also of whole numbers, rounded
  std::uint64_t whole = 0;
  std::string_view text;  ///< of the message: valid as long as it is unchanged

  /// Same place, same value; not a number is the same as itself, and the two zeros are.
  bool same_as(const Value& other) const;
};

/// Replaces `values` by all of the message's, header and key included, in the order of the wire.
void list_values(const AnyMessage& message, std::vector<Value>& values);

/// Names of the fields of all kinds of message, those of entries of lists too.
std::set<std::string_view> field_names();

/// "0.25", "7", "running".
std::string text_of(const Value& value);

/// "volume_m3", "positions_m[17]", "contacts[3].normal[0]".
std::string place_of(const Value& value);

}  // namespace palpate::messages
