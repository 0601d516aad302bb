#include "manyhands/model/io/urdf/urdf_element.h"

#include <algorithm>
#include <cmath>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/io/urdf/urdf.h"

namespace manyhands::io {

namespace {

constexpr double kLargest = 1e12;

bool is_listed(std::initializer_list<std::string_view> list, std::string_view name) {
  return std::ranges::find(list, name) != list.end();
}

}  // namespace

UrdfElement UrdfElement::child(const char* tag) const {
  const pugi::xml_node first = node_.child(tag);
  for (pugi::xml_node next = first.next_sibling(tag); next; next = next.next_sibling(tag)) {
    UrdfElement(*source_, next, what_)
        .note(LoadAction::kIgnored, "a further <" + std::string(tag) + ">; only the first counts");
  }
  return {*source_, first, what_};
}

UrdfElement UrdfElement::required_child(const char* tag, const std::string& example) const {
  UrdfElement found = child(tag);
  if (!found) fail("<" + std::string(this->tag()) + "> has no <" + tag + ">; expected " + example);
  return found;
}

std::vector<UrdfElement> UrdfElement::children(const char* tag) const {
  std::vector<UrdfElement> found;
  for (const pugi::xml_node& node : node_.children(tag)) found.emplace_back(*source_, node, what_);
  return found;
}

std::vector<UrdfElement> UrdfElement::children() const {
  std::vector<UrdfElement> found;
  for (const pugi::xml_node& node : node_.children()) {
    if (node.type() == pugi::node_element) found.emplace_back(*source_, node, what_);
  }
  return found;
}

std::string UrdfElement::attribute_name(const char* attribute) const {
  return "attribute '" + std::string(attribute) + "' of <" + std::string(tag()) + ">";
}

std::string_view UrdfElement::text_or_empty(const char* attribute) const { return node_.attribute(attribute).value(); }

std::string UrdfElement::text(const char* attribute) const {
  if (!has(attribute)) fail(attribute_name(attribute) + " is missing");
  std::string value = node_.attribute(attribute).value();
  if (value.empty()) fail(attribute_name(attribute) + " is empty");
  return value;
}

double UrdfElement::number(const char* attribute, Magnitude magnitude) const {
  return read_numbers(attribute, 1, "one finite number", magnitude)[0];
}

std::optional<double> UrdfElement::optional_number(const char* attribute, Magnitude magnitude) const {
  return has(attribute) ? std::optional(number(attribute, magnitude)) : std::nullopt;
}

std::vector<double> UrdfElement::numbers(const char* attribute, std::size_t count, const char* example) const {
  const std::string expected = std::to_string(count) + " finite numbers between blanks, such as \"" + example + "\"";
  return read_numbers(attribute, count, expected, Magnitude::kPhysical);
}

// Two slips that files in use have, and whose meaning is plain, are repaired: punctuation after a number, and more
// numbers than there should be.
std::vector<double> UrdfElement::read_numbers(const char* attribute, std::size_t count, const std::string& expected,
                                              Magnitude magnitude) const {
  const std::string value = substituted(attribute);
  const std::string holds = attribute_name(attribute) + " holds " + in_quotes(value);
  const std::vector<std::string_view> parts = split_blanks(value);
  if (parts.size() < count) fail(holds + "; expected " + expected);
  bool repaired = parts.size() > count;
  std::vector<double> result;
  for (std::string_view part : parts) {
    std::optional<double> number = parse_number(part);
    if (!number && part.find_last_of(",;.") == part.size() - 1) {
      part.remove_suffix(1);
      number = parse_number(part);
      repaired = true;
    }
    if (!number) fail(holds + "; expected " + expected);
    if (magnitude == Magnitude::kPhysical && std::abs(*number) > kLargest) fail(holds + "; expected at most 1e12");
    result.push_back(*number);
  }
  result.resize(count);
  if (repaired) {
    std::string taken;
    for (const double x : result) taken += " " + format_number(x);
    note(LoadAction::kRepaired, holds + ";" + taken + " taken");
  }
  return result;
}

/// roslaunch's $(optenv NAME default) is left in some files in use: its default is what was meant.
std::string UrdfElement::substituted(const char* attribute) const {
  std::string value = text(attribute);
  constexpr std::string_view kOptenv = "$(optenv ";
  if (!value.starts_with(kOptenv) || !value.ends_with(')')) return value;
  const std::size_t name_end = value.find(' ', kOptenv.size());
  if (name_end == value.npos) return value;
  std::string chosen = value.substr(name_end + 1, value.size() - name_end - 2);
  note(LoadAction::kRepaired, attribute_name(attribute) + " holds " + in_quotes(value) + "; its default taken");
  return chosen;
}

Vec3<double> UrdfElement::vec3(const char* attribute, const char* example) const {
  const std::vector<double> v = numbers(attribute, 3, example);
  return {v[0], v[1], v[2]};
}

Vec3<double> UrdfElement::vec3_or(const char* attribute, const Vec3<double>& value) const {
  return has(attribute) ? vec3(attribute, "0 0 1") : value;
}

Transform<double> UrdfElement::origin() const {
  const UrdfElement origin = child("origin");
  if (!origin) return Transform<double>::identity();
  origin.expect({"xyz", "rpy"});
  const Vec3<double> rpy = origin.vec3_or("rpy", Vec3<double>::zero());
  return {rotation_from_rpy(rpy), origin.vec3_or("xyz", Vec3<double>::zero())};
}

std::optional<std::string_view> UrdfElement::attribute_with_substitution() const {
  for (const pugi::xml_attribute& attribute : node_.attributes()) {
    const std::string_view value = attribute.value();
    if (value.starts_with("$(optenv ")) continue;
    if (value.find("${") != value.npos || value.find("$(") != value.npos) return value;
  }
  return std::nullopt;
}

void UrdfElement::expect(std::initializer_list<std::string_view> attributes,
                         std::initializer_list<std::string_view> child_tags) const {
  const std::string own_tag = "<" + std::string(tag()) + ">";
  for (const pugi::xml_attribute& attribute : node_.attributes()) {
    const std::string_view name = attribute.name();
    if (is_listed(attributes, name) || name.starts_with("xmlns")) continue;
    note(LoadAction::kIgnored, "attribute " + in_quotes(name) + " of " + own_tag + " is not used");
  }
  for (const pugi::xml_node& node : node_.children()) {
    const UrdfElement child(*source_, node, what_);
    if (node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata) {
      const std::vector<std::string_view> words = split_blanks(node.value());
      if (!words.empty()) note(LoadAction::kIgnored, "text " + in_quotes(words[0]) + "... in " + own_tag);
    } else if (node.type() == pugi::node_element && !is_listed(child_tags, child.tag())) {
      child.note(LoadAction::kIgnored, "<" + std::string(child.tag()) + "> in " + own_tag + " is not used");
    }
  }
}

void UrdfElement::fail(const std::string& message) const {
  throw UrdfError(source_->file, line(), what_ + ": " + message);
}

void UrdfElement::note(LoadAction action, std::string message) const {
  source_->report.notes.push_back({action, source_->file, line(), what_, std::move(message)});
}

void UrdfElement::note_serious(LoadAction action, std::string message) const {
  note(action, std::move(message));
  source_->report.notes.back().serious = true;
}

}  // namespace manyhands::io
