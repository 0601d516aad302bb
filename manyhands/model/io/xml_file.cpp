#include "manyhands/model/io/xml_file.h"

#include <algorithm>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

constexpr std::size_t kMostBytes = std::size_t{128} << 20;
constexpr int kMostDepth = 128;
constexpr std::ptrdiff_t kMostAttributes = 64;

/// How many bytes a character of UTF-8 has whose first byte is given; 0 of one that begins none.
std::size_t length_of(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first < 0xe0) return 2;
  if (first >= 0xe0 && first < 0xf0) return 3;
  return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = length_of(static_cast<unsigned char>(text.front()));
    if (length == 0 || length > text.size()) return false;
    for (const char c : text.substr(1, length - 1)) {
      if ((static_cast<unsigned char>(c) & 0xc0) != 0x80) return false;
    }
    text.remove_prefix(length);
  }
  return true;
}

/// Comments may be what they like; names go on to where they are read.
void require_utf8(std::string_view text, const std::string& what, int line) {
  if (is_utf8(text)) return;
  throw XmlError(line, what + " is no UTF-8; save the file as UTF-8");
}

void check_attributes(const pugi::xml_node& node, int line) {
  std::vector<std::string_view> names;
  require_utf8(node.name(), "an element's name", line);
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    names.emplace_back(attribute.name());
    require_utf8(names.back(), "an attribute's name", line);
    require_utf8(attribute.value(), "the attribute " + in_quotes(names.back()), line);
  }
  const std::string element = "<" + std::string(node.name()) + ">";
  if (std::ssize(names) > kMostAttributes) {
    throw XmlError(line, element + " has " + std::to_string(names.size()) + " attributes; expected at most " +
                             std::to_string(kMostAttributes));
  }
  std::ranges::sort(names);
  const auto twice = std::ranges::adjacent_find(names);
  if (twice != names.end()) {
    throw XmlError(line, element + " has the attribute " + in_quotes(*twice) + " twice; expected it once");
  }
}

}  // namespace

XmlFile::XmlFile(std::string_view text) {
  if (text.size() > kMostBytes) {
    throw XmlError(0, "the file has " + std::to_string(text.size() >> 20) + " MiB; expected at most " +
                          std::to_string(kMostBytes >> 20));
  }
  line_starts_.push_back(0);
  for (std::size_t at = text.find('\n'); at != text.npos; at = text.find('\n', at + 1)) {
    line_starts_.push_back(static_cast<std::ptrdiff_t>(at) + 1);
  }
  const pugi::xml_parse_result result =
      document_.load_buffer(text.data(), text.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result) {
    throw XmlError(line_at(result.offset), std::string("not well-formed XML: ") + result.description());
  }
  find_root();
  check_elements();
}

int XmlFile::line_at(std::ptrdiff_t offset) const {
  return static_cast<int>(std::ranges::upper_bound(line_starts_, offset) - line_starts_.begin());
}

void XmlFile::find_root() {
  for (const pugi::xml_node& node : document_.children()) {
    if (node.type() == pugi::node_doctype && std::string_view(node.value()).find('[') != std::string_view::npos) {
      throw XmlError(1,
                     "the file declares entities or a document type of its own (<!DOCTYPE ... [...]>), which is not "
                     "read; remove it");
    }
    if (node.type() != pugi::node_element) continue;
    if (root_) {
      throw XmlError(line(node), "a second root element <" + std::string(node.name()) + "> after <" +
                                     std::string(root_.name()) + ">; expected one");
    }
    root_ = node;
  }
}

void XmlFile::check_elements() const {
  int depth = 1;
  for (pugi::xml_node node = root_; node;) {
    if (node.type() == pugi::node_element) check_attributes(node, line(node));
    if (node.type() == pugi::node_pcdata) require_utf8(node.value(), "a text", line(node));
    if (node.first_child()) {
      node = node.first_child();
      if (++depth > kMostDepth) {
        throw XmlError(line(node), "elements are nested " + std::to_string(depth) + " deep; expected at most " +
                                       std::to_string(kMostDepth));
      }
      continue;
    }
    while (node != root_ && !node.next_sibling()) {
      node = node.parent();
      --depth;
    }
    node = node == root_ ? pugi::xml_node() : node.next_sibling();
  }
}

}  // namespace manyhands::io
