// Attributes of an XML element that is written.
#pragma once

#include <array>
#include <pugixml.hpp>
#include <string>

#include "manyhands/model/io/save/exact.h"

namespace manyhands::io {

inline void set(pugi::xml_node node, const char* attribute, const std::string& text) {
  node.append_attribute(attribute).set_value(text.c_str());
}
inline void set(pugi::xml_node node, const char* attribute, const char* text) {
  node.append_attribute(attribute).set_value(text);
}
inline void set(pugi::xml_node node, const char* attribute, double number) { set(node, attribute, exact_text(number)); }
inline void set(pugi::xml_node node, const char* attribute, int number) {
  set(node, attribute, std::to_string(number));
}
inline void set(pugi::xml_node node, const char* attribute, const Vec3<double>& v) {
  set(node, attribute, exact_text(v));
}
inline void set(pugi::xml_node node, const char* attribute, std::span<const double> numbers) {
  set(node, attribute, exact_text(numbers));
}
/// Unless it is `standing`, which the format takes without it.
inline void set_unless(pugi::xml_node node, const char* attribute, double number, double standing) {
  if (number != standing) set(node, attribute, number);
}

/// The document as text, indented by two blanks.
[[nodiscard]] std::string text_of(const pugi::xml_document& document);

}  // namespace manyhands::io
