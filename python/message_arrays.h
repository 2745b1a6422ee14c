// Messages as Python's values, field by field as they are described (modules/messages/describe.h):
// a new field needs nothing here.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>

#include "modules/messages/message_types.h"

namespace palpate::python {

/// Numbers and texts as they are, words as str; vectors, matrices and lists as read-only arrays
/// that look into `message` without a copy and keep it alive. Fields of a list's entries get one
/// array each, "contacts.gap_m"  (entries) or (entries × …). Words in lists are copied, as an array
/// of str.
template <class Message>
pybind11::dict arrays_of(std::shared_ptr<const Message> message);

/// The same of a message whose kind is known only at run time.
pybind11::dict arrays_of_any(std::shared_ptr<const messages::AnyMessage> message);

}  // namespace palpate::python
