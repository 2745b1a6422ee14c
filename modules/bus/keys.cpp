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
#include "modules/core/stop_signal.h"
#include "modules/core/whole_file.h"

namespace palpate::bus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, int system_error) {
  const std::string said = file.string() + ": " + std::strerror(system_error);
  if (is_disk_full(system_error)) throw std::runtime_error(said);
  throw InputError(said);
}

/// Readable and writable by its owner alone, from the first byte on. @param named  in messages
void write_private(const fs::path& file, const std::string& text, const fs::path& named) {
  const int number =
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  errno = number >= 0 ? ENOSPC : errno;  // of what was written in part
  const bool written = number >= 0 &&
                       ::write(number, text.data(), text.size()) == ssize_t(text.size()) &&
                       ::fsync(number) == 0;
  const int failure = errno;
  if (number >= 0) ::close(number);
  if (!written) fail(named, failure);
}

/// A folder with a trailing slash, or a link to one, is the folder. @throws InputError
fs::path place_of_folder(const fs::path& folder) {
  std::error_code failure;
  const fs::path place = fs::weakly_canonical(fs::absolute(folder), failure);
  if (failure) fail(folder, failure.value());
  return place.has_filename() ? place : place.parent_path();
}

/// A folder beside the one that is to be made, which gets its place when all is in it: whatever
/// ends the program, nothing is there that would refuse the next try.
class FolderInTheMaking {
 public:
  /// @throws InputError if the folder is there and not empty, or cannot be made
  explicit FolderInTheMaking(const fs::path& folder)
      : named_(folder), place_(place_of_folder(folder)), part_(place_) {
    std::error_code failure;
    if (fs::exists(place_, failure) && !fs::is_empty(place_, failure)) refuse_full();
    if (failure) fail(named_, failure.value());
    const fs::path above = fs::absolute(place_).parent_path();
    if (!fs::is_directory(above, failure)) {
      throw InputError(named_.string() + ": there is no folder " + above.string());
    }
    constexpr std::size_t kPartOfName = 160;  // of 255 bytes
    part_.replace_filename(place_.filename().string().substr(0, kPartOfName) + "." +
                           process_word() + ".part");
    fs::remove_all(part_, failure);  // of a process of that number, long ago
    if (::mkdir(part_.c_str(), S_IRWXU) != 0) fail(named_, errno);
    ::chmod(part_.c_str(), S_IRWXU);  // whatever the umask
  }
  ~FolderInTheMaking() {
    std::error_code ignored;
    fs::remove_all(part_, ignored);
  }
  FolderInTheMaking(const FolderInTheMaking&) = delete;
  FolderInTheMaking& operator=(const FolderInTheMaking&) = delete;

  /// @throws std::runtime_error for a full disk, Interrupted, else InputError; naming the file
  void write(const fs::path& file, const std::string& text) const {
    write_private(part_ / file.filename(), text, file);
    heed_signals();
  }
  void heed_signals() const {
    if (stop_.requested()) throw Interrupted(named_.string() + ": stopped while keys were made");
  }
  void finish() const {
    if (::rename(part_.c_str(), place_.c_str()) == 0) return;
    if (errno == ENOTEMPTY || errno == EEXIST) refuse_full();
    fail(named_, errno);
  }

 private:
  [[noreturn]] void refuse_full() const {
    throw InputError(named_.string() +
                     ": is not empty; keys go to a folder of their own, and are never replaced");
  }

  StopSignal stop_;  // outlives the folder
  fs::path named_, place_, part_;
};

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
  const FolderInTheMaking made(folder);
  made.write(key_files(folder, "").authority, authority.certificate());
  made.write(key_files(folder, "").governance, authority.signed_text(governance()));
  for (const Role& role : roles()) {
    const KeyFiles files = key_files(folder, role.name);
    const Identity identity = authority.identity(std::string(role.name), validity);
    made.write(files.key, identity.key);
    made.write(files.certificate, identity.certificate);
    made.write(files.permissions, authority.signed_text(permissions(role, validity)));
  }
  made.finish();
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
