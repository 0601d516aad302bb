#include "manyhands/model/io/sdf/sdf_element.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/io/sdf/sdf.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

constexpr double kLargest = 1e12;
constexpr double kUnlimited = 1e15;  // from there on a limit is none: SDF's own defaults are 1e16

double checked(const SdfElement& e, double value, const std::string& holds) {
  if (std::abs(value) > kLargest) e.fail(holds + "; expected at most 1e12");
  return value;
}

}  // namespace

SdfElement SdfElement::child(const char* tag) const {
  const pugi::xml_node first = node_.child(tag);
  for (pugi::xml_node next = first.next_sibling(tag); next; next = next.next_sibling(tag)) {
    SdfElement(*file_, next, what_)
        .note(LoadAction::kIgnored, "a further <" + std::string(tag) + ">; only the first counts");
  }
  return {*file_, first, what_};
}

std::vector<SdfElement> SdfElement::children(const char* tag) const {
  std::vector<SdfElement> found;
  for (const pugi::xml_node& node : node_.children()) {
    if (node.type() == pugi::node_element && (tag == nullptr || std::string_view(node.name()) == tag)) {
      found.emplace_back(*file_, node, what_);
    }
  }
  return found;
}

bool SdfElement::has_within(std::string_view tag) const {
  return static_cast<bool>(node_.find_node([&](const pugi::xml_node& node) { return tag == node.name(); }));
}

std::string SdfElement::name() const {
  std::string value = attribute("name");
  if (value.empty()) fail("<" + std::string(tag()) + "> has no name; expected one such as name=\"part\"");
  return value;
}

std::string SdfElement::text() const {
  std::string_view value = node_.child_value();
  if (value.empty()) value = node_.attribute("value").value();
  const std::size_t begin = value.find_first_not_of(" \t\r\n");
  if (begin == value.npos) return "";
  return std::string(value.substr(begin, value.find_last_not_of(" \t\r\n") - begin + 1));
}

std::string SdfElement::holds() const { return "<" + std::string(tag()) + "> holds " + in_quotes(text()); }

double SdfElement::number() const { return numbers(1)[0]; }

std::vector<double> SdfElement::numbers(std::size_t count) const {
  const std::string value = text();
  const std::vector<std::string_view> parts = split_blanks(value);
  const std::string expected = "; expected " + std::to_string(count) + (count == 1 ? " number" : " numbers");
  if (parts.size() < count) fail(holds() + expected);
  std::vector<double> result;
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<double> number = parse_number(parts[i]);
    if (!number) fail(holds() + expected);
    result.push_back(checked(*this, *number, holds()));
  }
  if (parts.size() > count) note(LoadAction::kRepaired, holds() + "; the first " + std::to_string(count) + " taken");
  return result;
}

bool SdfElement::flag() const {
  const std::string value = text();
  if (value == "1" || value == "true" || value == "True") return true;
  if (value != "0" && value != "false" && value != "False") fail(holds() + "; expected true or false");
  return false;
}

double SdfElement::number_or(const char* tag, double value) const {
  const SdfElement found = child(tag);
  return found ? found.number() : value;
}

double SdfElement::limit_or(const char* tag, double value) const {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const SdfElement found = child(tag);
  if (!found) return value;
  const std::string text = found.text();
  if (text == "inf" || text == "+inf") return kInfinite;
  if (text == "-inf") return -kInfinite;
  const std::optional<double> number = parse_number(text);
  if (!number) found.fail(found.holds() + "; expected one number");
  return std::abs(*number) < kUnlimited ? *number : std::copysign(kInfinite, *number);
}

double SdfElement::positive_or(const char* tag, double value) const {
  const SdfElement found = child(tag);
  if (!found) return value;
  const double number = found.number();
  if (number >= 0) return number;
  found.note_serious(LoadAction::kRepaired, found.holds() + ", which is negative; 0 taken");
  return 0;
}

double SdfElement::restitution_or(const char* tag, double value) const {
  const double number = positive_or(tag, value);
  if (number <= 1) return number;
  const SdfElement found = child(tag);
  found.note_serious(LoadAction::kRepaired, found.holds() + ", which would make energy; 1 taken");
  return 1;
}

Vec3<double> SdfElement::vec3_or(const char* tag, const Vec3<double>& value) const {
  const SdfElement found = child(tag);
  if (!found) return value;
  const std::vector<double> v = found.numbers(3);
  return {v[0], v[1], v[2]};
}

bool SdfElement::flag_or(const char* tag, bool value) const {
  const SdfElement found = child(tag);
  return found ? found.flag() : value;
}

std::string SdfElement::text_or(const char* tag, const std::string& value) const {
  const SdfElement found = child(tag);
  return found ? found.text() : value;
}

SdfPose SdfElement::pose() const {
  const SdfElement pose = child("pose");
  if (!pose) return {};
  SdfPose result{.relative_to = pose.attribute("relative_to")};
  if (result.relative_to.empty()) result.relative_to = pose.attribute("frame");  // its name up to SDF 1.6
  if (pose.text().empty()) return result;
  if (pose.attribute("rotation_format") == "quat_xyzw") {
    const std::vector<double> v = pose.numbers(7);
    const Quat<double> q{v[3], v[4], v[5], v[6]};
    if (!(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w > 1e-9)) pose.fail(pose.holds() + ", a quaternion of length 0");
    result.X = {to_matrix(normalized(q)), {v[0], v[1], v[2]}};
    return result;
  }
  const std::vector<double> v = pose.numbers(6);
  const std::string degrees = pose.attribute("degrees");
  const double unit = degrees == "true" || degrees == "1" ? std::numbers::pi / 180 : 1;
  result.X = {rotation_from_rpy(unit * Vec3<double>{v[3], v[4], v[5]}), {v[0], v[1], v[2]}};
  return result;
}

void SdfElement::expect(std::initializer_list<std::string_view> tags) const {
  for (const SdfElement& child : children()) {
    if (std::ranges::find(tags, child.tag()) != tags.end()) continue;
    child.note(LoadAction::kIgnored, "<" + std::string(child.tag()) + "> in <" + std::string(tag()) + "> is not used");
  }
}

void SdfElement::fail(const std::string& message) const { throw SdfError(file_->name, line(), what_ + ": " + message); }

void SdfElement::note(LoadAction action, std::string message) const {
  (*file_->report)->notes.push_back({action, file_->name, line(), what_, std::move(message)});
}

void SdfElement::note_serious(LoadAction action, std::string message) const {
  note(action, std::move(message));
  (*file_->report)->notes.back().serious = true;
}

}  // namespace manyhands::io
