// An element of an SDF file. Values are texts of child elements; every error and note carries file and line.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/math/spatial.h"
#include "manyhands/model/io/package_paths.h"
#include "manyhands/model/io/xml_file.h"
#include "manyhands/model/load_report.h"

namespace manyhands::io {

/// One file of those that belong together.
struct SdfFile {
  std::string name;
  XmlFile xml;
  PackagePaths paths;   ///< where its relative names start
  int version;          ///< of the format: 106 for 1.6
  LoadReport** report;  ///< where notes go at present
};

/// A <pose> as it is written.
struct SdfPose {
  Transform<double> X = Transform<double>::identity();
  std::string relative_to{};  ///< empty: the frame that is usual there
};

class SdfElement {
 public:
  /// `what` names the part in messages, for example "link 'hand'".
  SdfElement(const SdfFile& file, pugi::xml_node node, std::string what)
      : file_(&file), node_(node), what_(std::move(what)) {}

  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(node_); }
  [[nodiscard]] const SdfFile& file() const { return *file_; }
  [[nodiscard]] std::string_view tag() const { return node_.name(); }
  [[nodiscard]] int line() const { return file_->xml.line(node_); }
  [[nodiscard]] const std::string& what() const { return what_; }
  /// The same element under another name for messages.
  [[nodiscard]] SdfElement named(std::string what) const { return {*file_, node_, std::move(what)}; }

  /// The first child of that tag, or an empty element; further ones are noted as ignored.
  [[nodiscard]] SdfElement child(const char* tag) const;
  [[nodiscard]] std::vector<SdfElement> children(const char* tag = nullptr) const;
  [[nodiscard]] bool has(const char* tag) const { return static_cast<bool>(node_.child(tag)); }
  /// Whether an element of that tag is anywhere within.
  [[nodiscard]] bool has_within(std::string_view tag) const;

  // ---- attributes ------------------------------------------------------------------------------------------------
  [[nodiscard]] std::string attribute(const char* name) const { return node_.attribute(name).value(); }
  [[nodiscard]] std::string name() const;  ///< its attribute 'name'; fails if that is missing or empty

  // ---- its own text ----------------------------------------------------------------------------------------------
  [[nodiscard]] std::string text() const;  ///< without blanks around it; of Bullet's, its attribute 'value'
  [[nodiscard]] double number() const;
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const;  ///< fails if there are fewer
  [[nodiscard]] bool flag() const;                                     ///< 1, true, 0 or false

  // ---- texts of children -----------------------------------------------------------------------------------------
  [[nodiscard]] double number_or(const char* tag, double value) const;
  /// The same without bounds: numbers so large that they stand for none, and inf, become infinite.
  [[nodiscard]] double limit_or(const char* tag, double value) const;
  /// The same, 0 or more; what is negative is repaired to 0.
  [[nodiscard]] double positive_or(const char* tag, double value) const;
  /// The same, 0 to 1; what is above is repaired to 1.
  [[nodiscard]] double restitution_or(const char* tag, double value) const;
  [[nodiscard]] Vec3<double> vec3_or(const char* tag, const Vec3<double>& value) const;
  [[nodiscard]] bool flag_or(const char* tag, bool value) const;
  [[nodiscard]] std::string text_or(const char* tag, const std::string& value) const;
  /// Its <pose>, or the identity.
  [[nodiscard]] SdfPose pose() const;

  /// Notes every child element that is not listed as ignored.
  void expect(std::initializer_list<std::string_view> tags) const;

  [[noreturn]] void fail(const std::string& message) const;
  void note(LoadAction action, std::string message) const;
  /// A note that Python warns of.
  void note_serious(LoadAction action, std::string message) const;

 private:
  [[nodiscard]] std::string holds() const;

  const SdfFile* file_;
  pugi::xml_node node_;
  std::string what_;
};

}  // namespace manyhands::io
