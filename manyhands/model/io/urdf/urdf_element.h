// An element of a URDF file, read strictly: every value is checked, every error and note carries file and line.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/math/vec3.h"
#include "manyhands/model/io/xml_file.h"
#include "manyhands/model/load_report.h"

namespace manyhands::io {

/// The file that is being read and the notes taken so far.
struct UrdfSource {
  std::string file;
  const XmlFile& xml;
  LoadReport& report;
  bool bullet = false;  ///< whether Bullet's rules count
};

/// Which numbers a value may take.
enum class Magnitude {
  kPhysical,  ///< up to 1e12: lengths, angles, masses
  kAny,       ///< any finite number: limits, where huge means none
};

class UrdfElement {
 public:
  /// `what` names the part in messages, for example "link 'hand'".
  UrdfElement(UrdfSource& source, pugi::xml_node node, std::string what)
      : source_(&source), node_(node), what_(std::move(what)) {}

  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(node_); }
  [[nodiscard]] std::string_view tag() const { return node_.name(); }
  [[nodiscard]] int line() const { return source_->xml.line(node_); }
  [[nodiscard]] const std::string& what() const { return what_; }
  [[nodiscard]] bool is_bullet() const { return source_->bullet; }
  /// The same element under another name for messages.
  [[nodiscard]] UrdfElement named(std::string what) const { return {*source_, node_, std::move(what)}; }

  /// The first child of that tag, or an empty element; further ones are noted as ignored.
  [[nodiscard]] UrdfElement child(const char* tag) const;
  /// The same; fails if there is none.
  [[nodiscard]] UrdfElement required_child(const char* tag, const std::string& example) const;
  [[nodiscard]] std::vector<UrdfElement> children(const char* tag) const;
  [[nodiscard]] std::vector<UrdfElement> children() const;

  [[nodiscard]] bool has(const char* attribute) const { return static_cast<bool>(node_.attribute(attribute)); }
  [[nodiscard]] std::string_view text_or_empty(const char* attribute) const;
  [[nodiscard]] std::string text(const char* attribute) const;  ///< fails if missing or empty
  [[nodiscard]] double number(const char* attribute, Magnitude magnitude = Magnitude::kPhysical) const;
  [[nodiscard]] std::optional<double> optional_number(const char* attribute,
                                                      Magnitude magnitude = Magnitude::kPhysical) const;
  /// Numbers between blanks; fails if there are fewer than `count`.
  [[nodiscard]] std::vector<double> numbers(const char* attribute, std::size_t count, const char* example) const;
  [[nodiscard]] Vec3<double> vec3(const char* attribute, const char* example) const;
  [[nodiscard]] Vec3<double> vec3_or(const char* attribute, const Vec3<double>& value) const;
  /// The pose of its <origin>, or the identity.
  [[nodiscard]] Transform<double> origin() const;

  /// The first attribute value that holds ${...} or $(...), other than $(optenv ...), which has a default.
  [[nodiscard]] std::optional<std::string_view> attribute_with_substitution() const;

  /// Notes every attribute and child element that is not listed as ignored, and stray text.
  void expect(std::initializer_list<std::string_view> attributes,
              std::initializer_list<std::string_view> child_tags = {}) const;

  [[noreturn]] void fail(const std::string& message) const;
  void note(LoadAction action, std::string message) const;
  /// A note that Python warns of.
  void note_serious(LoadAction action, std::string message) const;

 private:
  [[nodiscard]] std::string attribute_name(const char* attribute) const;
  [[nodiscard]] std::string substituted(const char* attribute) const;
  [[nodiscard]] std::vector<double> read_numbers(const char* attribute, std::size_t count, const std::string& expected,
                                                 Magnitude magnitude) const;

  UrdfSource* source_;
  pugi::xml_node node_;
  std::string what_;
};

}  // namespace manyhands::io
