#include "modules/bus/output.h"

#include "modules/bus/bus.h"

namespace palpate::bus {

Output::Output(Bus& bus, const TopicInfo& topic)
    : bus_(bus), topic_(topic), raw_(bus.raw_writer(topic)) {
  bus_.outputs_.push_back(this);
}

Output::~Output() { std::erase(bus_.outputs_, this); }

}  // namespace palpate::bus
