#include "modules/bus/payload_type.h"

#include <fastrtps/utils/md5.h>

#include <algorithm>
#include <cstring>

namespace palpate::bus {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

constexpr std::uint32_t kUsualBytes = 1024;  // room that DDS makes before the first sample
constexpr std::size_t kHandleBytes = 16;
constexpr unsigned char kUnreadable = 0xff;  // every byte of the handle

}  // namespace

PayloadType::PayloadType(const messages::MessageType& type, std::uint64_t token, bool keyed)
    : type_(type), token_(token) {
  setName(std::string(type.wire_name).c_str());
  m_typeSize = kUsualBytes;
  m_isGetKeyDefined = keyed && type.key != messages::MessageType::Key::kNone;
}

bool PayloadType::serialize(void* data, rtps::SerializedPayload_t* payload) {
  const messages::Payload bytes = static_cast<Sample*>(data)->bytes;
  if (bytes.size() > payload->max_size || bytes.size() < 4) return false;
  std::memcpy(payload->data, bytes.data(), bytes.size());
  messages::set_token({payload->data, bytes.size()}, token_);
  payload->length = static_cast<std::uint32_t>(bytes.size());
  payload->encapsulation = (bytes[1] & 1u) != 0 ? CDR_LE : CDR_BE;
  return true;
}

bool PayloadType::deserialize(rtps::SerializedPayload_t* payload, void* data) {
  Sample& sample = *static_cast<Sample*>(data);
  sample.into->resize(payload->length);
  if (payload->length > 0) std::memcpy(sample.into->data(), payload->data, payload->length);
  sample.bytes = *sample.into;
  return true;
}

std::function<std::uint32_t()> PayloadType::getSerializedSizeProvider(void* data) {
  return [data] { return static_cast<std::uint32_t>(static_cast<Sample*>(data)->bytes.size()); };
}

bool PayloadType::getKey(void* data, rtps::InstanceHandle_t* handle, bool force_md5) {
  const auto key = messages::key_of(type_, static_cast<Sample*>(data)->bytes);
  if (!key.readable) {
    for (std::size_t i = 0; i < kHandleBytes; ++i) handle->value[i] = kUnreadable;
    return true;
  }
  // DDS hashes every key that may take more than the handle's bytes.
  if (force_md5 || type_.key == messages::MessageType::Key::kText) {
    MD5 md5;
    md5.init();
    md5.update(key.bytes.data(), static_cast<unsigned>(key.size));
    md5.finalize();
    for (std::size_t i = 0; i < kHandleBytes; ++i) handle->value[i] = md5.digest[i];
    return true;
  }
  for (std::size_t i = 0; i < kHandleBytes; ++i) {
    handle->value[i] = key.bytes[i];  // zeros after its end
  }
  return true;
}

}  // namespace palpate::bus
