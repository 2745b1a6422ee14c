#include "modules/recording/idl_text.h"

#include <array>
#include <cctype>
#include <string>
#include <utility>

#include "modules/core/error.h"
#include "modules/recording/idl_texts.h"

namespace palpate::recording {
namespace {

// The text without comments; words separated by one space.
std::string bare_idl(std::string_view text) {
  std::string bare;
  bool space = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i, 2) == "//") i = text.find('\n', i);
    if (i == std::string_view::npos) break;  // the last line was a comment
    if (std::isspace(static_cast<unsigned char>(text[i]))) {
      space = true;
      continue;
    }
    if (space && !bare.empty()) bare += ' ';
    space = false;
    bare += text[i];
  }
  return bare;
}

}  // namespace

std::string_view idl_text_of(const messages::MessageType& type) {
#define PALPATE_ENTRY(Message) std::pair{std::string_view(#Message), k##Message##Idl},
  static constexpr std::array texts{PALPATE_MESSAGES(PALPATE_ENTRY)};
#undef PALPATE_ENTRY
  for (const auto& [name, text] : texts) {
    if (name == type.name) return text;
  }
  PALPATE_DEMAND(!"a message without its IDL");
  return {};
}

bool same_idl(std::string_view a, std::string_view b) { return bare_idl(a) == bare_idl(b); }

}  // namespace palpate::recording
