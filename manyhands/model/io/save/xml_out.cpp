#include "manyhands/model/io/save/xml_out.h"

#include <sstream>

namespace manyhands::io {

std::string text_of(const pugi::xml_document& document) {
  std::ostringstream stream;
  document.save(stream, "  ", pugi::format_indent | pugi::format_no_declaration, pugi::encoding_utf8);
  return stream.str();
}

}  // namespace manyhands::io
