// Many messages of one topic as columns, one per described field (modules/messages/describe.h): the
// arrays of a recording, and of what a session said while it ran.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "modules/messages/message_types.h"

namespace palpate::python {

/// One field of all messages.
struct Column {
  enum class Kind {
    kText,
    kFlag,
    kUnsigned8,
    kUnsigned32,
    kUnsigned64,
    kSigned64,
    kFloat,
    kDouble
  };

  std::string name;
  Kind kind = Kind::kDouble;
  std::vector<std::size_t> shape;   ///< of one entry; empty: a number or text
  bool listed = false;              ///< a message may have any number of entries
  std::vector<std::uint8_t> bytes;  ///< of all entries, one after the other
  std::vector<std::string> texts;   ///< in place of bytes
  std::vector<std::int64_t>
      offsets;  ///< of a listed one: where each message's entries begin, and their end
};

class TopicColumns {
 public:
  /// Messages of one kind only.
  void add(const messages::AnyMessage& message);
  std::size_t size() const { return size_; }

  /// (name, values) in the order of the wire: an array (messages × …), a list of str, or for a
  /// listed field (values, offsets). Gives its memory away: call once.
  pybind11::list take();

 private:
  std::vector<Column> columns_;
  std::size_t size_ = 0;
};

}  // namespace palpate::python
