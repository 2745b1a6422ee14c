// The keys of a session: who has none, or others, neither reads nor writes it (DDS Security).
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "modules/bus/certificates.h"

namespace eprosima::fastdds::dds {
class DomainParticipantQos;
}

namespace palpate::bus {

/// Makes `folder` and in it the certificate of an authority, what it says of all traffic
/// (everything is authenticated and encrypted), and for each role (roles.h) a key, a certificate
/// and what the role may write and read. The authority's own key is not kept: nobody can add to
/// them later. Files are readable by their owner alone; they are all there, or none is: they come
/// to be in a folder beside it.
/// @throws InputError if the folder is there and not empty, or cannot be written; Interrupted if a
/// signal of StopSignal comes
void make_keys(const std::filesystem::path& folder, std::chrono::seconds valid_for);

/// The same by an authority that lives on.
void write_keys(const std::filesystem::path& folder, const Authority& authority,
                const Validity& validity);

/// Has the participant prove its role with the keys of a folder, and demand the same of others.
/// @throws InputError as check_keys() does (key_check.h)
void apply_keys(const std::filesystem::path& folder, const std::string& role,
                eprosima::fastdds::dds::DomainParticipantQos& qos);

}  // namespace palpate::bus
