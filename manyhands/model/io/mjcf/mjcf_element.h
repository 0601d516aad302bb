// An element of an MJCF file, read strictly, its default class's values standing in for what it does not say.
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/math/vec3.h"
#include "manyhands/model/io/mjcf/mjcf_source.h"

namespace manyhands::io {

/// The attributes of a default class by kind of element ("geom", "joint", "actuator" for all actuators ...); those of
/// the classes above are in it already.
struct MjcfClass {
  std::map<std::string, std::map<std::string, std::string, std::less<>>, std::less<>> values;
};

struct MjcfClasses {
  std::map<std::string, MjcfClass, std::less<>> by_name;
};

class MjcfElement {
 public:
  /// `what` names the part in messages, for example "body 'hand'".
  MjcfElement(MjcfSource& source, const MjcfFile& file, pugi::xml_node node, std::string what)
      : source_(&source), file_(&file), node_(node), what_(std::move(what)) {}

  [[nodiscard]] std::string_view tag() const { return node_.name(); }
  [[nodiscard]] int line() const { return file_->xml.line(node_); }
  [[nodiscard]] const std::string& what() const { return what_; }
  [[nodiscard]] MjcfSource& source() const { return *source_; }
  /// The model it is written in: 0 of the main one, see MjcfSource::models.
  [[nodiscard]] std::size_t model() const { return file_->model; }
  [[nodiscard]] const PackagePaths& paths() const { return source_->models()[model()].paths; }
  /// The same element under another name for messages.
  [[nodiscard]] MjcfElement named(std::string what) const;
  /// The same element, the names of it and all in it lengthened by `suffix`, before what lengthens them
  /// already.
  [[nodiscard]] MjcfElement with_suffix(const std::string& suffix) const;
  /// The same element, its missing attributes taken from its class, else the class that `childclass` of an element
  /// around it names, else the main class.
  [[nodiscard]] MjcfElement with_defaults(const MjcfClasses& classes, std::string_view kind) const;

  /// All child elements, those of included files in the place of <include>, and in that of <attach> the body that it
  /// names, or all that lies in that model's world.
  [[nodiscard]] std::vector<MjcfElement> children() const;
  [[nodiscard]] std::vector<MjcfElement> children(std::string_view tag) const;

  [[nodiscard]] std::vector<std::pair<std::string, std::string>> own_attributes() const;
  [[nodiscard]] bool has(const char* attribute) const { return find(attribute).has_value(); }
  [[nodiscard]] bool has_own(const char* attribute) const { return static_cast<bool>(node_.attribute(attribute)); }
  [[nodiscard]] std::string text_or(const char* attribute, const std::string& fallback) const;
  [[nodiscard]] std::string text(const char* attribute) const;  ///< fails if missing or empty
  [[nodiscard]] std::optional<double> optional_number(const char* attribute) const;
  [[nodiscard]] double number_or(const char* attribute, double fallback) const;
  [[nodiscard]] double positive_or(const char* attribute, double fallback) const;  ///< 0 or more
  [[nodiscard]] int integer_or(const char* attribute, int fallback) const;
  [[nodiscard]] bool boolean_or(const char* attribute, bool fallback) const;
  /// Numbers between blanks, none if the attribute is missing; fails unless there are `fewest` to `most`. Where the
  /// element gives fewer than its class, the class's last ones stay.
  [[nodiscard]] std::vector<double> numbers(const char* attribute, std::size_t fewest, std::size_t most) const;
  [[nodiscard]] Vec3<double> vec3_or(const char* attribute, const Vec3<double>& fallback) const;
  /// One of the words, or `fallback` if the attribute is missing.
  [[nodiscard]] std::string word_or(const char* attribute, std::initializer_list<std::string_view> words,
                                    const std::string& fallback) const;

  /// Notes every own attribute and child element that is not listed as ignored.
  void expect(std::initializer_list<std::string_view> attributes,
              std::initializer_list<std::string_view> child_tags = {}) const {
    expect(attributes, std::span(child_tags.begin(), child_tags.size()));
  }
  void expect(std::initializer_list<std::string_view> attributes, std::span<const std::string_view> child_tags) const;
  /// Notes each of these attributes as ignored where the element or its class gives it.
  void ignore(std::initializer_list<const char*> attributes) const;

  [[noreturn]] void fail(const std::string& message) const;
  void note(LoadAction action, std::string message) const;
  /// A note that Python warns of.
  void note_serious(LoadAction action, std::string message) const;
  /// A note of which only the first by this key is kept, and the others counted.
  void note_once(const std::string& key, LoadAction action, std::string message) const;

 private:
  [[nodiscard]] std::optional<std::string_view> find(const char* attribute) const;
  [[nodiscard]] std::string holds(const char* attribute) const;
  void add_children(const MjcfFile& file, const pugi::xml_node& node, std::vector<MjcfElement>& found) const;
  [[nodiscard]] std::optional<MjcfElement> find_body(const std::string& name) const;  ///< at any depth
  void add_attached(const pugi::xml_node& attach, std::vector<MjcfElement>& found) const;

  MjcfSource* source_;
  const MjcfFile* file_;
  pugi::xml_node node_;
  std::string what_;
  std::string childclass_{}, suffix_{};
  const std::map<std::string, std::string, std::less<>>* defaults_ = nullptr;
};

}  // namespace manyhands::io
