// The one type that DDS knows: a payload as it travels. Names and keys are those of the message.
#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>

#include <vector>

#include "modules/messages/message_types.h"

namespace palpate::bus {

class PayloadType : public eprosima::fastdds::dds::TopicDataType {
 public:
  /// What DDS is given to write, and fills on reading.
  struct Sample {
    messages::Payload bytes;  ///< to write; what was read
    std::vector<std::uint8_t> own;
    std::vector<std::uint8_t>* into = &own;  ///< memory for what is read
  };

  /// @param token  is written into each payload that leaves
  /// @param keyed  whether DDS tells samples apart by the message's key, if it has one
  PayloadType(const messages::MessageType& type, std::uint64_t token, bool keyed = true);

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override { return new Sample; }
  void deleteData(void* data) override { delete static_cast<Sample*>(data); }
  /// Never false: on that DDS aborts the process. Samples without a readable key share one.
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;

 private:
  const messages::MessageType& type_;
  std::uint64_t token_;
};

}  // namespace palpate::bus
