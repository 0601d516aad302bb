// An XML text, checked for what could hurt a reader, whose elements know their lines.
#pragma once

#include <pugixml.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace manyhands::io {

/// What is wrong with an XML text, and in which line (1-based).
class XmlError : public std::runtime_error {
 public:
  XmlError(int line, const std::string& message) : std::runtime_error(message), line_(line) {}
  [[nodiscard]] int line() const { return line_; }

 private:
  int line_;
};

/// A parsed XML text with exactly one root element. Refuses declarations inside a document type (and so every entity
/// trick), attributes given twice, and texts too large or too deep. External files are never read.
class XmlFile {
 public:
  /// Throws XmlError.
  explicit XmlFile(std::string_view text);

  [[nodiscard]] pugi::xml_node root() const { return root_; }
  [[nodiscard]] int line(const pugi::xml_node& node) const { return line_at(node.offset_debug()); }

 private:
  [[nodiscard]] int line_at(std::ptrdiff_t offset) const;
  void find_root();
  void check_elements() const;

  std::vector<std::ptrdiff_t> line_starts_;
  pugi::xml_document document_;
  pugi::xml_node root_;
};

}  // namespace manyhands::io
