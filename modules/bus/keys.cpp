#include "modules/bus/keys.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <stdexcept>
#include <vector>

#include "modules/bus/key_check.h"
#include "modules/bus/roles.h"
#include "modules/core/error.h"
#include "modules/core/output_file.h"

namespace palpate::bus {
namespace {

namespace fs = std::filesystem;

using Texts = std::vector<std::pair<fs::path, std::string>>;  ///< by file

[[noreturn]] void fail(const fs::path& file, int system_error) {
  const std::string said = file.string() + ": " + std::strerror(system_error);
  if (is_disk_full(system_error)) throw std::runtime_error(said);
  throw InputError(said);
}

/// Readable and writable by its owner alone, from the first byte on.
void write_private(const fs::path& file, const std::string& text) {
  const int number =
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  errno = number >= 0 ? ENOSPC : errno;  // of what was written in part
  const bool written = number >= 0 &&
                       ::write(number, text.data(), text.size()) == ssize_t(text.size()) &&
                       ::fsync(number) == 0;
  const int failure = errno;
  if (number >= 0) ::close(number);
  if (!written) fail(file, failure);
}

/// All, or none and no folder that was not there: a part of them would refuse the next try.
void write_all(const fs::path& folder, bool is_new, const Texts& texts) {
  try {
    for (const auto& [file, text] : texts) write_private(file, text);
  } catch (const std::exception&) {
    std::error_code ignored;
    for (const auto& [file, text] : texts) fs::remove(file, ignored);
    if (is_new) fs::remove(folder, ignored);
    throw;
  }
}

/// @returns whether it was not there
bool make_folder(const fs::path& folder) {
  std::error_code failure;
  const bool is_new = fs::create_directories(folder, failure);
  if (failure) fail(folder, failure.value());
  if (!fs::is_empty(folder)) {
    throw InputError(folder.string() +
                     ": is not empty; keys go to a folder of their own, and are never replaced");
  }
  fs::permissions(folder, fs::perms::owner_all);
  return is_new;
}

// Elements in the order of the schemas of DDS Security 1.1, which readers insist on.
constexpr const char* kXml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
constexpr const char* kAllDomains =
    "<domains><id_range><min>0</min><max>200</max></id_range></domains>\n";

/// Every sub-message of every topic is encrypted, for that is what a reader insists on; a whole
/// packet would be so in vain beside it.
std::string governance() {
  return std::string(kXml) + "<dds><domain_access_rules><domain_rule>\n" + kAllDomains +
         "<allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n"
         "<enable_join_access_control>true</enable_join_access_control>\n"
         "<discovery_protection_kind>ENCRYPT</discovery_protection_kind>\n"
         "<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>\n"
         "<rtps_protection_kind>NONE</rtps_protection_kind>\n"
         "<topic_access_rules><topic_rule>\n"
         "<topic_expression>*</topic_expression>\n"
         "<enable_discovery_protection>true</enable_discovery_protection>\n"
         "<enable_liveliness_protection>true</enable_liveliness_protection>\n"
         "<enable_read_access_control>true</enable_read_access_control>\n"
         "<enable_write_access_control>true</enable_write_access_control>\n"
         "<metadata_protection_kind>ENCRYPT</metadata_protection_kind>\n"
         "<data_protection_kind>NONE</data_protection_kind>\n"
         "</topic_rule></topic_access_rules>\n"
         "</domain_rule></domain_access_rules></dds>\n";
}

std::string topics(const char* element, const std::vector<std::string_view>& names) {
  if (names.empty()) return "";
  std::string text = std::string("<") + element + "><topics>";
  for (const auto name : names) text += "<topic>" + std::string(name) + "</topic>";
  return text + "</topics><partitions><partition>*</partition></partitions></" + element + ">\n";
}

std::string permissions(const Role& role, const Validity& validity) {
  const std::string name(role.name);
  return std::string(kXml) + "<dds><permissions><grant name=\"" + name + "\">\n<subject_name>" +
         subject_of(name) + "</subject_name>\n<validity><not_before>" + text_of(validity.from) +
         "</not_before><not_after>" + text_of(validity.to) + "</not_after></validity>\n" +
         "<allow_rule>" + kAllDomains + topics("publish", role.writes) +
         topics("subscribe", role.reads) +
         "</allow_rule>\n<default>DENY</default></grant></permissions></dds>\n";
}

/// As DDS takes it.
std::string url(const fs::path& file) { return "file://" + file.string(); }

}  // namespace

void make_keys(const fs::path& folder, std::chrono::seconds valid_for) {
  const Validity validity = valid_from_now(valid_for);
  write_keys(folder, Authority(validity), validity);
}

void write_keys(const fs::path& folder, const Authority& authority, const Validity& validity) {
  const bool is_new = make_folder(folder);
  Texts texts{{key_files(folder, "").authority, authority.certificate()},
              {key_files(folder, "").governance, authority.signed_text(governance())}};
  for (const Role& role : roles()) {
    const KeyFiles files = key_files(folder, role.name);
    const Identity identity = authority.identity(std::string(role.name), validity);
    texts.emplace_back(files.key, identity.key);
    texts.emplace_back(files.certificate, identity.certificate);
    texts.emplace_back(files.permissions, authority.signed_text(permissions(role, validity)));
  }
  write_all(folder, is_new, texts);
}

void apply_keys(const fs::path& folder, const std::string& role,
                eprosima::fastdds::dds::DomainParticipantQos& qos) {
  check_keys(folder, role);
  const KeyFiles files = key_files(folder, role);
  auto& properties = qos.properties().properties();
  const auto add = [&](const char* name, const std::string& value) {
    properties.emplace_back(std::string("dds.sec.") + name, value);
  };
  add("auth.plugin", "builtin.PKI-DH");
  add("auth.builtin.PKI-DH.identity_ca", url(files.authority));
  add("auth.builtin.PKI-DH.identity_certificate", url(files.certificate));
  add("auth.builtin.PKI-DH.private_key", url(files.key));
  add("access.plugin", "builtin.Access-Permissions");
  add("access.builtin.Access-Permissions.permissions_ca", url(files.authority));
  add("access.builtin.Access-Permissions.governance", url(files.governance));
  add("access.builtin.Access-Permissions.permissions", url(files.permissions));
  add("crypto.plugin", "builtin.AES-GCM-GMAC");
}

}  // namespace palpate::bus
